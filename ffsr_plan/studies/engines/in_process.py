"""The engine that runs one task after the other, in this process."""

from __future__ import annotations

from collections import deque

from ffsr_plan.studies.engines.engine import Job, JobEnd
from ffsr_plan.studies.engines.worker_side import process_name
from ffsr_plan.studies.tasks.grid import Grid
from ffsr_plan.studies.tasks.task_run import run_task


class InProcess:
    """See `Engine`."""

    in_this_process = True

    def __init__(self, grid: Grid) -> None:
        """See the class.

        Args:
            grid: the study.
        """
        self._grid, self._name, self._waiting = grid, process_name(), deque[Job]()

    def slots(self) -> int:
        """One."""
        return 1

    def submit(self, job: Job) -> None:
        """See `Engine`."""
        self._waiting.append(job)

    def next(self, timeout: float) -> JobEnd | None:
        """Run the next job, however long it takes."""
        if not self._waiting:
            return None
        job = self._waiting.popleft()
        outcomes = tuple(run_task(self._grid, task, self._name) for task in job.tasks)
        return JobEnd(job.number, outcomes)

    def close(self) -> None:
        """Drop the jobs that wait."""
        self._waiting.clear()
