"""The engine that runs jobs on processes of this computer, by loky.

Each worker has an executor of its own: one that dies takes no other along, and can be named.
"""

from __future__ import annotations

import os
import queue
from collections import deque
from concurrent.futures import Future
from typing import TYPE_CHECKING, Any

from ffsr_plan.search.workers import ctrl_c_blocked, exit_status
from ffsr_plan.studies.engines.engine import Job, JobEnd
from ffsr_plan.studies.engines.worker_side import packed, process_name, run_job, start_process
from ffsr_plan.studies.tasks.grid import Grid

if TYPE_CHECKING:
    from loky import ProcessPoolExecutor

_End = tuple[int, Any, Job, Future[Any]]  # worker, its executor, what it did and how that ended
_STUDY = "study"  # the only one of its processes
_AHEAD = 2  # jobs that a worker has in hand: one that it runs, and the next one


class Processes:
    """See `Engine`."""

    in_this_process = False

    def __init__(self, grid: Grid, workers: int) -> None:
        """Processes start with their first job.

        Args:
            grid: the study.
            workers: number of processes.

        Raises:
            InvalidInput: a planner that cannot be pickled.
        """
        self._blob, self._workers = packed(grid), workers
        self._executors: list[ProcessPoolExecutor | None] = [None] * workers
        self._in_hand: list[deque[Job]] = [deque() for _ in range(workers)]
        self._ends: queue.SimpleQueue[_End] = queue.SimpleQueue()

    def slots(self) -> int:
        """The number of workers."""
        return self._workers

    def submit(self, job: Job) -> None:
        """Give a job to the worker with the fewest in hand."""
        worker = min(range(self._workers), key=lambda w: len(self._in_hand[w]))
        self._in_hand[worker].append(job)
        if len(self._in_hand[worker]) <= _AHEAD:
            self._send(worker, job)

    def next(self, timeout: float) -> JobEnd | None:
        """See `Engine`."""
        from loky.process_executor import BrokenProcessPool

        try:
            worker, executor, job, future = self._ends.get(timeout=timeout)
        except queue.Empty:
            return None
        first = self._in_hand[worker][0].number == job.number
        self._in_hand[worker].remove(job)
        try:
            end = JobEnd(job.number, future.result())
        except BrokenProcessPool as error:
            if self._executors[worker] is executor:
                self._executors[worker] = None
            lost = f"worker {worker} of {process_name()} ({exit_status(error)})"
            return JobEnd(job.number, None, (lost,) if first else ())
        except Exception as error:  # of sending what came back
            return JobEnd(job.number, None, (), f"{type(error).__name__}: {error}")
        if len(self._in_hand[worker]) >= _AHEAD:
            self._send(worker, self._in_hand[worker][_AHEAD - 1])
        return end

    def close(self) -> None:
        """Kill the workers."""
        for executor in filter(None, self._executors):
            executor.shutdown(wait=True, kill_workers=True)
        self._executors = [None] * self._workers

    def _send(self, worker: int, job: Job) -> None:
        from loky import ProcessPoolExecutor
        from loky.process_executor import BrokenProcessPool

        executor = self._executors[worker]
        with ctrl_c_blocked():
            if executor is None:
                arguments = os.getpid(), _STUDY, self._blob
                executor = ProcessPoolExecutor(1, initializer=start_process, initargs=arguments)
                self._executors[worker] = executor
            try:
                future = executor.submit(run_job, _STUDY, job)
            except BrokenProcessPool as error:  # it died after its last job
                future = Future()
                future.set_exception(error)
        future.add_done_callback(lambda done: self._ends.put((worker, executor, job, done)))
