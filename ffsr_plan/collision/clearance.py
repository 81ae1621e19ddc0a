"""`clearance`: the least distance of a robot from the obstacles at one configuration."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.nearest_obstacle_kernels import nearest_pairs
from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.robots.shape_arrays import ROUND
from ffsr_plan.scene.scene import Scene


class Clearance(float):
    """A clearance [m], a float, with the pair of link and obstacle.

    Inside a cylinder or ellipsoid it is 0 at any depth, which is not known there, and an obstacle
    of another shape that is penetrated counts as nearer.

    The result of arithmetic, rounding or `min` with a float is a plain float without link and
    obstacle.

    Attributes:
        link: name of the nearest link; empty in an empty scene.
        obstacle: number of the nearest obstacle in the scene; None in an empty scene.
    """

    link: str
    obstacle: int | None

    def __new__(cls, distance: float, link: str, obstacle: int | None) -> Clearance:  # noqa: D102
        clearance = super().__new__(cls, distance)
        clearance.link, clearance.obstacle = link, obstacle
        return clearance

    def __repr__(self) -> str:
        if self.obstacle is None:
            return f"Clearance({float(self)} m, empty scene)"
        return f"Clearance({float(self)} m, link '{self.link}', obstacle {self.obstacle})"

    def __str__(self) -> str:
        return str(float(self))

    def __reduce__(self) -> tuple[type, tuple[float, str, int | None]]:
        return type(self), (float(self), self.link, self.obstacle)


def clearance(robot: SpaceRobot, scene: Scene, q: ArrayLike) -> Clearance:
    """Least distance from a link to an obstacle at one configuration, by Coal.

    For many configurations, `ObstacleQuery(robot, scene).distances` of
    `ffsr_plan.collision.distances` takes (N, nq) at once.

    Args:
        robot: the robot.
        scene: the obstacles.
        q: (nq,) configuration.

    Returns:
        The distance [m], negative in penetration and infinite in an empty scene; its attributes
        `link` and `obstacle` name the nearest pair. Inside a cylinder or ellipsoid the depth is not
        known and counts as 0, less what `scene.growth` adds: where another obstacle is penetrated
        too, that one is named.

    Raises:
        InvalidInput: not a robot, a scene or a configuration of that robot.
    """
    if not isinstance(robot, SpaceRobot):
        raise InvalidInput("robot", robot, "a SpaceRobot")
    if not isinstance(scene, Scene):
        raise InvalidInput("scene", scene, "a Scene")
    pair = ObstacleQuery(robot, scene).nearest(robot.check_configuration("q", q))
    obstacle = pair.obstacle if isinstance(pair.obstacle, int) else None
    return Clearance(pair.distance, pair.link, obstacle)


def point_distances(scene: Scene, points: Array) -> Array:
    """Signed distances of points from the nearest obstacle of those with closed forms.

    Args:
        scene: the obstacles; what has no closed form is left out.
        points: (n, 3) world [m].

    Returns:
        (n,) [m], not less than the distances from all obstacles; infinite without any.
    """
    known = scene.closed_form_part
    if not len(known):
        return np.full(len(points), np.inf)
    kinds, frames = frozen(np.array([ROUND])), np.zeros((1, 1, 15))
    frames[..., [0, 4, 8]] = 1.0  # a ball without extent
    return nearest_pairs(known.tree, kinds, frames, np.zeros(len(points), np.int64), points)[0]
