"""What a worker process does: it reads the study once, then runs its jobs."""

from __future__ import annotations

import os
import pickle
import platform
import signal
import threading
import time

from ffsr_plan.core.kernels import announcement
from ffsr_plan.studies.engines.engine import Job
from ffsr_plan.studies.tasks.grid import Grid
from ffsr_plan.studies.tasks.row import Outcome
from ffsr_plan.studies.tasks.task_run import run_task

_POLL = 1.0  # [s] between two looks at the process that started this one
_grids: dict[str, Grid] = {}  # by the name of the study: users of a cluster may share workers
_one_job = threading.RLock()  # workers of a cluster may have several threads; tasks need one


def packed(grid: Grid) -> bytes:
    """A grid as bytes that other processes can read; classes of `__main__` are in it by value.

    Args:
        grid: the study.

    Raises:
        InvalidInput: a planner that cannot be pickled.
    """
    import cloudpickle

    from ffsr_plan.core.errors import InvalidInput

    for named in grid.planners:
        try:
            cloudpickle.dumps(named.planner)
        except Exception as error:
            what, allowed = f"planners.{named.name}", f"a planner that can be pickled ({error})"
            raise InvalidInput(what, named.planner, allowed) from None
    blob: bytes = cloudpickle.dumps(grid)
    return blob


def run_job(study: str, job: Job, worker: str = "") -> tuple[Outcome, ...]:
    """Run the tasks of a job in this process, which holds the study; one job at a time.

    Args:
        study: name of the study.
        job: the job.
        worker: where this process is, beside its computer and number.
    """
    name = f"{process_name()} {worker}".strip()
    with _one_job:
        return tuple(run_task(_grids[study], task, name) for task in job.tasks)


def process_name() -> str:
    """Computer and number of this process."""
    return f"{platform.node()}:{os.getpid()}"


def start_process(caller: int, study: str, blob: bytes) -> None:
    """Prepare a worker process of this computer: it ends when its caller does, and not by Ctrl-C.

    Args:
        caller: number of the process that started it.
        study: name of the study.
        blob: the study, see `packed`.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(caller,), daemon=True).start()
    hold(study, blob)


def hold(study: str, blob: bytes) -> None:
    """Read a study, and hold it for its jobs.

    Args:
        study: name of the study.
        blob: the study, see `packed`.
    """
    announcement.withhold()
    with _one_job:
        _grids[study] = pickle.loads(blob)


def forget(study: str) -> None:
    """Hold a study no longer.

    Args:
        study: its name.
    """
    with _one_job:
        _grids.pop(study, None)


def _end_with(caller: int) -> None:
    while os.getppid() == caller:
        time.sleep(_POLL)
    os._exit(1)
