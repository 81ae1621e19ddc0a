"""Lazy shortest path over layers: nodes and edges are evaluated only on candidate paths."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray, States
from ffsr_plan.time_limit.deadline import Deadline

_EDGES_AT_ONCE = 1_000_000  # that are evaluated between two looks at the deadline


class LazyShortestPath:
    """Shortest paths over layers while node costs rise and edges are refused.

    The caller evaluates the nodes and edges of `path()`. Where one is worse than assumed, it
    corrects `node_costs` or `status` in place, and calls `path(first)` again with the first layer
    whose outgoing edges have to be searched again.
    """

    def __init__(
        self,
        edge_costs: Array,
        node_costs: Array,
        status: States,
        origin: int,
        deadline: Deadline | None = None,
    ) -> None:
        """A search from node `origin` of layer 0 to that of layer m.

        Args:
            edge_costs: (m, n, n), or (1, n, n) where all layers are alike.
            node_costs: (m + 1, n), infinite where a node may not be entered; optimistic at first.
            status: (m, n, n) state of each edge; refused ones are left out.
            origin: the node of layers 0 and m.
            deadline: after which searches raise `OutOfTime`.
        """
        self._edge_costs, self._node_costs, self._status = edge_costs, node_costs, status
        self._origin, self._deadline = origin, deadline or Deadline()
        m, n = len(status), status.shape[1]
        self._costs, self._before = np.full((m + 1, n), np.inf), np.zeros((m + 1, n), np.int64)
        self._costs[0, origin] = 0.0

    @property
    def least_cost(self) -> float:
        """Cost of the shortest path that was found last; infinite if there was none."""
        return float(self._costs[-1, self._origin])

    def path(self, first: int = 0) -> IntArray | None:
        """The shortest path at the present costs.

        Args:
            first: the first layer whose outgoing edges have to be searched again.

        Returns:
            (m + 1,) nodes, or None if there is no path.
        """
        from ffsr_plan.lattice.shortest_path_kernel import extend, trace

        costs, before, (m, n, _) = self._costs, self._before, self._status.shape
        layers = max(1, _EDGES_AT_ONCE // n**2)
        for begin in range(first, m, layers):
            self._deadline.check()
            end = min(begin + layers, m)
            extend(begin, end, self._edge_costs, self._node_costs, self._status, costs, before)
        if not np.isfinite(self.least_cost):
            return None
        path = np.empty(m + 1, dtype=np.int64)
        trace(before, self._origin, path)
        return path
