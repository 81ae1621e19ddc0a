"""Compiled motion of all links and the base rotation that it causes, at one joint configuration.

All vectors are in base axes and relative to the base; rates are per unit of edge time.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.robots.kinematics import Bodies

_EPS = np.finfo(np.float64).eps


class LinkStates(NamedTuple):
    """Memory for the motion of n links at one configuration.

    Attributes:
        rotations: (n, 3, 3) link axes to base axes.
        origins: (n, 3) origins of the links [m].
        angular: (n, 3) angular velocities [rad].
        linear: (n, 3) velocities of the origins [m].
        arms: (n, 3) centres of mass of the links, from that of the robot [m].
        flows: (n, 3) velocities of the links' centres of mass [m].
        inertia: (6,) xx, yy, zz, xy, xz, yz of the locked inertia about the robot's centre of mass
            [kg m^2].
        momentum: (3,) angular momentum of the links relative to the base, about the robot's centre
            of mass [kg m^2 rad].
    """

    rotations: Array
    origins: Array
    angular: Array
    linear: Array
    arms: Array
    flows: Array
    inertia: Array
    momentum: Array


@kernel
def link_states(count: int) -> LinkStates:
    """Memory for `count` links, the base at rest at the origin."""
    states = LinkStates(
        np.zeros((count, 3, 3)),
        np.zeros((count, 3)),
        np.zeros((count, 3)),
        np.zeros((count, 3)),
        np.zeros((count, 3)),
        np.zeros((count, 3)),
        np.zeros(6),
        np.zeros(3),
    )
    for axis in range(3):
        states.rotations[0, axis, axis] = 1.0
    return states


@kernel
def add_cross(result: Array, row: int, a: Array, b: Array) -> None:
    """Add a x b, (3,) each, to a row of `result`."""
    result[row, 0] += a[1] * b[2] - a[2] * b[1]
    result[row, 1] += a[2] * b[0] - a[0] * b[2]
    result[row, 2] += a[0] * b[1] - a[1] * b[0]


@kernel
def move_links(bodies: Bodies, values: Array, rates: Array, states: LinkStates) -> None:
    """Rotations, origins and velocities of all links; see `kinematics`.

    Args:
        bodies: the links.
        values: (nd,) joint values [rad or m].
        rates: (nd,) their rates.
        states: filled in.
    """
    turned, origins = states.rotations, states.origins
    angular, linear = states.angular, states.linear
    fixed, sines, versines = bodies.fixed, bodies.sine, bodies.versine
    for j in range(1, len(bodies.parents)):
        p, q, rate = bodies.parents[j], values[j - 1], rates[j - 1]
        slides = bodies.prismatic[j]
        sine, versine = (0.0, 0.0) if slides else (math.sin(q), 1.0 - math.cos(q))
        for b in range(3):
            x = fixed[j, 0, b] + sine * sines[j, 0, b] + versine * versines[j, 0, b]
            y = fixed[j, 1, b] + sine * sines[j, 1, b] + versine * versines[j, 1, b]
            z = fixed[j, 2, b] + sine * sines[j, 2, b] + versine * versines[j, 2, b]
            for a in range(3):
                turned[j, a, b] = turned[p, a, 0] * x + turned[p, a, 1] * y + turned[p, a, 2] * z
        x = bodies.offsets[j, 0] + q * bodies.slides[j, 0]
        y = bodies.offsets[j, 1] + q * bodies.slides[j, 1]
        z = bodies.offsets[j, 2] + q * bodies.slides[j, 2]
        step = states.arms[j]  # a place for it: it has its own value later
        for a in range(3):
            step[a] = turned[p, a, 0] * x + turned[p, a, 1] * y + turned[p, a, 2] * z
            origins[j, a] = origins[p, a] + step[a]
            along = 0.0
            for b in range(3):
                along += turned[j, a, b] * bodies.axes[j, b]
            linear[j, a] = linear[p, a] + (along * rate if slides else 0.0)
            angular[j, a] = angular[p, a] + (0.0 if slides else along * rate)
        add_cross(linear, j, angular[p], step)


@kernel
def weigh_links(bodies: Bodies, states: LinkStates) -> None:
    """Centres of mass, locked inertia and angular momentum of links that have been moved.

    Args:
        bodies: the links.
        states: arms, flows, inertia and momentum are filled in.
    """
    arms, flows = states.arms, states.flows
    mass = 0.0
    center_x, center_y, center_z = 0.0, 0.0, 0.0
    for j in range(len(bodies.masses)):
        for a in range(3):
            arms[j, a] = 0.0
            for b in range(3):
                arms[j, a] += states.rotations[j, a, b] * bodies.levers[j, b]
            flows[j, a] = states.linear[j, a]
        add_cross(flows, j, states.angular[j], arms[j])
        for a in range(3):
            arms[j, a] += states.origins[j, a]
        mass += bodies.masses[j]
        center_x += bodies.masses[j] * arms[j, 0]
        center_y += bodies.masses[j] * arms[j, 1]
        center_z += bodies.masses[j] * arms[j, 2]
    states.inertia[:] = 0.0
    states.momentum[:] = 0.0
    for j in range(len(bodies.masses)):
        arms[j, 0] -= center_x / mass
        arms[j, 1] -= center_y / mass
        arms[j, 2] -= center_z / mass
        _add_link(bodies, j, states)


@kernel
def _add_link(bodies: Bodies, j: int, states: LinkStates) -> None:
    """Add a link's share to inertia and momentum."""
    rotation, own, inertia = states.rotations[j], bodies.inertias[j], states.inertia
    mass, x, y, z = bodies.masses[j], states.arms[j, 0], states.arms[j, 1], states.arms[j, 2]
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
    u, v, w = states.angular[j, 0], states.angular[j, 1], states.angular[j, 2]
    momentum, flow = states.momentum, states.flows[j]
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
def base_rate(states: LinkStates, rate: Array) -> float:
    """The base's angular velocity at zero angular momentum, omega = -I^-1 l.

    Args:
        states: inertia and momentum.
        rate: (3,) the angular velocity, filled in [rad].

    Returns:
        A lower bound on the least eigenvalue of the inertia, 1 / |I^-1| in the Frobenius norm
        [kg m^2]; not positive where rounding leaves nothing of it.
    """
    xx, yy, zz = states.inertia[0], states.inertia[1], states.inertia[2]
    xy, xz, yz = states.inertia[3], states.inertia[4], states.inertia[5]
    a, b, c = yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy
    d, e, f = xz * yz - xy * zz, xy * yz - xz * yy, xy * xz - xx * yz
    determinant = xx * a + xy * d + xz * e
    x, y, z = states.momentum[0], states.momentum[1], states.momentum[2]
    rate[0] = -(a * x + d * y + e * z) / determinant
    rate[1] = -(d * x + b * y + f * z) / determinant
    rate[2] = -(e * x + f * y + c * z) / determinant
    norm = math.sqrt(a * a + b * b + c * c + 2.0 * (d * d + e * e + f * f))
    return float(determinant / norm)


@kernel
def rate_rounding(bodies: Bodies, states: LinkStates, rate: Array, least: float) -> float:
    """Rounding error of the base's angular velocity [rad].

    Places of links have relative errors of some eps of their distance from the base, which matter
    where links cancel, or where the arms carry the centre of mass close to the base's.

    Args:
        bodies: the links.
        states: the links, moved and weighed.
        rate: (3,) of `base_rate` [rad].
        least: of `base_rate` [kg m^2].
    """
    reach, inertia, momentum = 0.0, 0.0, 0.0
    for j in range(len(bodies.masses)):
        reach = max(reach, _sum(states.origins[j]) + _sum(bodies.levers[j]))
    for j in range(len(bodies.masses)):
        mass, arm, angular = bodies.masses[j], _sum(states.arms[j]), _sum(states.angular[j])
        flow = _sum(states.linear[j]) + angular * reach
        inertia += bodies.moments[j, 1] + 2.0 * mass * arm * (arm + reach)
        momentum += bodies.moments[j, 1] * angular + mass * (arm + reach) * flow
    speed = norm_of(rate)
    return (len(bodies.masses) + 8) * _EPS * (inertia * speed + momentum) / least


@kernel
def _sum(vector: Array) -> float:
    """Sum of the absolute components of a vector (3,), a bound on its length."""
    return abs(vector[0]) + abs(vector[1]) + abs(vector[2])


@kernel
def norm_of(vector: Array) -> float:
    """Length of a vector (3,)."""
    return math.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])
