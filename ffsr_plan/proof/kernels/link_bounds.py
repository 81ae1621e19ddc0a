"""Compiled bounds on distance, speed and acceleration in the base frame.

They hold over an interval of an edge and are computed from the base outwards: each is the smaller
of the bound that follows from the parent link and of the value at the middle of the interval plus
the largest change until its ends. docs/proof.md, section 4, derives them. Rates are per unit of
edge time, which has no dimension.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.bodies import LinkStates, norm_of
from ffsr_plan.robots.kinematics import Bodies


class LinkBounds(NamedTuple):
    """Bounds over one interval on the motion of n links relative to the base.

    Attributes:
        distances: (n,) of the link origins from the base origin [m].
        speeds: (n,) of the link origins [m].
        accelerations: (n,) norms for the link origins [m].
        angular: (n,) angular speeds [rad].
        angular_changes: (n,) norms of the angular accelerations [rad].
    """

    distances: Array
    speeds: Array
    accelerations: Array
    angular: Array
    angular_changes: Array


@kernel
def link_bounds(count: int) -> LinkBounds:
    """Memory for `count` links."""
    return LinkBounds(
        np.zeros(count), np.zeros(count), np.zeros(count), np.zeros(count), np.zeros(count)
    )


@kernel
def _longer(x: float, y: float, z: float, u: float, v: float, w: float) -> float:
    """The larger norm of two vectors."""
    return math.sqrt(max(x * x + y * y + z * z, u * u + v * v + w * w))


@kernel
def bound_links(
    bodies: Bodies, values: Array, rates: Array, half: float, states: LinkStates, bounds: LinkBounds
) -> None:
    """Bounds over an interval with constant joint rates.

    Args:
        bodies: the links.
        values: (nd,) joint values at its middle [rad or m].
        rates: (nd,) change over a whole edge [rad or m].
        half: half its length, in units of edge time.
        states: the links, moved to the middle.
        bounds: filled in.
    """
    for j in range(1, len(bodies.parents)):
        p, rate, slides = bodies.parents[j], abs(rates[j - 1]), bodies.prismatic[j]
        angular, change = bounds.angular[p], bounds.angular_changes[p]
        # the distance from the parent's origin is a convex function of the joint value
        low, high = values[j - 1] - half * rates[j - 1], values[j - 1] + half * rates[j - 1]
        a, b = bodies.offsets[j], bodies.slides[j]
        offset = _longer(
            a[0] + low * b[0],
            a[1] + low * b[1],
            a[2] + low * b[2],
            a[0] + high * b[0],
            a[1] + high * b[1],
            a[2] + high * b[2],
        )
        # |w_p x s_j|: the component of the parent's angular velocity across the joint's axis
        across = min(angular, _across(bodies, j, states) + half * change)
        turning, sliding = (0.0, rate) if slides else (rate, 0.0)
        bounds.angular_changes[j] = change + across * turning
        bounds.angular[j] = min(
            angular + turning, norm_of(states.angular[j]) + half * bounds.angular_changes[j]
        )
        bounds.accelerations[j] = (
            bounds.accelerations[p] + (change + angular * angular) * offset + 2.0 * across * sliding
        )
        bounds.speeds[j] = min(
            bounds.speeds[p] + angular * offset + sliding,
            norm_of(states.linear[j]) + half * bounds.accelerations[j],
        )
        bounds.distances[j] = min(
            bounds.distances[p] + offset, norm_of(states.origins[j]) + half * bounds.speeds[j]
        )


@kernel
def _across(bodies: Bodies, j: int, states: LinkStates) -> float:
    """|w_p x s_j| at the middle, with the parent p and the axis s_j of link j."""
    turned, axis, w = states.rotations[j], bodies.axes[j], states.angular[bodies.parents[j]]
    x = turned[0, 0] * axis[0] + turned[0, 1] * axis[1] + turned[0, 2] * axis[2]
    y = turned[1, 0] * axis[0] + turned[1, 1] * axis[1] + turned[1, 2] * axis[2]
    z = turned[2, 0] * axis[0] + turned[2, 1] * axis[1] + turned[2, 2] * axis[2]
    a, b, c = w[1] * z - w[2] * y, w[2] * x - w[0] * z, w[0] * y - w[1] * x
    return math.sqrt(a * a + b * b + c * c)


class Point(NamedTuple):
    """Motion of a point that is fixed to a link, relative to the base.

    Attributes:
        x, y, z: position at the middle of the interval, base axes [m].
        vx, vy, vz: velocity there [m].
        distance: bound on its distance from the base origin over the interval [m].
        speed: bound on its speed [m].
        acceleration: bound on the norm of its acceleration [m].
    """

    x: float
    y: float
    z: float
    vx: float
    vy: float
    vz: float
    distance: float
    speed: float
    acceleration: float


@kernel
def bound_point(
    link: int, place: Array, half: float, states: LinkStates, bounds: LinkBounds
) -> Point:
    """Motion and bounds of a point.

    Args:
        link: the link that carries it.
        place: (3,) in the frame of the link [m].
        half: half the length of the interval.
        states: the links at the middle.
        bounds: of the links over the interval.
    """
    turned, origin = states.rotations[link], states.origins[link]
    w, v = states.angular[link], states.linear[link]
    x = turned[0, 0] * place[0] + turned[0, 1] * place[1] + turned[0, 2] * place[2]
    y = turned[1, 0] * place[0] + turned[1, 1] * place[1] + turned[1, 2] * place[2]
    z = turned[2, 0] * place[0] + turned[2, 1] * place[1] + turned[2, 2] * place[2]
    vx, vy, vz = v[0] + w[1] * z - w[2] * y, v[1] + w[2] * x - w[0] * z, v[2] + w[0] * y - w[1] * x
    x, y, z = origin[0] + x, origin[1] + y, origin[2] + z
    length, angular = norm_of(place), bounds.angular[link]
    acceleration = (
        bounds.accelerations[link] + (bounds.angular_changes[link] + angular * angular) * length
    )
    speed = min(
        bounds.speeds[link] + angular * length,
        math.sqrt(vx * vx + vy * vy + vz * vz) + half * acceleration,
    )
    distance = min(bounds.distances[link] + length, math.sqrt(x * x + y * y + z * z) + half * speed)
    return Point(x, y, z, vx, vy, vz, distance, speed, acceleration)
