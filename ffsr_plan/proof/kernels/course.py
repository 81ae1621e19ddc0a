"""Compiled clearances of the collision shapes along the edges of a motion, for any offsets."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.collision.nearest_sphere_kernels import (
    STACK_SIZE,
    distance_to_sphere,
    nearest_sphere,
)
from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.bodies import LinkStates, move_links, weigh_links
from ffsr_plan.dynamics.kernels.rotation_series import Partial, multiply, normalise, rotation_at
from ffsr_plan.proof.kernels.travel import (
    BaseMotion,
    HullPoints,
    Scratch,
    Travel,
    bound_travel,
    fill_matrix,
    scratch_for,
)
from ffsr_plan.robots.kinematics import Bodies
from ffsr_plan.robots.shape_arrays import Primitives
from ffsr_plan.scene.sphere_tree import SphereTree


class Attitudes(NamedTuple):
    """The base's attitude along a motion of m edges.

    Attributes:
        starts: (k, 4) attitude at the start of each joint segment: one for each edge, or one in all
            (xyzw).
        turn: (3,) rotation vector of a base that does not react over an edge, base axes [rad].
        partial: rotations within the segments of a base that reacts.
    """

    starts: Array
    turn: Array
    partial: Partial


class Course(NamedTuple):
    """A motion of m edges among obstacles.

    Attributes:
        bodies: the links.
        shapes: the collision shapes.
        points: whose hulls contain the shapes.
        tree: the obstacles, at least one.
        base: what the base does.
        attitudes: of the base.
        positions: (m + 1, 3) base origin at the corners; where it floats, the centre of mass [m].
        values: (m + 1, nd) joint values at the corners [rad or m].
        whole: travel over whole edges, row by row.
        straight: (m,) whether that travel bounds parts of an edge too.
    """

    bodies: Bodies
    shapes: Primitives
    points: HullPoints
    tree: SphereTree
    base: BaseMotion
    attitudes: Attitudes
    positions: Array
    values: Array
    whole: Travel
    straight: Flags


class Memory(NamedTuple):
    """Scratch memory for one edge.

    Attributes:
        scratch: of the travel bound.
        travel: one row of it.
        frames: (g, 15) placements of the shapes.
        values: (nd,) joint values.
        rates: (nd,) their change over the edge.
        quats: (3, 4) attitude, and room for two others.
        position: (3,) base origin.
        stack: of the search for spheres.
        bounds: of the search for spheres.
        nearest: (g,) the sphere that was nearest to each shape last.
    """

    scratch: Scratch
    travel: Travel
    frames: Array
    values: Array
    rates: Array
    quats: Array
    position: Array
    stack: NDArray[np.int32]
    bounds: Array
    nearest: IntArray


@kernel
def memory_for(course: Course) -> Memory:
    """Memory for the edges of a course."""
    points, shapes = len(course.points.links), len(course.shapes.kinds)
    memory = Memory(
        scratch_for(len(course.bodies.parents)),
        Travel(
            np.empty((1, points, 3)),
            np.empty((1, points)),
            np.empty((1, points)),
            np.empty((1, points)),
            np.empty(1),
        ),
        np.empty((shapes, 15)),
        np.empty(course.values.shape[1]),
        np.empty(course.values.shape[1]),
        np.empty((3, 4)),
        np.empty(3),
        np.empty(STACK_SIZE, np.int32),
        np.empty(STACK_SIZE),
        np.zeros(shapes, np.int64),
    )
    memory.frames[:, 12:] = course.shapes.sizes
    return memory


@kernel
def attitude_at(course: Course, layer: int, time: float, quats: Array) -> None:
    """Attitude of the base at a time on an edge, in the first row of `quats` (3, 4)."""
    given, edges = course.attitudes, len(course.values) - 1
    if course.base.reacts:
        each = len(given.starts) == edges
        segment = layer if each else 0
        at = time if each else (layer + time) / edges
        rotation_at(given.partial, segment, at, quats[2], quats[1])
        multiply(quats[0], given.starts[segment], quats[1])
    else:
        turn, scale = given.turn, layer + time
        x, y, z = 0.5 * scale * turn[0], 0.5 * scale * turn[1], 0.5 * scale * turn[2]
        half = math.sqrt(x * x + y * y + z * z)
        sine = math.sin(half) / half if half > 1e-9 else 1.0
        quats[1] = sine * x, sine * y, sine * z, math.cos(half)
        multiply(quats[0], given.starts[0], quats[1])
    normalise(quats[0])


@kernel
def place_shapes(course: Course, layer: int, time: float, memory: Memory) -> None:
    """Placements of the shapes on the course at a time on an edge, without offset.

    Args:
        course: the motion.
        layer: the edge.
        time: on it, in [0, 1].
        memory: its frames are filled in.
    """
    values, rates, states = memory.values, memory.rates, memory.scratch.states
    for j in range(len(values)):
        begin, end = course.values[layer, j], course.values[layer + 1, j]
        values[j], rates[j] = (1.0 - time) * begin + time * end, end - begin
    move_links(course.bodies, values, rates, states)
    attitude_at(course, layer, time, memory.quats)
    turned, position, shapes = memory.scratch.rotation, memory.position, course.shapes
    fill_matrix(memory.quats[0], turned)
    begin_at, end_at = course.positions[layer], course.positions[layer + 1]
    for a in range(3):
        position[a] = (1.0 - time) * begin_at[a] + time * end_at[a]
    if course.base.floats:  # the centre of mass stays
        weigh_links(course.bodies, states)
        lever, arm = course.bodies.levers[0], states.arms[0]
        for a in range(3):
            for b in range(3):
                position[a] -= turned[a, b] * (lever[b] - arm[b])
    for i in range(len(shapes.kinds)):
        _place_shape(shapes, i, states, turned, position, memory.frames[i])


@kernel
def _place_shape(
    shapes: Primitives, i: int, states: LinkStates, turned: Array, position: Array, frame: Array
) -> None:
    """Rotation and position of shape `i` in the world, the first twelve numbers of `frame`."""
    link = shapes.links[i]
    rotation, origin = states.rotations[link], states.origins[link]
    for a in range(3):
        x = turned[a, 0] * rotation[0, 0] + turned[a, 1] * rotation[1, 0]
        y = turned[a, 0] * rotation[0, 1] + turned[a, 1] * rotation[1, 1]
        z = turned[a, 0] * rotation[0, 2] + turned[a, 1] * rotation[1, 2]
        x += turned[a, 2] * rotation[2, 0]
        y += turned[a, 2] * rotation[2, 1]
        z += turned[a, 2] * rotation[2, 2]
        at = position[a]
        for b in range(3):
            at += turned[a, b] * origin[b]
            own = shapes.rotations[i]
            frame[3 * a + b] = x * own[0, b] + y * own[1, b] + z * own[2, b]
        place = shapes.positions[i]
        frame[9 + a] = at + x * place[0] + y * place[1] + z * place[2]


@kernel
def measure(
    course: Course, layer: int, time: float, shift: Array, memory: Memory, found: Array
) -> float:
    """Distance of each shape to the nearest obstacle, in closed form.

    Args:
        course: the motion.
        layer: the edge.
        time: on it, in [0, 1].
        shift: (3,) offset of the base there [m].
        memory: scratch memory.
        found: (g,) distances, filled in [m]; for a hull, those of the box around it.

    Returns:
        The least of them [m].
    """
    place_shapes(course, layer, time, memory)
    least = np.inf
    for i in range(len(found)):
        kind, frame, near = course.shapes.kinds[i], memory.frames[i], memory.nearest[i]
        start = distance_to_sphere(kind, frame, shift, course.tree.spheres, near)
        found[i], memory.nearest[i] = nearest_sphere(
            course.tree, kind, frame, shift, start, near, memory.stack, memory.bounds
        )
        least = min(least, found[i])
    return least


@kernel
def travel_of_shapes(
    course: Course,
    layer: int,
    begin: float,
    end: float,
    step: Array,
    memory: Memory,
    result: Array,
) -> None:
    """Travel bound of each shape over a part of an edge.

    Args:
        course: the motion.
        layer: the edge.
        begin: start of the part, in [0, 1].
        end: its end.
        step: (3,) displacement of the base origin over the whole edge [m].
        memory: scratch memory.
        result: (g,) the bounds, filled in [m].
    """
    length, row, travel, away = end - begin, layer, course.whole, abs(0.5 * (begin + end) - 0.5)
    if length < 1.0 and not course.straight[layer]:
        time, values, rates = 0.5 * (begin + end), memory.values, memory.rates
        for j in range(len(values)):
            first, last = course.values[layer, j], course.values[layer + 1, j]
            values[j], rates[j] = (1.0 - time) * first + time * last, last - first
        attitude_at(course, layer, time, memory.quats)
        row, travel, away = 0, memory.travel, -1.0
        bound_travel(
            course.bodies, course.points, values, rates, length, course.base, memory.quats[0], row,
            memory.scratch, travel,
        )  # fmt: skip
    elif length == 1.0:
        away = -1.0
    base_speed = math.sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2])
    change = 4.0 / travel.lengths[row] ** 2
    for i in range(len(result)):
        result[i] = 0.0
        for k in range(course.points.first[i], course.points.first[i + 1]):
            velocity, curvature = travel.velocity[row, k], travel.curvature[row, k]
            x, y, z = velocity[0] + step[0], velocity[1] + step[1], velocity[2] + step[2]
            fastest, coarse = math.sqrt(x * x + y * y + z * z), base_speed + travel.speed[row, k]
            if away >= 0.0:  # a part that does not contain the middle
                way = length * min(fastest + away * change * curvature, coarse)
            else:
                way = min(length * fastest + curvature, length * coarse)
            result[i] = max(result[i], way + travel.attitude_error[row, k])
