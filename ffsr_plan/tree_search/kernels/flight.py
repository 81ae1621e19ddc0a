"""Compiled flight along straight edges: the attitude that reacts, and how far the way is clear.

The attitude follows R' = R [omega]x by fourth-order Magnus steps (Blanes, Casas and Ros 2000):

    R <- R exp( h/6 (w0 + 4 w1 + w2) + h^2/12 w0 x w2 )

with the angular velocity at begin, middle and end of a step of length h.
"""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.bodies import base_rate, move_links, total_mass, weigh_links
from ffsr_plan.dynamics.kernels.quaternions import fill_matrix, turn_by
from ffsr_plan.tree_search.kernels.clear_step import link_step, obstacle_step, place_shapes
from ffsr_plan.tree_search.kernels.search_arrays import JOINTS, TURN, SearchArrays

_END = 1e-12  # of an edge's time, within which its end is reached


@kernel
def fly(
    space: SearchArrays, begin: Array, attitude: Array, end: Array, arrival: Array, check: bool
) -> float:
    """Fly straight from one state to another.

    Args:
        space: robot, scene and settings.
        begin: (D,) state.
        attitude: (4,) of the base there.
        end: (D,) state.
        arrival: (4,) filled in: the attitude as far as the way was flown.
        check: whether to stop before the robot comes too close to anything.

    Returns:
        The share of the way that was flown, 1 for all of it.
    """
    setup, memory = space.setup[0], np.empty(17)
    quat, position, base, spare = memory[:4], memory[4:7], memory[7:10], memory[10:]
    quat[:] = attitude
    arrival[:] = attitude
    farthest = joint_travel(begin, end)
    margin = setup.margin if len(space.bars) == 0 else barred_margin(space, begin, end)
    extra = margin - setup.margin
    observe(space, begin, end, 0.0)
    time = flown = 0.0
    while True:
        left = 1.0 - time
        step = left
        if check:
            setup.checks += 1
            locate(space, begin, end, time, quat, position, base)
            place_shapes(space)
            step = link_step(space, setup.self_margin + extra, max(left, _END))
            if step > 0.0 and len(space.tree.order) > 0:
                step = obstacle_step(space, position, setup.turn, base, margin, step)
            if step < 0.0:
                return flown
        flown = time
        arrival[:] = quat
        if left <= _END:
            return 1.0
        if farthest > 0.0:
            step = min(step, setup.largest_turn / farthest)
        if 0.5 * left < step < left:
            step = 0.5 * left
        advance(space, begin, end, time, step, quat, spare)
        time = 1.0 if step >= left else time + step


@kernel
def joint_travel(begin: Array, end: Array) -> float:
    """Largest change of a joint value or of the wheels' turn [rad or m]."""
    most = 0.0
    for k in range(TURN, len(begin)):
        most = max(most, abs(end[k] - begin[k]))
    return most


@kernel
def observe(space: SearchArrays, begin: Array, end: Array, time: float) -> None:
    """Links and angular velocity of the base at a time on an edge."""
    (values, rates), rate = space.joints, space.robot[0].rate
    for j in range(len(values)):
        rates[j] = end[JOINTS + j] - begin[JOINTS + j]
        values[j] = begin[JOINTS + j] + time * rates[j]
    move_links(space.bodies, values, rates, space.links)
    if space.setup[0].reacts:
        weigh_links(space.bodies, space.links, space.robot)
        base_rate(space.robot)
    else:
        for a in range(3):
            rate[a] = space.setup[0].axis[a] * (end[TURN] - begin[TURN])


@kernel
def advance(
    space: SearchArrays,
    begin: Array,
    end: Array,
    time: float,
    step: float,
    quat: Array,
    spare: Array,
) -> None:
    """Move on by a step, and turn the attitude `quat` (4,) by what the base does meanwhile.

    Args:
        space: as observed at `time`; afterwards at `time` + `step`.
        begin: (D,) state.
        end: (D,) state.
        time: begin of the step.
        step: its length.
        quat: (4,) changed.
        spare: (7,) memory.
    """
    now, rate, spare = space.robot[0].rate, spare[:3], spare[3:]
    rate[:] = now
    last = 1.0 if time + step > 1.0 - _END else time + step
    if not space.setup[0].reacts:
        turn_by(quat, step * rate[0], step * rate[1], step * rate[2], spare)
        observe(space, begin, end, last)
        return
    observe(space, begin, end, 0.5 * (time + last))
    x, y, z = 4.0 * now[0], 4.0 * now[1], 4.0 * now[2]
    observe(space, begin, end, last)
    one, two = step / 6.0, step * step / 12.0
    turn_by(
        quat,
        one * (rate[0] + x + now[0]) + two * (rate[1] * now[2] - rate[2] * now[1]),
        one * (rate[1] + y + now[1]) + two * (rate[2] * now[0] - rate[0] * now[2]),
        one * (rate[2] + z + now[2]) + two * (rate[0] * now[1] - rate[1] * now[0]),
        spare,
    )


@kernel
def locate(
    space: SearchArrays, begin: Array, end: Array, time: float, quat: Array,
    position: Array, base: Array,
) -> None:  # fmt: skip
    """Rotation of the base, place and velocity of its origin.

    Args:
        space: as observed at `time`; the rotation is filled in.
        begin: (D,) state.
        end: (D,) state.
        time: on the edge.
        quat: (4,) attitude of the base.
        position: (3,) filled in, world [m].
        base: (3,) filled in, velocity of the origin in base axes [m].
    """
    setup, turn = space.setup[0], space.setup[0].turn
    fill_matrix(quat, turn)
    if setup.floats:
        find_center(space, setup.center, setup.drift)
        c, w = setup.center, space.robot[0].rate
        base[0] = -(w[1] * c[2] - w[2] * c[1]) - setup.drift[0]
        base[1] = -(w[2] * c[0] - w[0] * c[2]) - setup.drift[1]
        base[2] = -(w[0] * c[1] - w[1] * c[0]) - setup.drift[2]
        for a in range(3):
            position[a] = setup.anchor[a] - (
                turn[a, 0] * c[0] + turn[a, 1] * c[1] + turn[a, 2] * c[2]
            )
        return
    x, y, z = end[0] - begin[0], end[1] - begin[1], end[2] - begin[2]
    for a in range(3):
        position[a] = begin[a] + time * (end[a] - begin[a])
        base[a] = turn[0, a] * x + turn[1, a] * y + turn[2, a] * z


@kernel
def find_center(space: SearchArrays, center: Array, drift: Array) -> None:
    """Centre of mass (3,) [m] and its velocity (3,) [m] relative to the base, filled in.

    Args:
        space: its links have been moved and weighed.
        center: filled in.
        drift: filled in.
    """
    bodies, links = space.bodies, space.links
    mass = total_mass(bodies)
    for a in range(3):
        center[a], drift[a] = bodies[0].lever[a] - links[0].arm[a], 0.0
    for j in range(1, len(bodies)):
        share, flow = bodies[j].mass / mass, links[j].flow
        for a in range(3):
            drift[a] += share * flow[a]


@kernel
def barred_margin(space: SearchArrays, begin: Array, end: Array) -> float:
    """The clearance to keep on an edge [m]: larger near one that the proof refused."""
    margin = space.setup[0].margin
    count = len(begin)
    for k in range(len(space.bars)):
        along = length = 0.0
        for a in range(count):
            weight = space.weights[0, a]
            step, apart = weight * (end[a] - begin[a]), weight * (space.bars[k, a] - begin[a])
            along += step * apart
            length += step * step
        share = 0.0 if length == 0.0 else min(max(along / length, 0.0), 1.0)
        squared = 0.0
        for a in range(count):
            place = begin[a] + share * (end[a] - begin[a])
            squared += (space.weights[0, a] * (space.bars[k, a] - place)) ** 2
        if math.sqrt(squared) < space.bars[k, count]:
            margin = max(margin, space.bars[k, count + 1])
    return margin


@kernel
def fly_path(space: SearchArrays, states: Array, attitudes: Array, first: int, last: int) -> int:
    """Fly along the corners of a path from corner `first` on.

    Args:
        space: robot, scene and settings.
        states: (N, D) corners.
        attitudes: (N, 4) at the corners; those behind `first` are filled in.
        first: corner to begin at.
        last: corner to end at.

    Returns:
        The last corner that was reached.
    """
    for k in range(first, last):
        if fly(space, states[k], attitudes[k], states[k + 1], attitudes[k + 1], True) < 1.0:
            return k
    return last


@kernel
def distance(weights: Array, row: int, first: Array, second: Array) -> float:
    """Weighted Euclidean distance of two states; `row` of `weights` (2, D)."""
    squared = 0.0
    for k in range(len(first)):
        step = (first[k] - second[k]) * weights[row, k]
        squared += step * step
    return math.sqrt(squared)


@kernel
def path_length(weights: Array, states: Array, last: int) -> float:
    """Length L of the path through the corners 0 .. `last` of `states` (N, D)."""
    total = 0.0
    for k in range(last):
        total += distance(weights, 1, states[k], states[k + 1])
    return total
