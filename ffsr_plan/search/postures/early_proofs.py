"""Proofs of paths while the search still goes on, so that a time limit finds a proven one.

They leave no trace in the search: a limit that is not reached changes nothing in the plan.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import IntArray
from ffsr_plan.core.errors import OutOfTime
from ffsr_plan.search.postures.colony import PostureColony
from ffsr_plan.search.postures.path_proof import (
    PathProof,
    corners,
    corrected_proof,
    least_clearance,
    objective_of,
    prove_path,
)
from ffsr_plan.search.postures.posture_lattice import PostureLattice
from ffsr_plan.time_limit.deadline import Deadline

_SEARCH_PER_PROOF = 4.0, 12.0
"""Time for the search after each proof, as a multiple of the time that the proof took: until one
holds, and from then on."""
_RESERVE = 1.3  # for the last proof, as a multiple of the time of the longest


class ProvenPath(NamedTuple):
    """A path that holds.

    Attributes:
        path: (m + 1, 2) base offset and posture on each layer.
        proof: of its motion on the lattice.
        corrected: of its motion with the goal attitude met.
        queries: Coal queries of both proofs.
        least: what `least_clearance` gives.
    """

    path: IntArray
    proof: PathProof
    corrected: PathProof
    queries: int
    least: tuple[float, int]


class EarlyProofs:
    """The best proven path so far, and what is known of the time that proofs take.

    Nothing is proven ahead of the end where there is no time limit.

    Attributes:
        best: the best path that was proven to hold; None until there is one.
    """

    def __init__(self, lattice: PostureLattice, colony: PostureColony, deadline: Deadline) -> None:
        self._lattice, self._colony, self._deadline = lattice, colony, deadline
        self._seconds, self._next, self._objective = 0.0, 0.0, float("inf")
        self._last = b""
        self.best: ProvenPath | None = None

    def has(self, path: IntArray) -> bool:
        """Whether a path (m + 1, 2) is the best one that was proven."""
        return self.best is not None and np.array_equal(path, self.best.path)

    def reserve(self) -> float:
        """Time to keep for the last proof [s]."""
        return _RESERVE * self._seconds

    def offer(self, path: IntArray) -> None:
        """Prove a path if it is new, looks as if it held, and there is time.

        Args:
            path: (m + 1, 2) the best path of the search.
        """
        deadline, name = self._deadline, path.tobytes()
        if not deadline.is_limited or name == self._last or deadline.elapsed() < self._next:
            return
        if deadline.remaining() < self.reserve() or self._colony.shortcomings(path):
            return
        self._last, begin = name, deadline.elapsed()
        try:
            proof = prove_path(self._lattice, *corners(self._lattice, path))
            corrected, spent = corrected_proof(self._lattice, proof)
            queries = proof.prover.queries + spent
            least = least_clearance(corrected) if corrected.holds else (0.0, 0)
        except OutOfTime:
            return
        seconds = deadline.elapsed() - begin
        self._seconds = max(self._seconds, seconds)
        if corrected.holds:
            objective = objective_of(self._lattice, corrected)
            if objective < self._objective:
                self._objective = objective
                self.best = ProvenPath(path.copy(), proof, corrected, queries, least)
        wait = _SEARCH_PER_PROOF[self.best is not None]
        self._next = deadline.elapsed() + wait * seconds
