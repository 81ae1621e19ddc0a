"""The window: where the base may be on a way without a lattice."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.checks import FARTHEST, finite_array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import Rule
from ffsr_plan.robots.robot import SpaceRobot

_PARALLEL = (
    1e-9  # sine of an angle, or metres, up to which an axis counts as parallel or a way flat
)


@dataclass(frozen=True)
class Window(Rule):
    """Least and greatest coordinates of the base, or None."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> Array | None:
        """See `Rule.check`."""
        if value is None:
            return None
        try:
            window = finite_array(what, value, (2, 3), FARTHEST)  # type: ignore[arg-type]
        except InvalidInput as error:
            allowed = f"(low, high) of three coordinates each; {error.allowed}"
            raise InvalidInput(error.what, error.value, allowed) from None
        if np.any(window[0] > window[1]):
            raise InvalidInput(what, window.tolist(), "no low coordinate above the high one")
        return window

    def json_schema(self) -> dict[str, Any]:
        """See `Rule.json_schema`."""
        corner = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
        return {"type": "array", "items": corner, "minItems": 2, "maxItems": 2}


def default_window(robot: SpaceRobot, start: Array, goal: Array) -> Array:
    """The box around start and goal, grown by half their distance and the robot's reach.

    Args:
        robot: the robot.
        start: (nq,) start.
        goal: (3,) base origin at the goal, world [m].

    Returns:
        (2, 3) least and greatest coordinates [m].
    """
    ends = np.stack([start[:3], goal])
    room = 0.5 * float(np.linalg.norm(ends[1] - ends[0])) + reach(robot)
    window = np.stack([ends.min(axis=0) - room, ends.max(axis=0) + room])
    normal = plane_of_joints(robot, start[3:7])
    if normal is not None and abs(ends[1, normal] - ends[0, normal]) <= _PARALLEL:
        window[:, normal] = ends[:, normal].min(), ends[:, normal].max()
    return frozen(window)


def plane_of_joints(robot: SpaceRobot, attitude: Array) -> int | None:
    """The axis of the world that all joint axes are parallel to, as its number; None without one.

    Args:
        robot: the robot.
        attitude: (4,) of the base.
    """
    poses = robot.tree.poses(np.zeros((1, robot.nd)))
    axes = (poses.rotations[0] @ robot.tree.axes[..., None])[1:, :, 0]
    axes = np.abs(rotations.rotate(np.broadcast_to(attitude, (len(axes), 4)), axes))
    for normal in range(3):
        along = np.where(
            robot.prismatic, np.sqrt(np.maximum(1.0 - axes[:, normal] ** 2, 0.0)), axes[:, normal]
        )
        if len(axes) and np.all(along >= 1.0 - _PARALLEL):
            return normal
    return None


def reach(robot: SpaceRobot) -> float:
    """A bound on the distance of any point of the robot from the base origin [m].

    A prismatic joint counts by its limits; the spheres around the shapes count, not the shapes.
    """
    tree, shapes = robot.tree, robot.primitives
    steps = np.linalg.norm(tree.offsets(np.zeros((1, robot.nd)))[0], axis=1)
    slides = np.where(robot.prismatic, np.maximum(np.abs(robot.lower), np.abs(robot.upper)), 0.0)
    steps[1:] += slides
    farthest = np.zeros(len(steps))
    for link in range(1, len(steps)):
        farthest[link] = farthest[tree.parents[link]] + steps[link]
    sizes = np.linalg.norm(shapes.positions, axis=1) + np.linalg.norm(shapes.sizes, axis=1)
    return float(np.max(farthest[shapes.links] + sizes, initial=float(farthest.max())))
