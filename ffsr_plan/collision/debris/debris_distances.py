"""Distances of a robot to all drifting spheres of a scene, each placement at its own time."""

from __future__ import annotations

import numpy as np

from ffsr_plan.bodies.debris.scene_debris import tree_of
from ffsr_plan.collision.coal_measures import CoalMeasures
from ffsr_plan.collision.distances import Nearest
from ffsr_plan.collision.shape_placements import Placements
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene
from ffsr_plan.time_limit.deadline import Deadline

_AT_ONCE = 1024  # configurations that are measured between two looks at the deadline


class DebrisDistances:
    """Distances of the links to drifting spheres.

    They are closed forms, and Coal's for links with hulls. It contains scratch data: every thread
    needs its own.

    Attributes:
        fastest: speed of the fastest sphere [m/s].
        count: number of configurations measured.
    """

    def __init__(
        self, robot: SpaceRobot, scene: Scene, middle: float, deadline: Deadline | None = None
    ) -> None:
        """Prepare the measurements.

        Args:
            robot: the robot.
            scene: whose debris counts here, at least one sphere.
            middle: the time about which distances are fastest to find [s].
            deadline: after which measurements raise `OutOfTime`.
        """
        self._tree = tree_of(scene.debris, scene.growth, middle)
        self._shapes, self._deadline = robot.primitives, deadline or Deadline()
        self._links = [robot.link_of(shape) for shape in robot.collision_model.geometryObjects]
        self._first = len(scene) - len(self._tree.order)
        self._exact = bool(self._shapes.exact.all())
        self._measures = CoalMeasures(robot, Scene())
        self.fastest = float(self._tree.drifts[:, 4].max())
        self.count = 0

    def least(
        self,
        placed: Placements,
        places: IntArray,
        shifts: Array,
        times: Array,
        spread: Array,
        others: Array,
    ) -> Array:
        """The lesser of these distances and of others.

        Args:
            placed: K placements of the shapes.
            places: (n,) which of the K.
            shifts: (n, 3) displacements of the whole robot [m].
            times: (n,) [s].
            spread: (n,) time over which each sphere is inflated by half of its own path [s].
            others: (n,) other distances [m].

        Returns:
            (n,) distances [m].
        """
        return self._pairs(placed, places, shifts, (times, spread), others)[0]

    def nearest_at(self, placed: Placements, place: int, shift: Array, time: float) -> Nearest:
        """The nearest pair of one placement, displaced.

        Args:
            placed: K placements of the shapes.
            place: which of the K.
            shift: (3,) displacement of the whole robot [m].
            time: [s].
        """
        when = np.array([time]), np.zeros(1)
        far = np.full(1, np.inf)
        least, shape, row = self._pairs(placed, np.array([place]), shift[None], when, far)
        if row[0] < 0:
            return Nearest(np.inf, "", None)
        number = self._first + int(self._tree.order[row[0]])
        return Nearest(float(least[0]), self._links[int(shape[0])], number)

    def links_at(
        self, placed: Placements, place: int, shift: Array, time: float, spread: float
    ) -> Array:
        """Least distance of each shape of one placement, displaced.

        Args:
            placed: K placements of the shapes.
            place: which of the K.
            shift: (3,) displacement of the whole robot [m].
            time: [s].
            spread: time over which each sphere is inflated by half of its own path [s].

        Returns:
            (g,) distances [m]; where a body only lies in its box, lower bounds.
        """
        from ffsr_plan.collision.debris.nearest_debris_kernel import nearest_drifting_to_each

        when = time - self._tree.middle, float(spread)
        kinds, frames = self._shapes.kinds, placed.frames[place]
        return np.asarray(nearest_drifting_to_each(self._tree, kinds, frames, shift, when))

    def _pairs(
        self,
        placed: Placements,
        places: IntArray,
        shifts: Array,
        when: tuple[Array, Array],
        others: Array,
    ) -> tuple[Array, IntArray, IntArray]:
        """(n,) least distances, and (n,) shape and (n,) row of the sphere, -1 for others."""
        from ffsr_plan.collision.debris.nearest_debris_kernel import nearest_drifting_pairs

        least, times = np.array(others, dtype=np.float64), when[0] - self._tree.middle
        shape, row = np.full(len(places), -1), np.full(len(places), -1)
        for first in range(0, len(places) * bool(len(self._links)), _AT_ONCE):
            self._deadline.check()
            some = slice(first, first + _AT_ONCE)
            shape[some], row[some] = nearest_drifting_pairs(
                self._tree, self._shapes.kinds, placed.frames, places[some], shifts[some],
                times[some], when[1][some], least[some],
            )  # fmt: skip
        self.count += len(places)
        for k in np.flatnonzero(row >= 0).tolist() if not self._exact else ():
            where = placed, int(places[k]), shifts[k]
            at = float(times[k]), float(when[1][k])
            pair = int(shape[k]), int(row[k])
            least[k], shape[k], row[k] = self._nearest_hull(where, at, pair, float(others[k]))
        return least, shape, row

    def _nearest_hull(
        self,
        where: tuple[Placements, int, Array],
        when: tuple[float, float],
        pair: tuple[int, int],
        other: float,
    ) -> tuple[float, int, int]:
        """The nearest pair by Coal if the search has lower bounds only, as it has for hulls.

        Args:
            where: placements, which of them, and its displacement (3,) [m].
            when: time from the middle on, and spread [s].
            pair: shape and sphere of the least bound.
            other: distance below which pairs count [m].
        """
        from ffsr_plan.collision.debris.nearest_debris_kernel import drifting_pairs_below

        self._deadline.check()
        placed, place, shift = where
        best = min((other, -1, -1), (self._measured(where, when, *pair), *pair))
        bounds, shapes, rows = drifting_pairs_below(
            self._tree, self._shapes.kinds, placed.frames[place], shift, when, best[0]
        )
        for k in np.argsort(bounds, kind="stable").tolist():
            if bounds[k] >= best[0]:
                break
            found = self._measured(where, when, int(shapes[k]), int(rows[k]))
            best = min(best, (found, int(shapes[k]), int(rows[k])))
        return best

    def _measured(
        self,
        where: tuple[Placements, int, Array],
        when: tuple[float, float],
        shape: int,
        row: int,
    ) -> float:
        """Coal's distance of a pair [m]."""
        (placed, place, shift), (time, spread) = where, when
        sphere, drift = self._tree.spheres[row], self._tree.drifts[row]
        apart = sphere[:3] + time * drift[:3] - placed.positions[place, shape] - shift
        local = (placed.rotations[place, shape].T @ apart)[None]
        (found,) = self._measures.to_spheres([shape], [float(sphere[3])], local)
        return found - 0.5 * spread * float(drift[4])
