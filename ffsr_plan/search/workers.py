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
from concurrent.futures import Future, wait
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from ffsr_plan.core.kernels import announcement
from ffsr_plan.core.kernels.compiling_time import Stopwatch
from ffsr_plan.search.cluster_colonies import run_on_cluster
from ffsr_plan.search.colony_shares import outcomes_of, shares_of
from ffsr_plan.search.records import SearchMonitor, SearchRequest
from ffsr_plan.time_limit.deadline import Deadline

Job = TypeVar("Job")
Outcome = TypeVar("Outcome")
if TYPE_CHECKING:
    from loky import ProcessPoolExecutor

    # numpy loads its generators when they are first named
    Run = Callable[[Job, list[np.random.Generator], SearchMonitor], list[Outcome]]

_POLL = 0.01  # [s] between checks for results, Ctrl-C and the time
_STARTING = 3.0  # [s] that starting processes may take; with less time, colonies run in this one
_POLL_IN_WORKER = 0.001  # [s] between two looks at the caller and its event
_stop_event: Any = None  # in a worker: set by the caller when Ctrl-C was pressed
_begun: Any = None  # in a worker: set by it when it begins to work
_caller = 0  # in a worker: the process that started it
_stopped, _next_poll = False, 0.0  # in a worker: the event when last looked at, and when next


def in_process(request: SearchRequest) -> bool:
    """Whether colonies run in this process: with one worker, or too little time to start more."""
    if request.scheduler is not None:
        return False
    deadline = request.deadline or Deadline()
    return request.workers == 1 or deadline.remaining() < _STARTING


def run_apart(
    run: Run[Job, Outcome],
    job: Job,
    rngs: list[np.random.Generator],
    request: SearchRequest,
) -> list[Outcome]:
    """One outcome for each generator, from processes of this computer or from a cluster.

    Args:
        run: see `run_on_workers`.
        job: see `run_on_workers`.
        rngs: one a colony.
        request: number of processes or scheduler of the cluster, and the deadline.

    Raises:
        InvalidInput: no scheduler answers.
        OutOfTime: nothing came back by the deadline.
        WorkerDied: with the worker's number and its colonies.
    """
    spread = run_on_workers if request.scheduler is None else run_on_cluster
    return spread(run, job, rngs, request)


def run_on_workers(
    run: Run[Job, Outcome],
    job: Job,
    rngs: list[np.random.Generator],
    request: SearchRequest,
) -> list[Outcome]:
    """One outcome for each generator, in their order, whatever the number of workers.

    The deadline counts from the caller's beginning, so that starting processes is part of it.

    Args:
        run: a function of a module, called in a worker with the job, its share of the generators
            and a monitor; returns one outcome a generator, fewer if it was stopped.
        job: whatever `run` needs; it has to be picklable.
        rngs: one a colony.
        request: number of processes, and the deadline.

    Raises:
        OutOfTime: no process had started by the deadline.
        WorkerDied: with the worker's number, its colonies and its exit status.
    """
    from loky import ProcessPoolExecutor
    from loky.backend.context import get_context
    from loky.process_executor import TerminatedWorkerError

    workers = min(request.workers, len(rngs))
    shares = shares_of(len(rngs), workers)
    context, deadline = get_context("loky"), request.deadline or Deadline()
    deadline.stage = f"the start of {workers} worker processes, or their search"
    stop, token = context.Event(), context.Lock()
    announcement.share(token)
    begun = [context.Event() for _ in shares]
    settings = [(stop, token, own, os.getpid()) for own in begun]
    executors = [ProcessPoolExecutor(1, initializer=_start, initargs=each) for each in settings]
    try:
        with ctrl_c_blocked():
            limit = deadline.handed_on()
            futures = [
                executor.submit(_run_share, run, job, [rngs[k] for k in share], limit)
                for executor, share in zip(executors, shares, strict=True)
            ]
        request.begin()
        _wait(futures, begun, stop, deadline)
        outcomes: list[Outcome] = outcomes_of(shares, futures, TerminatedWorkerError, exit_status)
    finally:
        _end(executors)
    if not outcomes:
        deadline.check()
    return outcomes


def _wait(futures: list[Future[Any]], begun: list[Any], stop: Any, deadline: Deadline) -> None:  # noqa: ANN401 - of loky
    """Wait for all that have begun: these end by themselves at the deadline."""
    while waiting := wait(futures, timeout=_POLL).not_done:
        if deadline.stopped():
            stop.set()
        late = [k for k, future in enumerate(futures) if future in waiting]
        if deadline.passed() and not any(begun[k].is_set() for k in late):
            return


@contextmanager
def ctrl_c_blocked() -> Iterator[None]:
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


def _start(stop: Any, token: announcement.Token, begun: Any, caller: int) -> None:  # noqa: ANN401 - of loky
    global _stop_event, _begun, _caller
    announcement.share(token)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _stop_event, _begun, _caller = stop, begun, caller


def _run_share(
    run: Run[Job, Outcome],
    job: Job,
    rngs: list[np.random.Generator],
    limit: tuple[float, float],
) -> tuple[list[Outcome], float]:
    """The outcomes, and the time that was spent compiling [s]."""
    _begun.set()
    watch, deadline = Stopwatch(), Deadline.taken_over(limit, _stop_requested)
    outcomes = run(job, rngs, SearchMonitor(None, deadline))
    return outcomes, watch.compiling


def _stop_requested() -> bool:
    """Whether Ctrl-C was pressed; ends this process where its caller has died."""
    global _stopped, _next_poll
    if time.monotonic() >= _next_poll:
        if os.getppid() != _caller:
            os._exit(1)
        _stopped, _next_poll = bool(_stop_event.is_set()), time.monotonic() + _POLL_IN_WORKER
    return _stopped


def exit_status(error: Exception) -> str:
    """The exit status in loky's message, such as `SIGKILL(-9)`.

    Args:
        error: that of an executor whose process ended.
    """
    _, _, status = str(error).partition("The exit codes of the workers are {")
    return status.partition("}")[0] or "unknown"
