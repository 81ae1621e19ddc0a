"""Compiled cost of a path: length, clearance at fixed stations, and error of the goal attitude.

    cost = L + w sum over the stations of 1 / d + W max(0, missed angle - slack)

The stations are `STATIONS` points at equal steps of arc length between the ends: as many as the
inner nodes of a lattice of 40 divisions, so that the sum is that of Eq. 8. More corners do not
change it.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.collision.nearest_obstacle_kernels import nearest_obstacle
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.quaternions import angle_of
from ffsr_plan.tree_search.kernels.clear_step import place_shapes, put_in_world
from ffsr_plan.tree_search.kernels.flight import distance, fly, locate, observe, path_length
from ffsr_plan.tree_search.kernels.search_arrays import SearchArrays

STATIONS = 39
_NEAREST = 1e-9  # [m] that a clearance counts at least
SLACK = 0.002
"""Error of the attitude on arrival that costs nothing, as it is corrected in the end [rad]."""


@kernel
def path_cost(space: SearchArrays, states: Array, attitudes: Array, last: int) -> float:
    """Cost of a path that has been flown [m].

    Args:
        space: robot, scene and settings.
        states: (N, D) corners.
        attitudes: (N, 4) there.
        last: the last corner.
    """
    setup = space.setup[0]
    cost = path_length(space.weights, states, last)
    if setup.missed_weight > 0.0:
        missed = angle_of(attitudes[last], setup.goal)
        cost += setup.missed_weight * max(0.0, missed - SLACK)
    if setup.nearness_weight > 0.0 and len(space.tree.order) > 0:
        cost += setup.nearness_weight * nearness(space, states, attitudes, last)
    return cost


@kernel
def nearness(space: SearchArrays, states: Array, attitudes: Array, last: int) -> float:
    """Sum of 1 / d over the stations [1/m]; see `path_cost`."""
    count = states.shape[1]
    memory = np.empty(2 * count + 8)
    begin, end = memory[:count], memory[count : 2 * count]
    quat, arrival = memory[2 * count : 2 * count + 4], memory[2 * count + 4 :]
    step = path_length(space.weights, states, last) / (STATIONS + 1)
    total, passed, station = 0.0, 0.0, 1
    for k in range(last):
        length = distance(space.weights, 1, states[k], states[k + 1])
        begin[:] = states[k]
        quat[:] = attitudes[k]
        while station <= STATIONS and station * step <= passed + length:
            share = 0.0 if length == 0.0 else (station * step - passed) / length
            for a in range(count):
                end[a] = states[k, a] + share * (states[k + 1, a] - states[k, a])
            fly(space, begin, quat, end, arrival, False)
            total += 1.0 / max(clearance_at(space, end, arrival), _NEAREST)
            begin[:] = end
            quat[:] = arrival
            station += 1
        passed += length
    least = max(clearance_at(space, states[last], attitudes[last]), _NEAREST)
    return total + (STATIONS + 1 - station) / least  # rounding may leave the last one out


@kernel
def clearance_at(space: SearchArrays, state: Array, attitude: Array) -> float:
    """Least distance to an obstacle at a state, at most that which F counts [m]."""
    setup, memory = space.setup[0], np.empty(6)
    position, base = memory[:3], memory[3:]
    setup.checks += 1
    observe(space, state, state, 0.0)
    locate(space, state, state, 0.0, attitude, position, base)
    place_shapes(space)
    least = setup.cap
    if len(space.tree.order) == 0:
        return least
    for g in range(len(space.shapes)):
        put_in_world(space, g, position, setup.turn)
        near, row = nearest_obstacle(
            space.tree, space.shapes[g].kind, space.frame, space.still, least, -1, space.stack,
            space.bounds,
        )  # fmt: skip
        if row >= 0:
            least = near
    return least
