"""The best path over a band of offsets; only the edges of candidate paths are evaluated."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray, States
from ffsr_plan.lattice.edge_states import REFUSED
from ffsr_plan.lattice.roadmap import rule_out
from ffsr_plan.lattice.shortest_path import LazyShortestPath
from ffsr_plan.problem.objective import nearness
from ffsr_plan.problem.problem import Problem
from ffsr_plan.proof.interval_halving import Verdict
from ffsr_plan.refinement.edge_clearances import EdgeClearances, proven_clearances
from ffsr_plan.refinement.offset_band import OffsetBand

NO_GAIN = 1.0 - 1e-12
"""Relative: a smaller gain of F counts as none."""


class BandSearch:
    """Costs of the edges of a band: lower bounds, exact once a candidate path has used the edge."""

    def __init__(
        self,
        problem: Problem,
        edges: EdgeClearances,
        band: OffsetBand,
        clearances: Array,
        most: float,
    ) -> None:
        """Bounds from the clearances at nodes and, where delta > 0, half-way on the edges.

        Args:
            problem: gives the costs.
            edges: least clearances on edges.
            band: the offsets.
            clearances: (m + 1, w) at the nodes [m], -inf at those that are not allowed.
            most: F of the whole motion that is to be improved on.
        """
        from ffsr_plan.lattice.shortest_path_kernel import promising

        self._problem, self._edges, self._band, self._clearances = problem, edges, band, clearances
        self._most = most * NO_GAIN
        at_nodes = nearness(problem, clearances)
        self._costs: Array = np.maximum(at_nodes[:-1, :, None], at_nodes[1:, None])
        self._costs += band.lengths
        self._status: States = np.zeros(self._costs.shape, dtype=np.int8)
        if problem.delta > 0.0:
            wanted = promising(self._costs, self._most)
            half_way = band.lengths[wanted] + nearness(problem, edges.half_way(band, wanted))
            self._costs[wanted] = np.maximum(self._costs[wanted], half_way)
            self._status[~promising(self._costs, self._most)] = REFUSED

    def best_path(self, candidates: int) -> IntArray | None:
        """The cheapest of some candidate paths, by their true costs.

        Each candidate is the shortest path at the costs known so far. One whose true cost is no
        higher is the best of all paths.

        Args:
            candidates: number of paths to evaluate at most.

        Returns:
            (m + 1,) nodes; None if no candidate improves on the given F.
        """
        search = LazyShortestPath(self._costs, np.zeros(self._clearances.shape), self._status, 0)
        path, best, least = search.path(), None, self._most
        layers = np.arange(len(self._clearances))
        for _ in range(candidates):
            if path is None or not self._cost(path) < least:
                break
            offsets, clearances = self._band.offsets[layers, path], self._clearances[layers, path]
            worse = self._learn(path, self._edges.of_path(offsets, clearances))
            if self._cost(path) < least:
                best, least = path, self._cost(path)
            if worse is None:
                break
            path = search.path(worse)
        return best

    def _cost(self, path: IntArray) -> float:
        """The sum of the costs along a path, as far as they are known."""
        steps = np.arange(len(self._costs))
        return float(np.sum(self._costs[steps, path[:-1], path[1:]]))

    def _learn(self, path: IntArray, verdicts: list[Verdict]) -> int | None:
        """Raise the costs along a path to the true ones; the first layer with a higher one."""
        steps, tails, heads = np.arange(len(verdicts)), path[:-1], path[1:]
        least = proven_clearances(verdicts)
        costs = self._band.lengths[steps, tails, heads] + nearness(self._problem, least)
        worse = np.flatnonzero(costs > self._costs[steps, tails, heads])
        self._costs[worse, tails[worse], heads[worse]] = costs[worse]
        for i in np.flatnonzero(least == 0.0).tolist():
            ends, edge = self._band.offsets[i : i + 2], (int(tails[i]), int(heads[i]))
            rule_out(self._status[i], ends[0], ends[1], edge, verdicts[i])
        return int(worse[0]) if len(worse) else None
