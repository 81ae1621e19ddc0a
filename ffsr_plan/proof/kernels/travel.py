"""Compiled travel bound T: an upper bound on the path length of any point of the robot.

For each point of the shapes over an interval of an edge, while the joints and the base origin move
linearly and the base rotates by reaction or at a constant angular velocity. A point at y from the
base origin (base axes) has the world velocity R (omega x y + y') + Dp, and an acceleration of at
most A over the interval, of length h and middle m. So its path is no longer than

    T = min { h |velocity(m) + Dp| + A h^2 / 4,  h (|Dp| + Omega rho + v) }

    A = (kappa + Omega^2) rho + 2 Omega v + a

with bounds Omega >= |omega|, kappa >= |omega'|, rho >= |y|, v >= |y'|, a >= |y''|. docs/proof.md
derives all of them. No point of a shape has a longer path than the corners of its convex hull.
Spheres and capsules extend around their centre or segment by a constant distance, which cancels in
the proof.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Records, records
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.bodies import (
    LINK_STATE,
    ROBOT_STATE,
    base_at_rest,
    base_rate,
    move_links,
    norm_of,
    total_mass,
    turn_vector,
    weigh_links,
)
from ffsr_plan.dynamics.kernels.quaternions import fill_matrix
from ffsr_plan.proof.kernels.link_bounds import LINK_BOUND, Point, bound_links, bound_point

HULL_POINT = np.dtype([("link", np.int64), ("place", np.float64, 3)])
"""A corner of the hull that contains a shape.

    link    the link that carries it
    place   (3,) in the frame of the link [m]
"""

TRAVEL = np.dtype(
    [
        ("velocity", np.float64, 3),
        ("speed", np.float64),
        ("curvature", np.float64),
        ("attitude_error", np.float64),
    ]
)
"""The travel bound of a point over an interval for any displacement of the base.

    velocity        (3,) at the middle relative to the base origin, world axes [m]
    speed           bound on the norm of that velocity over the interval [m]
    curvature       length that a change of velocity can add, A h^2 / 4 [m]
    attitude_error  length that the error of the attitude can add [m]
"""

BASE_STATE = np.dtype([("center", np.float64, 9), ("rotation", np.float64, (3, 3))])
"""Of the base at the middle of an interval.

    center      (9,) position [m] and velocity [m] of the centre of mass in the base, and the mean
                of the bounds on the links' centres of mass; zeros unless the base floats
    rotation    (3, 3) attitude
"""


class BaseMotion(NamedTuple):
    """What the base does.

    Attributes:
        reacts: whether its rotation keeps the angular momentum at zero; otherwise it turns.
        floats: whether the centre of mass is at rest, so that the base step is zero, instead of the
            base origin moving linearly.
        turns: (m, 3) angular velocity on each edge of a base that does not react, base axes
            [rad].
        error: bound on the error of any attitude [rad].
    """

    reacts: bool
    floats: bool
    turns: Array
    error: float


class Scratch(NamedTuple):
    """Memory for one interval.

    Attributes:
        links: (n,) records of `LINK_STATE`, at the middle.
        bounds: (n,) of `LINK_BOUND`, over the interval.
        robot: (1,) of `ROBOT_STATE`.
        base: (1,) of `BASE_STATE`.
    """

    links: Records
    bounds: Records
    robot: Records
    base: Records


def scratch_for(count: int) -> Scratch:
    """Memory for `count` links."""
    links = base_at_rest(records(LINK_STATE, count))
    robot, base = records(ROBOT_STATE, 1), records(BASE_STATE, 1)
    return Scratch(links, records(LINK_BOUND, count), robot, base)


class BaseBounds(NamedTuple):
    """Bounds on the base's rotation over an interval.

    Attributes:
        speed: Omega, on the angular speed [rad].
        acceleration: kappa, on the angular acceleration [rad].
    """

    speed: float
    acceleration: float


@kernel
def bound_reaction(bodies: Records, half: float, scratch: Scratch) -> BaseBounds:
    """Bounds on the rotation of a base that keeps the angular momentum at zero.

    I omega + l = 0, with the locked inertia I and the links' angular momentum l relative to the
    base, both about the centre of mass; their rates of change are bounded term by term.

    Args:
        bodies: (n,) the links, `BODY`.
        half: half the length of the interval.
        scratch: the links at the middle, weighed, and their bounds; the rate is filled in.
    """
    links, bounds, robot = scratch.links, scratch.bounds, scratch.robot
    base_rate(robot)
    mass, mean = total_mass(bodies), 0.0
    for j in range(len(bodies)):
        mean += bodies[j].mass / mass * bounds[j].center[1]
    inertia_change, momentum_change, energy, own = 0.0, 0.0, 0.0, 0.0
    for j in range(len(bodies)):
        weight, center, angular = bodies[j].mass, bounds[j].center, bounds[j].angular
        pull = (1.0 - 2.0 * weight / mass) * center[1] + mean
        leverage = weight * (norm_of(links[j].arm) + half * pull)
        least, largest = bodies[j].moments[0], bodies[j].moments[1]
        inertia_change += (largest - least) * angular + 2.0 * leverage * center[1]
        momentum_change += 0.5 * (largest - least) * angular * angular
        momentum_change += largest * bounds[j].angular_change + leverage * center[2]
        energy += weight * center[1] * center[1] + largest * angular * angular
        own += least
    inertia = max(least_eigenvalue(robot[0].inertia) - half * inertia_change, own)
    now = norm_of(robot[0].rate)
    fastest = now + half * (momentum_change + inertia_change * now) / inertia
    fastest = min(fastest, math.sqrt(energy / inertia))
    return BaseBounds(fastest, (momentum_change + inertia_change * fastest) / inertia)


@kernel
def least_eigenvalue(entries: Array) -> float:
    """Least eigenvalue of a symmetric matrix, by Jacobi's rotations.

    Args:
        entries: (6,) xx, yy, zz, xy, xz, yz.
    """
    a = np.empty((3, 3))
    for i in range(3):
        a[i, i] = entries[i]
    a[0, 1] = a[1, 0] = entries[3]
    a[0, 2] = a[2, 0] = entries[4]
    a[1, 2] = a[2, 1] = entries[5]
    for _ in range(12):  # they converge quadratically: six are enough
        if abs(a[0, 1]) + abs(a[0, 2]) + abs(a[1, 2]) < 1e-17 * (a[0, 0] + a[1, 1] + a[2, 2]):
            break
        for p, q in ((0, 1), (0, 2), (1, 2)):
            if a[p, q] != 0.0:
                r, ratio = 3 - p - q, (a[q, q] - a[p, p]) / (2.0 * a[p, q])
                t = math.copysign(1.0, ratio) / (abs(ratio) + math.sqrt(ratio * ratio + 1.0))
                c = 1.0 / math.sqrt(t * t + 1.0)
                a[p, p] -= t * a[p, q]
                a[q, q] += t * a[p, q]
                a[p, q] = a[q, p] = 0.0
                x, y = a[r, p], a[r, q]
                a[r, p] = a[p, r] = c * (x - t * y)
                a[r, q] = a[q, r] = c * (y + t * x)
    return float(min(a[0, 0], a[1, 1], a[2, 2]))


@kernel
def bound_travel(
    bodies: Records,
    points: Records,
    values: Array,
    rates: Array,
    length: float,
    base: BaseMotion,
    layer: int,
    quat: Array,
    scratch: Scratch,
    travel: Records,
) -> None:
    """The travel bound over one interval.

    Args:
        bodies: (n,) the links, `BODY`.
        points: (P,) of the collision shapes, `HULL_POINT`.
        values: (nd,) joint values at the middle of the interval [rad or m].
        rates: (nd,) their change over a whole edge [rad or m].
        length: of the interval, in units of edge time.
        base: what the base does.
        layer: the edge.
        quat: (4,) attitude of the base at the middle (xyzw).
        scratch: filled in.
        travel: (P,) records of `TRAVEL`, filled in.
    """
    half, rate = 0.5 * length, scratch.robot[0].rate
    move_links(bodies, values, rates, scratch.links)
    bound_links(bodies, values, rates, half, scratch.links, scratch.bounds)
    x, y, z = base.turns[layer, 0], base.turns[layer, 1], base.turns[layer, 2]
    rate[0], rate[1], rate[2] = x, y, z
    turning = BaseBounds(math.sqrt(x * x + y * y + z * z), 0.0)
    bound_points(bodies, points, half, base, turning, quat, scratch, travel)


@kernel
def bound_points(
    bodies: Records,
    points: Records,
    half: float,
    base: BaseMotion,
    turning: BaseBounds,
    quat: Array,
    scratch: Scratch,
    travel: Records,
) -> None:
    """The travel bound over an interval whose links have been bounded.

    Args:
        bodies: (n,) the links, `BODY`.
        points: (P,) of the collision shapes, `HULL_POINT`.
        half: half the length of the interval.
        base: what the base does.
        turning: bounds on the rotation of a base that does not react.
        quat: (4,) attitude of the base at the middle (xyzw).
        scratch: the links, moved to the middle, and their bounds; the base's rotation at the middle
            if it does not react. The rest is filled in.
        travel: (P,) records of `TRAVEL`, filled in.
    """
    links, bounds, robot, mean = (
        scratch.links,
        scratch.bounds,
        scratch.robot,
        scratch.base[0].center,
    )
    for a in range(9):
        mean[a] = 0.0
    if base.reacts:
        weigh_links(bodies, links, robot)
        for j in range(len(bodies)):
            center = bound_point(j, bodies[j].lever, half, links, bounds)
            own = bounds[j].center
            own[0], own[1], own[2] = center.distance, center.speed, center.acceleration
        turning = bound_reaction(bodies, half, scratch)
    if base.floats:
        _move_center(bodies, links, bounds, mean)
    rotation, rate = scratch.base[0].rotation, robot[0].rate
    fill_matrix(quat, rotation)
    for k in range(len(points)):
        point = bound_point(points[k].link, points[k].place, half, links, bounds)
        _bound_in_world(point, half, base, turning, mean, rate, rotation, travel[k])


@kernel
def _bound_in_world(
    point: Point,
    half: float,
    base: BaseMotion,
    turning: BaseBounds,
    mean: Array,
    w: Array,
    rotation: Array,
    travel: Any,  # noqa: ANN401 - one record of TRAVEL
) -> None:
    """The travel bound of one point."""
    x, y, z = point.x - mean[0], point.y - mean[1], point.z - mean[2]
    vx, vy, vz = point.vx - mean[3], point.vy - mean[4], point.vz - mean[5]
    acceleration = point.acceleration + mean[8]
    speed, distance = point.speed + mean[7], point.distance + mean[6]
    if base.floats:
        speed = min(speed, math.sqrt(vx * vx + vy * vy + vz * vz) + half * acceleration)
        distance = min(distance, math.sqrt(x * x + y * y + z * z) + half * speed)
    vx += w[1] * z - w[2] * y
    vy += w[2] * x - w[0] * z
    vz += w[0] * y - w[1] * x
    turn_vector(travel.velocity, rotation, vx, vy, vz)
    acceleration += (turning.acceleration + turning.speed**2) * distance
    acceleration += 2.0 * turning.speed * speed
    travel.speed = turning.speed * distance + speed
    travel.curvature = half * half * acceleration
    now = math.sqrt(vx * vx + vy * vy + vz * vz)
    travel.attitude_error = base.error * (2.0 * distance + 2.0 * half * now)


@kernel
def _move_center(bodies: Records, links: Records, bounds: Records, mean: Array) -> None:
    """Fill in the mean (9,) over the bodies' centres of mass."""
    mass = total_mass(bodies)
    for j in range(len(bodies)):
        share, lever = bodies[j].mass / mass, bodies[j].lever
        link, center, turned = links[j], bounds[j].center, links[j].rotation
        for a in range(3):
            at = link.origin[a]
            at += turned[a, 0] * lever[0] + turned[a, 1] * lever[1] + turned[a, 2] * lever[2]
            mean[a] += share * at
            mean[3 + a] += share * link.flow[a]
            mean[6 + a] += share * center[a]


@kernel
def travels(
    bodies: Records,
    points: Records,
    values: Array,
    rates: Array,
    lengths: Array,
    base: BaseMotion,
    quats: Array,
    scratch: Scratch,
    travel: Records,
) -> None:
    """The travel bound over K intervals, each on an edge of its own.

    Args:
        bodies: (n,) the links, `BODY`.
        points: (P,) of the collision shapes, `HULL_POINT`.
        values: (K, nd) joint values at the middles [rad or m].
        rates: (K, nd) their changes over whole edges [rad or m].
        lengths: (K,) of the intervals, in units of edge time.
        base: what the base does.
        quats: (K, 4) attitudes of the base at the middles (xyzw).
        scratch: filled in.
        travel: (K, P) records of `TRAVEL`, filled in.
    """
    for row in range(len(values)):
        bound_travel(
            bodies, points, values[row], rates[row], lengths[row], base, row, quats[row],
            scratch, travel[row],
        )  # fmt: skip
