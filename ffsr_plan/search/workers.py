"""Independent colonies on worker processes, by loky.

Each worker has an executor of its own, so that the one that dies can be named. Workers do not run
the caller's `__main__` again. They never receive Ctrl-C: the caller asks them, through an event,
for what they have, or ends them. Workers whose caller has died end by themselves.
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Iterator
from concurrent.futures import wait
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from ffsr_plan.core.errors import WorkerDied
from ffsr_plan.core.kernels import announcement
from ffsr_plan.core.kernels.compiling_time import Stopwatch, add_compiled
from ffsr_plan.search.records import SearchMonitor, SearchRequest

Job = TypeVar("Job")
Outcome = TypeVar("Outcome")
if TYPE_CHECKING:
    from loky import ProcessPoolExecutor

    # numpy loads its generators when they are first named
    Run = Callable[[Job, list[np.random.Generator], SearchMonitor], list[Outcome]]

_POLL = 0.2  # [s] between checks for results and Ctrl-C
_stop_event: Any = None  # in a worker: set by the caller when Ctrl-C was pressed
_caller = 0  # in a worker: the process that started it


def run_on_workers(
    run: Run[Job, Outcome],
    job: Job,
    rngs: list[np.random.Generator],
    request: SearchRequest,
) -> list[Outcome]:
    """One outcome for each generator, in their order, whatever the number of workers.

    Args:
        run: a function of a module, called in a worker with the job, its share of the generators
            and a monitor; returns one outcome a generator, fewer if it was stopped.
        job: whatever `run` needs; it has to be picklable.
        rngs: one a colony.
        request: number of processes, stopping condition, and the time for the searches of each
            worker from when it has started.

    Raises:
        WorkerDied: with the worker's number, its colonies and its exit status.
    """
    from loky import ProcessPoolExecutor
    from loky.backend.context import get_context
    from loky.process_executor import TerminatedWorkerError

    workers = min(request.workers, len(rngs))
    shares = [list(range(w, len(rngs), workers)) for w in range(workers)]
    stop, token = get_context("loky").Event(), get_context("loky").Lock()
    announcement.share(token)
    setting = (stop, token, os.getpid())
    executors = [ProcessPoolExecutor(1, initializer=_start, initargs=setting) for _ in shares]
    try:
        with _ctrl_c_blocked():
            futures = [
                executor.submit(_run_share, run, job, [rngs[k] for k in share], request.time_limit)
                for executor, share in zip(executors, shares, strict=True)
            ]
        request.begin()
        while wait(futures, timeout=_POLL).not_done:
            if request.stop_requested():
                stop.set()
        outcomes: dict[int, Outcome] = {}
        compiling = 0.0
        for worker, (share, future) in enumerate(zip(shares, futures, strict=True)):
            try:
                own, seconds = future.result()
            except TerminatedWorkerError as error:
                raise WorkerDied(worker, share, _exit_status(error)) from None
            outcomes |= zip(share, own, strict=False)  # fewer after Ctrl-C
            compiling = max(compiling, seconds)
        add_compiled(compiling)
    finally:
        _end(executors)
    return [outcomes[k] for k in sorted(outcomes)]


@contextmanager
def _ctrl_c_blocked() -> Iterator[None]:
    """Processes that the body starts never receive Ctrl-C; this one receives it after the body."""
    resource_tracker.ensure_running()  # to start it would end the block
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _end(executors: list[ProcessPoolExecutor]) -> None:
    """Kill the workers; Ctrl-C meanwhile is raised in the end."""
    interrupt: KeyboardInterrupt | None = None
    for executor in executors:
        try:
            executor.shutdown(wait=True, kill_workers=True)
        except KeyboardInterrupt as error:
            interrupt = error
            executor.shutdown(wait=True, kill_workers=True)
    if interrupt is not None:
        raise interrupt


def _start(stop: Any, token: announcement.Token, caller: int) -> None:  # noqa: ANN401 - of loky
    global _stop_event, _caller
    announcement.share(token)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _stop_event, _caller = stop, caller


def _run_share(
    run: Run[Job, Outcome], job: Job, rngs: list[np.random.Generator], time_limit: float
) -> tuple[list[Outcome], float]:
    """The outcomes, and the time that was spent compiling [s]."""
    deadline, watch = time.monotonic() + time_limit, Stopwatch()
    outcomes = run(job, rngs, SearchMonitor(None, deadline, _stop_requested))
    return outcomes, watch.compiling


def _stop_requested() -> bool:
    if os.getppid() != _caller:
        os._exit(1)
    return bool(_stop_event.is_set())


def _exit_status(error: Exception) -> str:
    """The exit status in loky's message, such as `SIGKILL(-9)`."""
    _, _, status = str(error).partition("The exit codes of the workers are {")
    return status.partition("}")[0] or "unknown"
