"""The exact optimum of a lattice with progress: shortest paths, nodes and edges on demand.

Nodes that are not evaluated are assumed to have the largest clearance that others allow, and edges
to be free, so that the first shortest path that holds is the optimum. Paths are first searched up
to a limit of their cost, which rises until one holds.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import IntArray
from ffsr_plan.progress_lattice.progress_roadmap import ProgressRoadmap
from ffsr_plan.time_limit.deadline import Deadline

_SLACK = 1e-9  # relative; nodes whose paths exceed the limit by rounding only are kept
_FIRST_RISE = 0.03  # of the limit above the first lower bound; each later rise is twice the last
_RISES = 5  # before there is no limit


class ProgressSearch:
    """A search for the optimum."""

    def __init__(self, roadmap: ProgressRoadmap, deadline: Deadline) -> None:
        """A search of a roadmap.

        Args:
            roadmap: the lattice.
            deadline: after which the search raises `OutOfTime`.
        """
        self._roadmap, self._deadline = roadmap, deadline
        shape = roadmap.node_costs.shape
        self._costs = np.full(shape, np.inf)
        self._costs[0] = np.where(np.isfinite(roadmap.node_costs[0]), 0.0, np.inf)
        self._remaining = np.empty(shape)
        self._entered = np.full(shape, np.inf)
        self._before: IntArray = np.full((*shape, 3), -1, dtype=np.int64)
        self._tails = offsets_before(roadmap.heads)

    def path(self) -> IntArray | None:
        """The path with the least F, all its edges proven free.

        Returns:
            (m + 1, 3) place, offset, and step aside towards the next layer; None if there is none.

        Raises:
            OutOfTime: at the deadline.
        """
        from ffsr_plan.progress_lattice.progress_kernels import remain

        roadmap, first = self._roadmap, 0
        fresh, refused, rises = True, False, 0
        remain(
            roadmap.steps.goal, roadmap.origin, roadmap.edges, roadmap.heads, roadmap.edge_costs,
            roadmap.node_costs, self._remaining,
        )  # fmt: skip
        lowest = float(self._remaining[0, roadmap.steps.start, roadmap.origin])
        while True:
            limit = lowest * (1.0 + _FIRST_RISE * 2.0**rises) if rises < _RISES else np.inf
            path = self._shortest(first, limit, fresh, refused)
            if path is None and limit == np.inf:
                return None
            if path is None:
                first, fresh, rises = 0, True, rises + 1
                continue
            changed, refused = roadmap.learn(path), False
            if changed is None:
                changed, refused = roadmap.prove(path), True
            if changed is None:
                return path
            first, fresh = changed, False

    def _shortest(self, first: int, limit: float, fresh: bool, refused: bool) -> IntArray | None:
        """The shortest path at the present costs; None if none costs at most `limit`.

        Args:
            first: the first layer whose outgoing edges are searched.
            limit: of the cost.
            fresh: whether no search has had this limit yet.
            refused: whether edges have been refused since the last one.
        """
        from ffsr_plan.progress_lattice.progress_kernels import extend, trace

        self._deadline.check()
        roadmap, steps = self._roadmap, self._roadmap.steps
        extend(
            first, fresh, refused, roadmap.edges, roadmap.heads, self._tails,
            roadmap.edge_costs, roadmap.node_costs, roadmap.at_rest, roadmap.moving,
            self._remaining, limit * (1.0 + _SLACK), self._entered, self._costs, self._before,
        )  # fmt: skip
        found = self._costs[-1, steps.goal, roadmap.origin]
        if not np.isfinite(found) or found > limit:
            return None
        path = np.empty((len(self._costs), 3), dtype=np.int64)
        trace(self._before, steps.goal, roadmap.origin, path)
        return path

    @property
    def closed_layer(self) -> int:
        """Where there is no path, the first layer that cannot be reached; the last if all can."""
        reached = np.isfinite(self._costs).any(axis=(1, 2))
        return int(np.argmin(reached)) if not reached.all() else len(reached) - 1


def offsets_before(heads: IntArray) -> IntArray:
    """(n, W, 2) offsets and steps aside that lead to each offset, of the heads (n, W) of steps."""
    tails = np.full((*heads.shape, 2), -1, dtype=np.int64)
    found = np.zeros(len(heads), dtype=np.int64)
    for tail, aside in np.argwhere(heads >= 0).tolist():
        head = heads[tail, aside]
        tails[head, found[head]] = tail, aside
        found[head] += 1
    return tails
