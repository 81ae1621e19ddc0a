"""The pose that is wanted of a frame, from arguments that are checked."""

from __future__ import annotations

from numpy.typing import ArrayLike

from ffsr_plan.core.checks import FARTHEST, finite_array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.rotations import from_angles, matrix
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.goal_poses.pose_error import PoseTarget
from ffsr_plan.robots.kinematics import frame_index
from ffsr_plan.robots.robot import SpaceRobot


def pose_target(
    robot: SpaceRobot,
    frame: str,
    position: ArrayLike,
    attitude: ArrayLike | None,
    *,
    start: ArrayLike,
    mode: Mode,
    base_position: ArrayLike | None = None,
    base_attitude: ArrayLike | None = None,
) -> PoseTarget:
    """The arguments of `inverse_kinematics`, checked.

    Raises:
        InvalidInput: an argument that is not allowed.
    """
    if not isinstance(robot, SpaceRobot):
        raise InvalidInput("robot", robot, "a SpaceRobot")
    if robot.nd == 0:
        raise InvalidInput("robot", robot.name, "a robot with joints")
    index = frame_index(robot.model, frame)
    if base_position is not None and mode.floats:
        raise InvalidInput(
            "base_position",
            base_position,
            "None in the mode free-floating: it follows from the arms",
        )
    if base_attitude is not None and mode.attitude_reacts:
        raise InvalidInput(
            "base_attitude", base_attitude, f"None in the mode {mode}: it follows from the arms"
        )
    begin = robot.check_configuration("start", start)
    end = begin[:3] if base_position is None else base_position
    held = begin[3:7]
    if base_attitude is not None:
        held = from_angles(finite_array("base_attitude", base_attitude, (3,)))
    rotation = None
    if attitude is not None:
        rotation = matrix(from_angles(finite_array("attitude", attitude, (3,))))
    return PoseTarget(
        robot,
        index,
        finite_array("position", position, (3,), FARTHEST),
        rotation,
        mode,
        begin,
        finite_array("base_position", end, (3,), FARTHEST),
        held,
    )
