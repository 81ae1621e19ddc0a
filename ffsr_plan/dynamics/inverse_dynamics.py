"""Inverse dynamics: forces of thrusters, wheels and joints along a motion with a time law.

A motion and its pace, sigma' and sigma'' for the time sigma on an edge, give velocities and
accelerations. Those of a base that reacts follow from h = A_b v_b + A_theta theta' = 0 and from its
derivative, where A = [A_b A_theta] is the centroidal momentum matrix, restricted to the rows and
columns of the reacting velocities:

    v_b = -A_b^-1 A_theta theta'        v_b' = -A_b^-1 (A' v + A_theta theta'')

The recursive Newton-Euler algorithm without gravity then gives the joint torques, and the force and
moment on the base. In free flight all of them are quadratic in the pace: the same motion flown k
times as slowly needs 1 / k^2 of every force (Hollerbach 1984).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, IntArray, equal_by_content
from ffsr_plan.core.rotations import cross
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.robots.kinematics import turned


@equal_by_content
class States(NamedTuple):
    """Position, velocity, acceleration and forces of a motion at N instants.

    `configurations`, `velocities` and `accelerations` follow Pinocchio: the base velocity is linear
    [m/s], then angular [rad/s], both in base axes, and the base acceleration is the derivative of
    these six numbers. For the base in world axes see `base_velocity` and `base_acceleration`.

    Attributes:
        parameters: (N,) path parameters s in [0, 1], as in `Plan.at`.
        joints: (N, nd) joint values [rad or m], continuous joints without a jump at half a turn.
        configurations: (N, nq) configurations.
        velocities: (N, nv) base velocity (6, base axes), then joint velocities [rad/s or m/s].
        accelerations: (N, nv) derivative of `velocities`.
        thrust: (N, 3) force of the thrusters through the centre of mass, world axes [N].
        wheel_torque: (N, 3) moment of the wheels on the base, base axes [N m]; zero without wheels.
        wheel_momentum: (N, 3) momentum of the wheels, base axes [N m s]; zero without wheels.
        torques: (N, nd) joint torques without friction [N m, or N if prismatic].
    """

    parameters: Array
    joints: Array
    configurations: Array
    velocities: Array
    accelerations: Array
    thrust: Array
    wheel_torque: Array
    wheel_momentum: Array
    torques: Array

    def __repr__(self) -> str:
        count, joints = self.joints.shape
        return f"States({count} instants, {joints} joints)"

    @property
    def attitudes(self) -> Array:
        """(N, 4) attitude of the base, base axes to world axes (xyzw)."""
        return self.configurations[:, 3:7]

    @property
    def joint_velocities(self) -> Array:
        """(N, nd) joint velocities [rad/s or m/s]."""
        return self.velocities[:, 6:]

    @property
    def base_velocity(self) -> Array:
        """(N, 3) velocity of the base origin, world axes [m/s]."""
        return rotations.rotate(self.attitudes, self.velocities[:, :3])

    @property
    def base_acceleration(self) -> Array:
        """(N, 3) acceleration of the base origin, world axes [m/s^2]."""
        v = self.velocities
        along = self.accelerations[:, :3] + cross(v[:, 3:6], v[:, :3])
        return rotations.rotate(self.attitudes, along)


def states(
    motion: Motion,
    edge: IntArray,
    time: Array,
    pace: Array,
    acceleration: Array,
    push: Array | None = None,
) -> States:
    """The states of a motion at N instants, given its pace.

    Args:
        motion: the motion.
        edge: (N,) edges.
        time: (N,) times sigma on the edges, in [0, 1].
        pace: (N,) sigma' [1/s].
        acceleration: (N,) sigma'' [1/s^2].
        push: (N, 3) further acceleration of the base by thrusters, world axes [m/s^2], or None.

    Returns:
        The states, forces included.
    """
    q, joints = motion.at(edge, time), motion.joints_at(edge, time)
    to_base = np.swapaxes(rotations.matrix(q[:, 3:7]), 1, 2)
    v, a = _prescribed(motion, edge, to_base, pace, acceleration)
    if push is not None:
        a[:, :3] += turned(to_base, push)
    efforts, stored = _efforts(motion, q, v, a, to_base)
    force, moment, torques = efforts[:, :3], efforts[:, 3:6], efforts[:, 6:]
    thrust = wheel_torque = np.zeros((len(q), 3))
    if motion.mode.has_thrusters:
        thrust = rotations.rotate(q[:, 3:7], force)
    if motion.mode.has_wheels:
        wheel_torque = moment - cross(centers_of_mass(motion.robot, joints), force)
    parameters = (edge + time) / motion.edges
    return States(parameters, joints, q, v, a, thrust, wheel_torque, stored, torques)


def _prescribed(
    motion: Motion, edge: IntArray, to_base: Array, pace: Array, acceleration: Array
) -> tuple[Array, Array]:
    """(N, nv) velocities and accelerations, zero where the base reacts."""
    step = np.hstack([np.zeros((len(edge), 6)), np.diff(motion.joint_values, axis=0)[edge]])
    if motion.mode.has_wheels:
        step[:, 3:6] = motion.turns[edge]
    v, a = step * pace[:, None], step * acceleration[:, None]
    if motion.mode.has_thrusters:
        base_step = motion.base_steps()[edge]
        v[:, :3] = turned(to_base, base_step * pace[:, None])
        a[:, :3] = turned(to_base, base_step * acceleration[:, None])
    return v, a


def _efforts(motion: Motion, q: Array, v: Array, a: Array, to_base: Array) -> tuple[Array, Array]:
    """(N, nv) forces by the Newton-Euler algorithm and (N, 3) wheel momentum in base axes.

    The velocities and accelerations `v`, `a` (N, nv) of a reacting base are filled in.
    """
    mode = motion.mode
    model, data = motion.robot.model.copy(), motion.robot.model.createData()
    model.gravity = pin.Motion.Zero()
    efforts = np.empty_like(v)
    stored = np.zeros((len(q), 3))
    for k in range(len(q)):
        if mode.attitude_reacts:
            _react(model, data, q[k], v[k], a[k], slice(0 if mode.floats else 3, 6))
        else:
            stored[k] = -to_base[k] @ pin.computeCentroidalMomentum(model, data, q[k], v[k]).angular
        if mode.has_thrusters:
            a[k, :3] -= np.cross(v[k, 3:6], v[k, :3])  # base axes rotate with the base
        efforts[k] = pin.rnea(model, data, q[k], v[k], a[k])
    return efforts, stored


def _react(model: pin.Model, data: pin.Data, q: Array, v: Array, a: Array, base: slice) -> None:
    """Fill in the reacting part `base` of velocity and acceleration (nv,), which is zero before.

    The base's linear velocity does not contribute to the angular momentum.
    """
    matrix = np.array(pin.computeCentroidalMap(model, data, q))[base]
    v[base] = -np.linalg.solve(matrix[:, base], matrix @ v)
    change = np.array(pin.computeCentroidalMapTimeVariation(model, data, q, v))[base]
    a[base] = -np.linalg.solve(matrix[:, base], change @ v + matrix @ a)


__all__ = ["States", "states"]
