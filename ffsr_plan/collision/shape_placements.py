"""Placements of the collision shapes in the world."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.robots.kinematics import turned
from ffsr_plan.robots.robot import SpaceRobot


class Placements(NamedTuple):
    """K placements of the g collision shapes of a robot in the world.

    Attributes:
        frames: (K, g, 15) rotation (9, row by row; shape axes to world axes), position [m] and size
            [m] of each shape.
    """

    frames: Array

    @property
    def rotations(self) -> Array:
        """(K, g, 3, 3) rotations, shape axes to world axes."""
        return self.frames[..., :9].reshape(*self.frames.shape[:2], 3, 3)

    @property
    def positions(self) -> Array:
        """(K, g, 3) origins of the shapes in the world [m]."""
        return self.frames[..., 9:12]


def shape_placements(robot: SpaceRobot, configurations: Array) -> Placements:
    """Placements of all collision shapes.

    Args:
        robot: the robot.
        configurations: (K, nq).
    """
    poses = robot.tree.poses(robot.joint_values(configurations))
    shapes = robot.primitives
    base = rotations.matrix(configurations[:, 3:7])[:, None]
    links = base @ poses.rotations[:, shapes.links]
    origins = configurations[:, None, :3] + turned(base, poses.origins[:, shapes.links])
    count = links.shape[:2]
    parts = [
        (links @ shapes.rotations).reshape(*count, 9),
        origins + turned(links, shapes.positions),
        np.broadcast_to(shapes.sizes, (*count, 3)),
    ]
    frames = np.empty((*count, 15))  # in row-major order: kernels are compiled for each order
    return Placements(np.concatenate(parts, axis=2, out=frames))
