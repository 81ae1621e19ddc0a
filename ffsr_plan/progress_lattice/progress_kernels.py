"""Compiled shortest paths and bounds on a lattice with progress.

Between calls of `extend` nodes and edges only become dearer, so that a node is still entered best
by the same step unless its tail has changed or it is refused. Should a node become cheaper by
rounding, later layers are searched anew.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray, States
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.lattice.edge_states import REFUSED


@kernel
def extend(
    first: int,
    fresh: bool,
    refused: bool,
    edges: IntArray,
    heads: IntArray,
    tails: IntArray,
    edge_costs: Array,
    node_costs: Array,
    at_rest: States,
    moving: States,
    remaining: Array,
    limit: float,
    entered: Array,
    costs: Array,
    before: IntArray,
) -> None:
    """Shortest paths from the start, layer after layer from `first` on (Bellman).

    Args:
        first: the first layer whose edges are evaluated; `costs` are valid up to it.
        fresh: whether no node has been entered yet, or none up to this limit.
        refused: whether edges may have been refused since the last call.
        edges: (A, D), and the next ones, see `ProgressRoadmap`.
        heads: (n, W).
        tails: (n, W, 2) offsets from which a step aside leads to each, and these steps; -1 after.
        edge_costs: (E, W).
        node_costs: (m + 1, A, n).
        at_rest: (E, n, W).
        moving: (m, E, n, W), or (0, ...).
        remaining: (m + 1, A, n) least cost from each node to the goal, or a lower bound.
        limit: nodes through which every path costs more are left out.
        entered: (m + 1, A, n) least cost of reaching each node without its own, updated.
        costs: (m + 1, A, n) least cost of reaching each node, updated.
        before: (m + 1, A, n, 3) place and offset from which the shortest path comes, and its step
            aside; -1 for none; updated.
    """
    layers, count, n = costs.shape
    changed, again = np.zeros((2, count, n), dtype=np.bool_)
    for k in range(first, layers - 1):
        cheaper, come = False, before[k + 1]
        again[:] = fresh
        _mark(changed, edges, heads, come, again)
        if refused:
            _mark_refused(k, edges, at_rest, moving, come, again)
        for b in range(count):
            for h in range(n):
                if again[b, h]:
                    entered[k + 1, b, h] = _enter(
                        k, b, h, edges, tails, edge_costs, at_rest, moving, costs, come[b, h]
                    )
                total = entered[k + 1, b, h] + node_costs[k + 1, b, h]
                if total + remaining[k + 1, b, h] > limit:
                    total = np.inf
                changed[b, h] = total != costs[k + 1, b, h]
                cheaper = cheaper or total < costs[k + 1, b, h]
                costs[k + 1, b, h] = total
        fresh = fresh or cheaper


@kernel
def remain(
    goal: int,
    origin: int,
    edges: IntArray,
    heads: IntArray,
    edge_costs: Array,
    node_costs: Array,
    remaining: Array,
) -> None:
    """Least costs from nodes to the goal, without their own, if all edges are free.

    Args:
        goal: place of the goal.
        origin: offset of the goal.
        edges: (A, D), and the next ones, see `ProgressRoadmap`.
        heads: (n, W).
        edge_costs: (E, W).
        node_costs: (m + 1, A, n).
        remaining: (m + 1, A, n) filled in; infinite where no path leads to the goal.
    """
    layers, count, n = remaining.shape
    reach = edges.shape[1] // 2
    remaining[:] = np.inf
    remaining[layers - 1, goal, origin] = 0.0
    for k in range(layers - 2, -1, -1):
        for a in range(count):
            for b in range(max(a - reach, 0), min(a + reach + 1, count)):
                e = edges[a, b - a + reach]
                if e < 0:
                    continue
                for j in range(n):
                    least = remaining[k, a, j]
                    for w in range(heads.shape[1]):
                        h = heads[j, w]
                        if h >= 0:
                            own = node_costs[k + 1, b, h] + remaining[k + 1, b, h]
                            least = min(least, edge_costs[e, w] + own)
                    remaining[k, a, j] = least


@kernel
def _mark(changed: Flags, edges: IntArray, heads: IntArray, come: IntArray, again: Flags) -> None:
    """Mark in `again` (A, n) the nodes that are entered from `changed` (A, n) ones."""
    count, n = changed.shape
    reach = edges.shape[1] // 2
    for a in range(count):
        for j in range(n):
            if not changed[a, j]:
                continue
            for b in range(max(a - reach, 0), min(a + reach + 1, count)):
                for w in range(heads.shape[1]):
                    h = heads[j, w]
                    if h >= 0 and come[b, h, 0] == a and come[b, h, 1] == j:
                        again[b, h] = True


@kernel
def _mark_refused(
    k: int, edges: IntArray, at_rest: States, moving: States, come: IntArray, again: Flags
) -> None:
    """Mark in `again` (A, n) the nodes that are entered from layer `k` by refused edges."""
    count, n = again.shape
    for b in range(count):
        for h in range(n):
            a, j, w = come[b, h, 0], come[b, h, 1], come[b, h, 2]
            if a >= 0:
                e = edges[a, b - a + edges.shape[1] // 2]
                barred = len(moving) > 0 and moving[k, e, j, w] == REFUSED
                again[b, h] = again[b, h] or barred or at_rest[e, j, w] == REFUSED


@kernel
def _enter(
    k: int,
    b: int,
    h: int,
    edges: IntArray,
    tails: IntArray,
    edge_costs: Array,
    at_rest: States,
    moving: States,
    costs: Array,
    step: IntArray,
) -> float:
    """The least cost of entering place `b` and offset `h` from layer `k`, and the `step` for it."""
    least, reach = np.inf, edges.shape[1] // 2
    step[0] = -1
    for a in range(max(b - reach, 0), min(b + reach + 1, len(edges))):
        e = edges[a, b - a + reach]
        if e < 0:
            continue
        for i in range(tails.shape[1]):
            j, w = tails[h, i, 0], tails[h, i, 1]
            if j < 0:
                break
            total = costs[k, a, j] + edge_costs[e, w]
            if total >= least or at_rest[e, j, w] == REFUSED:
                continue
            if len(moving) and moving[k, e, j, w] == REFUSED:
                continue
            least = total
            step[0], step[1], step[2] = a, j, w
    return least


@kernel
def trace(before: IntArray, goal: int, origin: int, path: IntArray) -> None:
    """The shortest path to the goal.

    Args:
        before: (m + 1, A, n, 3), see `extend`.
        goal: place of the goal.
        origin: offset of the goal.
        path: (m + 1, 3) place, offset, and step aside towards the next layer; filled in.
    """
    last = len(path) - 1
    path[last, 0], path[last, 1], path[last, 2] = goal, origin, -1
    for k in range(last, 0, -1):
        path[k - 1] = before[k, path[k, 0], path[k, 1]]


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
