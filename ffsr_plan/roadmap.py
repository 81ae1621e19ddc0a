"""`Roadmap`: the lattice with its clearances, and its edges certified when they are asked for."""

from __future__ import annotations

import copy
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ffsr_plan.edges import ROUNDING, Verdict
from ffsr_plan.errors import NoPath
from ffsr_plan.inputs import Array, Flags, IntArray, States, frozen
from ffsr_plan.lattice import LayeredLattice
from ffsr_plan.objective import nearness, objective, path_length
from ffsr_plan.problem import Problem
from ffsr_plan.prover import Prover

UNKNOWN, FREE, REFUSED = 0, 1, -1


class Certificate(NamedTuple):
    """What was proven, and at what cost."""

    edges_free: int
    """Edges that were asked for and proven free."""
    edges_refused: int
    """Edges that were asked for and refused."""
    node_queries: int
    """Coal queries for the clearances of nodes: one a configuration, over all pairs."""
    edge_queries: int
    """Coal queries for all proofs, obstacles and self-collision together."""
    least_clearance: float
    """Proven lower bound on the clearance all along the returned path [m]."""


class Roadmap:
    """Nodes with exact clearances and lazily certified edges.

    Attributes:
        lattice: the lattice.
        prover: clearances and proofs for any offsets.
        clearances: (m + 1, n) clearance of each node [m]; NaN where a layer lacks the node.
        admissible: (m + 1, n) the nodes that touch nothing.
        status: (m, n, n) what is known of each edge: UNKNOWN, FREE or REFUSED.
    """

    def __init__(self, problem: Problem) -> None:
        """Evaluate all nodes.

        Raises:
            StartInCollision, GoalInCollision: with link, obstacle and depth.
            NoPath: if the arms collide with each other on the way, at every node alike.
        """
        self.problem = problem
        self.lattice = LayeredLattice(problem)
        self.prover = Prover(self.lattice.nominal)
        self.prover.check_ends()
        self.prover.check_self_collision()
        before = self.prover.queries
        m, n, origin = self.lattice.divisions, self.lattice.size, self.lattice.origin
        clearances = np.full((m + 1, n), np.nan)
        for i in range(m + 1):
            nodes = slice(origin, origin + 1) if i in (0, m) else slice(None)
            clearances[i, nodes] = self.prover.clearances(i, self.lattice.offsets[nodes])
        self._node_queries = self.prover.queries - before
        self.clearances = frozen(clearances)
        self.admissible: Flags = clearances > 0.0
        self.admissible.setflags(write=False)
        self.status: States = np.zeros((m, n, n), dtype=np.int8)
        self._verdicts: dict[tuple[int, int, int], Verdict] = {}

    def forget(self) -> Roadmap:
        """The same nodes with nothing known of the edges: a clean start for another colony."""
        twin = copy.copy(self)
        twin.status = np.zeros_like(self.status)
        twin._verdicts = {}
        return twin

    def certify(self, layer: int, tail: int, head: int) -> Verdict:
        """The verdict on the edge from node `tail` of `layer` to node `head` of the next one."""
        key = (layer, tail, head)
        if key not in self._verdicts:
            ends = (float(self.clearances[layer, tail]), float(self.clearances[layer + 1, head]))
            offsets = self.lattice.offsets
            verdict = self.prover.certify(layer, offsets[tail], offsets[head], ends)
            self._verdicts[key] = verdict
            self.status[key] = FREE if verdict.free else REFUSED
            if not verdict.free:
                rule_out(self.status[layer], offsets, offsets, (tail, head), verdict)
        return self._verdicts[key]

    def free(self, layer: int, tail: int, head: int) -> bool:
        """Whether an edge is free, certifying it if that is not known yet."""
        known = self.status[layer, tail, head]
        return bool(known == FREE or (known == UNKNOWN and self.certify(layer, tail, head).free))

    def prove_path(self, path: IntArray) -> bool:
        """Certify every edge of a path (m + 1,) whose state is unknown; whether all are free."""
        edges = [(i, int(j), int(k)) for i, (j, k) in enumerate(pairwise(path))]
        verdicts = [self.free(*edge) for edge in edges]  # not only up to the first refusal
        return all(verdicts)

    def prove_obvious(self) -> None:
        """Mark the edges that the clearances at their ends prove free without a query."""
        travel = self.lattice.base_travel + (self.prover.swing + ROUNDING)
        for i in range(self.lattice.divisions):
            tails = np.where(self.admissible[i], self.clearances[i], np.nan)
            heads = np.where(self.admissible[i + 1], self.clearances[i + 1], np.nan)
            self.status[i][tails[:, None] + heads > travel] = FREE

    def path_length(self, path: IntArray) -> float:
        """L of Eq. 6 [m] of a path, node indices (m + 1,)."""
        return path_length(self.problem, self.lattice.offsets[path])

    def path_clearances(self, path: IntArray) -> Array:
        """(m + 1,) clearances at the nodes of a path [m]."""
        return self.clearances[np.arange(len(path)), path]

    def objective(self, path: IntArray) -> float:
        """F of Eq. 8 of a path, node indices (m + 1,), edges taken as free."""
        return objective(self.problem, self.path_length(path), self.path_clearances(path))

    def edge_costs(self) -> Array:
        """(n, n) share of an edge in F: its length in length units."""
        return self.lattice.steps / self.problem.length_unit

    def node_costs(self) -> Array:
        """(m + 1, n) share of a node in F: delta / d_imin; infinite where it may not be entered."""
        costs = np.where(self.admissible, nearness(self.problem, self.clearances), np.inf)
        costs[[0, -1], self.lattice.origin] = 0.0  # layers 0 and m do not count in Eq. 8
        return frozen(costs)

    def proofs(self) -> Certificate:
        """What has been proven so far; no clearance of any path yet."""
        free = sum(v.free for v in self._verdicts.values())
        return Certificate(
            edges_free=free,
            edges_refused=len(self._verdicts) - free,
            node_queries=self._node_queries,
            edge_queries=self.prover.queries - self._node_queries,
            least_clearance=0.0,
        )

    def no_path(self) -> NoPath | None:
        """Search the lattice from the start, certifying as needed; the error if it has no path."""
        m, n, origin = self.lattice.divisions, self.lattice.size, self.lattice.origin
        reached = [origin]
        for layer in range(m):
            heads = [origin] if layer == m - 1 else [
                k for k in range(n) if self.admissible[layer + 1, k]
            ]  # fmt: skip
            onwards = [k for k in heads if any(self.free(layer, j, k) for j in reached)]
            if not onwards:
                return NoPath(layer + 1, self._closing(layer, reached), m)
            reached = onwards
        return None

    def _closing(self, layer: int, reached: list[int]) -> tuple[int | str, ...]:
        """What closes all edges from the nodes `reached` of a layer to the next one."""
        offsets, found = self.lattice.offsets, set[int | str]()
        for (i, tail, head), verdict in self._verdicts.items():
            if i == layer and not verdict.free:
                found.add(
                    self.prover.nearest_obstacle(i, offsets[tail], offsets[head], verdict.time)
                )
        for node in np.flatnonzero(~self.admissible[layer + 1]):
            if layer + 1 < self.lattice.divisions:
                at = offsets[node]
                found.add(self.prover.nearest_obstacle(layer + 1, at, at, 0.0))
        return tuple(sorted(found, key=lambda name: (isinstance(name, str), name)))


def rule_out(
    status: States, tails: Array, heads: Array, edge: tuple[int, int], verdict: Verdict
) -> None:
    """Refuse every edge of a layer that passes, at the same time, within the depth just met.

    Attitude and joints are the same there, and a translation shorter than the penetration depth
    does not lead out of the obstacle.

    Args:
        status: (j, k) of the layer's edges, updated.
        tails: (j, 3) offsets at the edges' beginnings [m].
        heads: (k, 3) offsets at their ends [m].
        edge: tail and head of the edge that was refused.
        verdict: why.
    """
    depth, t = -verdict.least_clearance * (1.0 - 1e-9), verdict.time
    if depth <= 0.0:
        return
    met = (1.0 - t) * tails[edge[0]] + t * heads[edge[1]]
    there = (1.0 - t) * (tails[:, None] - met) + t * (heads[None] - met)
    status[np.einsum("jki,jki->jk", there, there) < depth**2] = REFUSED


__all__ = ["FREE", "REFUSED", "UNKNOWN", "Certificate", "Roadmap", "rule_out"]
