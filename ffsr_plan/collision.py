"""Exact distances by Coal: link to sphere (Eqs. 7 and 9) and link to link."""

from __future__ import annotations

from typing import NamedTuple

import coal
import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from ffsr_plan.errors import InvalidInput
from ffsr_plan.inputs import Array
from ffsr_plan.robot import SpaceRobot
from ffsr_plan.scene import Scene


class Nearest(NamedTuple):
    """The nearest pair of a configuration."""

    distance: float
    """[m], negative in penetration."""
    link: str
    other: int | str
    """Index of the sphere, or name of the other link."""


class DistanceQuery:
    """Least distance over the pairs of a geometry model. Holds scratch data: one per thread.

    Attributes:
        count: configurations evaluated so far.
    """

    def __init__(
        self, robot: SpaceRobot, geometry: pin.GeometryModel, others: list[int | str]
    ) -> None:
        """`others[g]` is what geometry object g is called as the second of a pair."""
        self._robot = robot
        self._model = robot.model
        self._data = robot.model.createData()
        self._geometry = geometry
        self._geometry_data = geometry.createData()  # after the last pair: older data would crash
        self._others = others
        self.empty = len(geometry.collisionPairs) == 0
        self.count = 0

    def distance(self, q: Array) -> float:
        """Least distance [m] at `q` (nq,); infinite without pairs."""
        return self._evaluate(q)[0]

    def nearest(self, q: Array) -> Nearest:
        """The nearest pair at `q` (nq,)."""
        distance, pair = self._evaluate(q)
        if self.empty:
            return Nearest(distance, "", "")
        ends = self._geometry.collisionPairs[pair]
        link = self._robot.link_of(self._geometry.geometryObjects[ends.first])
        return Nearest(distance, link, self._others[ends.second])

    def distances(self, configurations: Array) -> Array:
        """(N,) least distances at (N, nq)."""
        if self.empty:
            return np.full(len(configurations), np.inf)
        self.count += len(configurations)
        model, data = self._model, self._data
        geometry, geometry_data = self._geometry, self._geometry_data
        compute, results = pin.computeDistances, geometry_data.distanceResults
        return np.array(
            [
                results[compute(model, data, geometry, geometry_data, q)].min_distance
                for q in configurations
            ]
        )

    def _evaluate(self, q: Array) -> tuple[float, int]:
        if self.empty:
            return np.inf, -1
        self.count += 1
        data = self._geometry_data
        pair = pin.computeDistances(self._model, self._data, self._geometry, data, q)
        return data.distanceResults[pair].min_distance, pair


def obstacle_query(robot: SpaceRobot, scene: Scene) -> DistanceQuery:
    """Distances of every link to every sphere."""
    geometry = pin.GeometryModel()
    links = [geometry.addGeometryObject(g) for g in robot.collision_model.geometryObjects]
    others: list[int | str] = [robot.link_of(g) for g in robot.collision_model.geometryObjects]
    for k, (center, radius) in enumerate(zip(scene.centers, scene.radii, strict=True)):
        placement = pin.SE3(np.eye(3), center)
        sphere = pin.GeometryObject(f"obstacle_{k}", 0, placement, coal.Sphere(float(radius)))
        index = geometry.addGeometryObject(sphere)
        others.append(k)
        for link in links:
            geometry.addCollisionPair(pin.CollisionPair(link, index))
    return DistanceQuery(robot, geometry, others)


def self_query(robot: SpaceRobot) -> DistanceQuery:
    """Distances between the links that are not adjacent; they depend on the joints alone."""
    others: list[int | str] = [robot.link_of(g) for g in robot.collision_model.geometryObjects]
    return DistanceQuery(robot, robot.collision_model, others)


def clearance(robot: SpaceRobot, scene: Scene, q: ArrayLike) -> float:
    """Least link-to-sphere distance [m] of one configuration `q` (nq,), by Coal.

    Negative in penetration, infinite in an empty scene. For many configurations of one scene, use
    `obstacle_query(robot, scene).distances(...)`, which sets the scene up once.
    """
    if not isinstance(robot, SpaceRobot):
        raise InvalidInput("robot", robot, "a SpaceRobot")
    if not isinstance(scene, Scene):
        raise InvalidInput("scene", scene, "a Scene")
    return obstacle_query(robot, scene).distance(robot.check_configuration("q", q))
