"""Independent colonies, side by side on worker processes.

A worker is a new Python that reads its job from standard input and writes its outcome to standard
output. So neither the caller's `__main__` nor its threads and locks come along, and a worker that
dies is seen at once by its exit status.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import time
from concurrent.futures import Future, ThreadPoolExecutor, wait
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.errors import FfsrPlanError, WorkerDied
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.records import Planner, Search, Watch


class Outcome(NamedTuple):
    """What one colony came to."""

    result: Search | FfsrPlanError
    edges_free: int
    edges_refused: int
    queries: int
    """Coal queries that its proofs took."""


def run_colonies(
    roadmap: Roadmap,
    planner: Planner,
    rngs: list[np.random.Generator],
    workers: int,
    seconds: float,
) -> list[Outcome]:
    """One search for each generator, in their order, whatever the number of workers.

    Raises:
        WorkerDied: with the worker's number, its colonies and its exit status.
    """
    if workers == 1:
        return _run(roadmap, planner, rngs, seconds)
    shares = [list(range(w, len(rngs), workers)) for w in range(min(workers, len(rngs)))]
    processes = [
        subprocess.Popen(
            [sys.executable, "-c", "from ffsr_plan.search.workers import main; main()"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,  # Ctrl-C reaches us alone, and we pass it on
        )
        for _ in shares
    ]

    def collect(worker: int) -> list[Outcome]:
        share, process = shares[worker], processes[worker]
        job = pickle.dumps((roadmap.problem, planner, [rngs[k] for k in share], seconds))
        answer, _ = process.communicate(job)
        if process.returncode != 0:
            raise WorkerDied(worker, share, process.returncode)
        outcome: list[Outcome] = pickle.loads(answer)
        return outcome

    pool = ThreadPoolExecutor(len(shares))
    futures = [pool.submit(collect, worker) for worker in range(len(shares))]
    try:
        _wait(futures, processes)
        parts = [future.result() for future in futures]
    finally:
        for process in processes:
            process.kill()
        pool.shutdown()
    results: dict[int, Outcome] = {}
    for share, part in zip(shares, parts, strict=True):
        results |= zip(share, part, strict=False)  # fewer outcomes than colonies after Ctrl-C
    return [results[k] for k in sorted(results)]


def _wait(futures: list[Future[list[Outcome]]], processes: list[subprocess.Popen[bytes]]) -> None:
    """Until all are back. Ctrl-C asks the workers for what they have, a second one ends all."""
    try:
        while wait(futures, timeout=0.2).not_done:
            pass
    except KeyboardInterrupt:
        for process in processes:
            process.send_signal(signal.SIGINT)
        while wait(futures, timeout=0.2).not_done:
            pass


def _run(
    roadmap: Roadmap,
    planner: Planner,
    rngs: list[np.random.Generator],
    seconds: float,
) -> list[Outcome]:
    """No colony knows what another one has proven: its outcome must not depend on that."""
    deadline = time.monotonic() + seconds
    roadmap.evaluate_all()
    outcomes = []
    for rng in rngs:
        own, before = roadmap.forget(), roadmap.prover.queries
        result: Search | FfsrPlanError
        try:
            result = planner.search(own, rng, Watch(None, deadline))
        except FfsrPlanError as error:
            result = error
        proofs, queries = own.proofs(), roadmap.prover.queries - before
        outcomes.append(Outcome(result, proofs.edges_free, proofs.edges_refused, queries))
        if isinstance(result, Search) and result.interrupted and time.monotonic() < deadline:
            break  # by Ctrl-C: no more colonies
    return outcomes


def main() -> None:
    """What a worker process runs."""
    answer = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever prints must not get into the answer
    problem, planner, rngs, seconds = pickle.load(sys.stdin.buffer)
    assert isinstance(problem, Problem)
    with answer:
        pickle.dump(_run(Roadmap(problem), planner, rngs, seconds), answer)
