"""Proofs of the paths of a search, the best proven path, and the solution that it makes."""

from __future__ import annotations

from contextlib import nullcontext
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.lattice.certificate import Certificate, proven_clearance
from ffsr_plan.problem.free_objective import least_objective, stations_objective
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.records import Branches, History, Solution
from ffsr_plan.time_limit.deadline import Deadline
from ffsr_plan.tree_search.kernels.search_arrays import Trees
from ffsr_plan.tree_search.path_improvement import ImprovedPath
from ffsr_plan.tree_search.path_proof import PathProof, prove
from ffsr_plan.tree_search.search_space import SearchSpace

_WORTH = 0.005  # share of its cost by which a path has to be better to be proven
_NEAR = 0.2  # least distance of states within which a larger margin is kept after a refusal
_RESERVE = 1.3  # for the last proof, as a multiple of the time of the longest
_MISSED = 1e-8  # [rad] of an attitude that is demanded
_MOST_BRANCHES = 10_000  # edges of the trees that are kept for pictures


class ProvenPath(NamedTuple):
    """A path that is proven free.

    Attributes:
        problem: the problem with the goal that it leads to.
        proof: of all its edges.
        motion: the motion along it.
        length: L [m].
        objective: F [length units].
    """

    problem: Problem
    proof: PathProof
    motion: Motion
    length: float
    objective: float


class ProvenPaths:
    """Proofs of paths, one after another.

    An edge that is refused makes the search keep farther away from anything near its middle.

    Attributes:
        best: the best path that is proven free, or None.
        refused: number of paths that were refused.
    """

    def __init__(self, space: SearchSpace, deadline: Deadline) -> None:
        """No proofs yet.

        Args:
            space: the configuration space, in which the search keeps a larger margin near edges
                that are refused.
            deadline: of the proofs.
        """
        self._space, self._deadline, self._longest = space, deadline, 0.0
        self.best: ProvenPath | None = None
        self.refused = 0
        self._edges_free = self._edges_refused = self._nodes = self._queries = 0
        self._rows: list[tuple[float, float, float, float]] = []

    def is_worth_proving(self, cost: float) -> bool:
        """Whether a path of this cost [m] is better than the best one by enough."""
        if self.best is None:
            return True
        return cost < (1.0 - _WORTH) * self.best.objective * self._space.problem.length_unit

    def reserve(self) -> float:
        """Time to keep for a proof at the end [s]."""
        return _RESERVE * self._longest

    def take(self, path: ImprovedPath) -> bool:
        """Whether a path is proven free; the best of those that are is kept.

        Ctrl-C waits for the proof of the first path.

        Raises:
            OutOfTime: by the deadline.
        """
        begin = self._deadline.elapsed()
        with self._deadline.without_stop() if self.best is None else nullcontext():
            proof = prove(self._space, path.states, self._deadline)
        self._longest = max(self._longest, self._deadline.elapsed() - begin)
        refused = len(proof.refusals)
        self._nodes += len(proof.clearances)
        self._queries += proof.prover.queries
        self._edges_refused += refused
        self._edges_free += proof.motion.edges - refused
        if refused:
            self.refused += 1
            self._bar(proof)
            return False
        if proof.missed > _MISSED:
            return False
        problem, motion = path.problem, proof.motion
        length, value = stations_objective(problem, motion)
        if self.best is None or value < self.best.objective:
            self.best = ProvenPath(problem, proof, motion, length, value)
        return True

    def note(self, new: float, ways: int) -> None:
        """Note a round in the history.

        Args:
            new: F of its best new path, not proven [length units].
            ways: number of different paths that are kept.
        """
        best = np.inf if self.best is None else self.best.objective
        self._rows.append((best, max(new, best), max(new, best), max(ways, 1)))

    def solution(self, trees: Trees, interrupted: bool) -> Solution:
        """The solution along the best path, of which there is one.

        Args:
            trees: those of the last search, for pictures.
            interrupted: whether time limit or Ctrl-C ended the search.
        """
        best = self.best
        assert best is not None
        problem = best.problem
        still = np.zeros((best.motion.edges + 1, 3))
        before = best.proof.prover.queries
        self._deadline.close()
        least, cut = proven_clearance(best.proof.prover, still, best.proof.clearances)
        queries = self._queries + best.proof.prover.queries - before
        nodes = self._nodes if len(problem.obstacles) else 0
        if not self._rows or self._rows[-1][0] != best.objective:
            self.note(best.objective, 1)
        return Solution(
            lattice=None,
            motion=best.motion,
            nodes=frozen(np.zeros(0, dtype=np.int64)),
            length=best.length,
            objective=best.objective,
            lattice_objective=best.objective,
            optimum=min(least_objective(problem), best.objective),
            optimum_is_exact=False,
            clearances=best.proof.clearances,
            history=History.of_rows(np.array(self._rows)),
            trails=self.branches(trees),
            certificate=Certificate(
                self._edges_free, self._edges_refused, nodes, max(queries - nodes, 0), least,
                problem.robot.unchecked_links,
            ),
            interrupted=interrupted or cut,
        )  # fmt: skip

    def _bar(self, proof: PathProof) -> None:
        """Keep twice the margin near the edges that were refused, more each time."""
        arrays = self._space.arrays
        weights, states, bars = arrays.weights[0], proof.states, arrays.bars
        for edge, _ in proof.refusals:
            middle = 0.5 * (states[edge] + states[edge + 1])
            length = float(np.linalg.norm((states[edge + 1] - states[edge]) * weights))
            near = np.linalg.norm((bars[:, :-2] - middle) * weights, axis=1) < _NEAR
            known = float(np.max(bars[near, -1], initial=float(arrays.setup[0]["margin"])))
            bars = np.vstack([bars, [*middle, max(_NEAR, length), 2.0 * known]])
        self._space.arrays = arrays._replace(bars=bars)

    def branches(self, trees: Trees) -> Branches:
        """Edges of the trees; of very many, some at equal distances in their order.

        Args:
            trees: those of the last search.
        """
        if self._space.problem.mode.floats:
            return Branches.none()  # the base of a node lies where the whole way to it leads
        parts = []
        for side in (0, 1):
            parents = trees.parents[side, : trees.counts[side]]
            nodes = np.flatnonzero(parents >= 0)
            places: Array = trees.states[side, :, :3]
            parts.append((places[parents[nodes]], places[nodes], np.full(len(nodes), side)))
        begin, end, tree = (np.concatenate(part) for part in zip(*parts, strict=True))
        chosen = slice(None, None, max(1, -(-len(tree) // _MOST_BRANCHES)))
        return Branches(
            frozen(begin[chosen].copy()), frozen(end[chosen].copy()), frozen(tree[chosen].copy())
        )
