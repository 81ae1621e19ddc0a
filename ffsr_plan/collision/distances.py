"""Exact distances by Coal: link to obstacle (Eqs. 7 and 9) and link to link.

A search in the tree over the obstacles finds the nearest pair of link and obstacle, and Coal
measures its distance. All pairs are never listed, so that ten thousand obstacles cost little more
than ten.
"""

from __future__ import annotations

import time
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ffsr_plan.collision.coal_measures import CoalMeasures
from ffsr_plan.collision.nearest_obstacle_kernels import (
    nearest_pairs,
    nearest_pairs_from,
    nearest_to_each,
    pairs_below,
)
from ffsr_plan.collision.shape_placements import Placements, shape_placements
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.robots.collision_shapes import sharpen
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene
from ffsr_plan.time_limit.deadline import Deadline

_TOUCHING, _MOST_TOUCHING = 1e-9, 20_000  # [m] bound of pairs that may touch; pairs to be listed
_AT_ONCE = 64  # configurations that are measured between two looks at the deadline, at first
_SECONDS_AT_ONCE = 0.003  # up to which twice as many are measured the next time


class Nearest(NamedTuple):
    """The nearest pair of a configuration.

    Attributes:
        distance: [m], negative in penetration; infinite in an empty scene.
        link: name of the link; empty in an empty scene.
        obstacle: number of the obstacle in the scene, or name of the other link; None in an empty
            scene.
    """

    distance: float
    link: str
    obstacle: int | str | None


class ObstacleQuery:
    """Distances of the links to the obstacles of a scene.

    It contains scratch data: every thread needs its own.

    Attributes:
        empty: whether the scene has no obstacles or the robot no shapes.
        count: number of configurations whose clearance Coal has measured.
    """

    def __init__(self, robot: SpaceRobot, scene: Scene, deadline: Deadline | None = None) -> None:
        """Prepare the measurements.

        Args:
            robot: the robot.
            scene: the obstacles.
            deadline: after which measurements raise `OutOfTime`.
        """
        self._robot, self._deadline = robot, deadline or Deadline()
        self._links = [robot.link_of(shape) for shape in robot.collision_model.geometryObjects]
        self._tree, self._shapes = scene.tree, robot.primitives
        self._bounds_only = not (self._shapes.exact.all() and scene.is_closed_form)
        self.empty = len(scene) == 0 or len(self._shapes.kinds) == 0
        self.count = 0
        self._at_once = _AT_ONCE
        self._measures = CoalMeasures(robot, scene)

    @property
    def radius(self) -> float:
        """Distance of the farthest point of spheres and shapes from the origin, at most [m]."""
        spheres = self._tree.spheres
        far = np.linalg.norm(spheres[:, :3], axis=1) + spheres[:, 3]
        return float(np.max(far, initial=0.0))

    def distances(self, configurations: Array) -> Array:
        """Least distances of many configurations.

        Args:
            configurations: (N, nq).

        Returns:
            (N,) distances [m], infinite in an empty scene.
        """
        placed = shape_placements(self._robot, configurations)
        count = len(configurations)
        return self.distances_at(placed, np.arange(count), np.zeros((count, 3)))

    def nearest(self, q: Array) -> Nearest:
        """The nearest pair of link and obstacle.

        Args:
            q: (nq,) configuration.
        """
        return self.nearest_at(shape_placements(self._robot, q[None]), 0, np.zeros(3))

    def touching(self, q: Array) -> list[Nearest]:
        """All pairs of a shape and an obstacle that touch, at most 20 000 of them.

        Args:
            q: (nq,) configuration.
        """
        if self.empty:
            return []
        placed = shape_placements(self._robot, q[None])
        bounds, shapes, rows = pairs_below(
            self._tree, self._shapes.kinds, placed.frames[0], np.zeros(3), _TOUCHING
        )
        chosen = np.argsort(bounds, kind="stable")[:_MOST_TOUCHING]
        shapes, rows = shapes[chosen], rows[chosen]
        found = []
        for shape, row in zip(shapes.tolist(), rows.tolist(), strict=True):
            own = placed.rotations[0][shape], placed.positions[0][shape]
            distance, _ = self._measures.distance(shape, row, *own)
            if distance <= 0.0:
                found.append(Nearest(distance, self._links[shape], int(self._tree.order[row])))
        return found

    def distances_at(self, placed: Placements, places: IntArray, shifts: Array) -> Array:
        """Least distances of many placements, each displaced.

        Args:
            placed: K placements of the shapes.
            places: (n,) which of the K; fastest if successive ones are close in space.
            shifts: (n, 3) displacements of the whole robot [m].

        Returns:
            (n,) distances [m], infinite in an empty scene.
        """
        return self._pairs(placed, places, shifts)[0]

    def closed_at(self, placed: Placements, places: IntArray, shifts: Array) -> Array:
        """The same in closed form, without a query of Coal where that is one for all pairs.

        Args:
            placed: K placements of the shapes.
            places: (n,) which of the K; fastest if successive ones are close in space.
            shifts: (n, 3) displacements of the whole robot [m].

        Returns:
            (n,) distances [m], infinite in an empty scene.
        """
        if self.empty or self._bounds_only:
            return self.distances_at(placed, places, shifts)
        kinds, frames, found = self._shapes.kinds, placed.frames, np.empty(len(places))
        for first in range(0, len(places), self._at_once):
            self._deadline.check()
            some = slice(first, first + self._at_once)
            found[some] = nearest_pairs(self._tree, kinds, frames, places[some], shifts[some])[0]
        return found

    def nearest_at(self, placed: Placements, place: int, shift: Array) -> Nearest:
        """The nearest pair of one placement, displaced.

        Args:
            placed: K placements of the shapes.
            place: which of the K.
            shift: (3,) displacement of the whole robot [m].
        """
        least, shape, sphere = self._pairs(placed, np.array([place]), shift[None])
        if self.empty:
            return Nearest(np.inf, "", None)
        return Nearest(
            float(least[0]), self._links[int(shape[0])], int(self._tree.order[sphere[0]])
        )

    def links_at(self, placed: Placements, place: int, shift: Array) -> Array:
        """Least distance of each shape of one placement, displaced.

        Args:
            placed: K placements of the shapes.
            place: which of the K.
            shift: (3,) displacement of the whole robot [m].

        Returns:
            (g,) distances [m]; where a body only lies in its box, lower bounds.
        """
        if self.empty:
            return np.full(len(self._shapes.kinds), np.inf)
        frames = placed.frames[place]
        return nearest_to_each(self._tree, self._shapes.kinds, frames, shift)

    def _pairs(
        self, placed: Placements, places: IntArray, shifts: Array
    ) -> tuple[Array, IntArray, IntArray]:
        """(n,) Coal's least distance, (n,) shape and (n,) row of the obstacle."""
        if self.empty:
            none = np.zeros(len(places), dtype=np.int64)
            return np.full(len(places), np.inf), none, none
        found: list[tuple[Array, IntArray, IntArray]] = []
        which = row = first = 0
        while first < len(places) or not found:
            self._deadline.check()
            begin, some = time.monotonic(), slice(first, first + self._at_once)
            first += self._at_once
            _, shape, sphere, local = nearest_pairs_from(
                self._tree,
                self._shapes.kinds,
                placed.frames,
                places[some],
                shifts[some],
                which,
                row,
            )
            if len(shape):
                which, row = int(shape[-1]), int(sphere[-1])
            self.count += len(shape)
            least = self._measured(placed, (places[some], shifts[some]), shape, sphere, local)
            if self._bounds_only:
                self._refine(placed, places[some], shifts[some], least, shape, sphere)
            found.append((least, shape, sphere))
            seconds = time.monotonic() - begin
            if len(shape) == self._at_once and seconds < _SECONDS_AT_ONCE:
                self._at_once *= 2
            elif seconds > 2.0 * _SECONDS_AT_ONCE:
                self._at_once = max(self._at_once // 2, 1)
        if len(found) == 1:
            return found[0]
        least, shape, sphere = (np.concatenate(parts) for parts in zip(*found, strict=True))
        return least, shape, sphere

    def _refine(
        self,
        placed: Placements,
        places: IntArray,
        shifts: Array,
        least: Array,
        shape: IntArray,
        sphere: IntArray,
    ) -> None:
        """Replace pairs, nearest by lower bounds, by the nearest ones."""
        for k, place in enumerate(places):
            self._deadline.check()
            pair = self._nearest_hull(placed, place, shifts[k], least[k], shape[k], sphere[k])
            least[k], shape[k], sphere[k] = pair

    def _measured(
        self,
        placed: Placements,
        where: tuple[IntArray, Array],
        shape: IntArray,
        row: IntArray,
        local: Array,
    ) -> Array:
        """(n,) Coal's distances of shapes (n,) to obstacles (n,).

        Spheres are centred at `local` (n, 3) in the frames of the shapes. The places (n,) and
        shifts (n, 3) in `where` are those of the robot.
        """
        measures, tree = self._measures, self._tree
        if measures.spheres_only:
            radii = tree.spheres[row, 3].tolist()
            return np.array(measures.to_spheres(shape.tolist(), radii, local))
        places, shifts = where
        own = placed.rotations[places, shape], placed.positions[places, shape] + shifts
        pairs = zip(shape.tolist(), row.tolist(), *own, strict=True)
        return np.array([measures.distance(*pair)[0] for pair in pairs])

    def _nearest_hull(
        self,
        placed: Placements,
        place: int,
        shift: Array,
        least: float,
        shape: int,
        sphere: int,
    ) -> tuple[float, int, int]:
        """The nearest pair if the search has lower bounds only, as it has for hulls.

        All pairs with a bound below `least`, the measured distance of one pair, are measured in the
        order of their bounds.
        """
        rotations, positions = placed.rotations[place], placed.positions[place]
        frames = placed.frames[place]
        bounds, shapes, rows = pairs_below(self._tree, self._shapes.kinds, frames, shift, least)
        best = (least, shape, sphere)
        for k in np.argsort(bounds, kind="stable").tolist():
            if bounds[k] >= best[0]:
                break
            i, row = int(shapes[k]), int(rows[k])
            distance, _ = self._measures.distance(i, row, rotations[i], positions[i] + shift)
            best = min(best, (distance, i, row))
        return best


class SelfQuery:
    """Distances between links that are not adjacent; they depend on the joint values alone.

    It contains scratch data: every thread needs its own.

    Attributes:
        pairs: (p, 2) indices of the shapes of each pair.
        empty: whether there are no pairs.
        count: number of configurations evaluated.
    """

    def __init__(self, robot: SpaceRobot, deadline: Deadline | None = None) -> None:
        self._robot, self._model = robot, robot.model
        self._deadline = deadline or Deadline()
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
        """Distance of each pair.

        Args:
            q: (nq,) configuration.

        Returns:
            (p,) distances [m], negative in penetration.
        """
        self._deadline.check()
        self.count += not self.empty
        data = self._geometry_data
        pin.computeDistances(self._model, self._data, self._geometry, data, q)
        return np.array([result.min_distance for result in data.distanceResults])

    def distances_of(self, pairs: IntArray, q: Array) -> Array:
        """Distances of some pairs.

        Args:
            pairs: (k,) numbers of the pairs.
            q: (nq,) configuration.

        Returns:
            (k,) distances [m], negative in penetration.
        """
        self.count += 1
        geometry, data = self._geometry, self._geometry_data
        pin.updateGeometryPlacements(self._model, self._data, geometry, data, q)
        found = [pin.computeDistance(geometry, data, pair).min_distance for pair in pairs.tolist()]
        return np.array(found)

    def distance(self, q: Array) -> float:
        """Least distance over all pairs.

        Args:
            q: (nq,) configuration.

        Returns:
            The distance [m]; infinite without pairs.
        """
        if self.empty:
            return np.inf
        self._deadline.check()
        self.count += 1
        data = self._geometry_data
        pair = pin.computeDistances(self._model, self._data, self._geometry, data, q)
        return float(data.distanceResults[pair].min_distance)

    def touching(self, q: Array) -> list[Nearest]:
        """All pairs of shapes of two links that touch.

        Args:
            q: (nq,) configuration.
        """
        distances = [] if self.empty else self.distances(q).tolist()
        return [self._pair(k, distance) for k, distance in enumerate(distances) if distance <= 0.0]

    def nearest(self, q: Array) -> Nearest:
        """The nearest pair of links.

        Args:
            q: (nq,) configuration.
        """
        distances = self.distances(q)
        if self.empty:
            return Nearest(np.inf, "", None)
        pair = int(np.argmin(distances))
        return self._pair(pair, float(distances[pair]))

    def _pair(self, pair: int, distance: float) -> Nearest:
        first, second = (
            self._robot.link_of(self._geometry.geometryObjects[int(k)]) for k in self.pairs[pair]
        )
        return Nearest(distance, first, second)
