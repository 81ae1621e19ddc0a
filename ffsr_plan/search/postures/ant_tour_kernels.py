"""Compiled tours of ants through base offsets and postures, and their cost to go."""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.search.postures.cost_kernels import (
    PostureGrid,
    clearance_at,
    edge_length,
    is_free,
    new_workspace,
    node_cost,
    obstacles_on,
    step_between,
)
from ffsr_plan.time_limit.deadline import Deadline

_NODES_AT_ONCE = 1024  # of a layer, that are worked out between two looks at the deadline


def cost_to_go(grid: PostureGrid, nominal: Array, deadline: Deadline | None = None) -> Array:
    """(m + 1, b, n) least cost [m] from each node to the goal, every layer at one attitude.

    Args:
        grid: the lattice.
        nominal: (m + 1, 4) the attitudes.
        deadline: after which `OutOfTime` is raised.
    """
    deadline = deadline or Deadline()
    m, count, offsets = len(grid.rows) - 1, len(grid.successors), len(grid.across)
    ahead, own = np.full((m + 1, offsets, count), np.inf), np.empty((offsets, count))
    ahead[m, grid.origin[0], grid.origin[1]] = 0.0
    for layer in range(m, -1, -1):
        for add in (add_edges, add_nodes):
            for first in range(0, offsets * count, _NODES_AT_ONCE):
                deadline.check()
                last = min(first + _NODES_AT_ONCE, offsets * count)
                add(grid, nominal, layer, ahead, own, first, last)
    return ahead


@kernel
def add_edges(
    grid: PostureGrid, nominal: Array, i: int, ahead: Array, own: Array, first: int, last: int
) -> None:
    """Work out the cost to go from nodes of one layer.

    Args:
        grid: the lattice.
        nominal: (m + 1, 4) the attitudes, not used.
        i: the layer; the one after it is worked out.
        ahead: (m + 1, b, n) of `cost_to_go`, of which layer `i` is filled in.
        own: (b, n) costs of the nodes of the layer after it [m].
        first: number of the first node, base offset times n plus posture.
        last: number behind the last one.
    """
    m, count, row = len(grid.rows) - 1, len(grid.successors), grid.rows[i]
    offsets, steps = len(grid.across), grid.successors.shape[1]
    if i == m:
        return
    for node in range(first, last):
        b, p = node // count, node % count
        if not grid.allowed[row, p]:
            continue
        for step in range(steps):
            on = grid.successors[p, step]
            if on < 0:
                continue
            for b_on in range(offsets):
                rest = ahead[i + 1, b_on, on] + own[b_on, on]
                if rest < ahead[i, b, p]:
                    length = edge_length(
                        grid.delta_d, grid.across[b, b_on], grid.squared_steps[row, p, step]
                    )
                    ahead[i, b, p] = min(ahead[i, b, p], rest + length)


@kernel
def add_nodes(
    grid: PostureGrid, nominal: Array, i: int, ahead: Array, own: Array, first: int, last: int
) -> None:
    """Work out the costs of nodes of one layer.

    Args:
        grid: the lattice.
        nominal: (m + 1, 4) the attitudes.
        i: the layer.
        ahead: (m + 1, b, n) of `cost_to_go`; layer `i` is worked out.
        own: (b, n) costs of the nodes [m], filled in.
        first: number of the first node, base offset times n plus posture.
        last: number behind the last one.
    """
    m, count, row = len(grid.rows) - 1, len(grid.successors), grid.rows[i]
    workspace, free = new_workspace(), is_free(grid)
    if i == 0:
        return
    obstacles = obstacles_on(grid, i)
    for node in range(first, last):
        b, p = node // count, node % count
        own[b, p] = 0.0
        if ahead[i, b, p] < np.inf and not free:
            frames, center = grid.frames[row, p], grid.centers[row, p]
            grid.queries[0] += 1
            clearance = clearance_at(
                obstacles, frames, grid.places[i, b], center, nominal[i], workspace
            )
            own[b, p] = node_cost(grid.clearance_cost, clearance, i < m)


@kernel
def walk(
    grid: PostureGrid,
    rng: np.random.Generator,
    ahead: Array,
    detour_scale: float,
    tau_offset: Array,
    tau_posture: Array,
    path: IntArray,
) -> bool:
    """One ant's path from start to goal; whether it reached the goal.

    A step is chosen with probability tau exp(-(length + cost to go from its head) / detour_scale):
    the excess over the best step counts, not the length of the step.

    Args:
        grid: the lattice.
        rng: source of randomness.
        ahead: (m + 1, b, n) of `cost_to_go`.
        detour_scale: [m].
        tau_offset: (m, b, b) pheromone of each change of the base offset.
        tau_posture: (m, n, k) pheromone of each posture step.
        path: (m + 1, 2) base offset and posture on each layer, filled in.
    """
    m, steps, count = len(grid.rows) - 1, grid.successors.shape[1], len(grid.across)
    wheel, delta_d = np.empty(steps * count), grid.delta_d
    path[0] = grid.origin
    for i in range(m):
        b, p = path[i, 0], path[i, 1]
        least = ahead[i, b, p]
        total = 0.0
        for step in range(steps):
            on = grid.successors[p, step]
            for b_on in range(count):
                weight = 0.0
                if on >= 0 and ahead[i + 1, b_on, on] < np.inf:
                    squared_step = grid.squared_steps[grid.rows[i], p, step]
                    cost = edge_length(delta_d, grid.across[b, b_on], squared_step)
                    cost += ahead[i + 1, b_on, on]
                    weight = math.exp(-min(max(cost - least, 0.0) / detour_scale, 500.0))
                    weight *= tau_offset[i, b, b_on] * tau_posture[i, p, step]
                total += weight
                wheel[step * count + b_on] = total
        if total <= 0.0:
            return False
        chosen = int(np.searchsorted(wheel, rng.random() * total, side="right"))
        chosen = min(chosen, len(wheel) - 1)
        path[i + 1, 0], path[i + 1, 1] = chosen % count, grid.successors[p, chosen // count]
    return True


@kernel
def lay_pheromone(
    grid: PostureGrid, amount: float, path: IntArray, tau: Array, tau_posture: Array
) -> None:
    """Lay pheromone along a path (m + 1, 2)."""
    for i in range(len(path) - 1):
        b, p = path[i, 0], path[i, 1]
        tau[i, b, path[i + 1, 0]] += amount
        tau_posture[i, p, step_between(grid.indices, p, path[i + 1, 1])] += amount
