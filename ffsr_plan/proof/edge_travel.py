"""Travel bounds along the edges of a motion, for the intervals of interval halving.

An interval is computed for all edges at once and kept. If the velocities hardly change over an
interval, its parts are bounded from the same numbers: at time t the velocity differs from that at
the middle by at most A |t - middle|.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array, Flags
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.link_bounds import link_motion
from ffsr_plan.proof.travel_bound import IntervalTravel, ObserverTravels, TravelBound

_STRAIGHTNESS = 0.03  # largest share of curvature in an interval's travel to bound its parts by it
_ERROR_FACTOR = 10.0  # applied to the reaction's error, which is an estimate


class EdgeTravel:
    """Travel bounds of the collision shapes along edges with any displacement of the base.

    Attributes:
        speeds: (m,) bound on the speed of any shape on each edge relative to the base origin [m].
        speeds_in_base: (m,) bound on the speed of any shape in the base frame [m].
        attitude_error: length that an error of the attitude can add over any interval [m]; not
            part of `speeds`.
    """

    def __init__(self, motion: Motion) -> None:
        self._motion = motion
        self._bound, self._tree = TravelBound(motion.robot), motion.robot.tree
        self._known: dict[tuple[float, float], tuple[ObserverTravels, Flags]] = {}
        whole = self.over(0.0, 1.0)[0]
        self.speeds, self.speeds_in_base = (_largest_speed(travel) for travel in whole)
        self.attitude_error = float(np.max(whole.world.attitude_error, initial=0.0))

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
        low, high = 0.0, 1.0
        travels, straight = self.over(low, high)
        while end - begin < high - low and not straight[layer]:
            middle = 0.5 * (low + high)
            low, high = (low, middle) if end <= middle else (middle, high)
            travels, straight = self.over(low, high)
        travel = travels.in_base if base_step is None else travels.world
        step = np.zeros(3) if base_step is None else base_step
        if end - begin == high - low:
            return travel.bounds(layer, step)
        return travel.within(layer, end - begin, 0.5 * (begin + end - low - high), step)

    def over(self, begin: float, end: float) -> tuple[ObserverTravels, Flags]:
        """The bounds over one interval of every edge, computed once.

        Args:
            begin: start of the interval.
            end: end of the interval.

        Returns:
            The bounds, and (m,) whether the motion is straight enough to bound parts by them.
        """
        if (begin, end) in self._known:
            return self._known[begin, end]
        motion, m = self._motion, self._motion.edges
        time = 0.5 * (begin + end)
        quats = motion.attitudes_at((np.arange(m) + time) / m)
        rates = np.diff(motion.joint_values, axis=0)
        joints = motion.joint_values[:-1] + time * rates
        links = link_motion(self._tree, joints, rates, np.full(m, end - begin))
        if motion.mode.attitude_reacts:
            error = _ERROR_FACTOR * motion.reaction.error * len(motion.reaction.increments)
            floats = motion.mode.floats
            travels = self._bound.reacting(links, quats, error, floats)
        else:
            travels = self._bound.held(links, quats, motion.turns)
        largest = (end - begin) * np.max(travels.world.speed, axis=1, initial=0.0)
        curvature = np.max(travels.world.curvature, axis=1, initial=0.0)
        self._known[begin, end] = travels, curvature <= _STRAIGHTNESS * largest
        return self._known[begin, end]


def _largest_speed(whole: IntervalTravel) -> Array:
    """(m,) bound on the speed of any point over whole edges [m]."""
    from_middle = np.linalg.norm(whole.velocity, axis=-1) + 2.0 * whole.curvature
    largest: Array = np.max(np.minimum(from_middle, whole.speed), axis=1, initial=0.0)
    return largest
