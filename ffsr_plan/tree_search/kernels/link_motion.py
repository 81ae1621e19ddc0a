"""Compiled kinematics of the links, and the base's angular velocity that conserves momentum.

All vectors are in base axes; rates are per unit of the time of an edge.
"""

from __future__ import annotations

import math

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.tree_search.kernels.search_arrays import JOINTS, Records


@kernel
def place_links(links: Records, begin: Array, end: Array, time: float) -> None:
    """Poses of all links at a time on an edge; see `robots.kinematics` for the formulas.

    Args:
        links: values, rotations and origins are filled in.
        begin: (D,) state at time 0.
        end: (D,) state at time 1.
        time: in [0, 1].
    """
    for j in range(1, len(links)):
        link = links[j]
        above = links[link.parent]
        rate = end[JOINTS + j - 1] - begin[JOINTS + j - 1]
        value = begin[JOINTS + j - 1] + time * rate
        link.value, link.rate = value, rate
        sine, versine = math.sin(value), 1.0 - math.cos(value)
        for a in range(3):
            x, y, z = above.rotation[a, 0], above.rotation[a, 1], above.rotation[a, 2]
            for b in range(3):
                link.rotation[a, b] = (
                    x * (link.fixed[0, b] + sine * link.sine[0, b] + versine * link.versine[0, b])
                    + y * (link.fixed[1, b] + sine * link.sine[1, b] + versine * link.versine[1, b])
                    + z * (link.fixed[2, b] + sine * link.sine[2, b] + versine * link.versine[2, b])
                )
            link.origin[a] = (
                above.origin[a]
                + x * (link.offset[0] + value * link.slide[0])
                + y * (link.offset[1] + value * link.slide[1])
                + z * (link.offset[2] + value * link.slide[2])
            )


@kernel
def move_links(links: Records) -> None:
    """Velocities of all links that have been placed.

    Args:
        links: angular and linear velocities are filled in.
    """
    for j in range(1, len(links)):
        link = links[j]
        above = links[link.parent]
        spin = above.angular
        x = link.origin[0] - above.origin[0]
        y = link.origin[1] - above.origin[1]
        z = link.origin[2] - above.origin[2]
        link.linear[0] = above.linear[0] + spin[1] * z - spin[2] * y
        link.linear[1] = above.linear[1] + spin[2] * x - spin[0] * z
        link.linear[2] = above.linear[2] + spin[0] * y - spin[1] * x
        for a in range(3):
            turned = slid = 0.0
            for b in range(3):
                turned += link.rotation[a, b] * link.turning[b]
                slid += link.rotation[a, b] * link.sliding[b]
            link.angular[a] = spin[a] + turned * link.rate
            link.linear[a] += slid * link.rate


@kernel
def find_center(links: Records, setup: Records) -> None:
    """Centre of mass relative to the base, and its velocity.

    Args:
        links: the links, placed and moved.
        setup: (1,) `center` and `drift` are filled in.
    """
    own = setup[0]
    mass = 0.0
    for a in range(3):
        own.center[a] = own.drift[a] = 0.0
    for j in range(len(links)):
        link = links[j]
        mass += link.mass
        turn = link.rotation
        x = turn[0, 0] * link.lever[0] + turn[0, 1] * link.lever[1] + turn[0, 2] * link.lever[2]
        y = turn[1, 0] * link.lever[0] + turn[1, 1] * link.lever[1] + turn[1, 2] * link.lever[2]
        z = turn[2, 0] * link.lever[0] + turn[2, 1] * link.lever[1] + turn[2, 2] * link.lever[2]
        own.center[0] += link.mass * (link.origin[0] + x)
        own.center[1] += link.mass * (link.origin[1] + y)
        own.center[2] += link.mass * (link.origin[2] + z)
        spin = link.angular
        own.drift[0] += link.mass * (link.linear[0] + spin[1] * z - spin[2] * y)
        own.drift[1] += link.mass * (link.linear[1] + spin[2] * x - spin[0] * z)
        own.drift[2] += link.mass * (link.linear[2] + spin[0] * y - spin[1] * x)
    for a in range(3):
        own.center[a] /= mass
        own.drift[a] /= mass


@kernel
def react(links: Records, setup: Records) -> None:
    """Angular velocity of the base at zero angular momentum: I omega = -l.

    I is the locked inertia and l the links' angular momentum relative to the base, both about the
    centre of mass, which `find_center` has found.

    Args:
        links: the links, placed and moved.
        setup: (1,) `rate` is filled in.
    """
    own = setup[0]
    xx = yy = zz = xy = xz = yz = 0.0
    l0 = l1 = l2 = 0.0
    for j in range(len(links)):
        link = links[j]
        turn, spin, mass = link.rotation, link.angular, link.mass
        ax = turn[0, 0] * link.lever[0] + turn[0, 1] * link.lever[1] + turn[0, 2] * link.lever[2]
        ay = turn[1, 0] * link.lever[0] + turn[1, 1] * link.lever[1] + turn[1, 2] * link.lever[2]
        az = turn[2, 0] * link.lever[0] + turn[2, 1] * link.lever[1] + turn[2, 2] * link.lever[2]
        vx = link.linear[0] + spin[1] * az - spin[2] * ay
        vy = link.linear[1] + spin[2] * ax - spin[0] * az
        vz = link.linear[2] + spin[0] * ay - spin[1] * ax
        x = link.origin[0] + ax - own.center[0]
        y = link.origin[1] + ay - own.center[1]
        z = link.origin[2] + az - own.center[2]
        l0 += mass * (y * vz - z * vy)
        l1 += mass * (z * vx - x * vz)
        l2 += mass * (x * vy - y * vx)
        xx += mass * (y * y + z * z)
        yy += mass * (x * x + z * z)
        zz += mass * (x * x + y * y)
        xy -= mass * x * y
        xz -= mass * x * z
        yz -= mass * y * z
        for a in range(3):  # the body's own inertia, turned into base axes
            p = q = r = 0.0
            for b in range(3):
                p += turn[a, b] * link.inertia[b, 0]
                q += turn[a, b] * link.inertia[b, 1]
                r += turn[a, b] * link.inertia[b, 2]
            first = p * turn[0, 0] + q * turn[0, 1] + r * turn[0, 2]
            second = p * turn[1, 0] + q * turn[1, 1] + r * turn[1, 2]
            third = p * turn[2, 0] + q * turn[2, 1] + r * turn[2, 2]
            momentum = first * spin[0] + second * spin[1] + third * spin[2]
            if a == 0:
                xx, xy, xz, l0 = xx + first, xy + second, xz + third, l0 + momentum
            elif a == 1:
                yy, yz, l1 = yy + second, yz + third, l1 + momentum
            else:
                zz, l2 = zz + third, l2 + momentum
    solve_rate(xx, yy, zz, xy, xz, yz, l0, l1, l2, own.rate)


@kernel
def solve_rate(
    xx: float, yy: float, zz: float, xy: float, xz: float, yz: float,
    l0: float, l1: float, l2: float, rate: Array,
) -> None:  # fmt: skip
    """Solve I omega = -l for a symmetric inertia; `rate` (3,) is filled in."""
    a, b, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    d, e, f = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    scale = -1.0 / (xx * a + xy * b + xz * c)
    rate[0] = scale * (a * l0 + b * l1 + c * l2)
    rate[1] = scale * (b * l0 + d * l1 + e * l2)
    rate[2] = scale * (c * l0 + e * l1 + f * l2)
