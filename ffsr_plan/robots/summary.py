"""What the robots at hand are like: joints, mass, reach, postures."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.robots.robot import SpaceRobot, load_robot, robot_names
from ffsr_plan.robots.shape_arrays import BOX

_STARTS, _CLIMBS, _STEPS = 256, 4, 33
_WINDOWS = np.array([[1.0], [1.0], [0.1], [0.1], [0.01], [0.01]])
"""Share of a joint's range that is searched to either side, sweep by sweep."""


class RobotSummary(NamedTuple):
    """A robot in a few words and numbers."""

    name: str
    mass: float
    """[kg], of all bodies."""
    reach: float
    """[m]; see `reach_of`."""
    joint_names: tuple[str, ...]
    postures: tuple[str, ...]
    """Named postures of its SRDF."""


def robot_summaries() -> list[RobotSummary]:
    """The bundled robots, by name."""
    return [summary(load_robot(name)) for name in robot_names()]


def summary(robot: SpaceRobot) -> RobotSummary:
    """The summary of any robot."""
    mass = float(sum(body.mass for body in robot.model.inertias))
    return RobotSummary(robot.name, mass, reach_of(robot), robot.joint_names, tuple(robot.postures))


def reach_of(robot: SpaceRobot) -> float:
    """How far from the base origin a shape on the arms can get [m]; 0 without arms.

    The most that a search over the joint limits finds, joint by joint, from a few random starts of
    a fixed seed. Whether the robot gets in its own way is not asked.
    """
    low = np.where(np.isfinite(robot.lower), robot.lower, -np.pi)
    high = np.where(np.isfinite(robot.upper), robot.upper, np.pi)
    starts = np.random.default_rng(0).uniform(low, high, (_STARTS, robot.nd))
    best = starts[np.argsort(-_extents(robot, starts), kind="stable")[:_CLIMBS]]
    for window in _WINDOWS * (high - low):
        for joint in range(robot.nd):
            steps = np.zeros((_STEPS, 1, robot.nd))
            steps[:, 0, joint] = window[joint] * np.linspace(-1.0, 1.0, _STEPS)
            tried = np.clip(best + steps, low, high)
            found = _extents(robot, tried.reshape(-1, robot.nd)).reshape(_STEPS, -1)
            best = tried[found.argmax(axis=0), np.arange(len(best))]
    return float(_extents(robot, best).max())


def _extents(robot: SpaceRobot, joint_values: Array) -> Array:
    """(K,) farthest from the base origin of any point of the arms' shapes [m]."""
    shapes = robot.primitives
    signs = np.array(list(product((-1.0, 1.0), repeat=3)))
    boxes = (shapes.kinds == BOX)[:, None]
    half = np.where(boxes, shapes.sizes, shapes.sizes[:, [2, 2, 1]])  # of round ones, the axis
    corners = shapes.positions[:, None] + (half[:, None] * signs) @ shapes.rotations.mT
    poses = robot.tree.poses(joint_values)
    far = np.zeros(len(joint_values))
    for link, points, around in zip(
        shapes.links, corners, np.where(boxes[:, 0], 0.0, shapes.sizes[:, 0]), strict=True
    ):
        if link > 0:
            placed = points @ poses.rotations[:, link].mT + poses.origins[:, link, None]
            far = np.maximum(far, np.linalg.norm(placed, axis=2).max(axis=1) + around)
    return far
