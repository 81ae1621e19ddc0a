"""Exact distances by Coal: link to sphere (Eqs. 7 and 9) and link to link.

A tree over the spheres finds the nearest pair of link and obstacle, Coal measures it. No structure
holds all pairs, so that ten thousand spheres cost little more than ten.
"""

from __future__ import annotations

from typing import NamedTuple

import coal
import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from ffsr_plan.collision.nearest_kernels import nearest_pairs, nearest_to_each, pairs_below
from ffsr_plan.collision.shape_placements import Placements, shape_placements
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.robots.collision_shapes import sharpen
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene


class Nearest(NamedTuple):
    """The nearest pair of a configuration."""

    distance: float
    """[m], negative in penetration."""
    link: str
    other: int | str
    """Index of the sphere, or name of the other link."""


class ObstacleQuery:
    """Distances of the links to the spheres of a scene. Holds scratch data: one per thread.

    Attributes:
        count: configurations whose clearance Coal has measured so far.
    """

    def __init__(self, robot: SpaceRobot, scene: Scene) -> None:
        self._robot = robot
        self._links = [robot.link_of(shape) for shape in robot.collision_model.geometryObjects]
        self._tree, self._shapes = scene.tree, robot.primitives
        self._bounds_only = not bool(self._shapes.exact.all())
        self.empty = len(scene) == 0 or len(self._shapes.kinds) == 0
        self.count = 0
        self._ball = coal.Sphere(1.0)
        self._measures = [
            coal.ComputeDistance(shape.geometry, self._ball)
            for shape in robot.collision_model.geometryObjects
        ]
        self._request = coal.DistanceRequest()
        sharpen(self._request)
        self._here, self._there = coal.Transform3s.Identity(), coal.Transform3s.Identity()

    def distances(self, configurations: Array) -> Array:
        """(N,) least distances [m] at (N, nq); infinite in an empty scene."""
        placed = shape_placements(self._robot, configurations)
        count = len(configurations)
        return self.distances_at(placed, np.arange(count), np.zeros((count, 3)))

    def nearest(self, q: Array) -> Nearest:
        """The nearest pair at `q` (nq,)."""
        return self.nearest_at(shape_placements(self._robot, q[None]), 0, np.zeros(3))

    def distances_at(self, placed: Placements, places: IntArray, shifts: Array) -> Array:
        """(n,) least distances [m] of the shapes placed as in row `places` (n,), moved by `shifts`.

        Args:
            placed: rows of placements.
            places: (n,) indices of rows; best if neighbours in space follow each other.
            shifts: (n, 3) displacements of the whole robot [m].
        """
        return self._pairs(placed, places, shifts)[0]

    def nearest_at(self, placed: Placements, place: int, shift: Array) -> Nearest:
        """The nearest pair of the shapes placed as in row `place`, moved by `shift` (3,)."""
        least, shape, sphere = self._pairs(placed, np.array([place]), shift[None])
        if self.empty:
            return Nearest(np.inf, "", "")
        return Nearest(
            float(least[0]), self._links[int(shape[0])], int(self._tree.order[sphere[0]])
        )

    def links_at(self, placed: Placements, place: int, shift: Array) -> Array:
        """(g,) least distance of each shape [m]; for a hull, that of the box around it."""
        if self.empty:
            return np.full(len(self._shapes.kinds), np.inf)
        frames = placed.frames[place]
        return nearest_to_each(self._tree, self._shapes.kinds, frames, shift)

    def _pairs(
        self, placed: Placements, places: IntArray, shifts: Array
    ) -> tuple[Array, IntArray, IntArray]:
        """(n,) Coal's least distance, (n,) shape and (n,) row of the tree's spheres."""
        if self.empty:
            nothing = np.zeros(len(places), dtype=np.int64)
            return np.full(len(places), np.inf), nothing, nothing
        self.count += len(places)
        _, shape, sphere, local = nearest_pairs(
            self._tree, self._shapes.kinds, placed.frames, places, shifts
        )
        least = self._measured(shape, sphere, local)
        if self._bounds_only:
            for k, place in enumerate(places):
                pair = self._among_bounds(placed, place, shifts[k], least[k], shape[k], sphere[k])
                least[k], shape[k], sphere[k] = pair
        return least, shape, sphere

    def _measured(self, shape: IntArray, sphere: IntArray, local: Array) -> Array:
        """(n,) Coal's distances of shapes (n,) to spheres (n,) centred at `local` (n, 3).

        Places are in the shape's frame: one ball and one placement serve all pairs.
        """
        ball, here, there, request = self._ball, self._here, self._there, self._request
        measures = [self._measures[i] for i in shape.tolist()]
        radii = self._tree.spheres[sphere, 3].tolist()
        found = []
        for measure, radius, center in zip(measures, radii, local, strict=True):
            ball.radius = radius
            there.setTranslation(center)
            found.append(measure(here, there, request, coal.DistanceResult()))
        return np.array(found)

    def _among_bounds(
        self,
        placed: Placements,
        place: int,
        shift: Array,
        least: float,
        shape: int,
        sphere: int,
    ) -> tuple[float, int, int]:
        """Measure what may be nearer than a pair at distance `least` that was found by bounds."""
        rotations, positions = placed.rotations[place], placed.positions[place]
        frames = placed.frames[place]
        bounds, shapes, rows = pairs_below(self._tree, self._shapes.kinds, frames, shift, least)
        best = (least, shape, sphere)
        for k in np.argsort(bounds, kind="stable").tolist():
            if bounds[k] >= best[0]:
                break
            i, row = int(shapes[k]), int(rows[k])
            apart = self._tree.spheres[row, :3] - positions[i] - shift
            local = (rotations[i].T @ apart)[None]
            found = self._measured(shapes[k : k + 1], rows[k : k + 1], local)
            best = min(best, (float(found[0]), i, row))
        return best


class SelfQuery:
    """Distances between links that are not adjacent; they depend on the joints alone.

    Attributes:
        pairs: (p, 2) indices of the shapes of each pair.
        count: configurations evaluated so far.
    """

    def __init__(self, robot: SpaceRobot) -> None:
        self._robot, self._model = robot, robot.model
        self._geometry = robot.collision_model
        self._data = robot.model.createData()
        self._geometry_data = self._geometry.createData()
        for request in self._geometry_data.distanceRequests:
            sharpen(request)
        ends = [(pair.first, pair.second) for pair in self._geometry.collisionPairs]
        self.pairs: IntArray = np.array(ends, dtype=np.int64).reshape(-1, 2)
        self.empty = not ends
        self.count = 0

    def distances(self, q: Array) -> Array:
        """(p,) distance of each pair [m] at `q` (nq,)."""
        self.count += not self.empty
        data = self._geometry_data
        pin.computeDistances(self._model, self._data, self._geometry, data, q)
        return np.array([result.min_distance for result in data.distanceResults])

    def distance(self, q: Array) -> float:
        """Least distance [m] at `q` (nq,); infinite without pairs."""
        if self.empty:
            return np.inf
        self.count += 1
        data = self._geometry_data
        pair = pin.computeDistances(self._model, self._data, self._geometry, data, q)
        return float(data.distanceResults[pair].min_distance)

    def nearest(self, q: Array) -> Nearest:
        """The nearest pair at `q` (nq,)."""
        found = self.distances(q)
        if self.empty:
            return Nearest(np.inf, "", "")
        pair = int(np.argmin(found))
        first, second = (
            self._robot.link_of(self._geometry.geometryObjects[int(k)]) for k in self.pairs[pair]
        )
        return Nearest(float(found[pair]), first, second)


class Clearance(float):
    """A clearance [m] that knows its pair.

    Attributes:
        link: name of the nearest link; empty in an empty scene.
        obstacle: index of the nearest sphere in the scene; None in an empty scene.
    """

    link: str
    obstacle: int | None

    def __new__(cls, distance: float, link: str, obstacle: int | None) -> Clearance:
        """A number with a name to it."""
        clearance = super().__new__(cls, distance)
        clearance.link, clearance.obstacle = link, obstacle
        return clearance

    def __reduce__(self) -> tuple[type, tuple[float, str, int | None]]:
        return type(self), (float(self), self.link, self.obstacle)


def clearance(robot: SpaceRobot, scene: Scene, q: ArrayLike) -> Clearance:
    """Least link-to-sphere distance [m] of one configuration `q` (nq,), by Coal.

    A number: negative in penetration, infinite in an empty scene; its attributes `link` and
    `obstacle` name the nearest pair. For many configurations,
    `ffsr_plan.collision.ObstacleQuery(robot, scene).distances(...)` takes (N, nq) at once.

    Raises:
        InvalidInput: not a robot, a scene or a configuration of that robot.
    """
    if not isinstance(robot, SpaceRobot):
        raise InvalidInput("robot", robot, "a SpaceRobot")
    if not isinstance(scene, Scene):
        raise InvalidInput("scene", scene, "a Scene")
    near = ObstacleQuery(robot, scene).nearest(robot.check_configuration("q", q))
    return Clearance(near.distance, near.link, near.other if isinstance(near.other, int) else None)
