"""Lazy shortest path over layers: nodes and edges are evaluated only on candidate paths."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray, States


def lazy_shortest_path(
    edge_costs: Array,
    node_costs: Array,
    status: States,
    origin: int,
    objection: Callable[[IntArray], int | None],
) -> IntArray | None:
    """The shortest path over layers whose nodes and edges are evaluated on candidate paths.

    Args:
        edge_costs: (m, n, n), or (1, n, n) where all layers are alike.
        node_costs: (m + 1, n), infinite where a node may not be entered; optimistic at first.
        status: (m, n, n) state of each edge; refused ones are left out.
        origin: the node of layers 0 and m.
        objection: evaluates the nodes and edges of a path (m + 1,). Where one is worse than
            assumed it corrects `node_costs` or `status`, and returns the first layer whose outgoing
            edges have to be searched again; None if the path holds.

    Returns:
        (m + 1,) nodes, or None if there is no path.
    """
    from ffsr_plan.lattice.shortest_path_kernel import extend

    m, n = len(status), status.shape[1]
    costs, before = np.full((m + 1, n), np.inf), np.zeros((m + 1, n), dtype=np.int64)
    costs[0, origin] = 0.0
    first = 0
    while True:
        extend(first, edge_costs, node_costs, status, costs, before)
        if not np.isfinite(costs[m, origin]):
            return None
        path = np.empty(m + 1, dtype=np.int64)
        path[m] = origin
        for i in range(m, 0, -1):
            path[i - 1] = before[i, path[i]]
        again = objection(path)
        if again is None:
            return path
        first = again
