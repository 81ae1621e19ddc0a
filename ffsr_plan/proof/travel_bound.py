"""The travel bound T of one robot over intervals of edges, for any motion of its joints and base.

The mathematics is in `kernels.travel`.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import coal
import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.rotations import IDENTITY
from ffsr_plan.robots.robot import SpaceRobot

if TYPE_CHECKING:
    from ffsr_plan.proof.kernels.travel import BaseMotion, HullPoints


class IntervalTravel(NamedTuple):
    """The travel bound over K intervals for any displacement of the base; P points of g shapes.

    Attributes:
        velocity: (K, P, 3) at the middle relative to the base origin, world axes [m].
        speed: (K, P) bound on the norm of that velocity over the interval [m].
        curvature: (K, P) length that a change of velocity can add, A h^2 / 4 [m].
        attitude_error: (K, P) length that the error of the attitude can add [m].
        lengths: (K,) h, in units of edge time.
        first: (g,) index of the first point of each shape; a shape's points are consecutive.
    """

    velocity: Array
    speed: Array
    curvature: Array
    attitude_error: Array
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
        length = self.lengths[interval][..., None]
        velocity = self.velocity[interval] + base_step[..., None, :]
        straight = length * np.linalg.norm(velocity, axis=-1) + self.curvature[interval]
        base_speed = np.linalg.norm(base_step, axis=-1)[..., None]
        coarse = length * (base_speed + self.speed[interval])
        return self._of_shapes(np.minimum(straight, coarse) + self.attitude_error[interval])

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
        velocity = np.linalg.norm(self.velocity[interval] + base_step, axis=-1)
        change = 4.0 / self.lengths[interval] ** 2 * self.curvature[interval]
        coarse = np.linalg.norm(base_step) + self.speed[interval]
        fastest = np.minimum(velocity + abs(offset) * change, coarse)
        return self._of_shapes(length * fastest + self.attitude_error[interval])

    def _of_shapes(self, points: Array) -> Array:
        largest: Array = np.maximum.reduceat(points, self.first, axis=-1)
        return largest


class TravelBound:
    """The travel bound of one robot.

    Attributes:
        points: points whose hulls contain the shapes.
    """

    def __init__(self, robot: SpaceRobot) -> None:
        from ffsr_plan.proof.kernels.travel import HullPoints

        self._bodies = robot.bodies
        shapes = robot.collision_model.geometryObjects
        points = [hull_points(shape) for shape in shapes]
        counts = np.array([len(p) for p in points], dtype=np.int64)
        carriers = np.array([shape.parentJoint - 1 for shape in shapes], dtype=np.int64)
        self.points: HullPoints = HullPoints(
            np.repeat(carriers, counts),
            np.concatenate([np.zeros((0, 3)), *points]),
            np.append(0, np.cumsum(counts)),
        )

    def in_world(
        self, values: Array, rates: Array, lengths: Array, base: BaseMotion, quats: Array
    ) -> IntervalTravel:
        """The bound on travel in the world.

        Args:
            values: (K, nd) joint values at the middles of the intervals [rad or m].
            rates: (K, nd) their changes over whole edges [rad or m].
            lengths: (K,) of the intervals, in units of edge time.
            base: what the base does.
            quats: (K, 4) attitudes of the base at the middles (xyzw).
        """
        from ffsr_plan.proof.kernels.travel import travels

        found = travels(self._bodies, self.points, values, rates, lengths, base, quats)
        return IntervalTravel(*found, self.points.first[:-1])

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

        still = BaseMotion(False, False, np.zeros(3), 0.0)
        return self.in_world(values, rates, lengths, still, np.tile(IDENTITY, (len(values), 1)))


def hull_points(geometry: pin.GeometryObject) -> Array:
    """Points whose convex hull, widened by a sphere's or capsule's radius, contains the shape.

    Args:
        geometry: a collision shape on its link.

    Returns:
        (N, 3) points in the frame of the link [m].
    """
    shape, placement = geometry.geometry, geometry.placement
    if isinstance(shape, coal.Sphere):
        local = np.zeros((1, 3))
    elif isinstance(shape, coal.Capsule):
        local = np.array([[0.0, 0.0, -shape.halfLength], [0.0, 0.0, shape.halfLength]])
    else:  # boxes and hulls: the corners of the bounding box along their own axes
        shape.computeLocalAABB()
        box = np.array([shape.aabb_local.min_, shape.aabb_local.max_])
        local = np.array(list(product(*box.T)))
    points: Array = local @ placement.rotation.T + placement.translation
    return points
