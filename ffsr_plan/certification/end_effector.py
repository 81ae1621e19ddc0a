"""Where a frame of the robot goes, and how far from where a base at rest would take it."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import one_of
from ffsr_plan.robots.robot import SpaceRobot


def checked_frame(robot: SpaceRobot, frame: object) -> str:
    """Name of a frame: the given one, or the link with the most joints before it, the last such.

    Args:
        robot: the robot.
        frame: a name, or None.

    Raises:
        InvalidInput: no such frame; the nearest name is suggested.
    """
    model = robot.model
    if frame is not None:
        return one_of("frame", frame, [each.name for each in model.frames])
    links = [each for each in model.frames if each.type == pin.FrameType.BODY]
    deepest = max(range(len(links)), key=lambda k: (len(model.supports[links[k].parentJoint]), k))
    return str(links[deepest].name)


def frame_positions(robot: SpaceRobot, frame: str, configurations: Array) -> Array:
    """(N, 3) origins of a frame in the world at configurations (N, nq) [m]."""
    data, number = robot.model.createData(), robot.model.getFrameId(frame)
    found = np.empty((len(configurations), 3))
    for k, q in enumerate(configurations):
        pin.forwardKinematics(robot.model, data, q)
        found[k] = pin.updateFramePlacement(robot.model, data, number).translation
    return found


def drifts(robot: SpaceRobot, frame: str, configurations: Array) -> Array:
    """How far a frame is from where it would be with the base as in the first configuration.

    Args:
        robot: the robot.
        frame: its name.
        configurations: (N, nq).

    Returns:
        (N,) distances [m].
    """
    held = np.array(configurations)
    held[:, :7] = configurations[0, :7]
    apart = frame_positions(robot, frame, configurations) - frame_positions(robot, frame, held)
    return np.asarray(np.linalg.norm(apart, axis=1))
