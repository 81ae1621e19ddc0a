"""Distances of placed solids to bodies that move, in the axes of each body.

Distances do not depend on the axes in which they are taken. In those of a body its shapes rest, so
that the functions for obstacles at rest serve; what is placed anew is the base of the robot.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.verification.distances.obstacle_arrays import shape_arrays
from ffsr_plan.verification.distances.obstacle_distance_kernels import shape_distances
from ffsr_plan.verification.distances.solid_arrays import SolidArrays
from ffsr_plan.verification.moving_bodies.scene_bodies import BodyPoses

_Placed = tuple[Array, Array, Array, Array]
"""Turns and places of the solids, base axes; turns and places of the base, world axes."""


class BodyDistances:
    """Distances to B bodies."""

    def __init__(self, bodies: Sequence[MovingBody], growth: float, solids: SolidArrays) -> None:
        """Prepare distances.

        Args:
            bodies: the bodies.
            growth: distance by which their shapes are grown on all sides [m].
            solids: the solids of the robot.
        """
        self._shapes = [shape_arrays(body.shapes, growth, np.zeros(3))[0] for body in bodies]
        self._solids = solids

    def at(self, asked: IntArray, body: IntArray, placed: _Placed, poses: BodyPoses) -> Array:
        """Distances for some questions.

        Args:
            asked: (q, 2) configuration and solid of each question.
            body: (q,) the body of each.
            placed: the robot in N configurations.
            poses: of the bodies, one for each configuration.

        Returns:
            (q,) signed distances [m]; where a solid and a body overlap, a lower bound.
        """
        turns, places, base_turns, base_places = placed
        found = np.empty(len(asked))
        for k, shapes in enumerate(self._shapes):
            rows = np.flatnonzero(body == k)
            if not len(rows):
                continue
            back = np.swapaxes(poses.turns[:, k], 1, 2)
            apart = base_places - poses.places[:, k]
            own_turns, own_places = back @ base_turns, (back @ apart[:, :, None])[:, :, 0]
            count = len(shapes.radii)
            every = np.tile(np.array([[0, count]]), (len(rows), 1))
            found[rows] = shape_distances(
                self._solids, np.ascontiguousarray(asked[rows]), turns, places,
                np.ascontiguousarray(own_turns), np.ascontiguousarray(own_places), shapes,
                np.arange(count), every, np.full(len(rows), np.inf),
            )  # fmt: skip
        return found
