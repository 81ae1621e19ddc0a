"""Compiled motion of all links and the base rotation that it causes, at one joint configuration.

All vectors are in base axes and relative to the base; rates are per unit of edge time.
"""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.core.arrays import Array, Records
from ffsr_plan.core.kernels.compilation import kernel

LINK_STATE = np.dtype(
    [
        ("rotation", np.float64, (3, 3)),
        ("origin", np.float64, 3),
        ("angular", np.float64, 3),
        ("linear", np.float64, 3),
        ("arm", np.float64, 3),
        ("flow", np.float64, 3),
    ]
)
"""Motion of a link at one configuration.

    rotation    (3, 3) link axes to base axes
    origin      (3,) of the link [m]
    angular     (3,) angular velocity [rad]
    linear      (3,) velocity of the origin [m]
    arm         (3,) centre of mass of the link, from that of the robot [m]
    flow        (3,) velocity of the link's centre of mass [m]
"""

ROBOT_STATE = np.dtype(
    [("inertia", np.float64, 6), ("momentum", np.float64, 3), ("rate", np.float64, 3)]
)
"""The whole robot at one configuration.

    inertia     (6,) xx, yy, zz, xy, xz, yz of the locked inertia about the centre of mass [kg m^2]
    momentum    (3,) angular momentum of the links relative to the base, about the centre of mass
                [kg m^2 rad]
    rate        (3,) angular velocity of the base at zero angular momentum [rad]
"""

_EPS = np.finfo(np.float64).eps


def base_at_rest(links: Records) -> Records:
    """Put the base at rest at the origin: the first of n records of `LINK_STATE`, all zero."""
    links["rotation"][0] = np.eye(3)
    return links


@kernel
def add_cross(result: Array, a: Array, b: Array) -> None:
    """Add a x b, (3,) each, to `result`."""
    result[0] += a[1] * b[2] - a[2] * b[1]
    result[1] += a[2] * b[0] - a[0] * b[2]
    result[2] += a[0] * b[1] - a[1] * b[0]


@kernel
def turn_vector(result: Array, rotation: Array, x: float, y: float, z: float) -> None:
    """Fill in the product (3,) of a matrix (3, 3) and a vector."""
    for a in range(3):
        result[a] = rotation[a, 0] * x + rotation[a, 1] * y + rotation[a, 2] * z


@kernel
def move_links(bodies: Records, values: Array, rates: Array, links: Records) -> None:
    """Rotations, origins and velocities of all links; see `kinematics`.

    Args:
        bodies: (n,) the links, `BODY`.
        values: (nd,) joint values [rad or m].
        rates: (nd,) their rates.
        links: (n,) `LINK_STATE`, filled in.
    """
    for j in range(1, len(bodies)):
        body, link, parent = bodies[j], links[j], links[bodies[j].parent]
        q, rate, slides = values[j - 1], rates[j - 1], body.prismatic
        turned, rotation, step = parent.rotation, link.rotation, link.arm  # arms follow later
        sine, versine = (0.0, 0.0) if slides else (math.sin(q), 1.0 - math.cos(q))
        fixed, sines, versines, axis = body.fixed, body.sine, body.versine, body.axis
        for b in range(3):
            x = fixed[0, b] + sine * sines[0, b] + versine * versines[0, b]
            y = fixed[1, b] + sine * sines[1, b] + versine * versines[1, b]
            z = fixed[2, b] + sine * sines[2, b] + versine * versines[2, b]
            for a in range(3):
                rotation[a, b] = turned[a, 0] * x + turned[a, 1] * y + turned[a, 2] * z
        offset, slide = body.offset, body.slide
        x, y, z = offset[0] + q * slide[0], offset[1] + q * slide[1], offset[2] + q * slide[2]
        turn_vector(step, turned, x, y, z)
        for a in range(3):
            along = 0.0
            for b in range(3):
                along += rotation[a, b] * axis[b]
            link.origin[a] = parent.origin[a] + step[a]
            link.linear[a] = parent.linear[a] + (along * rate if slides else 0.0)
            link.angular[a] = parent.angular[a] + (0.0 if slides else along * rate)
        add_cross(link.linear, parent.angular, step)


@kernel
def weigh_links(bodies: Records, links: Records, robot: Records) -> None:
    """Centres of mass, locked inertia and angular momentum of links that have been moved.

    Args:
        bodies: (n,) the links, `BODY`.
        links: (n,) `LINK_STATE`; arms and flows are filled in.
        robot: (1,) `ROBOT_STATE`; inertia and momentum are filled in.
    """
    mass, x, y, z = 0.0, 0.0, 0.0, 0.0
    for j in range(len(bodies)):
        link, lever, own = links[j], bodies[j].lever, bodies[j].mass
        arm, flow = link.arm, link.flow
        turn_vector(arm, link.rotation, lever[0], lever[1], lever[2])
        for a in range(3):
            flow[a] = link.linear[a]
        add_cross(flow, link.angular, arm)
        for a in range(3):
            arm[a] += link.origin[a]
        mass += own
        x, y, z = x + own * arm[0], y + own * arm[1], z + own * arm[2]
    inertia, momentum = robot[0].inertia, robot[0].momentum
    for a in range(3):
        inertia[a], inertia[3 + a], momentum[a] = 0.0, 0.0, 0.0
    for j in range(len(bodies)):
        arm = links[j].arm
        arm[0] -= x / mass
        arm[1] -= y / mass
        arm[2] -= z / mass
        _add_link(bodies[j].mass, bodies[j].inertia, links, j, inertia, momentum)


@kernel
def _add_link(
    mass: float, own: Array, links: Records, j: int, inertia: Array, momentum: Array
) -> None:
    """Add a link's share to inertia and momentum."""
    rotation, arm, flow, angular = links[j].rotation, links[j].arm, links[j].flow, links[j].angular
    x, y, z = arm[0], arm[1], arm[2]
    xx, yy, zz, xy, xz, yz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for b in range(3):
        u = rotation[0, 0] * own[0, b] + rotation[0, 1] * own[1, b] + rotation[0, 2] * own[2, b]
        v = rotation[1, 0] * own[0, b] + rotation[1, 1] * own[1, b] + rotation[1, 2] * own[2, b]
        w = rotation[2, 0] * own[0, b] + rotation[2, 1] * own[1, b] + rotation[2, 2] * own[2, b]
        xx += u * rotation[0, b]
        xy += u * rotation[1, b]
        xz += u * rotation[2, b]
        yy += v * rotation[1, b]
        yz += v * rotation[2, b]
        zz += w * rotation[2, b]
    u, v, w = angular[0], angular[1], angular[2]
    momentum[0] += xx * u + xy * v + xz * w + mass * (y * flow[2] - z * flow[1])
    momentum[1] += xy * u + yy * v + yz * w + mass * (z * flow[0] - x * flow[2])
    momentum[2] += xz * u + yz * v + zz * w + mass * (x * flow[1] - y * flow[0])
    inertia[0] += xx + mass * (y * y + z * z)
    inertia[1] += yy + mass * (x * x + z * z)
    inertia[2] += zz + mass * (x * x + y * y)
    inertia[3] += xy - mass * x * y
    inertia[4] += xz - mass * x * z
    inertia[5] += yz - mass * y * z


@kernel
def base_rate(robot: Records) -> float:
    """The base's angular velocity at zero angular momentum, omega = -I^-1 l.

    Args:
        robot: (1,) `ROBOT_STATE`; the rate is filled in.

    Returns:
        A lower bound on the least eigenvalue of the inertia, 1 / |I^-1| in the Frobenius norm
        [kg m^2]; not positive where rounding leaves nothing of it.
    """
    inertia, momentum, rate = robot[0].inertia, robot[0].momentum, robot[0].rate
    xx, yy, zz = inertia[0], inertia[1], inertia[2]
    xy, xz, yz = inertia[3], inertia[4], inertia[5]
    a, b, c = yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy
    d, e, f = xz * yz - xy * zz, xy * yz - xz * yy, xy * xz - xx * yz
    determinant = xx * a + xy * d + xz * e
    x, y, z = momentum[0], momentum[1], momentum[2]
    scale = -1.0 / determinant
    rate[0] = scale * (a * x + d * y + e * z)
    rate[1] = scale * (d * x + b * y + f * z)
    rate[2] = scale * (e * x + f * y + c * z)
    norm = math.sqrt(a * a + b * b + c * c + 2.0 * (d * d + e * e + f * f))
    return float(determinant / norm)


@kernel
def rate_rounding(bodies: Records, links: Records, robot: Records, least: float) -> float:
    """Rounding error of the base's angular velocity [rad].

    Places of links have relative errors of some eps of their distance from the base, which matter
    where links cancel, or where the arms carry the centre of mass close to the base's.

    Args:
        bodies: (n,) the links, `BODY`.
        links: (n,) `LINK_STATE`, moved and weighed.
        robot: (1,) `ROBOT_STATE`, with the rate.
        least: of `base_rate` [kg m^2].
    """
    reach, inertia, momentum = 0.0, 0.0, 0.0
    for j in range(len(bodies)):
        reach = max(reach, _sum(links[j].origin) + _sum(bodies[j].lever))
    for j in range(len(bodies)):
        link, mass, largest = links[j], bodies[j].mass, bodies[j].moments[1]
        arm, angular = _sum(link.arm), _sum(link.angular)
        flow = _sum(link.linear) + angular * reach
        inertia += largest + 2.0 * mass * arm * (arm + reach)
        momentum += largest * angular + mass * (arm + reach) * flow
    speed = norm_of(robot[0].rate)
    return (len(bodies) + 8) * _EPS * (inertia * speed + momentum) / least


@kernel
def total_mass(bodies: Records) -> float:
    """Mass of all links [kg]."""
    mass = 0.0
    for j in range(len(bodies)):
        mass += bodies[j].mass
    return mass


@kernel
def _sum(vector: Array) -> float:
    """Sum of the absolute components of a vector (3,), a bound on its length."""
    return abs(vector[0]) + abs(vector[1]) + abs(vector[2])


@kernel
def norm_of(vector: Array) -> float:
    """Length of a vector (3,)."""
    return math.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])
