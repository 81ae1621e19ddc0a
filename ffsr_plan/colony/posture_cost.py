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

from ffsr_plan.inputs import Array, Flags, IntArray
from ffsr_plan.nearest import _DEPTH, _search

COLLISION, DEEPER = 3.0, 15.0  # metres of cost for a collision, and for each metre of its depth
CLOSE_ENOUGH = math.radians(0.5)  # error of the goal attitude that costs nothing
NEAR, CAP, DELTA_D, REACH = range(4)


class Ground(NamedTuple):
    """What the ants walk on: layers 0 .. m, base offsets b, postures n, steps k, shapes g."""

    nodes: Array
    children: NDArray[np.int32]
    spheres: Array
    """The three of the scene's `SphereTree`."""
    kinds: IntArray
    """(g,) of `Primitives`."""
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


@njit(cache=True, nogil=True)
def step_between(ground: Ground, tail: int, head: int) -> int:
    """Which of a posture's steps leads to another one; -1 if none does."""
    step = 0
    for axis in range(ground.indices.shape[1]):
        change = ground.indices[head, axis] - ground.indices[tail, axis]
        if change < -1 or change > 1:
            return -1
        step = 3 * step + change + 1
    return step


@njit(cache=True, nogil=True)
def clearance_at(
    ground: Ground, layer: int, offset: int, posture: int, quat: Array, frame: Array, shift: Array
) -> float:
    """Least distance [m] to any obstacle at a node and an attitude; for hulls, of their boxes."""
    if len(ground.spheres) == 0 or len(ground.kinds) == 0:
        return np.inf
    x, y, z, w = quat[0], quat[1], quat[2], quat[3]
    r = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    place, center = ground.places[layer, offset], ground.centers[layer, posture]
    stack, bounds = np.empty(_DEPTH, np.int32), np.empty(_DEPTH)
    least, nearest = np.inf, -1
    for g in range(len(ground.kinds)):
        own = ground.frames[layer, posture, g]
        for a in range(3):
            for b in range(3):
                frame[3 * a + b] = r[a][0] * own[b] + r[a][1] * own[3 + b] + r[a][2] * own[6 + b]
            frame[9 + a] = place[a] + (
                r[a][0] * (own[9] - center[0])
                + r[a][1] * (own[10] - center[1])
                + r[a][2] * (own[11] - center[2])
            )
            frame[12 + a] = own[12 + a]
        least, nearest = _search(
            ground.nodes, ground.children, ground.spheres, ground.kinds[g], frame, shift, least,
            nearest, stack, bounds,
        )  # fmt: skip
    return least


@njit(cache=True, nogil=True)
def node_cost(ground: Ground, clearance: float, inner: bool) -> float:
    """Cost [m] of a node: delta / d, or that of a collision."""
    if clearance <= 0.0:
        return COLLISION - DEEPER * clearance
    if not inner:
        return 0.0
    return float(ground.numbers[NEAR] / min(clearance, ground.numbers[CAP]))


@njit(cache=True, nogil=True)
def edge_length(
    ground: Ground, layer: int, offset: int, posture: int, offset_on: int, step: int
) -> float:
    """d_pq of Eq. 6 [m], posture steps included."""
    across = ground.across[offset, offset_on] + ground.bends[layer, posture, step]
    return math.sqrt(ground.numbers[DELTA_D] ** 2 + across)


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
def is_barred(ground: Ground, layer: int, b: int, p: int, b_on: int, p_on: int) -> bool:
    """Whether an edge has been refused."""
    for k in range(len(ground.barred)):
        r = ground.barred[k]
        if r[0] == layer and r[1] == b and r[2] == p and r[3] == b_on and r[4] == p_on:
            return True
    return False


@njit(cache=True, nogil=True)
def path_cost(
    ground: Ground,
    offsets: IntArray,
    postures: IntArray,
    first: int,
    quats: Array,
    costs: Array,
    weight: float,
    limit: float,
) -> float:
    """Cost [m] of a path, worked out behind layer `first`; infinite as soon as it exceeds `limit`.

    Args:
        ground: the lattice.
        offsets: (m + 1,) base offset on each layer.
        postures: (m + 1,) posture on each layer.
        first: the layer up to which `quats` and `costs` hold.
        quats: (m + 1, 4) attitudes, updated behind `first`.
        costs: (m + 1,) cost up to each layer, updated behind `first`.
        weight: of a radian by which the goal attitude is missed [m].
        limit: [m].
    """
    m = len(offsets) - 1
    frame, shift = np.empty(15), np.zeros(3)
    for i in range(first, m):
        b, p, b_on, p_on = offsets[i], postures[i], offsets[i + 1], postures[i + 1]
        step = step_between(ground, p, p_on)
        if step < 0 or not ground.allowed[i + 1, p_on] or is_barred(ground, i, b, p, b_on, p_on):
            return np.inf
        compose(quats[i], ground.turns[i, p, step], quats[i + 1])
        clearance = clearance_at(ground, i + 1, b_on, p_on, quats[i + 1], frame, shift)
        costs[i + 1] = (
            costs[i]
            + edge_length(ground, i, b, p, b_on, step)
            + node_cost(ground, clearance, i + 1 < m)
        )
        if costs[i + 1] > limit:
            return np.inf
    total: float = costs[m]
    if ground.numbers[REACH] > 0.0:
        total += weight * max(0.0, angle_to(quats[m], ground.goal) - CLOSE_ENOUGH)
    return total if total <= limit else np.inf
