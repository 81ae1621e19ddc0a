"""The run of a study: tasks go out to an engine, rows come in, whatever happens to workers."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterator
from typing import NamedTuple

from ffsr_plan.studies.engines.engine import Engine, Job, JobEnd
from ffsr_plan.studies.interruption import Interruption
from ffsr_plan.studies.records.record import Record
from ffsr_plan.studies.tasks.grid import Grid, Task
from ffsr_plan.studies.tasks.row import FAULT, PLAN, Outcome
from ffsr_plan.studies.tasks.task_run import begun_row

RETRIES = 2
"""How often a task is done again whose worker died; then it is a fault."""
_POLL = 0.2  # [s] between two looks at Ctrl-C
_JOB = 1.0  # [s] that a job should take at least
_MOST_TASKS = 100  # of a job
_SHARES = 4  # jobs that each worker gets at least, as far as there are tasks
_AHEAD = 2  # jobs in hand for each worker: one that it runs, and the next one
_SMOOTHING = 0.2  # weight of the last task in the mean duration of tasks


class StudyProgress(NamedTuple):
    """How far a study has come.

    Attributes:
        done: tasks that have a row, those of earlier runs included.
        total: all tasks.
        failed: rows of this run without a plan.
        workers: that are at work at the moment.
        notice: what has just happened to a worker; empty otherwise.
    """

    done: int
    total: int
    failed: int
    workers: int
    notice: str = ""


OnProgress = Callable[[StudyProgress], object]


class Run:
    """One run of a study."""

    def __init__(
        self,
        grid: Grid,
        record: Record,
        engine: Engine,
        on_progress: OnProgress,
        retry_failed: bool,
    ) -> None:
        """See the class.

        Args:
            grid: the study.
            record: of the study.
            engine: what runs its tasks.
            on_progress: called whenever rows have been written.
            retry_failed: whether tasks are done again whose row has no plan.
        """
        self._grid, self._record, self._engine = grid, record, engine
        self._on_progress, self._replace = on_progress, retry_failed
        self._known = record.done(failed_too=not retry_failed)
        self._total = len(grid)
        self._left = 0
        self._failed, self._number = 0, 0
        self._mean = math.nan  # [s] of a task
        self._jobs: dict[int, Job] = {}
        self._again: deque[Task] = deque()
        self._lost: dict[str, list[str]] = {}

    def go(self, interruption: Interruption) -> None:
        """Run all tasks that have no row yet.

        Args:
            interruption: tells of Ctrl-C, after which no more tasks are begun.

        Raises:
            InvalidInput: a file that cannot be written, or a grid that does not fit to the rows.
        """
        self._left = self._count()
        tasks = self._remaining()
        self._tell()
        while not interruption.pressed:
            self._fill(tasks)
            if not self._jobs:
                break
            interruption.raises = self._engine.in_this_process
            try:
                end = self._engine.next(_POLL)
            except KeyboardInterrupt:
                break
            finally:
                interruption.raises = False
            if end is not None:
                self._take(end)

    def _count(self) -> int:
        """The number of tasks that have no row, after a look at those that have."""
        count = 0
        for task in self._remaining():
            self._record.refuse_another(self._grid, task)
            count += 1
        return count

    def _remaining(self) -> Iterator[Task]:
        return (task for task in self._grid.tasks() if task.key not in self._known)

    def _fill(self, tasks: Iterator[Task]) -> None:
        """Hand out jobs until all workers have enough of them.

        While there are tasks whose worker died, no worker gets a job beside the one that it runs:
        the next one that dies tells which task it is that kills workers.
        """
        ahead = 1 if self._engine.in_this_process or self._lost else _AHEAD
        most = ahead * self._engine.slots()
        while len(self._jobs) < most:
            chosen = self._next_tasks(tasks)
            if not chosen:
                return
            self._number += 1
            job = Job(self._number, tuple(chosen))
            self._jobs[job.number] = job
            self._engine.submit(job)

    def _next_tasks(self, tasks: Iterator[Task]) -> list[Task]:
        if self._again:  # alone: the worker of one of them died, and it is not known of which
            return [self._again.popleft()]
        chosen = []
        for _ in range(self._size()):
            task = next(tasks, None)
            if task is None:
                break
            chosen.append(task)
        return chosen

    def _size(self) -> int:
        """Number of tasks of the next job."""
        if self._engine.in_this_process or math.isnan(self._mean):
            return 1
        wanted = math.ceil(_JOB / max(self._mean, _JOB / _MOST_TASKS))
        return max(1, min(wanted, self._left // (_SHARES * self._engine.slots())))

    def _take(self, end: JobEnd) -> None:
        """Write what has come in, all in one transaction."""
        outcomes, notices = list[Outcome](), list[str]()
        next_end: JobEnd | None = end
        while next_end is not None:
            outcomes += self._outcomes(next_end, notices)
            next_end = None if self._engine.in_this_process else self._engine.next(0.0)
        if outcomes:
            self._record.write(outcomes, self._replace)
        for outcome in outcomes:
            self._left -= 1
            self._failed += outcome.row["outcome"] != PLAN
            self._learn(outcome)
        for notice in notices or [""]:
            self._tell(notice)

    def _outcomes(self, end: JobEnd, notices: list[str]) -> list[Outcome]:
        """The outcomes of a job; tasks without one are done again, or become faults."""
        job = self._jobs.pop(end.number)
        for worker in end.lost:
            names = ", ".join(self._name(task) for task in job.tasks[:3])
            more = f" and {len(job.tasks) - 3} more" if len(job.tasks) > 3 else ""
            notices.append(f"worker lost: {worker}, with {names}{more}")
            for task in job.tasks:
                self._lost.setdefault(task.key, []).append(worker)
        if end.outcomes is not None:
            return [self._with_losses(outcome) for outcome in end.outcomes]
        if end.fault:
            return [self._fault(task, "WorkerError", end.fault) for task in job.tasks]
        found = []
        for task in job.tasks:
            lost = self._lost.get(task.key, [])
            if len(job.tasks) == 1 and len(lost) > RETRIES:
                text = f"{len(lost)} workers died while they ran this task: {', '.join(lost)}"
                found.append(self._fault(task, "WorkerDied", text))
            else:
                self._again.append(task)
        return found

    def _fault(self, task: Task, error: str, message: str) -> Outcome:
        row = begun_row(self._grid, task)
        row |= {"outcome": FAULT, "error": error, "message": message}
        return self._with_losses(Outcome(row))

    def _with_losses(self, outcome: Outcome) -> Outcome:
        import json

        lost = self._lost.pop(str(outcome.row["key"]), [])
        outcome.row["lost_workers"] = json.dumps(lost)
        return outcome

    def _learn(self, outcome: Outcome) -> None:
        """Take the duration of a task into the mean; the first one may have compiled kernels."""
        wall = outcome.row["wall"]
        if isinstance(wall, float):
            before = wall if math.isnan(self._mean) else self._mean
            self._mean = (1.0 - _SMOOTHING) * before + _SMOOTHING * wall

    def _tell(self, notice: str = "") -> None:
        done, slots = self._total - self._left, self._engine.slots()
        self._on_progress(StudyProgress(done, self._total, self._failed, slots, notice))

    def _name(self, task: Task) -> str:
        problem, planner = self._grid.sources[task.problem].name, self._grid.planners[task.planner]
        return f"'{problem}' by {planner.name}, seed {task.seed}"
