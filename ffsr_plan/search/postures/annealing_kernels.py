"""Compiled annealing of a path through base offsets and postures by segment shifts.

A shift rotates the rest of the path behind its segment about one axis by one angle. Lengths and the
attitude at the goal follow from the segment alone, and the angle bounds the change of the
clearances behind it, so that most shifts are rejected before any distance is computed.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.search.postures.cost_kernels import (
    COLLISION_COST,
    ClearanceCost,
    CostedPath,
    PostureGrid,
    Workspace,
    angle_to,
    attitude_cost,
    compose,
    new_workspace,
    node_cost,
    path_cost,
    take_edges,
    visit,
)

_FIRST_PART = 64  # shifts of an annealing between two checks of time and Ctrl-C, at first
_SECONDS_OF_A_PART = 0.006  # up to which the next part is twice as long


@kernel
def uncosted_path(path: IntArray) -> CostedPath:
    """A path (m + 1, 2) whose costs are not worked out yet."""
    m = len(path) - 1
    return CostedPath(
        path.copy(),
        np.zeros(m),
        np.zeros((m + 1, 4)),
        np.zeros(m + 1),
        np.zeros(m + 1),
        np.zeros(m + 1),
    )


@kernel
def least_cost(constants: ClearanceCost, clearance: float, change: float, inner: bool) -> float:
    """The least that a node may cost [m] whose clearance changes by `change` at most."""
    cost = node_cost(constants, clearance + change, inner)
    return cost if clearance + change <= 0.0 else min(COLLISION_COST, cost)


@kernel
def trial_cost(
    grid: PostureGrid,
    current: CostedPath,
    trial: CostedPath,
    first: int,
    last: int,
    weight: float,
    limit: float,
    workspace: Workspace,
) -> float:
    """Cost [m] of a path that differs from another one on the layers first .. last - 1.

    Args:
        grid: the lattice.
        current: the path as it is.
        trial: the new one, of which only the nodes are given; worked out from `first` on, but for
            lengths that do not change.
        first: the first layer that differs.
        last: the layer after the last one that differs.
        weight: of a radian by which the goal attitude is missed [m].
        limit: a cost above it is infinite [m].
        workspace: to work in.
    """
    m = len(current.nodes) - 1
    trial.quats[first - 1] = current.quats[first - 1]
    if not take_edges(grid, trial, first - 1, last):
        return np.inf
    old, new = current.quats, trial.quats
    spin = angle_to(old[last], new[last])
    if spin > 0.0:  # the rest of the path is rotated in the world by one rotation
        back, change = np.empty(4), np.empty(4)
        back[:3], back[3] = -old[last, :3], old[last, 3]
        compose(new[last], back, change)
        for i in range(last, m + 1):
            compose(change, old[i], new[i])
    else:
        new[last:] = old[last:]
    total = attitude_cost(grid.reach_attitude, new[m], grid.goal, grid.free_error, weight)
    for i in range(m):
        total += trial.lengths[i] if first - 1 <= i < last else current.lengths[i]
    for i in range(1, first):
        total += current.costs[i]
    trial.least[first:last] = 0.0
    for i in range(last, m + 1):
        displacement = spin * grid.radii[grid.rows[i], current.nodes[i, 1]]
        trial.least[i] = least_cost(grid.clearance_cost, current.clearances[i], displacement, i < m)
        total += trial.least[i]
    if total > limit:
        return np.inf
    if spin > 0.0:
        return visit(grid, trial, first, m + 1, total, limit, workspace)
    trial.clearances[last:], trial.costs[last:] = current.clearances[last:], current.costs[last:]
    return visit(grid, trial, first, last, total, limit, workspace)


@kernel
def adopt(current: CostedPath, trial: CostedPath, first: int, last: int) -> None:
    """Make the trial the current path."""
    current.nodes[first:last] = trial.nodes[first:last]
    current.lengths[first - 1 : last] = trial.lengths[first - 1 : last]
    current.quats[first:] = trial.quats[first:]
    current.clearances[first:] = trial.clearances[first:]
    current.costs[first:] = trial.costs[first:]


@kernel
def shift(
    successors: IntArray,
    neighbours: IntArray,
    axes: int,
    nodes: IntArray,
    moved: IntArray,
    first: int,
    last: int,
    kind: int,
) -> bool:
    """Shift the nodes on the layers first .. last - 1 of a path; whether that is possible.

    Kinds are: back and forth along each posture axis, to either side along each axis of the base,
    a layer later and a layer earlier.
    """
    beside = neighbours.shape[1]
    if kind < 2 * axes:
        step = (3**axes - 1) // 2 + (3 ** (kind // 2) if kind % 2 else -(3 ** (kind // 2)))
        for i in range(first, last):
            moved[i, 1] = successors[nodes[i, 1], step]
            if moved[i, 1] < 0:
                return False
    elif kind < 2 * axes + beside:
        for i in range(first, last):
            moved[i, 0] = neighbours[nodes[i, 0], kind - 2 * axes]
            if moved[i, 0] < 0:
                return False
    else:  # shift the segment by one layer
        when = -1 if kind == 2 * axes + beside else 1
        for i in range(first, last):
            moved[i] = nodes[i + when]
    return True


class Annealing(NamedTuple):
    """The state of an annealing between two of its parts."""

    current: CostedPath
    trial: CostedPath
    """Equal to `current` in its nodes."""
    levels: Array
    """(3,) cost of the best path [m], of the current one, and weight of the goal attitude [m]."""
    best_path: IntArray
    """(m + 1, 2)."""


def anneal(
    grid: PostureGrid,
    rng: np.random.Generator,
    path: IntArray,
    iterations: int,
    hot: float,
    cold: float,
    weights: Array,
    best_path: IntArray,
    stop_requested: Callable[[], bool] = bool,
) -> float:
    """Shift whole segments of a path by one, along an axis or in time, as the temperature falls.

    The result is the same however the annealing is divided into parts.

    Args:
        grid: the lattice.
        rng: source of randomness.
        path: (m + 1, 2) base offset and posture on each layer.
        iterations: shifts to try.
        hot: temperature at the beginning [m].
        cold: at the end [m].
        weights: (2,) of a radian by which the goal attitude is missed [m]: at the beginning, and
            from half of the iterations on, by which the best path is judged.
        best_path: (m + 1, 2) the best path, filled in.
        stop_requested: asked every few milliseconds; whether to end with the best path so far.

    Returns:
        The cost of the best path [m].
    """
    state = Annealing(uncosted_path(path), uncosted_path(path), np.empty(3), best_path)
    state.levels[:] = path_cost(grid, state.current, weights[1]), np.inf, weights[0]
    best_path[:] = path
    done, part = 0, _FIRST_PART
    while done < iterations:
        begin, until = time.monotonic(), min(done + part, iterations)
        anneal_part(grid, rng, state, done, until, iterations, hot, cold, weights)
        done = until
        if stop_requested():
            break
        seconds = time.monotonic() - begin
        if seconds < _SECONDS_OF_A_PART:
            part *= 2
        elif seconds > 2.0 * _SECONDS_OF_A_PART:
            part = max(part // 2, 1)
    return float(state.levels[0])


@kernel
def anneal_part(
    grid: PostureGrid,
    rng: np.random.Generator,
    state: Annealing,
    begin: int,
    end: int,
    iterations: int,
    hot: float,
    cold: float,
    weights: Array,
) -> None:
    """The shifts `begin` .. `end` - 1 of an annealing; see `anneal`."""
    current, trial, best_path = state.current, state.trial, state.best_path
    m, workspace = len(best_path) - 1, new_workspace()
    successors, neighbours, axes = grid.successors, grid.neighbours, grid.indices.shape[1]
    kinds = 2 * axes + neighbours.shape[1] + 2
    best, now, weight = state.levels[0], state.levels[1], state.levels[2]
    for n in range(begin, end):
        done = n / iterations
        if n % 64 == 0:
            weight = weights[0] * (weights[1] / weights[0]) ** min(1.0, 2.0 * done)
            now = path_cost(grid, current, weight)  # rounding errors do not add up either
        heat = hot * (cold / hot) ** done
        length = int(math.exp(rng.random() * math.log(m)))
        first = 1 + int(rng.random() * (m - 1))
        last = min(first + length, m)
        kind = int(rng.random() * kinds)
        if not shift(successors, neighbours, axes, current.nodes, trial.nodes, first, last, kind):
            trial.nodes[first:last] = current.nodes[first:last]
            continue
        limit = now - heat * math.log(1.0 - rng.random())
        cost = trial_cost(grid, current, trial, first, last, weight, limit, workspace)
        if cost == np.inf:
            trial.nodes[first:last] = current.nodes[first:last]
            continue
        now = cost
        adopt(current, trial, first, last)
        if done >= 0.5 and cost < best:
            best = cost
            best_path[:] = current.nodes
    state.levels[0], state.levels[1], state.levels[2] = best, now, weight
