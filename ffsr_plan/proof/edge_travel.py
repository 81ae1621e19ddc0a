"""Bounds on travel along the edges of a motion, for the intervals that halving asks about.

Intervals at one place of their edges are worked out for all edges at once, and kept. Where the
velocities hardly change over an interval, its parts are bounded from the same numbers: by t the
velocity has changed by A |t - middle| at most.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array, Flags
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.travel_bound import Travel, TravelBound, Travels

_STRAIGHT = 0.03  # of an interval's travel; less than that is not worth a closer look
_ERRORS = 10.0  # the reaction's error is an estimate


class EdgeTravel:
    """How far the collision shapes travel along edges whose base moves by any step.

    Attributes:
        speeds: (m,) what no shape outruns on each edge, on top of the base's own speed [m].
        speeds_in_base: (m,) the same as seen from the base [m].
        slack: what an error of the attitude may add over any interval [m]; not in `speeds`.
    """

    def __init__(self, motion: Motion) -> None:
        self._motion = motion
        self._bound = TravelBound(motion.robot)
        self._known: dict[tuple[float, float], tuple[Travels, Flags]] = {}
        whole = self._over(0.0, 1.0)[0]
        self.speeds, self.speeds_in_base = (_fastest(travel) for travel in whole)
        self.slack = float(np.max(whole.world.slack, initial=0.0))

    def bounds(self, layer: int, begin: float, end: float, base_step: Array) -> Array:
        """(g,) travel of each shape in the world [m] over a dyadic interval of an edge.

        Args:
            layer: the edge.
            begin: beginning of the interval, a whole multiple of its length, a power of two.
            end: its end.
            base_step: (3,) what the base origin covers over the whole edge, world axes [m].
        """
        travels, low, high = self._around(layer, begin, end)
        return _over_part(travels.world, layer, low, high, begin, end, base_step)

    def bounds_in_base(self, layer: int, begin: float, end: float) -> Array:
        """(g,) travel of each shape as seen from the base [m]; as for `bounds`."""
        travels, low, high = self._around(layer, begin, end)
        return _over_part(travels.in_base, layer, low, high, begin, end, np.zeros(3))

    def _around(self, layer: int, begin: float, end: float) -> tuple[Travels, float, float]:
        """The widest interval around another that is straight enough to serve it, or it itself."""
        low, high = 0.0, 1.0
        travels, straight = self._over(low, high)
        while end - begin < high - low and not straight[layer]:
            middle = 0.5 * (low + high)
            low, high = (low, middle) if end <= middle else (middle, high)
            travels, straight = self._over(low, high)
        return travels, low, high

    def _over(self, begin: float, end: float) -> tuple[Travels, Flags]:
        """The bounds over one interval of every edge, and where they may serve its parts too."""
        if (begin, end) not in self._known:
            motion, m = self._motion, self._motion.edges
            time = 0.5 * (begin + end)
            quats = motion.at(np.arange(m), np.full(m, time))[:, 3:7]
            rates = np.diff(motion.joint_values, axis=0)
            joints = motion.joint_values[:-1] + time * rates
            lengths = np.full(m, end - begin)
            if motion.mode.attitude_reacts:
                error = _ERRORS * motion.reaction.error * len(motion.reaction.increments)
                travels = self._bound.reacting(
                    joints, rates, quats, lengths, error, motion.mode.floats
                )
            else:
                turn = np.tile(motion.turn, (m, 1))
                travels = self._bound.held(joints, rates, quats, lengths, turn)
            most = (end - begin) * np.max(travels.world.speed, axis=1, initial=0.0)
            straight = np.max(travels.world.bend, axis=1, initial=0.0) <= _STRAIGHT * most
            self._known[begin, end] = travels, straight
        return self._known[begin, end]


def _fastest(whole: Travel) -> Array:
    """(K,) the most of any point's speed over whole edges."""
    by_middle = np.linalg.norm(whole.velocity, axis=-1) + 2.0 * whole.bend
    return np.asarray(np.max(np.minimum(by_middle, whole.speed), axis=1, initial=0.0))


def _over_part(
    travel: Travel,
    layer: int,
    low: float,
    high: float,
    begin: float,
    end: float,
    base_step: Array,
) -> Array:
    if end - begin == high - low:
        return travel.bounds(layer, base_step)
    return travel.within(layer, end - begin, 0.5 * (begin + end - low - high), base_step)
