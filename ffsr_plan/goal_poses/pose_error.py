"""Pose error of a frame at the end of a straight joint path, and its Jacobian.

The joints move steadily from start to goal and the base reacts. The base pose at the end, and with
it the pose of an end effector, therefore depends on the whole joint path and not on the goal's
joint values alone. With theta the joint values at the end and D the rotation of the base at the end
of the path for each unit of change of theta (base axes), the pose changes by

    J = J_mode + [-[r]x; 1] R (D - A)

J_mode is the Jacobian of a robot that moves on from the end: the generalized Jacobian in the mode
free-floating, the ordinary one where wheels hold the base, and in the mode free-flying the ordinary
one plus the rotation of the base by A (`momentum.connection`). The second term is the contribution
of the path, a rotation about the centre of mass where the base floats and about the base's origin
where thrusters translate it; r leads from there to the end effector. It is the holonomy of the thin
triangle between two joint paths.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.rotations import inverse, log, matrix, multiply
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.momentum import connection, generalized_jacobian
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.robots.robot import SpaceRobot

_JOINT_STEP = 1e-6  # [rad or m] of the finite differences for D


class PoseTarget(NamedTuple):
    """A frame, its wanted pose, and the motion that has to end with it.

    Attributes:
        robot: the robot.
        frame: index of the frame in the robot's model.
        position: (3,) wanted for the frame's origin, world [m].
        rotation: (3, 3) wanted rotation from frame to world axes, or None if any is accepted.
        mode: what actuates the base.
        start: (nq,) configuration at the beginning.
        base_position: (3,) prescribed base origin at the end, world [m].
        base_quat: (4,) prescribed base attitude at the end, xyzw.
    """

    robot: SpaceRobot
    frame: int
    position: Array
    rotation: Array | None
    mode: Mode
    start: Array
    base_position: Array
    base_quat: Array


def end_configuration(target: PoseTarget, joint_values: Array) -> Array:
    """(nq,) end of the straight joint path from the start, base reaction included.

    Args:
        target: gives the robot, the mode and the start.
        joint_values: (nd,) at the end [rad or m], clipped to the joint limits.
    """
    robot = target.robot
    within = np.clip(joint_values, robot.lower, robot.upper)
    goal = robot.assemble(target.base_position, target.base_quat, within)
    base_positions = np.array([target.start[:3], target.base_position])
    motion = Motion(robot, target.mode, target.start, goal, base_positions)
    return motion.configurations()[-1]


def end_of_path(target: PoseTarget, begin: Array, change: Array) -> Array:
    """Like `end_configuration`, of a path on which a continuous joint may go the longer way.

    Args:
        target: gives the robot, the mode and the start.
        begin: (nd,) joint values at the start [rad or m].
        change: (nd,) of the joint values over the path [rad or m].
    """
    robot = target.robot
    if not np.isinf(robot.upper).any():
        return end_configuration(target, begin + change)
    ends = np.clip(np.array([begin, begin + change]), robot.lower, robot.upper)
    goal = robot.assemble(target.base_position, target.base_quat, ends[1])
    base_positions = np.array([target.start[:3], target.base_position])
    motion = Motion(robot, target.mode, target.start, goal, base_positions, ends)
    return motion.configurations()[-1]


def pose_error(target: PoseTarget, q: Array) -> Array:
    """(3,) position error [m], or (6,) with the rotation vector [rad] too, world axes.

    Args:
        target: gives the frame and its wanted pose.
        q: (nq,) configuration.
    """
    pose = _frame_pose(target, q)
    position_error = pose.translation - target.position
    if target.rotation is None:
        return position_error
    return np.concatenate([position_error, pin.log3(pose.rotation @ target.rotation.T)])


def pose_jacobian(target: PoseTarget, begin: Array, change: Array, q: Array) -> Array:
    """Derivative of `pose_error` at the end of the path by the joint values there.

    Args:
        target: gives the frame, its wanted pose and the mode.
        begin: (nd,) joint values at the start [rad or m].
        change: (nd,) of the joint values over the path [rad or m].
        q: (nq,) configuration at its end, by `end_of_path`.

    Returns:
        (3, nd) or (6, nd), J of the module's docstring.
    """
    robot = target.robot
    model, data, pose = robot.model, robot.model.createData(), _frame_pose(target, q)
    if target.mode.floats:
        jacobian = generalized_jacobian(robot, q, model.frames[target.frame].name)
    else:
        whole = pin.computeFrameJacobian(model, data, q, target.frame, pin.LOCAL_WORLD_ALIGNED)
        jacobian = np.array(whole[:, 6:])
        if target.mode is Mode.FREE_FLYING:
            jacobian += whole[:, 3:6] @ connection(robot, q)
    if target.mode.attitude_reacts:
        floats = target.mode.floats
        lever = pose.translation - (pin.centerOfMass(model, data, q) if floats else q[:3])
        beyond = _base_rotation_derivative(robot, begin, change) - connection(robot, q)
        rotation = matrix(q[3:7]) @ beyond
        jacobian += np.vstack([-pin.skew(lever) @ rotation, rotation])
    return _of_error(target, pose, jacobian)


def held_jacobian(target: PoseTarget, q: Array) -> Array:
    """Derivative of `pose_error` by the joint values on a base that does not move.

    Args:
        target: gives the frame and its wanted pose.
        q: (nq,) configuration, of which joint limits need not hold.

    Returns:
        (3, nd) or (6, nd).
    """
    model = target.robot.model
    data, axes = model.createData(), pin.LOCAL_WORLD_ALIGNED
    whole = pin.computeFrameJacobian(model, data, q, target.frame, axes)
    return _of_error(target, _frame_pose(target, q), np.array(whole[:, 6:]))


def _of_error(target: PoseTarget, pose: pin.SE3, jacobian: Array) -> Array:
    """A Jacobian (6, nd) of the frame's velocity as that of the pose error."""
    if target.rotation is None:
        return jacobian[:3]
    # from angular velocity to the rate of the rotation vector
    jacobian[3:] = pin.Jlog3(pose.rotation @ target.rotation.T).T @ jacobian[3:]
    return jacobian


def _frame_pose(target: PoseTarget, q: Array) -> pin.SE3:
    model = target.robot.model
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    return pin.updateFramePlacement(model, data, target.frame)


def _base_rotation_derivative(robot: SpaceRobot, begin: Array, change: Array) -> Array:
    """D, (3, nd): rotation at the end of the path, in its base axes, per unit of joint change."""
    steps = change + _JOINT_STEP * np.vstack([np.zeros(robot.nd), np.eye(robot.nd)])
    begins = np.tile(begin, (len(steps), 1))
    ends = Reaction(robot, begins, steps, inside=False).increments
    return log(multiply(inverse(ends[:1]), ends[1:])).T / _JOINT_STEP
