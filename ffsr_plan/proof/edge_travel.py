"""Travel bounds along the edges of a motion, for the intervals of interval halving.

An interval is computed for all edges at once and kept. If the velocities hardly change over an
interval, its parts are bounded from the same numbers: at time t the velocity differs from that at
the middle by at most A |t - middle|.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ffsr_plan.core.arrays import Array, Flags
from ffsr_plan.core.rotations import IDENTITY
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.travel_bound import IntervalTravel, TravelBound

_STRAIGHTNESS = 0.03  # largest share of curvature in an interval's travel to bound its parts by it


class EdgeTravel:
    """Travel bounds of the collision shapes along edges with any displacement of the base.

    Attributes:
        speeds: (m,) bound on the speed of any shape on each edge relative to the base origin [m].
        shapes: (g,) records of `SHAPE`.
        points: (P,) records of `HULL_POINT`, whose hulls contain the shapes.
        base: what the base does.
        attitude_error: length that an error of the attitude can add over any interval [m]; not
            part of `speeds`.
    """

    def __init__(self, motion: Motion | CurvedMotion) -> None:
        """Bounds along the edges of a motion.

        Args:
            motion: the motion, without offsets.
        """
        from ffsr_plan.proof.kernels.travel import BaseMotion

        self._motion, self._bound = motion, TravelBound(motion.robot)
        self.shapes, self.points = self._bound.shapes, self._bound.points
        turns = np.zeros((motion.edges, 3))
        if motion.mode.has_wheels and isinstance(motion, Motion):
            turns = motion.turns
        self.base = BaseMotion(
            motion.mode.attitude_reacts,
            motion.mode.floats,
            turns,
            motion.attitude_error,
        )
        self._known: dict[tuple[float, float, bool], tuple[IntervalTravel, Flags]] = {}
        whole = self.over(0.0, 1.0)[0]
        self.speeds = _largest_speed(whole)
        self.attitude_error = float(np.max(whole.points["attitude_error"], initial=0.0))

    @cached_property
    def speeds_in_base(self) -> Array:
        """(m,) bound on the speed of any shape in the base frame [m]."""
        return _largest_speed(self.over(0.0, 1.0, in_base=True)[0])

    def bounds(self, layer: int, begin: float, end: float, base_step: Array | None = None) -> Array:
        """Travel bound of each shape over a dyadic interval of an edge.

        The widest straight interval that contains the given one is computed, or the given one.

        Args:
            layer: the edge.
            begin: start of the interval, an integer multiple of its length, a power of two.
            end: end of the interval.
            base_step: (3,) displacement of the base origin over the whole edge, world axes [m];
                None for the travel relative to the base.

        Returns:
            (g,) bounds [m].
        """
        low, high, in_base = 0.0, 1.0, base_step is None
        travel, straight = self.over(low, high, in_base)
        while end - begin < high - low and not straight[layer]:
            middle = 0.5 * (low + high)
            low, high = (low, middle) if end <= middle else (middle, high)
            travel, straight = self.over(low, high, in_base)
        step = np.zeros(3) if base_step is None else base_step
        if end - begin == high - low:
            return travel.bounds(layer, step)
        return travel.within(layer, end - begin, 0.5 * (begin + end - low - high), step)

    def over(self, begin: float, end: float, in_base: bool = False) -> tuple[IntervalTravel, Flags]:
        """The bounds over one interval of every edge, computed once.

        Args:
            begin: start of the interval.
            end: end of the interval.
            in_base: whether travel relative to the base is wanted, rather than in the world.

        Returns:
            The bounds, and (m,) whether the motion is straight enough to bound parts by them.
        """
        if (begin, end, in_base) in self._known:
            return self._known[begin, end, in_base]
        travel = self._computed(begin, end, in_base)
        largest = (end - begin) * np.max(travel.points["speed"], axis=1, initial=0.0)
        curvature = np.max(travel.points["curvature"], axis=1, initial=0.0)
        self._known[begin, end, in_base] = travel, curvature <= _STRAIGHTNESS * largest
        return self._known[begin, end, in_base]

    def _computed(self, begin: float, end: float, in_base: bool) -> IntervalTravel:
        """The bounds over one interval of every edge."""
        motion, m, time = self._motion, self._motion.edges, 0.5 * (begin + end)
        if isinstance(motion, CurvedMotion):
            if in_base:
                still = self.base._replace(reacts=False, floats=False, error=0.0)
                quats = np.tile(IDENTITY, (m, 1))
                return self._bound.on_curve(motion.pieces_in_base, begin, end, still, quats)
            quats = motion.attitudes_at(np.arange(m), np.full(m, time))
            return self._bound.on_curve(motion.pieces, begin, end, self.base, quats)
        lengths, rates = np.full(m, end - begin), np.diff(motion.joint_values, axis=0)
        values = motion.joint_values[:-1] + time * rates
        if in_base:
            return self._bound.in_base(values, rates, lengths)
        quats = motion.attitudes_at((np.arange(m) + time) / m)
        return self._bound.in_world(values, rates, lengths, self.base, quats)


def _largest_speed(whole: IntervalTravel) -> Array:
    """(m,) bound on the speed of any point over whole edges [m]."""
    from_middle = (
        np.linalg.norm(whole.points["velocity"], axis=-1) + 2.0 * whole.points["curvature"]
    )
    largest: Array = np.max(np.minimum(from_middle, whole.points["speed"]), axis=1, initial=0.0)
    return largest
