"""Distances of configurations to all obstacles, each where they are at its time."""

from __future__ import annotations

import numpy as np

from ffsr_plan.collision.body_distances import BodyDistances
from ffsr_plan.collision.debris.debris_distances import DebrisDistances
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.core.arrays import Array
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene


def distances_in_time(robot: SpaceRobot, scene: Scene, q: Array, times: Array) -> Array:
    """Least distances of configurations to all obstacles.

    Args:
        robot: the robot.
        scene: the obstacles.
        q: (n, nq) configurations.
        times: (n,) [s].

    Returns:
        (n,) distances [m].
    """
    found = ObstacleQuery(robot, scene.at_rest).distances(q)
    placed, rows, still = shape_placements(robot, q), np.arange(len(q)), np.zeros((len(q), 3))
    for body, at_rest in zip(scene.bodies, scene.body_scenes, strict=True):
        query = ObstacleQuery(robot, at_rest)
        found = BodyDistances(robot, query, placed, body.poses(times)).least(rows, still, found)
    if scene.debris:
        debris = DebrisDistances(robot, scene, float(np.median(times)))
        found = debris.least(placed, rows, still, times, np.zeros(len(q)), found)
    return found
