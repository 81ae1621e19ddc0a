"""Independent colonies on the workers of a Dask cluster.

A worker that dies is none of the caller's concern at first: Dask gives its colonies to another one,
where they find the same. Ctrl-C and the time limit reach the workers through the scheduler.
"""

from __future__ import annotations

import threading
import time
import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeVar

from ffsr_plan.clusters.cluster_client import connected
from ffsr_plan.core.kernels import announcement
from ffsr_plan.core.kernels.compiling_time import Stopwatch
from ffsr_plan.search.colony_shares import outcomes_of, shares_of
from ffsr_plan.search.records import SearchMonitor, SearchRequest
from ffsr_plan.time_limit.deadline import Deadline

Work = TypeVar("Work")
Outcome = TypeVar("Outcome")
if TYPE_CHECKING:
    import numpy as np

    Run = Callable[[Work, list[np.random.Generator], SearchMonitor], list[Outcome]]

_POLL = 0.02  # [s] between two looks at results, Ctrl-C and the time
_POLL_ON_WORKER = 0.5  # [s] between two questions whether Ctrl-C was pressed
_RETURNING = 5.0  # [s] after the end that outcomes may take to come back
_one_search = threading.RLock()  # workers may have several threads; a search needs one


def run_on_cluster(
    run: Run[Work, Outcome],
    job: Work,
    rngs: list[np.random.Generator],
    request: SearchRequest,
) -> list[Outcome]:
    """One outcome for each generator, in their order, whatever the number of workers.

    The clocks of all computers have to agree where there is a time limit.

    Args:
        run: a function of a module, called on a worker with the job, its share of the generators
            and a monitor; returns one outcome a generator, fewer if it was stopped.
        job: whatever `run` needs; it has to be picklable.
        rngs: one a colony.
        request: the scheduler, and the deadline.

    Raises:
        InvalidInput: no scheduler answers there.
        OutOfTime: nothing came back by the deadline.
        WorkerDied: several workers died with the same colonies.
    """
    deadline = request.deadline or Deadline()
    deadline.stage = "the search on a cluster"
    with connected(request.scheduler) as client:
        from distributed.scheduler import KilledWorker

        workers = min(max(1, len(client.nthreads())), len(rngs))
        shares = shares_of(len(rngs), workers)
        limit, name = _handed_on(deadline), f"ffsr-plan-colonies-{uuid.uuid4().hex}"
        with _stopping(name, client) as stop:
            futures = [
                client.submit(
                    _run_share, run, job, [rngs[k] for k in share], limit, name,
                    key=f"{name}-{w}", pure=False,
                )
                for w, share in enumerate(shares)
            ]  # fmt: skip
            request.begin()
            try:
                _wait(futures, stop, deadline)
                outcomes: list[Outcome] = outcomes_of(shares, futures, KilledWorker, _last_place)
            finally:
                client.cancel(futures, force=True)
    if not outcomes:
        deadline.check()
    return outcomes


@contextmanager
def _stopping(name: str, client: Any) -> Iterator[Any]:  # noqa: ANN401 - of Dask
    """What tells all workers that Ctrl-C was pressed; set in the end, so that none goes on."""
    from distributed import Event

    stop = Event(name, client=client)
    try:
        yield stop
    finally:
        stop.set()


def _wait(futures: list[Any], stop: Any, deadline: Deadline) -> None:  # noqa: ANN401 - of Dask
    """Wait for all; these end by themselves at the deadline."""
    told, until = False, float("inf")
    while not all(future.done() for future in futures) and time.monotonic() < until:
        if deadline.stopped() and not told:
            stop.set()
            told = True
        if deadline.passed() and until == float("inf"):
            until = time.monotonic() + _RETURNING
        time.sleep(_POLL)


def _last_place(killed: Any) -> str:  # noqa: ANN401 - of Dask
    """Where the last of the workers died that Dask gave the share to."""
    return f"unknown, on {killed.last_worker.address}"


def _handed_on(deadline: Deadline) -> tuple[float, float]:
    """The limit, and the end by the clock that computers agree on [s]."""
    return deadline.seconds, time.time() + deadline.remaining()


def _run_share(
    run: Run[Work, Outcome],
    job: Work,
    rngs: list[np.random.Generator],
    limit: tuple[float, float],
    name: str,
) -> tuple[list[Outcome], float]:
    """On a worker: the outcomes, and the time that was spent compiling [s]."""
    announcement.withhold()
    seconds, end = limit
    with _one_search, _told_to_stop(name) as stopped:
        watch = Stopwatch()
        own = seconds, time.monotonic() + end - time.time()
        outcomes = run(job, rngs, SearchMonitor(None, Deadline.taken_over(own, stopped)))
        return outcomes, watch.compiling


@contextmanager
def _told_to_stop(name: str) -> Iterator[Callable[[], bool]]:
    """On a worker: whether the caller has asked to stop, heard on another thread."""
    from distributed import Event, get_worker

    stop, heard, over = Event(name, client=get_worker()._get_client()), threading.Event(), False

    def listen() -> None:
        while not over and not heard.is_set():
            if stop.wait(timeout=_POLL_ON_WORKER):
                heard.set()

    threading.Thread(target=listen, daemon=True).start()
    try:
        yield heard.is_set
    finally:
        over = True
