"""Independent colonies on worker processes, by loky.

Each worker has an executor of its own, so that the one that dies can be named. Workers do not run
the caller's `__main__` again. They ignore Ctrl-C: the first one asks them, through an event, for
what they have; a second one ends them.
"""

from __future__ import annotations

import signal
import time
from collections.abc import Callable
from concurrent.futures import Future, wait
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from ffsr_plan.core.errors import WorkerDied
from ffsr_plan.search.records import SearchMonitor

Job = TypeVar("Job")
Outcome = TypeVar("Outcome")
if TYPE_CHECKING:  # numpy loads its generators when they are first named
    Run = Callable[[Job, list[np.random.Generator], SearchMonitor], list[Outcome]]

_POLL = 0.2  # [s] between checks for Ctrl-C
_stop_event: Any = None  # in a worker: set by the caller when Ctrl-C was pressed


def run_on_workers(
    run: Run[Job, Outcome],
    job: Job,
    rngs: list[np.random.Generator],
    workers: int,
    time_limit: float,
) -> list[Outcome]:
    """One outcome for each generator, in their order, whatever the number of workers.

    Args:
        run: a function of a module, called in a worker with the job, its share of the generators
            and a monitor; returns one outcome a generator, fewer if it was stopped.
        job: whatever `run` needs; it has to be picklable.
        rngs: one a colony.
        workers: number of processes.
        time_limit: [s] for the searches of each worker, from when it has started.

    Raises:
        WorkerDied: with the worker's number, its colonies and its exit status.
    """
    from loky import ProcessPoolExecutor
    from loky.backend.context import get_context
    from loky.process_executor import TerminatedWorkerError

    shares = [list(range(w, len(rngs), workers)) for w in range(min(workers, len(rngs)))]
    stop = get_context("loky").Event()
    executors = [ProcessPoolExecutor(1, initializer=_start, initargs=(stop,)) for _ in shares]
    try:
        futures = [
            executor.submit(_run_share, run, job, [rngs[k] for k in share], time_limit)
            for executor, share in zip(executors, shares, strict=True)
        ]
        _wait(futures, stop)
        outcomes: dict[int, Outcome] = {}
        for worker, (share, future) in enumerate(zip(shares, futures, strict=True)):
            try:
                outcomes |= zip(share, future.result(), strict=False)  # fewer after Ctrl-C
            except TerminatedWorkerError as error:
                raise WorkerDied(worker, share, _exit_status(error)) from None
    finally:
        for executor in executors:
            executor.shutdown(wait=True, kill_workers=True)
    return [outcomes[k] for k in sorted(outcomes)]


def _start(stop: Any) -> None:  # noqa: ANN401 - an event of loky's context has no public type
    global _stop_event
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _stop_event = stop


def _run_share(
    run: Run[Job, Outcome], job: Job, rngs: list[np.random.Generator], time_limit: float
) -> list[Outcome]:
    deadline = time.monotonic() + time_limit
    return run(job, rngs, SearchMonitor(None, deadline, lambda: bool(_stop_event.is_set())))


def _wait(futures: list[Future[Any]], stop: Any) -> None:  # noqa: ANN401
    """Wait for all. The first Ctrl-C asks the workers to stop, a second one is raised."""
    try:
        while wait(futures, timeout=_POLL).not_done:
            pass
    except KeyboardInterrupt:
        stop.set()
        while wait(futures, timeout=_POLL).not_done:
            pass


def _exit_status(error: Exception) -> str:
    """The exit status in loky's message, such as `SIGKILL(-9)`."""
    _, _, status = str(error).partition("The exit codes of the workers are {")
    return status.partition("}")[0] or "unknown"
