"""What thrusters, wheels and joints must do for the robot to move as a motion says.

A motion and the pace on it, sigma' and sigma'' for the time sigma on an edge, give velocities and
accelerations. Those of a base that reacts follow from h = A_b v_b + A_theta theta' = 0 and from its
derivative; A = [A_b A_theta] is the centroidal momentum matrix (rows and columns of what reacts):

    v_b = -A_b^-1 A_theta theta'        v_b' = -A_b^-1 (A' v + A_theta theta'')

The recursive Newton-Euler algorithm without gravity then gives the joint torques, and the force and
moment on the base. In free flight all of them are quadratic in the pace: flown k times as slowly,
the same motion takes 1 / k^2 of every force (Hollerbach 1984).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.rotations import cross
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.robots.kinematics import turned


class States(NamedTuple):
    """A motion at N instants: where, how fast, and what brings it about.

    `configurations`, `velocities` and `accelerations` are Pinocchio's: the base's velocity is
    linear [m/s], then angular [rad/s], in base axes, and its acceleration the derivative of these
    six numbers.
    """

    parameters: Array
    """(N,) path parameters s in [0, 1], as `Plan.at` takes them."""
    joints: Array
    """(N, nd) [rad or m], continuous joints without a jump at half a turn."""
    configurations: Array
    """(N, nq)."""
    velocities: Array
    """(N, nv)."""
    accelerations: Array
    """(N, nv)."""
    thrust: Array
    """(N, 3) force of the thrusters through the centre of mass, world axes [N]."""
    wheel_torque: Array
    """(N, 3) moment of the wheels on the base, base axes [N m]; zero where there are none."""
    wheel_momentum: Array
    """(N, 3) stored in the wheels, base axes [N m s]; zero where there are none."""
    torques: Array
    """(N, nd) of the joints, without friction [N m, or N where prismatic]."""

    @property
    def base_velocity(self) -> Array:
        """(N, 3) of the base origin, world axes [m/s]."""
        return rotations.rotate(self.configurations[:, 3:7], self.velocities[:, :3])

    @property
    def base_acceleration(self) -> Array:
        """(N, 3) of the base origin, world axes [m/s^2]: the derivative of `base_velocity`."""
        v = self.velocities
        along = self.accelerations[:, :3] + cross(v[:, 3:6], v[:, :3])
        return rotations.rotate(self.configurations[:, 3:7], along)


def states(motion: Motion, edge: IntArray, time: Array, pace: Array, acceleration: Array) -> States:
    """The states on `edge` (N,) at `time` (N,) in [0, 1], whose derivatives are given.

    Args:
        motion: the motion.
        edge: (N,).
        time: (N,) sigma.
        pace: (N,) sigma' [1/s].
        acceleration: (N,) sigma'' [1/s^2].
    """
    robot, q = motion.robot, motion.at(edge, time)
    joints = motion.joints_at(edge, time)
    step = np.hstack([np.zeros((len(q), 6)), np.diff(motion.joint_values, axis=0)[edge]])
    if not motion.mode.attitude_reacts:
        step[:, 3:6] = motion.turn
    v, a = step * pace[:, None], step * acceleration[:, None]
    to_base = np.swapaxes(rotations.matrix(q[:, 3:7]), 1, 2)
    if not motion.mode.floats:
        way = motion.base_steps()[edge]
        v[:, :3] = turned(to_base, way * pace[:, None])
        a[:, :3] = turned(to_base, way * acceleration[:, None])
    model, data = robot.model.copy(), robot.model.createData()
    model.gravity = pin.Motion.Zero()
    efforts = np.empty_like(v)
    stored = np.zeros((len(q), 3))
    for k in range(len(q)):
        if motion.mode.attitude_reacts:
            _react(model, data, q[k], v[k], a[k], slice(0 if motion.mode.floats else 3, 6))
        else:
            stored[k] = -to_base[k] @ pin.computeCentroidalMomentum(model, data, q[k], v[k]).angular
        if not motion.mode.floats:
            a[k, :3] -= np.cross(v[k, 3:6], v[k, :3])  # base axes turn with the base
        efforts[k] = pin.rnea(model, data, q[k], v[k], a[k])
    force, moment, torques = efforts[:, :3], efforts[:, 3:6], efforts[:, 6:]
    none = np.zeros((len(q), 3))
    thrust = none if motion.mode.floats else rotations.rotate(q[:, 3:7], force)
    wheels = (
        none
        if motion.mode.attitude_reacts
        else moment - cross(centers_of_mass(robot, joints), force)
    )
    parameters = (edge + time) / motion.edges
    return States(parameters, joints, q, v, a, thrust, wheels, stored, torques)


def _react(model: pin.Model, data: pin.Data, q: Array, v: Array, a: Array, base: slice) -> None:
    """Fill in what reacts of velocity and acceleration (nv,), which are zero there.

    In free flight thrusters carry no angular momentum, so the base's linear part does not matter.
    """
    matrix = np.array(pin.computeCentroidalMap(model, data, q))[base]
    v[base] = -np.linalg.solve(matrix[:, base], matrix @ v)
    change = np.array(pin.computeCentroidalMapTimeVariation(model, data, q, v))[base]
    a[base] = -np.linalg.solve(matrix[:, base], change @ v + matrix @ a)


__all__ = ["States", "states"]
