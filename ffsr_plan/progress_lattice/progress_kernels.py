"""Compiled shortest paths and bounds on a lattice with progress."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray, States
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.lattice.edge_states import REFUSED


@kernel
def extend(
    first: int,
    edges: IntArray,
    heads: IntArray,
    edge_costs: Array,
    node_costs: Array,
    at_rest: States,
    moving: States,
    costs: Array,
    before: IntArray,
) -> None:
    """Shortest paths from the start, layer after layer from `first` on (Bellman).

    Args:
        first: the first layer whose edges are evaluated; `costs` are valid up to it.
        edges: (A, D) edge of each step from each place; -1 where there is none.
        heads: (n, W) offset that each step aside from each offset leads to; -1 for none.
        edge_costs: (E, W).
        node_costs: (m + 1, A, n), infinite where a node may not be entered.
        at_rest: (E, n, W) states of edges as far as obstacles at rest count; refused ones are left
            out.
        moving: (m, E, n, W) the same for bodies that move; (0, ...) without any.
        costs: (m + 1, A, n) least cost of reaching each node, updated.
        before: (m + 1, A, n) step by which the shortest path comes: place and offset that it comes
            from, and the step aside, as one number; updated.
    """
    layers, count, n = costs.shape
    reach, aside = edges.shape[1] // 2, heads.shape[1]
    for k in range(first, layers - 1):
        costs[k + 1] = np.inf
        for a in range(count):
            for d in range(edges.shape[1]):
                e, b = edges[a, d], a + d - reach
                if e < 0:
                    continue
                for j in range(n):
                    so_far = costs[k, a, j]
                    if so_far == np.inf:
                        continue
                    for w in range(aside):
                        h = heads[j, w]
                        if h < 0:
                            continue
                        total = so_far + edge_costs[e, w]
                        if total >= costs[k + 1, b, h] or node_costs[k + 1, b, h] == np.inf:
                            continue
                        if at_rest[e, j, w] == REFUSED:
                            continue
                        if len(moving) and moving[k, e, j, w] == REFUSED:
                            continue
                        costs[k + 1, b, h] = total
                        before[k + 1, b, h] = (a * n + j) * aside + w
        for a in range(count):
            for j in range(n):
                costs[k + 1, a, j] += node_costs[k + 1, a, j]


@kernel
def trace(before: IntArray, aside: int, goal: int, origin: int, path: IntArray) -> None:
    """The shortest path to the goal.

    Args:
        before: (m + 1, A, n), see `extend`.
        aside: W, number of steps aside.
        goal: place of the goal.
        origin: offset of the goal.
        path: (m + 1, 3) place, offset, and step aside towards the next layer; filled in.
    """
    n, last = before.shape[2], len(path) - 1
    path[last, 0], path[last, 1], path[last, 2] = goal, origin, -1
    for k in range(last, 0, -1):
        code = before[k, path[k, 0], path[k, 1]]
        node = code // aside
        path[k - 1, 0], path[k - 1, 1], path[k - 1, 2] = node // n, node % n, code % aside


@kernel
def take_in(
    nodes: IntArray,
    exact: Array,
    distances: Array,
    travel: Array,
    drift: Array,
    window: int,
    bounds: Array,
    known: Flags,
) -> None:
    """Let evaluated nodes bound the clearances of others from above.

    From node to node a clearance changes by no more than robot and bodies travel.

    Args:
        nodes: (k, 3) layer, place and offset of each.
        exact: (k,) their clearances [m].
        distances: (n, n) between offsets [m].
        travel: (A, A) of the robot from place to place [m].
        drift: (m + 1,) that any body has travelled up to each layer, at most [m].
        window: layers and places, on either side, that are bounded.
        bounds: (m + 1, A, n) upper bounds, updated [m].
        known: (m + 1, A, n) whether they are exact, updated.
    """
    layers, count, n = bounds.shape
    for i in range(len(nodes)):
        layer, place, offset = nodes[i, 0], nodes[i, 1], nodes[i, 2]
        for k in range(max(layer - window, 0), min(layer + window + 1, layers)):
            aged = exact[i] + abs(drift[k] - drift[layer])
            for a in range(max(place - window, 0), min(place + window + 1, count)):
                so_far = aged + travel[place, a]
                for j in range(n):
                    bound = so_far + distances[offset, j]
                    if bound < bounds[k, a, j] and not known[k, a, j]:
                        bounds[k, a, j] = bound
    for i in range(len(nodes)):
        bounds[nodes[i, 0], nodes[i, 1], nodes[i, 2]] = exact[i]
        known[nodes[i, 0], nodes[i, 1], nodes[i, 2]] = True


@kernel
def refuse_near(
    status: States, heads: IntArray, offsets: Array, time: float, met: Array, depth: float
) -> None:
    """Refuse every edge of a step that passes nearer than `depth` to a place at the same time.

    Args:
        status: (n, W) of the step's edges, updated.
        heads: (n, W) offset that each step aside leads to; -1 for none.
        offsets: (n, 3) [m].
        time: when, in [0, 1].
        met: (3,) offset of the place [m].
        depth: [m].
    """
    for j in range(heads.shape[0]):
        for w in range(heads.shape[1]):
            h = heads[j, w]
            if h < 0:
                continue
            square = 0.0
            for i in range(3):
                x = (1.0 - time) * offsets[j, i] + time * offsets[h, i] - met[i]
                square += x * x
            if square < depth * depth:
                status[j, w] = REFUSED
