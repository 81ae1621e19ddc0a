"""`PairProgramme`: the path through layers at equal times that needs the least change of velocity.

The programme is exact. With a limit on the cost it looks only at states whose cost and bound stay
below it (`pair_programme_kernel`), which is a small share of all. The limit grows from a lower
bound on the least cost until a path is found, never above an upper bound from a local search.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray, States
from ffsr_plan.time_limit.deadline import Deadline

BYTES_PER_EDGE = 16.0
"""Memory for each edge of a lattice of two divisions or more [bytes]: 2 for the way back, 1 for the
edge's state, and 16 for each pair of nodes of one layer."""
_ROUNDING = 1.0 + 1e-12
_FIRST_RISE, _GROWTH = 0.02, 2.5  # of the limit above the lower bound: share of it, factor
_REACH = {0: 1, 1: 6, 2: 2}  # of the local search on either side of a path, by number of axes


class BestPath(NamedTuple):
    """What the programme found within a limit.

    Attributes:
        nodes: (m + 1,) nodes of the best path; None without any.
        change: its change of velocity for a flight of unit duration [m]; infinite without any.
        beyond: change below which no path is that was left out [m].
    """

    nodes: IntArray | None
    change: float
    beyond: float


class PairProgramme:
    """Best paths over the nodes of a layered lattice, for any nodes and edges that are allowed."""

    def __init__(
        self,
        indices: IntArray,
        spacing: Array,
        length: float,
        divisions: int,
        deadline: Deadline | None = None,
    ) -> None:
        """Lay out the memory, some `BYTES_PER_EDGE` for each edge.

        Args:
            indices: (n, axes) offset indices of the nodes, 0 to 2 axes; node n // 2 is the origin.
            spacing: (axes,) distance between two offsets [m].
            length: of the straight way from start to goal [m].
            divisions: m, at least 2.
            deadline: after which searches raise `OutOfTime`.
        """
        n, axes = indices.shape
        self.divisions, self.origin = divisions, n // 2
        self._indices, self._step = indices, length / divisions
        self._at = np.zeros((n, 2))
        self._at[:, :axes] = indices * spacing
        self._deadline = deadline or Deadline()
        self._costs, self._onward = np.empty((n, n)), np.empty((n, n))
        self._back = np.empty((divisions, n, n), dtype=np.int16)

    @property
    def straight(self) -> float:
        """Change of velocity along the straight line, twice its length: no path needs less [m]."""
        return 2.0 * self.divisions * self._step

    def change(self, nodes: IntArray) -> float:
        """Change of velocity for a flight of unit duration along a path (m + 1,) of nodes [m]."""
        steps = np.diff(self._at[nodes], axis=0)
        ends = np.hypot(self._step, np.linalg.norm(steps[[0, -1]], axis=1))
        turns = np.linalg.norm(np.diff(steps, axis=0), axis=1)
        return float(self.divisions * (ends.sum() + turns.sum()))

    def within(self, allowed: Flags, status: States, limit: float = math.inf) -> BestPath:
        """The best path whose change of velocity is at most a limit.

        Args:
            allowed: (m + 1, n) nodes that may be passed; of layers 0 and m, the origin alone.
            status: (m, n, n) states of edges; refused ones are left out.
            limit: [m].

        Returns:
            The best path, if its change is within the limit: with one step left the bound is
            exact, so that no other is left.

        Raises:
            OutOfTime: at the deadline.
        """
        from ffsr_plan.fuel.pair_programme_kernel import extend_pairs, first_pairs

        m, origin, at, step = self.divisions, self.origin, self._at, self._step
        nodes = [np.flatnonzero(row) for row in allowed]
        nodes[0] = nodes[m] = np.array([origin])
        costs, onward = self._costs, self._onward
        first_pairs(at, step, origin, nodes[1], status, costs)
        most, beyond = limit * _ROUNDING / m, math.inf
        for i in range(1, m):
            self._deadline.check()
            three = nodes[i - 1], nodes[i], nodes[i + 1]
            skipped = extend_pairs(
                i, at, step, origin, three, status, most, costs, onward, self._back
            )
            beyond = min(beyond, skipped)
            costs, onward = onward, costs
        return self._traced(nodes[m - 1], costs[origin], beyond * m)

    def _traced(self, tails: IntArray, costs: Array, beyond: float) -> BestPath:
        """The best path, from costs (n,) of the states at the goal, by the node before it."""
        step, at, origin, m = self._step, self._at, self.origin, self.divisions
        last = np.hypot(step, np.linalg.norm(at[origin] - at[tails], axis=1))
        whole = costs[tails] + last
        if not len(tails) or not np.isfinite(whole.min()):
            return BestPath(None, math.inf, beyond)
        path = np.full(m + 1, origin, dtype=np.int64)
        path[m - 1] = tails[np.argmin(whole)]
        for i in range(m - 1, 0, -1):
            path[i - 1] = self._back[i, path[i + 1], path[i]]
        return BestPath(path, self.change(path), beyond)

    def optimum(
        self, allowed: Flags, status: States, lower: float, upper: float = math.inf
    ) -> BestPath:
        """The best path of all.

        Args:
            allowed: (m + 1, n) nodes that may be passed.
            status: (m, n, n) states of edges; refused ones are left out.
            lower: bound below which no path is [m], positive.
            upper: change of some path, or infinity [m].

        Returns:
            The best path; without nodes if there is none.

        Raises:
            OutOfTime: at the deadline.
        """
        base, rise = lower, _FIRST_RISE * lower
        while True:
            limit = min(upper, base + rise)
            found = self.within(allowed, status, limit)
            if found.nodes is not None or found.beyond == math.inf:
                return found
            base, rise = max(base, min(found.beyond, upper)), _GROWTH * rise

    def improved(self, path: IntArray, allowed: Flags, status: States) -> BestPath:
        """A path made better by a local search: the best near it, as long as that is better.

        Args:
            path: (m + 1,) nodes, all allowed, by edges that are not refused.
            allowed: (m + 1, n) nodes that may be passed.
            status: (m, n, n) states of edges; refused ones are left out.

        Raises:
            OutOfTime: at the deadline.
        """
        reach = _REACH[self._indices.shape[1]]
        best = BestPath(path, self.change(path), math.inf)
        while True:
            assert best.nodes is not None
            apart = np.abs(self._indices[None] - self._indices[best.nodes][:, None])
            near = allowed & np.all(apart <= reach, axis=2)
            found = self.within(near, status)
            if not found.change < best.change / _ROUNDING:
                return best
            best = found
