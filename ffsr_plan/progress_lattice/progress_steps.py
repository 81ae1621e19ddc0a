"""Steps of progress along a way from start to goal, and the motion that makes all of them."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.progress_lattice.ways import Way
from ffsr_plan.proof.edge_travel import EdgeTravel


class ProgressSteps:
    """All steps of a lattice with progress.

    Attributes:
        way: the way.
        values: (A,) progress of each place.
        start: number of the place at the start.
        goal: number of the place at the goal.
        motion: a motion without offsets that makes every step, and ends at the goal.
        corners: (A,) a corner of that motion at each place.
        edges: (A, D) edge of that motion that makes a step of -most .. most from each place; -1
            where there is none.
        lengths: (E,) length of each edge of the motion along the way [m].
        most: places that a step goes at most.
    """

    def __init__(self, way: Way) -> None:
        """List the steps.

        Args:
            way: the places.
        """
        self.way, self.most, self.values = way, way.most, way.values
        self.start, self.goal = way.start, way.goal
        walk, edges = self._walk()
        self.edges: IntArray = edges
        self.corners: IntArray = np.array([walk.index(place) for place in range(len(self.values))])
        places: IntArray = np.array(walk)
        self.motion = way.motion(places, np.zeros((len(walk), 3)))
        self.lengths = frozen(way.lengths(places))

    @cached_property
    def travel(self) -> EdgeTravel:
        """Travel bounds along the edges of the motion."""
        return EdgeTravel(self.motion)

    @cached_property
    def between(self) -> Array:
        """(A, A) bound on the travel of any point of the robot from place to place [m]."""
        along = np.linalg.norm(self.motion.base_steps(), axis=1)
        travel = along + self.travel.speeds + self.travel.attitude_error
        way = np.concatenate([[0.0], np.cumsum(travel[self.edges[:-1, self.most + 1]])])
        return np.abs(way[:, None] - way[None])

    def _walk(self) -> tuple[list[int], IntArray]:
        """Places in an order that makes every step and ends at the goal, and the edges."""
        last, most = len(self.values) - 1, self.most
        edges = np.full((last + 1, 2 * most + 1), -1, dtype=np.int64)
        walk = [0]

        def go(place: int) -> None:
            edges[walk[-1], place - walk[-1] + most] = len(walk) - 1
            walk.append(place)

        for place in range(last + 1):  # a wait and a single step forwards at each
            go(place)
            if place < last:
                go(place + 1)
        for size in range(1, most + 1):
            for first in range(size):
                while walk[-1] != first:
                    go(walk[-1] + (1 if first > walk[-1] else -1))
                for place in range(first + size, last + 1, size):
                    go(place)
                for place in range(walk[-1] - size, -1, -size):
                    go(place)
        while walk[-1] != self.goal:
            go(walk[-1] + 1)
        return walk, edges
