"""Summaries of robots: joints, mass, a bound on the reach, postures."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np

from ffsr_plan.robots.loading import load_robot, robot_names
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.robots.shape_arrays import BOX


class RobotSummary(NamedTuple):
    """A robot in a few words and numbers.

    Attributes:
        name: name of the robot.
        mass: mass of all bodies [kg].
        reach_bound: upper bound on the reach of the arms [m]; see `reach_bound`.
        joint_names: names of the joints.
        postures: names of the postures of its SRDF.
        unchecked_links: see `SpaceRobot.unchecked_links`.
    """

    name: str
    mass: float
    reach_bound: float
    joint_names: tuple[str, ...]
    postures: tuple[str, ...]
    unchecked_links: tuple[str, ...]


def robot_summaries() -> list[RobotSummary]:
    """Summaries of the bundled robots, sorted by name."""
    return [summary(load_robot(name)) for name in robot_names()]


def summary(robot: SpaceRobot) -> RobotSummary:
    """Summary of a robot.

    Args:
        robot: any robot.
    """
    bound = reach_bound(robot)
    return RobotSummary(
        robot.name,
        robot.mass,
        bound,
        robot.joint_names,
        tuple(robot.postures),
        robot.unchecked_links,
    )


def reach_bound(robot: SpaceRobot) -> float:
    """Upper bound on the distance from the base origin to any point of the arms' shapes.

    It is the sum of the link lengths from the base to the shape, prismatic joints at their limits,
    and the size of the shape. Joint limits of revolute joints are ignored; an arm that can stretch
    out attains the bound.

    Args:
        robot: any robot.

    Returns:
        The bound [m]; 0 for a robot without arms.
    """
    tree, shapes = robot.tree, robot.primitives
    extremes = np.where(robot.prismatic, [robot.lower, robot.upper], 0.0)
    lengths = np.linalg.norm(tree.offsets(extremes), axis=2).max(axis=0)
    origins = np.zeros(len(lengths))
    for level in tree.levels:
        origins[level] = origins[tree.parents[level]] + lengths[level]
    is_box = (shapes.kinds == BOX)[:, None]
    half = np.where(is_box, shapes.sizes, shapes.sizes[:, [2, 2, 1]])  # round: axis of the capsule
    signs = np.array(list(product((-1.0, 1.0), repeat=3)))
    corners = shapes.positions[:, None] + (half[:, None] * signs) @ shapes.rotations.mT
    radii = np.where(is_box[:, 0], 0.0, shapes.sizes[:, 0])
    bounds = origins[shapes.links] + np.linalg.norm(corners, axis=2).max(axis=1) + radii
    return float(bounds[shapes.links > 0].max(initial=0.0))
