"""Compiled recursive Newton-Euler algorithm along a path, the reaction of the base included.

At the parameter s of a path, with x = s'^2 and u = s'', every force is a u + b x: a is the momentum
of the links per unit of s', b its rate at the constant pace s' = 1. Both are sums over links, from
the tips inwards. All vectors are in base axes and relative to the base origin; there is no gravity.

The base's angular acceleration follows from the momentum as its velocity does. With the rate h of
the angular momentum about the centre of mass that there would be without it, and the locked inertia
I about that centre, it is -I^-1 h.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Records, records
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.bodies import (
    LINK_STATE,
    ROBOT_STATE,
    add_cross,
    base_at_rest,
    base_rate,
    move_links,
    total_mass,
    turn_vector,
    weigh_links,
)

LINK_FORCES = np.dtype(
    [
        ("center", np.float64, 3),
        ("axis", np.float64, 3),
        ("growth", np.float64, 3),
        ("spin", np.float64, 3),
        ("force", np.float64, (2, 3)),
        ("moment", np.float64, (2, 3)),
    ]
)
"""Accelerations and forces of a link at one point of a path, per unit of s'^2.

    center      (3,) centre of mass [m]
    axis        (3,) of the joint above the link
    growth      (3,) acceleration of the link's origin [m]
    spin        (3,) angular acceleration [rad]
    force       (2, 3) momentum per unit of s', and its rate; of all links beyond too, in the end
    moment      (2, 3) the same of the angular momentum, at first about the link's centre of mass,
                in the end about the base origin
"""


class ForceMemory(NamedTuple):
    """Scratch memory for a robot with n links.

    Attributes:
        links: (n,) records of `LINK_STATE`.
        forces: (n,) of `LINK_FORCES`.
        robot: (1,) of `ROBOT_STATE`.
        vectors: (4, 3).
    """

    links: Records
    forces: Records
    robot: Records
    vectors: Array


def force_memory_for(count: int) -> ForceMemory:
    """Memory for `count` links."""
    return ForceMemory(
        base_at_rest(records(LINK_STATE, count)),
        records(LINK_FORCES, count),
        records(ROBOT_STATE, 1),
        np.zeros((4, 3)),
    )


@kernel
def forces_along(
    bodies: Records,
    joints: Array,
    rates: Array,
    base: Array,
    turn: Array,
    reacts: tuple[bool, bool],
    memory: ForceMemory,
    result: Array,
) -> None:
    """Velocities, accelerations and forces at N points of a path.

    Args:
        bodies: (n,) the links, `BODY`.
        joints: (N, nd) joint values [rad or m].
        rates: (N, 2, nd) their first and second derivatives by s.
        base: (N, 2, 3) those of the base origin, base axes [m]; not read where it floats.
        turn: (N, 2, 3) angular velocity of the base and its derivative [rad]; not read where the
            attitude reacts.
        reacts: whether the base's attitude reacts, and whether its origin does.
        memory: scratch memory.
        result: (N, 4, 6 + nd) filled in: velocities and their derivatives by s, as Pinocchio has
            them; a and b of thrust (3), moment of wheels about the centre of mass (3) and torques.
    """
    links, forces, robot = memory.links, memory.forces, memory.robot
    omega, change, center = memory.vectors[0], memory.vectors[1], memory.vectors[2]
    for k in range(len(joints)):
        for a in range(3):
            links[0].linear[a], links[0].angular[a] = 0.0, 0.0
        move_links(bodies, joints[k], rates[k, 0], links)
        weigh_links(bodies, links, robot)
        if reacts[0]:
            base_rate(robot)
        for a in range(3):
            omega[a] = robot[0].rate[a] if reacts[0] else turn[k, 0, a]
        _turn_links(bodies, links, forces, omega, center)
        _accelerate_links(bodies, rates[k], links, forces)
        for j in range(len(bodies)):
            _load_link(bodies, links, forces, j)
        if reacts[0]:
            _moment_about(center, forces, robot[0].momentum)
            base_rate(robot)
        for a in range(3):
            change[a] = robot[0].rate[a] if reacts[0] else turn[k, 1, a]
        for j in range(len(bodies)):
            _spin_link(bodies, links, forces, j, change)
        _write(bodies, rates[k], base[k], reacts[1], memory, result[k])


@kernel
def _turn_links(
    bodies: Records, links: Records, forces: Records, omega: Array, center: Array
) -> None:
    """Add the base's angular velocity to the velocities of links, relative to a base at rest.

    The centres of mass of the robot, (3,) `center`, and of the links are filled in.
    """
    lever = bodies[0].lever
    for a in range(3):
        center[a] = lever[a] - links[0].arm[a]
    for j in range(len(bodies)):
        link, force, axis = links[j], forces[j], bodies[j].axis
        turn_vector(force.axis, link.rotation, axis[0], axis[1], axis[2])
        for a in range(3):
            force.center[a] = center[a] + link.arm[a]
            link.angular[a] += omega[a]
        add_cross(link.linear, omega, link.origin)
        add_cross(link.flow, omega, force.center)


@kernel
def _accelerate_links(bodies: Records, rates: Array, links: Records, forces: Records) -> None:
    """Accelerations of the origins of all links, and angular ones, where the base has none.

    The vector from the parent's origin to the link's replaces the link's arm.
    """
    for a in range(3):
        forces[0].spin[a], forces[0].growth[a] = 0.0, 0.0
    for j in range(1, len(bodies)):
        above, force, step = bodies[j].parent, forces[j], links[j].arm
        slides, axis, w = bodies[j].prismatic, force.axis, links[above].angular
        rate, bend, own = rates[0, j - 1], rates[1, j - 1], forces[above]
        for a in range(3):
            step[a] = links[j].origin[a] - links[above].origin[a]
            force.spin[a] = own.spin[a] + (0.0 if slides else bend * axis[a])
            force.growth[a] = own.growth[a] + (bend * axis[a] if slides else 0.0)
        _add_turning(force.growth, own.spin, w, step)
        if slides:
            _add_scaled_cross(force.growth, 2.0 * rate, w, axis)
        else:
            _add_scaled_cross(force.spin, rate, w, axis)


@kernel
def _load_link(bodies: Records, links: Records, forces: Records, j: int) -> None:
    """Forces of a link where neither the base's origin moves nor its turning changes."""
    link, force, mass = links[j], forces[j], bodies[j].mass
    momentum, rate, spin = force.moment[0], force.moment[1], link.arm
    for a in range(3):
        spin[a] = force.center[a] - link.origin[a]
        force.force[0, a], force.force[1, a] = mass * link.flow[a], force.growth[a]
    _add_turning(force.force[1], force.spin, link.angular, spin)
    for a in range(3):
        force.force[1, a] *= mass
        momentum[a], rate[a] = 0.0, 0.0
    _add_spun(momentum, bodies[j].inertia, link.rotation, link.angular)
    _add_spun(rate, bodies[j].inertia, link.rotation, force.spin)
    add_cross(rate, link.angular, momentum)


@kernel
def _spin_link(bodies: Records, links: Records, forces: Records, j: int, change: Array) -> None:
    """Add what the base's angular acceleration (3,) changes in the forces of a link."""
    force = forces[j]
    _add_scaled_cross(force.force[1], bodies[j].mass, change, force.center)
    _add_spun(force.moment[1], bodies[j].inertia, links[j].rotation, change)


@kernel
def _moment_about(center: Array, forces: Records, moment: Array) -> None:
    """Fill in the rate of the angular momentum of all links about the centre of mass (3,)."""
    for a in range(3):
        moment[a] = 0.0
    for j in range(len(forces)):
        force = forces[j]
        for a in range(3):
            moment[a] += force.moment[1, a]
        add_cross(moment, force.center, force.force[1])
        _add_scaled_cross(moment, -1.0, center, force.force[1])


@kernel
def _write(
    bodies: Records, rates: Array, base: Array, floats: bool, memory: ForceMemory, result: Array
) -> None:
    """Fill in one point (4, 6 + nd) of the result, forces summed from the tips inwards."""
    forces, omega, center = memory.forces, memory.vectors[0], memory.vectors[2]
    push, mass = memory.vectors[3], total_mass(bodies)
    for i in range(2):
        for a in range(3):
            push[a] = base[i, a]
            if floats:
                push[a] = 0.0
                for j in range(len(bodies)):
                    push[a] -= forces[j].force[i, a] / mass
            result[i, a], result[i, 3 + a] = push[a], memory.vectors[i, a]
        for j in range(len(bodies)):
            for a in range(3):
                forces[j].force[i, a] += bodies[j].mass * push[a]
            add_cross(forces[j].moment[i], forces[j].center, forces[j].force[i])
        _sum_inwards(bodies, memory.links, forces, i, result[2 + i])
        total, moment = forces[0].force[i], result[2 + i, 3:6]
        for a in range(3):
            result[2 + i, a], moment[a] = total[a], forces[0].moment[i, a]
        _add_scaled_cross(moment, -1.0, center, total)
        for j in range(len(bodies) - 1):
            result[i, 6 + j] = rates[i, j]
    _add_scaled_cross(result[1], -1.0, omega, result[0])  # base axes rotate with the base


@kernel
def _sum_inwards(bodies: Records, links: Records, forces: Records, i: int, row: Array) -> None:
    """Add forces of links to those of their parents, and fill in torques (6 + nd,) of joints."""
    for j in range(len(bodies) - 1, 0, -1):
        axis, force, moment = forces[j].axis, forces[j].force[i], forces[j].moment[i]
        above, about = forces[bodies[j].parent], links[j].arm
        for a in range(3):
            about[a] = moment[a]
            above.force[i, a] += force[a]
            above.moment[i, a] += moment[a]
        _add_scaled_cross(about, -1.0, links[j].origin, force)
        row[5 + j] = 0.0
        for a in range(3):
            row[5 + j] += axis[a] * (force[a] if bodies[j].prismatic else about[a])


@kernel
def _add_turning(result: Array, spin: Array, w: Array, arm: Array) -> None:
    """Add spin x arm + w x (w x arm), (3,) each, to `result`."""
    add_cross(result, spin, arm)
    along = w[0] * arm[0] + w[1] * arm[1] + w[2] * arm[2]
    square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2]
    for a in range(3):
        result[a] += along * w[a] - square * arm[a]


@kernel
def _add_scaled_cross(result: Array, scale: float, a: Array, b: Array) -> None:
    """Add `scale` a x b, (3,) each, to `result`."""
    result[0] += scale * (a[1] * b[2] - a[2] * b[1])
    result[1] += scale * (a[2] * b[0] - a[0] * b[2])
    result[2] += scale * (a[0] * b[1] - a[1] * b[0])


@kernel
def _add_spun(result: Array, inertia: Array, rotation: Array, w: Array) -> None:
    """Add the angular momentum at w (3,) of an inertia (3, 3) in axes turned by `rotation`."""
    x = rotation[0, 0] * w[0] + rotation[1, 0] * w[1] + rotation[2, 0] * w[2]
    y = rotation[0, 1] * w[0] + rotation[1, 1] * w[1] + rotation[2, 1] * w[2]
    z = rotation[0, 2] * w[0] + rotation[1, 2] * w[1] + rotation[2, 2] * w[2]
    for b in range(3):
        along = inertia[b, 0] * x + inertia[b, 1] * y + inertia[b, 2] * z
        for a in range(3):
            result[a] += rotation[a, b] * along
