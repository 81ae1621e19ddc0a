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
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.bodies import (
    LinkStates,
    base_rate,
    link_states,
    move_links,
    norm_of,
    weigh_links,
)
from ffsr_plan.proof.kernels.link_bounds import (
    LinkBounds,
    Point,
    bound_links,
    bound_point,
    link_bounds,
)
from ffsr_plan.robots.kinematics import Bodies


class HullPoints(NamedTuple):
    """P points whose hulls contain the g collision shapes.

    Attributes:
        links: (P,) the link that carries each point.
        places: (P, 3) in the frames of their links [m].
        first: (g + 1,) index of the first point of each shape, and P.
    """

    links: IntArray
    places: Array
    first: IntArray


class BaseMotion(NamedTuple):
    """What the base does.

    Attributes:
        reacts: whether its rotation keeps the angular momentum at zero; otherwise it turns.
        floats: whether the centre of mass is at rest, so that the base step is zero, instead of the
            base origin moving linearly.
        turn: (3,) angular velocity of a base that does not react, base axes [rad].
        error: bound on the error of any attitude [rad].
    """

    reacts: bool
    floats: bool
    turn: Array
    error: float


class Travel(NamedTuple):
    """The travel bound over K intervals for any displacement of the base.

    Attributes:
        velocity: (K, P, 3) at the middle relative to the base origin, world axes [m].
        speed: (K, P) bound on the norm of that velocity over the interval [m].
        curvature: (K, P) length that a change of velocity can add, A h^2 / 4 [m].
        attitude_error: (K, P) length that the error of the attitude can add [m].
        lengths: (K,) h, in units of edge time.
    """

    velocity: Array
    speed: Array
    curvature: Array
    attitude_error: Array
    lengths: Array


class Scratch(NamedTuple):
    """Memory for one interval.

    Attributes:
        states: the links at the middle.
        bounds: of the links over the interval.
        centers: (n, 3) bounds on distance [m], speed [m] and acceleration [m] of the links' centres
            of mass.
        rate: (3,) angular velocity of the base at the middle, base axes [rad].
        mean: (9,) position [m] and velocity [m] of the centre of mass in the base, and the mean of
            `centers`; zeros unless the base floats.
        rotation: (3, 3) attitude of the base.
    """

    states: LinkStates
    bounds: LinkBounds
    centers: Array
    rate: Array
    mean: Array
    rotation: Array


@kernel
def scratch_for(count: int) -> Scratch:
    """Memory for `count` links."""
    return Scratch(
        link_states(count),
        link_bounds(count),
        np.zeros((count, 3)),
        np.zeros(3),
        np.zeros(9),
        np.zeros((3, 3)),
    )


class BaseBounds(NamedTuple):
    """Bounds on the base's rotation over an interval.

    Attributes:
        speed: Omega, on the angular speed [rad].
        acceleration: kappa, on the angular acceleration [rad].
    """

    speed: float
    acceleration: float


@kernel
def bound_reaction(bodies: Bodies, half: float, scratch: Scratch) -> BaseBounds:
    """Bounds on the rotation of a base that keeps the angular momentum at zero.

    I omega + l = 0, with the locked inertia I and the links' angular momentum l relative to the
    base, both about the centre of mass; their rates of change are bounded term by term.

    Args:
        bodies: the links.
        half: half the length of the interval.
        scratch: the links at the middle, weighed, and their bounds; the rate is filled in.
    """
    states, bounds, centers = scratch.states, scratch.bounds, scratch.centers
    base_rate(states, scratch.rate)
    mass, mean = np.sum(bodies.masses), 0.0
    for j in range(len(bodies.masses)):
        mean += bodies.masses[j] / mass * centers[j, 1]
    inertia_change, momentum_change, energy, own = 0.0, 0.0, 0.0, 0.0
    for j in range(len(bodies.masses)):
        weight, speed, angular = bodies.masses[j], centers[j, 1], bounds.angular[j]
        pull = (1.0 - 2.0 * weight / mass) * speed + mean
        leverage = weight * (norm_of(states.arms[j]) + half * pull)
        least, largest = bodies.moments[j, 0], bodies.moments[j, 1]
        inertia_change += (largest - least) * angular + 2.0 * leverage * speed
        momentum_change += 0.5 * (largest - least) * angular * angular
        momentum_change += largest * bounds.angular_changes[j] + leverage * centers[j, 2]
        energy += weight * speed * speed + largest * angular * angular
        own += least
    inertia = max(least_eigenvalue(states.inertia) - half * inertia_change, own)
    now = norm_of(scratch.rate)
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
    bodies: Bodies,
    points: HullPoints,
    values: Array,
    rates: Array,
    length: float,
    base: BaseMotion,
    quat: Array,
    row: int,
    scratch: Scratch,
    out: Travel,
) -> None:
    """The travel bound over one interval.

    Args:
        bodies: the links.
        points: of the collision shapes.
        values: (nd,) joint values at the middle of the interval [rad or m].
        rates: (nd,) their change over a whole edge [rad or m].
        length: of the interval, in units of edge time.
        base: what the base does.
        quat: (4,) attitude of the base at the middle (xyzw).
        row: of the result.
        scratch: filled in.
        out: that row is filled in.
    """
    half, states, bounds = 0.5 * length, scratch.states, scratch.bounds
    move_links(bodies, values, rates, states)
    bound_links(bodies, values, rates, half, states, bounds)
    turning = BaseBounds(norm_of(base.turn), 0.0)
    scratch.rate[:] = base.turn
    scratch.mean[:] = 0.0
    if base.reacts:
        weigh_links(bodies, states)
        for j in range(len(bodies.masses)):
            center = bound_point(j, bodies.levers[j], half, states, bounds)
            scratch.centers[j] = center.distance, center.speed, center.acceleration
        turning = bound_reaction(bodies, half, scratch)
    if base.floats:
        _move_center(bodies, scratch)
    fill_matrix(quat, scratch.rotation)
    out.lengths[row] = length
    for k in range(len(points.links)):
        point = bound_point(points.links[k], points.places[k], half, states, bounds)
        _bound_in_world(point, half, base, turning, scratch, row, k, out)


@kernel
def _bound_in_world(
    point: Point,
    half: float,
    base: BaseMotion,
    turning: BaseBounds,
    scratch: Scratch,
    row: int,
    k: int,
    out: Travel,
) -> None:
    """The travel bound of one point, number `k`."""
    mean, w, rotation = scratch.mean, scratch.rate, scratch.rotation
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
    for a in range(3):
        out.velocity[row, k, a] = rotation[a, 0] * vx + rotation[a, 1] * vy + rotation[a, 2] * vz
    acceleration += (turning.acceleration + turning.speed**2) * distance
    acceleration += 2.0 * turning.speed * speed
    out.speed[row, k] = turning.speed * distance + speed
    out.curvature[row, k] = half * half * acceleration
    now = math.sqrt(vx * vx + vy * vy + vz * vz)
    out.attitude_error[row, k] = base.error * (2.0 * distance + 2.0 * half * now)


@kernel
def _move_center(bodies: Bodies, scratch: Scratch) -> None:
    """Fill in the mean over the bodies' centres of mass."""
    mass, states, mean = np.sum(bodies.masses), scratch.states, scratch.mean
    for j in range(len(bodies.masses)):
        share, turned, lever = bodies.masses[j] / mass, states.rotations[j], bodies.levers[j]
        for a in range(3):
            at = states.origins[j, a]
            at += turned[a, 0] * lever[0] + turned[a, 1] * lever[1] + turned[a, 2] * lever[2]
            mean[a] += share * at
            mean[3 + a] += share * states.flows[j, a]
            mean[6 + a] += share * scratch.centers[j, a]


@kernel
def fill_matrix(quat: Array, rotation: Array) -> None:
    """The rotation matrix (3, 3) of a unit quaternion (4,)."""
    x, y, z, w = quat[0], quat[1], quat[2], quat[3]
    rotation[0] = 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)
    rotation[1] = 2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)
    rotation[2] = 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)


@kernel
def travels(
    bodies: Bodies,
    points: HullPoints,
    values: Array,
    rates: Array,
    lengths: Array,
    base: BaseMotion,
    quats: Array,
) -> Travel:
    """The travel bound over K intervals.

    Args:
        bodies: the links.
        points: of the collision shapes.
        values: (K, nd) joint values at the middles [rad or m].
        rates: (K, nd) their changes over whole edges [rad or m].
        lengths: (K,) of the intervals, in units of edge time.
        base: what the base does.
        quats: (K, 4) attitudes of the base at the middles (xyzw).
    """
    k, p = len(values), len(points.links)
    out = Travel(
        np.empty((k, p, 3)), np.empty((k, p)), np.empty((k, p)), np.empty((k, p)), np.empty(k)
    )
    scratch = scratch_for(len(bodies.parents))
    for row in range(k):
        bound_travel(
            bodies, points, values[row], rates[row], lengths[row], base, quats[row], row, scratch,
            out,
        )  # fmt: skip
    return out
