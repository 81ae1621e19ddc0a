"""One task from its problem to its row. Whatever goes wrong becomes a row too."""

from __future__ import annotations

import json
import math
import re
import time
import traceback
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime, timezone

from ffsr_plan.core.errors import FfsrPlanError, GoalPoseIgnored, InvalidInput, PlanningError
from ffsr_plan.core.kernels.compiling_time import Stopwatch
from ffsr_plan.problem.problem import Problem
from ffsr_plan.studies.tasks import row as rows
from ffsr_plan.studies.tasks.grid import Grid, Task
from ffsr_plan.studies.tasks.plan_figures import figures_of
from ffsr_plan.studies.tasks.planner_call import call_planner
from ffsr_plan.studies.tasks.row import Outcome, Row

_last: tuple[Grid, int, Problem] | None = None
_TIME_SPENT = re.compile(r" in [\d.e+-]+ s\b")
_LONGEST_TRACEBACK = 8000  # characters, the last of it


def run_task(grid: Grid, task: Task, worker: str) -> Outcome:
    """Plan, and describe what came of it.

    Args:
        grid: the study.
        task: one of its tasks.
        worker: name of the process.

    Raises:
        KeyboardInterrupt: Ctrl-C; there is no row then.
    """
    row, plan = begun_row(grid, task), None
    begin, spent, watch = time.perf_counter(), time.process_time(), Stopwatch()
    try:
        with warnings.catch_warnings(), _limited_memory(grid.memory_limit):
            warnings.simplefilter("ignore", GoalPoseIgnored)
            problem = _problem(grid, task.problem)
            watch = Stopwatch()
            found = call_planner(
                grid.planners[task.planner], problem, task.seed, grid.seconds(str(row["problem"]))
            )
            row["seconds"] = watch.computing
            figures, text = figures_of(problem, found, grid.plans)
        row |= figures
        if text is not None:
            name = f"{task.key}.{text.suffix}"
            plan = f"plans/{name[:2]}/{name}", text.content
            row["plan"] = plan[0]
    except Exception as error:
        row |= error_figures(error)
        row["seconds"] = watch.computing
    row["wall"], row["cpu"] = time.perf_counter() - begin, time.process_time() - spent
    row["worker"], row["finished"] = worker, datetime.now(timezone.utc).isoformat("T", "seconds")
    return Outcome(row, plan)


def begun_row(grid: Grid, task: Task) -> Row:
    """The columns of a row that say which task it belongs to.

    Args:
        grid: the study.
        task: one of its tasks.
    """
    source, planner = grid.sources[task.problem], grid.planners[task.planner]
    axes = json.dumps({**source.axes, **planner.axes})
    row: Row = dict.fromkeys(rows.COLUMNS)
    return row | {
        "key": task.key,
        "problem": source.name,
        "planner": planner.name,
        "seed": task.seed,
        "axes": axes,
        "figures": "{}",
        "lost_workers": "[]",
        "version": rows.package_version(),
    }


def error_figures(error: Exception) -> Row:
    """The columns of a row that say what went wrong.

    Args:
        error: what was raised.
    """
    if isinstance(error, PlanningError):
        outcome = rows.NO_PLAN
    elif isinstance(error, InvalidInput):
        outcome = rows.INVALID
    else:
        outcome = rows.FAULT
    message = _TIME_SPENT.sub("", str(error), 1) if isinstance(error, FfsrPlanError) else str(error)
    found: Row = {"outcome": outcome, "error": type(error).__name__, "message": message}
    if outcome == rows.FAULT:
        found["traceback"] = "".join(traceback.format_exception(error))[-_LONGEST_TRACEBACK:]
    return found


def _problem(grid: Grid, number: int) -> Problem:
    """A problem of a study; that of the last task is kept, as the next one often has the same."""
    global _last
    if _last is None or _last[0] is not grid or _last[1] != number:
        _last = None  # two large problems need not be in memory
        _last = grid, number, grid.sources[number].problem()
    return _last[2]


@contextmanager
def _limited_memory(limit: int | None) -> Iterator[None]:
    """In the body, memory beyond what is in use now is refused by a MemoryError."""
    if limit is None or math.isinf(limit):
        yield
        return
    import os
    import resource

    before = resource.getrlimit(resource.RLIMIT_AS)
    with open("/proc/self/statm", encoding="ascii") as file:
        now = int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    most = now + limit if before[1] == resource.RLIM_INFINITY else min(now + limit, before[1])
    resource.setrlimit(resource.RLIMIT_AS, (most, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)
