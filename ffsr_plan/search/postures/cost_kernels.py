"""What a path through base offsets and postures costs, attitude carried along; compiled.

The attitude at a node is the product of the turns of all joint steps on the way there, so that a
change anywhere changes everything behind it. Costs are in metres: F of Eq. 8 times its unit of
length. Collisions and a missed goal attitude cost something instead of being forbidden, so that a
search can pass through what it must leave again.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ffsr_plan.collision.nearest_kernels import STACK_SIZE, nearest_sphere
from ffsr_plan.core.arrays import Array, Flags, IntArray

COLLISION, DEEPER = 3.0, 15.0  # metres of cost for a collision, and for each metre of its depth
CLOSE_ENOUGH = math.radians(0.5)  # error of the goal attitude that costs nothing
NEAR, CAP, DELTA_D, REACH = range(4)


class Obstacles(NamedTuple):
    """The scene's `SphereTree`, and the kinds of the shapes that are held against it."""

    nodes: Array
    children: NDArray[np.int32]
    spheres: Array
    kinds: IntArray
    """(g,) of `Primitives`."""


class Ground(NamedTuple):
    """What the ants walk on: layers 0 .. m, base offsets b, postures n, steps k, shapes g."""

    obstacles: Obstacles
    frames: Array
    """(m + 1, n, g, 15) shapes relative to the base."""
    places: Array
    """(m + 1, b, 3) base origin, or where it floats the robot's centre of mass [m]."""
    centers: Array
    """(m + 1, n, 3) centre of mass, base frame; zero where thrusters hold the base origin."""
    across: Array
    """(b, b) squared length between base offsets, in Eq. 6 [m^2]."""
    indices: IntArray
    """(n, axes) of the postures."""
    successors: IntArray
    """(n, k)."""
    bends: Array
    """(m, n, k) squared length of joint steps [m^2]."""
    turns: Array
    """(m, n, k, 4) rotation of the base over joint steps."""
    allowed: Flags
    """(m + 1, n)."""
    barred: IntArray
    """(r, 5) refused edges: layer, base offsets and postures at both ends."""
    neighbours: IntArray
    """(b, j) base offsets beside each, -1 where there is none."""
    origin: IntArray
    """(2,) base offset and posture of start and goal."""
    start: Array
    """(4,) attitude."""
    goal: Array
    """(4,) attitude; counts where it is to be reached."""
    numbers: Array
    """delta times the unit of length squared [m^2], clearance cap [m], delta_d [m], 1 to reach."""
    reach: Array
    """(m + 1, n) of the shapes, from what the base turns about [m]."""


class Room(NamedTuple):
    """What a search for the nearest obstacle writes into."""

    frame: Array
    shift: Array
    stack: NDArray[np.int32]
    bounds: Array


class Course(NamedTuple):
    """A path, and what its cost is made of."""

    nodes: IntArray
    """(m + 1, 2) base offset and posture on each layer."""
    lengths: Array
    """(m,) of the edges [m]."""
    quats: Array
    """(m + 1, 4) attitudes."""
    clearances: Array
    """(m + 1,) at the nodes [m]."""
    costs: Array
    """(m + 1,) of the nodes [m]."""
    least: Array
    """(m + 1,) what the nodes cost at least [m]."""


@njit(cache=True, nogil=True)
def step_between(indices: IntArray, tail: int, head: int) -> int:
    """Which of a posture's steps leads to another one; -1 if none does."""
    step = 0
    for axis in range(indices.shape[1]):
        change = indices[head, axis] - indices[tail, axis]
        if change < -1 or change > 1:
            return -1
        step = 3 * step + change + 1
    return step


@njit(cache=True, nogil=True)
def working_room() -> Room:
    """Room to work in, for one thread."""
    return Room(np.empty(15), np.zeros(3), np.empty(STACK_SIZE, np.int32), np.empty(STACK_SIZE))


@njit(cache=True, nogil=True)
def is_free(ground: Ground) -> bool:
    """Whether there is nothing to keep clear of, or nothing that would have to."""
    return len(ground.obstacles.spheres) == 0 or len(ground.obstacles.kinds) == 0


@njit(cache=True, nogil=True)
def clearance_at(
    obstacles: Obstacles, frames: Array, place: Array, center: Array, quat: Array, room: Room
) -> float:
    """Least distance [m] to any obstacle at a node and an attitude; for hulls, of their boxes.

    Args:
        obstacles: of the ground.
        frames: (g, 15) of the posture.
        place: (3,) of the base offset.
        center: (3,) of the posture.
        quat: (4,) attitude.
        room: to work in.
    """
    x, y, z, w = quat[0], quat[1], quat[2], quat[3]
    r = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    frame, least, nearest = room.frame, np.inf, -1
    for g in range(len(frames)):
        own = frames[g]
        for a in range(3):
            for b in range(3):
                frame[3 * a + b] = r[a][0] * own[b] + r[a][1] * own[3 + b] + r[a][2] * own[6 + b]
            frame[9 + a] = place[a] + (
                r[a][0] * (own[9] - center[0])
                + r[a][1] * (own[10] - center[1])
                + r[a][2] * (own[11] - center[2])
            )
            frame[12 + a] = own[12 + a]
        kind = obstacles.kinds[g]
        least, nearest = nearest_sphere(
            obstacles, kind, frame, room.shift, least, nearest, room.stack, room.bounds
        )
    return least


@njit(cache=True, nogil=True)
def node_cost(numbers: Array, clearance: float, inner: bool) -> float:
    """Cost [m] of a node: delta / d, or that of a collision."""
    if clearance <= 0.0:
        return COLLISION - DEEPER * clearance
    if not inner:
        return 0.0
    return float(numbers[NEAR] / min(clearance, numbers[CAP]))


@njit(cache=True, nogil=True)
def edge_length(delta_d: float, across: float, bend: float) -> float:
    """d_pq of Eq. 6 [m], posture steps included; the latter two squared."""
    return math.sqrt(delta_d * delta_d + across + bend)


@njit(cache=True, nogil=True)
def compose(p: Array, q: Array, product: Array) -> None:
    """Rotation p q (xyzw)."""
    product[0] = p[3] * q[0] + p[0] * q[3] + p[1] * q[2] - p[2] * q[1]
    product[1] = p[3] * q[1] - p[0] * q[2] + p[1] * q[3] + p[2] * q[0]
    product[2] = p[3] * q[2] + p[0] * q[1] - p[1] * q[0] + p[2] * q[3]
    product[3] = p[3] * q[3] - p[0] * q[0] - p[1] * q[1] - p[2] * q[2]


@njit(cache=True, nogil=True)
def angle_to(p: Array, q: Array) -> float:
    """Angle [rad] of the rotation from p to q."""
    x = p[3] * q[0] - p[0] * q[3] - p[1] * q[2] + p[2] * q[1]
    y = p[3] * q[1] + p[0] * q[2] - p[1] * q[3] - p[2] * q[0]
    z = p[3] * q[2] - p[0] * q[1] + p[1] * q[0] - p[2] * q[3]
    w = p[3] * q[3] + p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
    return 2.0 * math.atan2(math.sqrt(x * x + y * y + z * z), abs(w))


@njit(cache=True, nogil=True)
def is_barred(barred: IntArray, layer: int, b: int, p: int, b_on: int, p_on: int) -> bool:
    """Whether an edge has been refused."""
    for k in range(len(barred)):
        r = barred[k]
        if r[0] == layer and r[1] == b and r[2] == p and r[3] == b_on and r[4] == p_on:
            return True
    return False


@njit(cache=True, nogil=True)
def missed_cost(numbers: Array, quat: Array, goal: Array, weight: float) -> float:
    """Cost [m] of the attitude at the goal, a radian of error costing `weight` [m]."""
    if numbers[REACH] == 0.0:
        return 0.0
    return weight * max(0.0, angle_to(quat, goal) - CLOSE_ENOUGH)


@njit(cache=True, nogil=True)
def take_edges(ground: Ground, course: Course, first: int, last: int) -> bool:
    """Work out the edges first .. last - 1 of a course; whether all of them are there.

    The attitude on layer `first` is given; lengths and the attitudes behind are filled in.
    """
    nodes, quats, turns, bends = course.nodes, course.quats, ground.turns, ground.bends
    across, indices, allowed, barred = ground.across, ground.indices, ground.allowed, ground.barred
    delta_d = ground.numbers[DELTA_D]
    for i in range(first, last):
        b, p, b_on, p_on = nodes[i, 0], nodes[i, 1], nodes[i + 1, 0], nodes[i + 1, 1]
        step = step_between(indices, p, p_on)
        if step < 0 or not allowed[i + 1, p_on] or is_barred(barred, i, b, p, b_on, p_on):
            return False
        course.lengths[i] = edge_length(delta_d, across[b, b_on], bends[i, p, step])
        compose(quats[i], turns[i, p, step], quats[i + 1])
    return True


@njit(cache=True, nogil=True)
def visit(
    ground: Ground, course: Course, first: int, last: int, total: float, limit: float, room: Room
) -> float:
    """Take the nodes on the layers first .. last - 1 at their attitudes, clearances filled in.

    Args:
        ground: the lattice.
        course: the path, of which `course.least` has already been counted in for these nodes.
        first: the first layer.
        last: the layer behind the last one.
        total: cost so far [m].
        limit: no further than where the cost exceeds it [m].
        room: to work in.

    Returns:
        The total with the nodes' costs in place of the least ones; infinite beyond the limit.
    """
    obstacles, frames, places, centers = (
        ground.obstacles, ground.frames, ground.places, ground.centers,
    )  # fmt: skip
    nodes, quats, numbers = course.nodes, course.quats, ground.numbers
    free = is_free(ground)
    for i in range(first, last):
        b, p, clearance = nodes[i, 0], nodes[i, 1], np.inf
        if not free:
            clearance = clearance_at(
                obstacles, frames[i, p], places[i, b], centers[i, p], quats[i], room
            )
        course.clearances[i] = clearance
        course.costs[i] = node_cost(numbers, clearance, i + 1 < len(nodes))
        total += course.costs[i] - course.least[i]
        if total > limit:
            return np.inf
    return total


@njit(cache=True, nogil=True)
def path_cost(ground: Ground, course: Course, weight: float) -> float:
    """Cost [m] of a path, all of whose course is worked out; infinite if an edge is not there.

    Args:
        ground: the lattice.
        course: the path; all but its nodes is filled in.
        weight: of a radian by which the goal attitude is missed [m].
    """
    m, room = len(course.nodes) - 1, working_room()
    course.quats[0] = ground.start
    course.least[:] = 0.0
    if not take_edges(ground, course, 0, m):
        return np.inf
    total = np.sum(course.lengths) + missed_cost(
        ground.numbers, course.quats[m], ground.goal, weight
    )
    return visit(ground, course, 1, m + 1, total, np.inf, room)
