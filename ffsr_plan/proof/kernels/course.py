"""Compiled clearances of the collision shapes along the edges of a motion, for any offsets."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.collision.nearest_obstacle_kernels import (
    STACK_SIZE,
    distance_to_obstacle,
    nearest_obstacle,
)
from ffsr_plan.core.arrays import Array, Flags, IntArray, Records, records
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.curves.kernels.pieces import TURN, Pieces, joints_at, share_at, value_at
from ffsr_plan.dynamics.kernels.bodies import move_links, norm_of, weigh_links
from ffsr_plan.dynamics.kernels.quaternions import fill_matrix, multiply, normalise, turn_by
from ffsr_plan.dynamics.kernels.rotation_series import Partial, rotation_at
from ffsr_plan.proof.kernels.curved_travel import bound_curved_travel
from ffsr_plan.proof.kernels.passage import Passage, see_from_body, way_over
from ffsr_plan.proof.kernels.travel import (
    TRAVEL,
    BaseMotion,
    Scratch,
    bound_travel,
    scratch_for,
)
from ffsr_plan.scene.shapes.obstacle_tree import ObstacleTree

SHAPE = np.dtype(
    [
        ("kind", np.int64),
        ("extent", np.float64, 3),
        ("link", np.int64),
        ("rotation", np.float64, (3, 3)),
        ("position", np.float64, 3),
        ("first", np.int64),
        ("end", np.int64),
    ]
)
"""A collision shape.

    kind        ROUND or BOX, as in `shape_arrays`
    extent      (3,) sizes as there [m]
    link        that carries it
    rotation    (3, 3) shape axes to link axes
    position    (3,) origin of the shape in the link's frame [m]
    first, end  its points are those from `first` to `end` - 1
"""


class Course(NamedTuple):
    """A motion of m edges among obstacles.

    Attributes:
        bodies: (n,) the links, records of `BODY`.
        shapes: (g,) the collision shapes, of `SHAPE`.
        points: (P,) whose hulls contain the shapes, of `HULL_POINT`.
        tree: the obstacles, at least one.
        base: what the base does.
        starts: (k, 4) attitude of the base at the start of each edge, or of the one joint segment
            that a base reacts to (xyzw).
        partial: rotations within the segments of a base that reacts.
        positions: (m + 1, 3) base origin at the corners; where it floats, the centre of mass [m].
        values: (m + 1, nd) joint values at the corners [rad or m].
        whole: (m, P) travel over whole edges, of `TRAVEL`.
        straight: (m,) whether that travel bounds parts of an edge too.
        pieces: the edges where they are curved, in place of positions and joint values; none where
            they are straight.
        passage: the body in whose axes the obstacles rest, on the edge that is looked at.
    """

    bodies: Records
    shapes: Records
    points: Records
    tree: ObstacleTree
    base: BaseMotion
    starts: Array
    partial: Partial
    positions: Array
    values: Array
    whole: Records
    straight: Flags
    pieces: Pieces
    passage: Passage


class Memory(NamedTuple):
    """Scratch memory for one edge.

    Attributes:
        scratch: of the travel bound.
        travel: (P,) of it, `TRAVEL`.
        frames: (g, 15) placements of the shapes.
        joints: (4, nd) joint values, and their change over the edge; on curved edges also bounds on
            their first and second derivatives.
        quats: (3, 4) attitude, and room for two others.
        vectors: (4, 3) base origin, displacement of it over the edge, offset of it, and zeros [m].
        stack: of the search for spheres.
        bounds: of the search for spheres.
        nearest: (g,) the sphere that was nearest to each shape last.
        ways: (g,) travel of the shapes [m].
        first: (g,) distances of the shapes at the start of an interval [m].
    """

    scratch: Scratch
    travel: Records
    frames: Array
    joints: Array
    quats: Array
    vectors: Array
    stack: NDArray[np.int32]
    bounds: Array
    nearest: IntArray
    ways: Array
    first: Array


def memory_for(course: Course) -> Memory:
    """Memory for the edges of a course."""
    shapes = len(course.shapes)
    frames = np.zeros((shapes, 15))
    frames[:, 12:] = course.shapes["extent"]
    return Memory(
        scratch_for(len(course.bodies)),
        records(TRAVEL, len(course.points)),
        frames,
        np.empty((4, course.values.shape[1])),
        np.empty((3, 4)),
        np.zeros((4, 3)),
        np.empty(STACK_SIZE, np.int32),
        np.empty(STACK_SIZE),
        np.zeros(shapes, np.int64),
        np.empty(shapes),
        np.empty(shapes),
    )


@kernel
def attitude_at(course: Course, layer: int, time: float, quats: Array) -> None:
    """Attitude of the base at a time on an edge, in the first row of `quats` (3, 4)."""
    starts, edges, attitude, turned = course.starts, len(course.straight), quats[0], quats[1]
    if course.base.reacts:
        each = len(starts) == edges
        segment = layer if each else 0
        at = time if each else (layer + time) / edges
        if not each and len(course.pieces.rows) > 0:
            at = min(max(share_at(course.pieces, layer, time), 0.0), 1.0)
        rotation_at(course.partial, segment, at, quats[2], turned)
        multiply(attitude, starts[segment], turned)
        normalise(attitude)
    elif len(course.pieces.rows) > 0:
        turn, share = course.pieces.rows[layer, TURN], share_at(course.pieces, layer, time)
        attitude[:] = starts[0]
        turn_by(attitude, share * turn[0], share * turn[1], share * turn[2], turned)
    else:
        turn = course.base.turns[layer]
        attitude[:] = starts[layer]
        turn_by(attitude, time * turn[0], time * turn[1], time * turn[2], turned)


@kernel
def place_shapes(course: Course, layer: int, time: float, memory: Memory) -> None:
    """Placements of the shapes on the course at a time on an edge, without offset.

    Args:
        course: the motion.
        layer: the edge.
        time: on it, in [0, 1].
        memory: its frames are filled in.
    """
    values, rates, links = memory.joints[0], memory.joints[1], memory.scratch.links
    begin, end = course.values[layer], course.values[layer + 1]
    for j in range(len(values)):
        values[j], rates[j] = (1.0 - time) * begin[j] + time * end[j], end[j] - begin[j]
    curved = len(course.pieces.rows) > 0
    if curved:
        joints_at(course.pieces, layer, time, values, rates)
    bodies, shapes = course.bodies, course.shapes
    move_links(bodies, values, rates, links)
    attitude_at(course, layer, time, memory.quats)
    turned, position = memory.scratch.base[0].rotation, memory.vectors[0]
    fill_matrix(memory.quats[0], turned)
    begin, end = course.positions[layer], course.positions[layer + 1]
    for a in range(3):
        position[a] = (1.0 - time) * begin[a] + time * end[a]
        if curved:
            position[a] = value_at(course.pieces, layer, time, a)
    if course.base.floats:  # the centre of mass stays
        weigh_links(bodies, links, memory.scratch.robot)
        lever, arm = bodies[0].lever, links[0].arm
        for a in range(3):
            for b in range(3):
                position[a] -= turned[a, b] * (lever[b] - arm[b])
    for i in range(len(shapes)):
        link = links[shapes[i].link]
        _place_shape(
            shapes[i].rotation, shapes[i].position, link.rotation, link.origin, turned, position,
            memory.frames[i],
        )  # fmt: skip


@kernel
def _place_shape(
    own: Array,
    place: Array,
    rotation: Array,
    origin: Array,
    turned: Array,
    position: Array,
    frame: Array,
) -> None:
    """Rotation and position of a shape in the world, the first twelve numbers of `frame`."""
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
            frame[3 * a + b] = x * own[0, b] + y * own[1, b] + z * own[2, b]
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
        found: (g,) distances, filled in [m]; where a body only lies in its
            box, lower bounds.

    Returns:
        The least of them [m].
    """
    place_shapes(course, layer, time, memory)
    if len(course.passage.poses) > 0:
        see_from_body(course.passage, time, shift, memory.frames)
        return _search(course, memory.vectors[3], memory, found)
    return _search(course, shift, memory, found)


@kernel
def _search(course: Course, shift: Array, memory: Memory, found: Array) -> float:
    """Distances of placed shapes (g,), filled in, and the least of them [m]."""
    least, nearest = np.inf, memory.nearest
    tree, stack, bounds = course.tree, memory.stack, memory.bounds
    for i in range(len(found)):
        kind, frame, near = course.shapes[i].kind, memory.frames[i], nearest[i]
        start = distance_to_obstacle(tree, kind, frame, shift, near, np.inf)
        distance, near = nearest_obstacle(tree, kind, frame, shift, start, near, stack, bounds)
        found[i], nearest[i] = distance, near
        least = min(least, distance)
    return least


@kernel
def travel_of_shapes(
    course: Course, layer: int, begin: float, end: float, memory: Memory, ways: Array
) -> None:
    """Travel bound of each shape over a part of an edge.

    Args:
        course: the motion.
        layer: the edge.
        begin: start of the part, in [0, 1].
        end: its end.
        memory: scratch memory, with the displacement of the base origin over the whole edge.
        ways: (g,) the bounds, filled in [m].
    """
    length, travel, away = end - begin, course.whole[layer], -1.0
    if length < 1.0 and not course.straight[layer]:
        time, values, rates = 0.5 * (begin + end), memory.joints[0], memory.joints[1]
        travel = memory.travel
        attitude_at(course, layer, time, memory.quats)
        if len(course.pieces.rows) > 0:
            bound_curved_travel(
                course.bodies, course.points, course.pieces, layer, begin, end, course.base,
                memory.quats[0], memory.joints, memory.scratch, travel,
            )  # fmt: skip
        else:
            first, last = course.values[layer], course.values[layer + 1]
            for j in range(len(values)):
                values[j], rates[j] = (1.0 - time) * first[j] + time * last[j], last[j] - first[j]
            bound_travel(
                course.bodies, course.points, values, rates, length, course.base, layer,
                memory.quats[0], memory.scratch, travel,
            )  # fmt: skip
    elif length < 1.0:
        away = abs(0.5 * (begin + end) - 0.5)
    step, shapes = memory.vectors[1], course.shapes
    base_speed, more = norm_of(step), way_over(course.passage, begin, end)
    for i in range(len(shapes)):
        longest = 0.0
        for k in range(shapes[i].first, shapes[i].end):
            point, velocity = travel[k], travel[k].velocity
            x, y, z = velocity[0] + step[0], velocity[1] + step[1], velocity[2] + step[2]
            fastest, coarse = math.sqrt(x * x + y * y + z * z), base_speed + point.speed
            if away >= 0.0:  # a part of the whole edge that does not contain its middle
                way = length * min(fastest + away * 4.0 * point.curvature, coarse)
            else:
                way = min(length * fastest + point.curvature, length * coarse)
            longest = max(longest, way + point.attitude_error)
        ways[i] = longest + more
