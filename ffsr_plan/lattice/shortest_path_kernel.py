"""Compiled shortest paths through layers."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray, States
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.lattice.edge_states import REFUSED


@kernel
def extend(
    first: int,
    last: int,
    edge_costs: Array,
    node_costs: Array,
    status: States,
    costs: Array,
    before: IntArray,
) -> None:
    """Shortest paths from the start, layer after layer from `first` on (Bellman).

    Args:
        first: the first layer whose edges are evaluated; `costs` are valid up to it.
        last: the layer at which to end.
        edge_costs: (m, n, n) or (1, n, n).
        node_costs: (m + 1, n), infinite where a node may not be entered.
        status: (m, n, n); refused edges are left out.
        costs: (m + 1, n) least cost of reaching each node, updated.
        before: (m + 1, n) the node that the shortest path comes from, updated.
    """
    n = status.shape[1]
    for i in range(first, last):
        edges = edge_costs[min(i, len(edge_costs) - 1)]
        costs[i + 1] = np.inf
        for j in range(n):
            so_far = costs[i, j]
            if so_far == np.inf:
                continue
            for k in range(n):
                total = so_far + edges[j, k]
                if total < costs[i + 1, k] and status[i, j, k] != REFUSED:
                    costs[i + 1, k] = total
                    before[i + 1, k] = j
        for k in range(n):
            costs[i + 1, k] += node_costs[i + 1, k]


@kernel
def trace(before: IntArray, origin: int, path: IntArray) -> None:
    """The shortest path to a node of the last layer.

    Args:
        before: (m + 1, n) the node that the shortest path comes from.
        origin: the node.
        path: (m + 1,) nodes, filled in.
    """
    last = len(path) - 1
    path[last] = origin
    for i in range(last, 0, -1):
        path[i - 1] = before[i, path[i]]


@kernel
def promising(costs: Array, most: float) -> Flags:
    """The edges of paths, from first node to first node, that are cheaper than `most`.

    Args:
        costs: (m, w, w) of the edges, infinite where there is none.
        most: cost that a path has to stay below.

    Returns:
        (m, w, w) whether the cheapest path over an edge is cheaper.
    """
    m, w = costs.shape[0], costs.shape[1]
    before, after = np.full((m + 1, w), np.inf), np.full((m + 1, w), np.inf)
    before[0, 0] = after[m, 0] = 0.0
    for i in range(m):
        for j in range(w):
            if before[i, j] < np.inf:
                for k in range(w):
                    before[i + 1, k] = min(before[i + 1, k], before[i, j] + costs[i, j, k])
    for i in range(m - 1, -1, -1):
        for j in range(w):
            for k in range(w):
                after[i, j] = min(after[i, j], costs[i, j, k] + after[i + 1, k])
    found = np.zeros(costs.shape, dtype=np.bool_)
    for i in range(m):
        for j in range(w):
            for k in range(w):
                found[i, j, k] = before[i, j] + costs[i, j, k] + after[i + 1, k] < most
    return found
