"""Momentum conservation: motion of the base caused by motion of the arms.

The centroidal momentum matrix A_g(q) = [A_b A_theta] (6 x nv; linear rows, then angular about the
centre of mass, world axes) maps velocities to momentum. Zero momentum determines the base.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.rotations import IDENTITY, angle_rate_matrix, to_angles
from ffsr_plan.robots.kinematics import frame_index, turned
from ffsr_plan.robots.robot import SpaceRobot


def connection(robot: SpaceRobot, q: ArrayLike) -> Array:
    """The mechanical connection A(theta), (3, nd).

    At zero angular momentum the angular velocity of the base is omega = A theta' [rad/s, base
    frame], whatever force acts through the centre of mass. A depends on the joints alone, not on
    the base pose.

    Args:
        robot: the robot.
        q: (nq,) configuration.

    Returns:
        (3, nd) matrix A(theta).

    Raises:
        InvalidInput: a configuration that the robot does not have.
    """
    q = _configuration(robot, q)
    return connections(robot, robot.joint_values(q)[None])[0]


def connections(robot: SpaceRobot, joint_values: Array) -> Array:
    """The mechanical connection at many joint values at once.

    Args:
        robot: the robot.
        joint_values: (N, nd) [rad or m]; not checked.

    Returns:
        (N, 3, nd) matrices A(theta).
    """
    if robot.nd == 0:
        return np.zeros((len(joint_values), 3, 0))
    return connections_of(angular_maps(robot, joint_values))


def connections_of(angular: Array) -> Array:
    """The mechanical connection from the maps to angular momentum.

    Args:
        angular: (N, 3, 3 + nd) see `angular_maps`.

    Returns:
        (N, 3, nd) matrices A(theta).
    """
    return np.asarray(-np.linalg.solve(angular[:, :, :3], angular[:, :, 3:]), dtype=np.float64)


def angular_maps(robot: SpaceRobot, joint_values: Array) -> Array:
    """Maps from base angular velocity and joint rates to angular momentum.

    Args:
        robot: the robot.
        joint_values: (N, nd) [rad or m]; not checked.

    Returns:
        (N, 3, 3 + nd) maps from (3,) angular velocity and (nd,) joint rates, to the angular
        momentum about the centre of mass, in base axes.
    """
    data = robot.model.createData()
    configurations = robot.assemble(np.zeros(3), IDENTITY, joint_values)
    angular = np.empty((len(joint_values), 3, robot.model.nv - 3))
    for k, q in enumerate(configurations):
        pin.computeCentroidalMap(robot.model, data, q)
        angular[k] = data.Ag[3:, 3:]  # the columns of the base's linear velocity are zero
    return angular


def centers_of_mass(robot: SpaceRobot, joint_values: Array) -> Array:
    """Centre of mass of the whole robot relative to the base origin.

    Args:
        robot: the robot.
        joint_values: (N, nd) [rad or m]; not checked.

    Returns:
        (N, 3) in base axes [m].
    """
    bodies = list(robot.model.inertias)[1:]
    masses = np.array([body.mass for body in bodies])
    levers = np.array([body.lever for body in bodies])
    poses = robot.tree.poses(joint_values)
    centers = poses.origins + turned(poses.rotations, levers)
    return np.einsum("b,kbi->ki", masses / masses.sum(), centers)


def attitude_rate_map(robot: SpaceRobot, q: ArrayLike) -> Array:
    """G of Eq. 1, (3, nd): (alpha', beta', gamma') = G theta'.

    G = E(Theta)^-1 A(theta), with E from `rotations.angle_rate_matrix`.

    Args:
        robot: the robot.
        q: (nq,) configuration.

    Returns:
        (3, nd) matrix G.

    Raises:
        InvalidInput: beta = +-90 degrees, where the ZYX angles are singular.
    """
    q = _configuration(robot, q)
    rates = np.linalg.solve(angle_rate_matrix(to_angles(q[3:7])), connection(robot, q))
    return np.asarray(rates, dtype=np.float64)


def generalized_jacobian(robot: SpaceRobot, q: ArrayLike, frame: str) -> Array:
    """Generalized Jacobian J* of a frame, (6, nd), free-floating (Umetani and Yoshida 1989).

    J* = J_theta - J_b A_b^-1 A_theta: the frame's velocity at zero linear and angular momentum is
    J* theta'. Rows: linear [m/s], then angular [rad/s], in world axes at the frame's origin
    (LOCAL_WORLD_ALIGNED).

    Args:
        robot: the robot.
        q: (nq,) configuration.
        frame: name of a link, joint or other frame of the model; the link of several of one name.

    Returns:
        (6, nd) matrix J*.

    Raises:
        InvalidInput: unknown frame, with the nearest name.
    """
    q = _configuration(robot, q)
    model = robot.model
    index = frame_index(robot.model, frame)
    data = model.createData()
    pin.computeCentroidalMap(model, data, q)
    momentum_map = np.array(data.Ag)
    jacobian = pin.computeFrameJacobian(model, data, q, index, pin.LOCAL_WORLD_ALIGNED)
    base_rate = np.linalg.solve(momentum_map[:, :6], momentum_map[:, 6:])
    return jacobian[:, 6:] - jacobian[:, :6] @ base_rate


def _configuration(robot: SpaceRobot, q: ArrayLike) -> Array:
    """(nq,) a configuration that the robot has."""
    if not isinstance(robot, SpaceRobot):
        raise InvalidInput("robot", robot, "a SpaceRobot")
    return robot.check_configuration("q", q)
