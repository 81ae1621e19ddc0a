"""The fastest pace along a curve within limits, and the calmest one that arrives at a given time.

The search asks for every limit at both ends of each step and in its middle. In between, limits are
exceeded by a little, which is measured at the ends of quarter steps, with a bound on peaks in
between from the second differences there. Steps that exceed a limit by more than `_LOOSE` get a
smaller share of it, and the search is repeated. What is left is evened out to zero: in free flight,
a law slowed down by k demands 1 / k^2 of everything.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.smooth_flight.curve_samples import PARTS, CurveSamples
from ffsr_plan.smooth_flight.fastest_pace_kernel import StepLimits, squares_of
from ffsr_plan.smooth_flight.limits_on_pace import Demands, step_limits

_LOOSE = 1e-3  # excess that is evened out by slowing down the whole flight
_MOST_ROUNDS = 12
_PEAK = 1.5 / 8.0  # of a second difference: by how much a peak exceeds samples, half in reserve
_SAME = 1e-4  # relative tolerance of the duration before the law is slowed down to it
_EXACT = 1e-14  # of the share of one law in a mixture of two


class EndSpeeds(NamedTuple):
    """s' at both ends [1/s]; zero is a rest."""

    begin: float = 0.0
    end: float = 0.0


class Search(NamedTuple):
    """A curve and its demands, among whose paces is searched.

    Attributes:
        samples: the curve at K = 4 S + 1 parameters.
        wanted: demands there.
        ends: s' at both ends.
    """

    samples: CurveSamples
    wanted: Demands
    ends: EndSpeeds = EndSpeeds()

    def ceiled(self, speed: float) -> Search:
        """The same with s' [1/s] no higher than a ceiling."""
        return self._replace(wanted=self.wanted.ceiled(speed**2))

    def fastest(self) -> Array:
        """s'^2 of the fastest pace.

        Returns:
            (S + 1,) at the ends of the steps [1/s^2]; between them it is linear in s.

        Raises:
            InvalidInput: end speeds that the limits do not allow.
        """
        limits = step_limits(self.samples, self.wanted)
        for _ in range(_MOST_ROUNDS):
            squares = self._squares(limits)
            excess = self.excess(squares)
            if np.max(excess) <= 1.0 + _LOOSE:
                break
            limits.share[:] /= np.maximum(excess, 1.0)
        if self.ends == EndSpeeds():
            return squares / max(1.0, np.max(excess))
        for _ in range(_MOST_ROUNDS):  # a slower law would miss the speeds at the ends
            if np.max(excess) <= 1.0:
                break
            limits.share[:] /= np.max(excess)
            squares = self._squares(limits)
            excess = self.excess(squares)
        return squares

    def calmest(self, duration: float) -> Array:
        """s'^2 of the law with the lowest ceiling on s' that does not take longer than a time.

        Args:
            duration: the time [s], longer than the fastest law takes.

        Returns:
            (S + 1,) [1/s^2], as for `fastest`.
        """
        s = self.samples.ends
        length = s[-1] - s[0]
        lowest = length / duration  # of any law, s' exceeds it somewhere
        highest = float(np.sqrt(np.max(self.fastest())))

        def late(logarithm: float) -> float:
            squares = self.ceiled(float(np.exp(logarithm))).fastest()
            return float(np.log(duration_of(s, squares) / duration))

        bracket = np.log(lowest), np.log(highest)
        if late(bracket[1]) >= 0.0:
            return self.fastest()
        found = float(brentq(late, *bracket, xtol=_SAME, rtol=_SAME))
        while late(found) > 0.0:
            found += _SAME
        return self.ceiled(float(np.exp(found))).fastest()

    def on_time(self, duration: float) -> Array:
        """s'^2 of a law that takes a time exactly, whatever the speeds at its ends.

        A law that is slowed down misses them. Instead, two laws are mixed that differ by little,
        one too early and one too late: all limits are convex in s'^2 and s'', so the mixture keeps
        them, and its speeds at the ends are those of both.

        Args:
            duration: the time [s], longer than the fastest law takes.

        Returns:
            (S + 1,) [1/s^2], as for `fastest`.

        Raises:
            InvalidInput: even the law whose speed never exceeds those at the ends takes less time.
        """
        s = self.samples.ends
        lowest = max((s[-1] - s[0]) / duration, *self.ends)
        early = self.fastest()
        late = self.ceiled(lowest).fastest()
        if duration_of(s, late) < duration:
            allowed = f"at most {duration_of(s, late):.6g} s with these speeds at the ends"
            raise InvalidInput("duration", duration, allowed)
        low, high = np.log(lowest), np.log(np.sqrt(np.max(early)))
        while high - low > _SAME:
            squares = self.ceiled(float(np.exp((low + high) / 2.0))).fastest()
            if duration_of(s, squares) > duration:
                low, late = (low + high) / 2.0, squares
            else:
                high, early = (low + high) / 2.0, squares

        def missed(share: float) -> float:
            return duration_of(s, (1.0 - share) * early + share * late) - duration

        share = float(brentq(missed, 0.0, 1.0, xtol=_EXACT, rtol=_EXACT))
        mixed: Array = (1.0 - share) * early + share * late
        return mixed

    def excess(self, squares: Array) -> Array:
        """(S,) largest share of a limit in use over each step, peaks between samples included."""
        s = self.samples.ends
        u = np.diff(squares) / (2.0 * np.diff(s))
        within = np.linspace(0.0, 1.0, PARTS + 1)
        x = squares[:-1, None] + within * np.diff(squares)[:, None]
        shares = self.wanted.by_step(slice(None)).shares(np.broadcast_to(u[:, None], x.shape), x)
        bends = shares[:, 2:] - 2.0 * shares[:, 1:-1] + shares[:, :-2]
        peaks = np.max(shares, axis=1) + _PEAK * np.max(np.maximum(-bends, 0.0), axis=1)
        most: Array = np.max(peaks, axis=1)
        return most

    def _squares(self, limits: StepLimits) -> Array:
        begin, end = self.ends
        squares, most = squares_of(limits, begin**2, end**2)
        for what, speed, possible in (
            ("begin_speed", begin, most[0]),
            ("end_speed", end, squares[-1]),
        ):
            if possible < speed**2 * (1.0 - 1e-9):
                allowed = f"at most {np.sqrt(possible):.4g} 1/s within the limits"
                raise InvalidInput(what, speed, allowed)
        return squares


def duration_of(s: Array, squares: Array) -> float:
    """Duration [s] of a law with constant s'' between parameters (S + 1,)."""
    speeds = np.sqrt(squares)
    return float(np.sum(2.0 * np.diff(s) / (speeds[1:] + speeds[:-1])))
