"""`PathDynamics`: velocities, accelerations and forces along a path, for any pace along it.

A path is a curve in its parameter s; a time law s(t) flies it. With x = s'^2 and u = s'',

    velocity        v  = V s'
    acceleration    v' = V u + V' x        V' = dV/ds
    forces          f  = a u + b x

where a is the momentum per unit of s' and b its rate at s' = 1. What an actuator prescribes is
given with the path; what reacts follows from momentum conservation. In free flight there is no
other force: the same path flown k times as slowly needs 1 / k^2 of every force (Hollerbach 1984).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.robots.kinematics import turned
from ffsr_plan.robots.robot import SpaceRobot


class Prescribed(NamedTuple):
    """What actuators prescribe at N points of a path: first and second derivatives by s.

    Attributes:
        configurations: (N, nq) base pose in the world and joints, reaction included.
        joints: (N, nd) joint values without a jump at half a turn [rad or m].
        base: (N, 2, 3) derivatives of the base origin by thrusters, world axes [m].
        turn: (N, 2, 3) angular velocity of the base by wheels, and its derivative, base axes [rad].
        rates: (N, 2, nd) derivatives of the joint values [rad or m].
    """

    configurations: Array
    joints: Array
    base: Array
    turn: Array
    rates: Array


class PathDynamics(NamedTuple):
    """Velocities and forces at N points of a path; the first of each pair goes with u = s''.

    Attributes:
        velocities: (N, 2, nv) V and V', base linear [m] and angular [rad], both in base axes, then
            joints [rad or m]; V' is the derivative of these numbers.
        thrust: (N, 2, 3) through the centre of mass, world axes [kg m]; zero without thrusters.
        wheel_torque: (N, 2, 3) on the base, base axes [kg m^2]; zero without wheels. The first is
            minus the momentum of the wheels per unit of s'.
        torques: (N, 2, nd) of joints, without friction [kg m^2, or kg m if prismatic].
    """

    velocities: Array
    thrust: Array
    wheel_torque: Array
    torques: Array


def path_dynamics(robot: SpaceRobot, mode: Mode, path: Prescribed) -> PathDynamics:
    """Dynamics of a path, whatever its pace.

    Args:
        robot: the robot.
        mode: what actuates the base; derivatives that it does not prescribe are not read.
        path: N points.

    Returns:
        Velocities and forces at these points.
    """
    from ffsr_plan.dynamics.kernels.newton_euler import force_memory_for, forces_along

    quats, count = path.configurations[:, 3:7], len(path.joints)
    to_base = np.swapaxes(rotations.matrix(quats), 1, 2)
    base = np.stack([turned(to_base, path.base[:, k]) for k in range(2)], axis=1)
    result = np.empty((count, 4, 6 + robot.nd))
    forces_along(
        robot.bodies,
        _own(path.joints),
        _own(path.rates),
        base,
        _own(path.turn),
        (mode.attitude_reacts, mode.floats),
        force_memory_for(robot.nd + 1),
        result,
    )
    thrust = moment = np.zeros((count, 2, 3))
    if mode.has_thrusters:
        force = result[:, 2:, :3]
        thrust = np.stack([rotations.rotate(quats, force[:, k]) for k in range(2)], axis=1)
    if mode.has_wheels:
        moment = result[:, 2:, 3:6]
    return PathDynamics(result[:, :2], thrust, moment, result[:, 2:, 6:])


def _own(array: Array) -> Array:
    """A contiguous copy that can be written to: kernels are compiled for such arrays."""
    return np.array(array, dtype=np.float64, order="C")
