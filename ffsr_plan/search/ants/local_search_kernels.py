"""Compiled local search on a path of the lattice.

The neighbourhood of a path consists of all paths that are displaced from it, on every layer
independently, by one of a few steps: to the adjacent nodes, and to some farther along an axis. It
contains every shift of every segment by such a step; a small shortest-path problem selects its best
member.

Edge costs are the same in both directions, bit for bit: rows are read for columns.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.core.kernels.compilation import kernel

_LEAST_GAIN = 1e-12  # relative improvement that counts


def neighbourhood(indices: IntArray, wide: bool) -> IntArray:
    """(n, w) nodes within one displacement of each node, itself first, -1 where there is none.

    Args:
        indices: (n, axes) offset indices of the nodes of a layer.
        wide: along an axis, all steps up to half its width; else the powers of two among them.
    """
    axes = indices.shape[1]
    if axes == 0:
        return np.zeros((1, 1), dtype=np.int64)
    lowest = indices.min(axis=0)
    shape = tuple(int(e) for e in indices.max(axis=0) - lowest + 1)
    table = np.full(shape, -1, dtype=np.int64)
    table[tuple((indices - lowest).T)] = np.arange(len(indices))
    next_to = np.stack(np.meshgrid(*[[0, -1, 1]] * axes, indexing="ij"), -1).reshape(-1, axes)
    unit = np.eye(axes, dtype=np.int64)
    far = [
        sign * size * unit[axis]
        for axis in range(axes)
        for size in range(2, shape[axis] // 2 + 1)
        if wide or size.bit_count() == 1
        for sign in (1, -1)
    ]
    targets = (indices - lowest)[:, None] + np.array([*next_to, *far])
    inside = np.all((targets >= 0) & (targets < shape), axis=2)
    found = table[tuple(np.moveaxis(np.where(inside[..., None], targets, 0), 2, 0))]
    return np.where(inside, found, -1)


@kernel
def path_cost(path: IntArray, edge_costs: Array, node_costs: Array, open_edges: Flags) -> float:
    """F of a path, infinite if one of its edges is closed."""
    total = 0.0
    for i in range(len(path) - 1):
        if not open_edges[i, path[i], path[i + 1]]:
            return np.inf
        total += edge_costs[path[i], path[i + 1]] + node_costs[i + 1, path[i + 1]]
    return total


@kernel
def _best_neighbour(
    path: IntArray, edge_costs: Array, node_costs: Array, open_edges: Flags, table: IntArray
) -> float:
    """Replace a path by the best one in its neighbourhood; return its cost.

    The best one over all edges comes first, as few are closed; if it has no closed edge, it is the
    best over the open ones too.
    """
    m, width = len(path) - 1, table.shape[1]
    costs, nodes = np.empty((m + 1, width)), np.empty((m + 1, width), dtype=np.int64)
    counts, found = np.empty(m + 1, dtype=np.int64), np.empty(m + 1, dtype=np.int64)
    for closed in (True, False):
        _extend(path, edge_costs, node_costs, open_edges, closed, table, costs, nodes, counts)
        if counts[m] == 0:
            return np.inf
        if _trace(edge_costs, open_edges, closed, costs, nodes, counts, found):
            path[:] = found
            return float(costs[m, 0])
    return np.inf


@kernel
def _extend(
    path: IntArray,
    edge_costs: Array,
    node_costs: Array,
    open_edges: Flags,
    closed: bool,
    table: IntArray,
    costs: Array,
    nodes: IntArray,
    counts: IntArray,
) -> None:
    """Least costs of the nodes around a path, layer after layer; `closed` edges count or not.

    The results are `nodes` (m + 1, w), their `costs`, and `counts` (m + 1,), how many are reached.
    """
    m, width = len(path) - 1, table.shape[1]
    costs[0, 0], nodes[0, 0], counts[0] = 0.0, path[0], 1
    for i in range(m):
        reached = 0
        for b in range(width if i < m - 1 else 1):
            head, least = table[path[i + 1], b], np.inf
            if head < 0 or node_costs[i + 1, head] == np.inf:
                continue
            if closed:
                row = np.uint64(head)  # without a sign, indices need no check for one
                for a in range(counts[i]):
                    least = min(least, costs[i, a] + edge_costs[row, np.uint64(nodes[i, a])])
            else:
                for a in range(counts[i]):
                    if open_edges[i, nodes[i, a], head]:
                        least = min(least, costs[i, a] + edge_costs[nodes[i, a], head])
            if least < np.inf:
                costs[i + 1, reached] = least + node_costs[i + 1, head]
                nodes[i + 1, reached] = head
                reached += 1
        counts[i + 1] = reached


@kernel
def _trace(
    edge_costs: Array,
    open_edges: Flags,
    closed: bool,
    costs: Array,
    nodes: IntArray,
    counts: IntArray,
    found: IntArray,
) -> bool:
    """The best path through the results of `_extend`; whether all its edges are open."""
    m, all_open = len(found) - 1, True
    found[m] = nodes[m, 0]
    for i in range(m - 1, -1, -1):
        head, least, choice = found[i + 1], np.inf, 0
        for a in range(counts[i]):
            total = costs[i, a] + edge_costs[nodes[i, a], head]
            if total < least and (closed or open_edges[i, nodes[i, a], head]):
                least, choice = total, a
        found[i] = nodes[i, choice]
        all_open &= open_edges[i, found[i], head]
    return all_open


@kernel
def _best_moves(path: IntArray, edge_costs: Array, node_costs: Array, open_edges: Flags) -> float:
    """Move the node of each layer in turn to the best one between its neighbours; the gain in F."""
    m, n = len(path) - 1, len(edge_costs)
    gain = 0.0
    for i in range(1, m):
        tail, now, head = path[i - 1], path[i], path[i + 1]
        present = edge_costs[tail, now] + node_costs[i, now] + edge_costs[now, head]
        better = 0
        for k in range(n):
            better += edge_costs[tail, k] + node_costs[i, k] + edge_costs[head, k] < present
        if better == 0:
            continue
        best, choice = present, now
        for k in range(n):
            cost = edge_costs[tail, k] + node_costs[i, k] + edge_costs[k, head]
            if cost < best and open_edges[i - 1, tail, k] and open_edges[i, k, head]:
                best, choice = cost, k
        path[i] = choice
        gain += present - best
    return gain


@kernel
def improve(
    path: IntArray, edge_costs: Array, node_costs: Array, open_edges: Flags, table: IntArray
) -> float:
    """Improve a path in place until its neighbourhood holds no better one; return its cost.

    A path with closed edges is replaced if its neighbourhood holds an open one; otherwise the cost
    is infinite.
    """
    cost = path_cost(path, edge_costs, node_costs, open_edges)
    while True:
        better = _best_neighbour(path, edge_costs, node_costs, open_edges, table)
        if better < np.inf:
            better -= _best_moves(path, edge_costs, node_costs, open_edges)
        if not better < cost * (1.0 - _LEAST_GAIN):
            return min(better, cost)
        cost = better
