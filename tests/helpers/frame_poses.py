"""Poses of frames, and goals that a random robot can reach."""

import numpy as np
import pinocchio as pin

from ffsr_plan.core.rotations import to_angles
from ffsr_plan.dynamics.motion import Motion
from tests.helpers.urdf_builders import random_configuration, random_robot


def pose_of(robot, q, frame):
    """Position (3,) and rotation (3, 3) of a frame by Pinocchio's forward kinematics."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    placed = data.oMf[robot.model.getFrameId(frame)]
    return np.array(placed.translation), np.array(placed.rotation)


def angles_of(rotation):
    return to_angles(pin.Quaternion(rotation).coeffs())


def some_goal(seed, mode):
    """A robot, a pose that it can reach, and where its base is taken meanwhile."""
    robot, rng = random_robot(seed, depth=4), np.random.default_rng(seed)
    start, goal = (random_configuration(robot, rng) for _ in range(2))
    end = Motion(robot, mode, start, goal, np.array([start[:3], goal[:3]])).configurations()[-1]
    frame = robot.model.frames[robot.model.nframes - 1].name
    base = {} if mode == "free-floating" else {"base_position": goal[:3]}
    if mode == "attitude-held":
        base["base_attitude"] = to_angles(goal[3:7])
    return robot, start, frame, pose_of(robot, end, frame), {"mode": mode, **base}
