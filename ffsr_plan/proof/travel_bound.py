"""The travel bound T of one robot over intervals of edges, for any motion of its joints and base.

The mathematics is in `kernels.travel`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray, Records, records
from ffsr_plan.core.rotations import IDENTITY
from ffsr_plan.robots.robot import SpaceRobot

if TYPE_CHECKING:
    from ffsr_plan.curves.kernels.pieces import Pieces
    from ffsr_plan.proof.kernels.travel import BaseMotion


class IntervalTravel(NamedTuple):
    """The travel bound over K intervals for any displacement of the base; P points of g shapes.

    Attributes:
        points: (K, P) records of `TRAVEL`.
        lengths: (K,) h, in units of edge time.
        first: (g,) index of the first point of each shape; a shape's points are consecutive.
    """

    points: Records
    lengths: Array
    first: IntArray

    def bounds(self, interval: int | IntArray, base_step: Array) -> Array:
        """T over whole intervals.

        Args:
            interval: one interval, or intervals (...).
            base_step: (..., 3) displacement of the base origin over a whole edge, world axes [m].
                It broadcasts with `interval`.

        Returns:
            (..., g) bound of each shape [m].
        """
        length: Array = self.lengths[interval][..., None]
        points: Records = self.points[interval]
        velocity = points["velocity"] + base_step[..., None, :]
        straight = length * np.linalg.norm(velocity, axis=-1) + points["curvature"]
        base_speed = np.linalg.norm(base_step, axis=-1)[..., None]
        coarse = length * (base_speed + points["speed"])
        return self._of_shapes(np.minimum(straight, coarse) + points["attitude_error"])

    def within(self, interval: int, length: float, offset: float, base_step: Array) -> Array:
        """T over a part of an interval that does not contain the middle.

        Over the part the velocity differs from that at the middle by at most A |t - middle|.

        Args:
            interval: the interval.
            length: length of the part, in units of edge time.
            offset: distance between the middles of the part and of the interval, same units.
            base_step: (3,) displacement of the base origin over a whole edge, world axes [m].

        Returns:
            (g,) bound of each shape [m].
        """
        points: Records = self.points[interval]
        velocity = np.linalg.norm(points["velocity"] + base_step, axis=-1)
        change = 4.0 / self.lengths[interval] ** 2 * points["curvature"]
        coarse = np.linalg.norm(base_step) + points["speed"]
        fastest = np.minimum(velocity + abs(offset) * change, coarse)
        return self._of_shapes(length * fastest + points["attitude_error"])

    def _of_shapes(self, points: Array) -> Array:
        largest: Array = np.maximum.reduceat(points, self.first, axis=-1)
        return largest


class TravelBound:
    """The travel bound of one robot.

    Attributes:
        shapes: (g,) the collision shapes, records of `SHAPE`.
        points: (P,) points whose hulls contain the shapes, records of `HULL_POINT`.
    """

    def __init__(self, robot: SpaceRobot) -> None:
        from ffsr_plan.proof.kernels.course import SHAPE
        from ffsr_plan.proof.kernels.travel import HULL_POINT

        self._bodies, given = robot.bodies, robot.primitives
        self.shapes: Records = records(SHAPE, len(given.kinds))
        columns = {
            "kind": given.kinds,
            "extent": given.sizes,
            "link": given.links,
            "rotation": given.rotations,
            "position": given.positions,
            "first": np.cumsum(given.corners) - given.corners,
            "end": np.cumsum(given.corners),
        }
        for name, column in columns.items():
            self.shapes[name] = column
        self.points: Records = records(HULL_POINT, len(given.points))
        self.points["link"] = np.repeat(given.links, given.corners)
        self.points["place"] = given.points

    def in_world(
        self, values: Array, rates: Array, lengths: Array, base: BaseMotion, quats: Array
    ) -> IntervalTravel:
        """The bound on travel in the world, over intervals of different edges.

        Args:
            values: (K, nd) joint values at the middles of the intervals [rad or m].
            rates: (K, nd) their changes over whole edges [rad or m].
            lengths: (K,) of the intervals, in units of edge time.
            base: what the base does on K edges.
            quats: (K, 4) attitudes of the base at the middles (xyzw).
        """
        from ffsr_plan.proof.kernels.travel import TRAVEL, scratch_for, travels

        found = records(TRAVEL, len(values), len(self.points))
        travels(
            self._bodies, self.points, np.array(values), np.array(rates), lengths, base,
            np.array(quats), scratch_for(len(self._bodies)), found,
        )  # fmt: skip
        return IntervalTravel(found, lengths, self.shapes["first"])

    def on_curve(
        self, pieces: Pieces, begin: float, end: float, base: BaseMotion, quats: Array
    ) -> IntervalTravel:
        """The bound on travel over one interval of every piece of a curve, for a base step of zero.

        Args:
            pieces: the curve, m pieces; what thrusters do to the base is part of the bound.
            begin: start of the interval, in [0, 1].
            end: its end.
            base: what else the base does.
            quats: (m, 4) attitudes of the base at the middles (xyzw).
        """
        from ffsr_plan.proof.kernels.curved_travel import curved_travels
        from ffsr_plan.proof.kernels.travel import TRAVEL, scratch_for

        found = records(TRAVEL, len(quats), len(self.points))
        joints = np.empty((4, len(self._bodies) - 1))
        curved_travels(
            self._bodies, self.points, pieces, begin, end, base, np.array(quats), joints,
            scratch_for(len(self._bodies)), found,
        )  # fmt: skip
        return IntervalTravel(found, np.full(len(quats), end - begin), self.shapes["first"])

    def in_base(self, values: Array, rates: Array, lengths: Array) -> IntervalTravel:
        """The bound on travel relative to the base, for a base step of zero.

        Two shapes of one robot do not touch if their distances at an interval's ends sum to more
        than the sum of their bounds.

        Args:
            values: (K, nd) joint values at the middles of the intervals [rad or m].
            rates: (K, nd) their changes over whole edges [rad or m].
            lengths: (K,) of the intervals, in units of edge time.
        """
        from ffsr_plan.proof.kernels.travel import BaseMotion

        still = BaseMotion(False, False, np.zeros((len(values), 3)), 0.0)
        return self.in_world(values, rates, lengths, still, np.tile(IDENTITY, (len(values), 1)))
