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

from ffsr_plan.core.arrays import Array, Records
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.bodies import norm_of

LINK_BOUND = np.dtype(
    [
        ("distance", np.float64),
        ("speed", np.float64),
        ("acceleration", np.float64),
        ("angular", np.float64),
        ("angular_change", np.float64),
        ("center", np.float64, 3),
    ]
)
"""Bounds over one interval on the motion of a link relative to the base.

    distance        of the link's origin from the base origin [m]
    speed           of the link's origin [m]
    acceleration    norm for the link's origin [m]
    angular         angular speed [rad]
    angular_change  norm of the angular acceleration [rad]
    center          (3,) distance, speed and acceleration of the link's centre of mass [m]
"""


@kernel
def _longer(x: float, y: float, z: float, u: float, v: float, w: float) -> float:
    """The larger norm of two vectors."""
    return math.sqrt(max(x * x + y * y + z * z, u * u + v * v + w * w))


@kernel
def bound_links(
    bodies: Records, values: Array, rates: Array, half: float, links: Records, bounds: Records
) -> None:
    """Bounds over an interval with constant joint rates.

    Args:
        bodies: (n,) the links, `BODY`.
        values: (nd,) joint values at its middle [rad or m].
        rates: (nd,) change over a whole edge [rad or m].
        half: half its length, in units of edge time.
        links: (n,) `LINK_STATE`, moved to the middle.
        bounds: (n,) `LINK_BOUND`, filled in but for the centres.
    """
    for j in range(1, len(bodies)):
        _bound_link(bodies, j, values[j - 1], abs(rates[j - 1]), 0.0, half, links, bounds)


@kernel
def bound_curved_links(
    bodies: Records,
    values: Array,
    rates: Array,
    bends: Array,
    half: float,
    links: Records,
    bounds: Records,
) -> None:
    """Bounds over an interval with joint rates that change.

    Args:
        bodies: (n,) the links, `BODY`.
        values: (nd,) joint values at its middle [rad or m].
        rates: (nd,) bounds on the magnitudes of their derivatives over it [rad or m].
        bends: (nd,) bounds on those of their second derivatives [rad or m].
        half: half its length.
        links: (n,) `LINK_STATE`, moved to the middle.
        bounds: (n,) `LINK_BOUND`, filled in but for the centres.
    """
    for j in range(1, len(bodies)):
        _bound_link(bodies, j, values[j - 1], rates[j - 1], bends[j - 1], half, links, bounds)


@kernel
def _bound_link(
    bodies: Records,
    j: int,
    value: float,
    rate: float,
    bend: float,
    half: float,
    links: Records,
    bounds: Records,
) -> None:
    """Bounds for a link from those of its parent.

    Args:
        bodies: (n,) the links, `BODY`.
        j: the link.
        value: of its joint at the middle of the interval [rad or m].
        rate: bound on the magnitude of the joint's rate [rad or m].
        bend: bound on that of the rate's change [rad or m].
        half: half the length of the interval.
        links: (n,) `LINK_STATE`, moved to the middle.
        bounds: (n,) `LINK_BOUND`, filled in for the link but for its centre.
    """
    parent, slides = bodies[j].parent, bodies[j].prismatic
    above, own, link = bounds[parent], bounds[j], links[j]
    angular, change = above.angular, above.angular_change
    # the distance from the parent's origin is a convex function of the joint value
    low, high = value - half * rate, value + half * rate
    a, b = bodies[j].offset, bodies[j].slide
    offset = _longer(
        a[0] + low * b[0],
        a[1] + low * b[1],
        a[2] + low * b[2],
        a[0] + high * b[0],
        a[1] + high * b[1],
        a[2] + high * b[2],
    )
    # |w_p x s_j|: the component of the parent's angular velocity across the joint's axis
    across = _across(link.rotation, bodies[j].axis, links[parent].angular)
    across = min(angular, across + half * change)
    turning, sliding, turning_bend, sliding_bend = rate, 0.0, bend, 0.0
    if slides:
        turning, sliding, turning_bend, sliding_bend = 0.0, rate, 0.0, bend
    own.angular_change = change + across * turning + turning_bend
    own.angular = min(angular + turning, norm_of(link.angular) + half * own.angular_change)
    own.acceleration = (
        above.acceleration
        + (change + angular * angular) * offset
        + 2.0 * across * sliding
        + sliding_bend
    )
    own.speed = min(
        above.speed + angular * offset + sliding, norm_of(link.linear) + half * own.acceleration
    )
    own.distance = min(above.distance + offset, norm_of(link.origin) + half * own.speed)


@kernel
def _across(turned: Array, axis: Array, w: Array) -> float:
    """|w x R s| for an angular velocity w, a rotation R (3, 3) and an axis s."""
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
def bound_point(j: int, place: Array, half: float, links: Records, bounds: Records) -> Point:
    """Motion and bounds of a point.

    Args:
        j: the link that carries it.
        place: (3,) in the frame of the link [m].
        half: half the length of the interval.
        links: (n,) `LINK_STATE` at the middle.
        bounds: (n,) `LINK_BOUND` over the interval.
    """
    turned, origin, own = links[j].rotation, links[j].origin, bounds[j]
    w, v = links[j].angular, links[j].linear
    x = turned[0, 0] * place[0] + turned[0, 1] * place[1] + turned[0, 2] * place[2]
    y = turned[1, 0] * place[0] + turned[1, 1] * place[1] + turned[1, 2] * place[2]
    z = turned[2, 0] * place[0] + turned[2, 1] * place[1] + turned[2, 2] * place[2]
    vx, vy, vz = v[0] + w[1] * z - w[2] * y, v[1] + w[2] * x - w[0] * z, v[2] + w[0] * y - w[1] * x
    x, y, z = origin[0] + x, origin[1] + y, origin[2] + z
    length, angular = norm_of(place), own.angular
    acceleration = own.acceleration + (own.angular_change + angular * angular) * length
    speed = min(
        own.speed + angular * length,
        math.sqrt(vx * vx + vy * vy + vz * vz) + half * acceleration,
    )
    distance = min(own.distance + length, math.sqrt(x * x + y * y + z * z) + half * speed)
    return Point(x, y, z, vx, vy, vz, distance, speed, acceleration)
