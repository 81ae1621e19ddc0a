"""`ControlPoints`: the polygon that a curve is drawn with."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.rotations import rotate
from ffsr_plan.curves.splines import control_points_through
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.dynamics.motion import Motion


class ControlPoints(NamedTuple):
    """The m + 1 control points of a curve of m pieces.

    Attributes:
        positions: (m + 1, 3) base origin, or where it floats the centre of mass, world axes [m].
        joint_values: (m + 1, nd) [rad or m].
        shares: (m + 1,) share of the rotation by wheels from start to goal; where the base reacts,
            of the polygon's parameter, which is that of the joints' way if it is straight.
    """

    positions: Array
    joint_values: Array
    shares: Array

    @property
    def table(self) -> Array:
        """(m + 1, 3 + nd + 1) all of them."""
        return np.hstack([self.positions, self.joint_values, self.shares[:, None]])

    def through(self) -> ControlPoints:
        """Those of the curve that passes through the present ones."""
        table = control_points_through(self.table)
        return ControlPoints(table[:, :3], table[:, 3:-1], table[:, -1])

    def repeated(self, counts: IntArray) -> ControlPoints:
        """Each point (m + 1,) so many times; the curve rests at one that is there thrice."""
        return ControlPoints(*(np.repeat(each, counts, axis=0) for each in self))


def control_points_on(motion: Motion, parameters: Array) -> ControlPoints:
    """Control points on the polygon of a motion.

    Args:
        motion: the motion, m edges.
        parameters: (k + 1,) from 0 to m, increasing; corner i is at i.

    Returns:
        k + 1 control points.
    """
    edge = np.minimum(parameters.astype(np.int64), motion.edges - 1)
    time = parameters - edge
    if motion.mode.floats:
        center = centers_of_mass(motion.robot, motion.joint_values[:1])
        start = motion.positions[0] + rotate(motion.attitudes[:1], center)
        positions = np.tile(start, (len(parameters), 1))
    else:
        positions = _between(motion.positions, edge, time[:, None])
    shares = parameters / motion.edges
    if motion.turn_shares is not None:
        shares = _between(motion.turn_shares, edge, time)
    return ControlPoints(positions, motion.joints_at(edge, time), shares)


def _between(corners: Array, edge: Array, time: Array) -> Array:
    values: Array = (1.0 - time) * corners[edge] + time * corners[edge + 1]
    return values
