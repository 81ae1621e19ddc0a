"""Pairs of a shape and an obstacle that are near each other, with the gradients of their distances.

The distance of two convex bodies is a convex function of the displacement of one of them, depths of
penetration counted as negative. So the linear function with its value and gradient at one place is
nowhere above it: where that is positive, the bodies are apart.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.collision.coal_measures import CoalMeasures
from ffsr_plan.collision.nearest_obstacle_kernels import pairs_below
from ffsr_plan.collision.shape_placements import Placements
from ffsr_plan.core.arrays import Array
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene
from ffsr_plan.time_limit.deadline import Deadline

_MOST_PAIRS = 400  # of one placement, the nearest ones


class PairGaps(NamedTuple):
    """Distances of p pairs as linear functions of the robot's displacement.

    Attributes:
        distances: (p,) [m], negative in penetration, in ascending order.
        gradients: (p, 3) their change by a displacement of the whole robot, world axes.
    """

    distances: Array
    gradients: Array


class NearPairs:
    """Near pairs of the links of a robot and the obstacles of a scene.

    It contains scratch data: every thread needs its own.

    Attributes:
        count: number of placements that were looked at.
    """

    def __init__(self, robot: SpaceRobot, scene: Scene, deadline: Deadline | None = None) -> None:
        """Prepare the measurements.

        Args:
            robot: the robot.
            scene: the obstacles.
            deadline: after which measurements raise `OutOfTime`.
        """
        self._deadline, self._tree, self._kinds = (
            deadline or Deadline(),
            scene.tree,
            robot.primitives.kinds,
        )
        self._empty = len(scene) == 0 or len(self._kinds) == 0
        self._measures = CoalMeasures(robot, scene)
        self.count = 0

    def at(self, placed: Placements, place: int, shift: Array, limit: float) -> PairGaps:
        """The pairs of one placement that may be nearer to each other than a limit.

        Args:
            placed: K placements of the shapes.
            place: which of the K.
            shift: (3,) displacement of the whole robot [m].
            limit: [m].

        Raises:
            OutOfTime: at the deadline.
        """
        self._deadline.check()
        if self._empty:
            return PairGaps(np.zeros(0), np.zeros((0, 3)))
        self.count += 1
        frames = placed.frames[place]
        bounds, shapes, rows = pairs_below(self._tree, self._kinds, frames, shift, limit)
        chosen = np.argsort(bounds, kind="stable")[:_MOST_PAIRS]
        distances, gradients = np.empty(len(chosen)), np.empty((len(chosen), 3))
        rotations, positions = placed.rotations[place], placed.positions[place] + shift
        for k, pair in enumerate(chosen.tolist()):
            shape, row = int(shapes[pair]), int(rows[pair])
            own = rotations[shape], positions[shape]
            distances[k], gradients[k] = self._measures.distance(shape, row, *own)
        order = np.argsort(distances, kind="stable")
        return PairGaps(distances[order], gradients[order])
