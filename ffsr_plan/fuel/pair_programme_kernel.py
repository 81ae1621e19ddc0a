"""Compiled dynamic programme over pairs of successive nodes, with a bound on what is left.

A path through layers at equal times has the steps e_1 .. e_m and costs

    |e_1| + sum over t = 2 .. m of |e_t - e_(t-1)| + |e_m|.

A second difference joins three nodes, so a state is a pair: node j on layer i - 1, node k on layer
i. All steps have the same part along the way, `step`; only the parts across it differ.

The bound. Let v be the last step of a state, r >= 1 the number of steps left, and w the mean that
they must have to end at the goal. What is left of the cost is the length C of the polygon
v, x_1, .., x_r, 0 through the steps x_t. It passes through x_t, so |x_t - v| + |x_t| <= C: every
x_t lies in the ellipse with the foci v and 0 and the long axis C. An ellipse is convex, so their
mean w lies in it too:

    C >= |w - v| + |w|.

Equal steps x_t = w cost just that, so the bound is exact where no obstacle is in the way and
offsets are continuous. By the triangle inequality it is at least |v| and at least |2 w - v|.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.core.arrays import Array, IntArray, States
from ffsr_plan.core.kernels.compilation import inlined_kernel, kernel
from ffsr_plan.lattice.edge_states import REFUSED

_NOTHING = np.inf
ShortIntArray = NDArray[np.int16]
"""Numbers of nodes, of which a lattice that fits into memory has fewer than 32 768."""


@inlined_kernel
def change_left(step: float, v0: float, v1: float, w0: float, w1: float) -> float:
    """A lower bound on the cost from a state to the goal, see above.

    Args:
        step: part of every step along the way [m].
        v0: part of the last step across the way, on the first axis [m].
        v1: on the second axis [m].
        w0: mean of the steps left, on the first axis [m]; with none left, that of `v0`.
        w1: on the second axis [m].

    Returns:
        |w - v| + |w| [m].
    """
    turn = math.sqrt((w0 - v0) ** 2 + (w1 - v1) ** 2)
    return turn + math.sqrt(step * step + w0 * w0 + w1 * w1)


@kernel
def first_pairs(
    at: Array, step: float, origin: int, nodes: IntArray, status: States, costs: Array
) -> None:
    """Costs of the states on layer 1, which all come from the origin.

    Args:
        at: (n, 2) offsets [m].
        step: part of every step along the way [m].
        origin: node of layer 0.
        nodes: (k,) nodes of layer 1 that are allowed.
        status: (m, n, n) states of edges.
        costs: (n, n) of node and the node before [m], updated for `nodes`.
    """
    for k in nodes:
        costs[k, origin] = _NOTHING
        if status[0, origin, k] != REFUSED:
            x, y = at[k, 0] - at[origin, 0], at[k, 1] - at[origin, 1]
            costs[k, origin] = math.sqrt(step * step + x * x + y * y)


@kernel
def extend_pairs(
    layer: int,
    at: Array,
    step: float,
    origin: int,
    allowed: tuple[IntArray, IntArray, IntArray],
    status: States,
    limit: float,
    costs: Array,
    onward: Array,
    back: ShortIntArray,
) -> float:
    """Least costs of the states on the next layer.

    A state whose cost and bound exceed the limit is left out. The states before a node are looked
    at in the order of their costs, and no longer once one costs as much as the best sum so far.

    Args:
        layer: i, from 1 to m - 1.
        at: (n, 2) offsets [m].
        step: part of every step along the way [m].
        origin: node of layer m.
        allowed: nodes that are allowed on the layers i - 1, i and i + 1.
        status: (m, n, n) states of edges.
        limit: cost of a whole path above which it is of no interest [m].
        costs: (n, n) of node on layer i and node before [m].
        onward: (n, n) of node on layer i + 1 and node on layer i [m], updated.
        back: (m, n, n) node on layer i - 1 of the best path to each of them, updated.

    Returns:
        The least cost that a path through a state left out can have [m]; infinite without one.
    """
    tails, nodes, heads = allowed
    left, beyond = len(status) - layer, _NOTHING
    chosen, found = np.empty(len(tails), np.int64), np.empty(len(tails))
    for k in nodes:
        count = 0
        w0, w1 = (at[origin, 0] - at[k, 0]) / left, (at[origin, 1] - at[k, 1]) / left
        for j in tails:
            v0, v1 = at[k, 0] - at[j, 0], at[k, 1] - at[j, 1]
            whole = costs[k, j] + change_left(step, v0, v1, w0, w1)
            if whole <= limit and whole < _NOTHING:
                chosen[count], found[count] = j, costs[k, j]
                count += 1
            else:
                beyond = min(beyond, whole)
        for head in heads:
            onward[head, k] = _NOTHING
        if count > 0:
            order = np.argsort(found[:count])
            pairs = chosen[order], found[order]
            least = pairs_from(
                layer, at, step, origin, k, heads, pairs, status, limit, onward, back
            )
            beyond = min(beyond, least)
    return beyond


@kernel
def pairs_from(
    layer: int,
    at: Array,
    step: float,
    origin: int,
    k: int,
    heads: IntArray,
    pairs: tuple[IntArray, Array],
    status: States,
    limit: float,
    onward: Array,
    back: ShortIntArray,
) -> float:
    """Least costs of the states from one node to the next layer, as in `extend_pairs`.

    Args:
        layer: i.
        at: (n, 2) offsets [m].
        step: part of every step along the way [m].
        origin: node of layer m.
        k: node of layer i.
        heads: nodes of layer i + 1 that are allowed.
        pairs: (c,) nodes of layer i - 1, c >= 1, and (c,) costs of their states [m], ascending.
        status: (m, n, n) states of edges.
        limit: cost of a whole path above which it is of no interest [m].
        onward: (n, n) of node on layer i + 1 and node on layer i [m], infinite; updated.
        back: (m, n, n), updated.

    Returns:
        The least cost that a path through a state left out can have [m].
    """
    left, beyond, (before, so_far) = len(status) - layer - 1, _NOTHING, pairs
    x, y = at[before, 0] - 2.0 * at[k, 0], at[before, 1] - 2.0 * at[k, 1]
    for head in heads:
        if status[layer, k, head] == REFUSED:
            continue
        a, b = at[head, 0], at[head, 1]
        v0, v1 = a - at[k, 0], b - at[k, 1]
        w0, w1 = v0, v1
        if left > 0:
            w0, w1 = (at[origin, 0] - a) / left, (at[origin, 1] - b) / left
        whole = so_far[0] + change_left(step, v0, v1, w0, w1)
        if whole > limit:
            beyond = min(beyond, whole)
            continue
        best, best_before = _NOTHING, before[0]
        for q in range(len(so_far)):
            room = best - so_far[q]
            if room <= 0.0:
                break
            turn = (x[q] + a) ** 2 + (y[q] + b) ** 2
            if turn < room * room:
                best, best_before = so_far[q] + math.sqrt(turn), before[q]
        onward[head, k], back[layer, head, k] = best, best_before
    return beyond
