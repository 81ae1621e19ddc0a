"""A pace whose jerk is limited: the moving average, over time, of a pace whose jerk is not.

The mean of s over the last w seconds has the third derivative (s''(t) - s''(t - w)) / w. It is late
by w / 2 on average, so the curve's limits are kept by slowing it down, not by its derivation: with
demands of E on accelerations and torques and of J on jerk, relative to their limits, by
max(E^(1/2), J^(1/3)), because a law slowed down by k demands 1 / k^2 and 1 / k^3 of them. w is the
one for which the whole flight is shortest.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from ffsr_plan.core.arrays import Array
from ffsr_plan.dynamics.path_dynamics import Prescribed
from ffsr_plan.smooth_flight.curve_samples import Curve, dynamics_at
from ffsr_plan.smooth_flight.limits_on_pace import demands
from ffsr_plan.smooth_flight.pace import Pace
from ffsr_plan.trajectory.flight_limits import FlightLimits

_WITHIN = np.linspace(0.0, 1.0, 5)  # where a piece is sampled; as many as quarter steps have ends
_MARGIN = 1e-3  # relative, for peaks between samples beyond those that second differences show
_PEAK = 0.55  # of a second difference: a kink, where a piece of the curve ends, exceeds by a half
_SHORTEST = 1e-9  # share of the duration below which a piece is a rounding error
_WIDTHS = 1e-3, 1.0  # shares of a law's duration between which w is looked for


class JerkLimits(NamedTuple):
    """A curve and its limits, jerk included.

    Attributes:
        curve: the curve, a cubic on each of its pieces but for the attitude.
        limits: the limits.
    """

    curve: Curve
    limits: FlightLimits

    def fastest(self, pace: Pace) -> tuple[Pace, float]:
        """The shortest moving average of a pace that keeps all limits, and its width [s]."""

        def duration(logarithm: float) -> float:
            return self._within(pace, float(np.exp(logarithm)), 0.0).duration

        bounds = np.log(np.array(_WIDTHS) * pace.duration)
        best = minimize_scalar(
            duration, bounds=tuple(bounds), method="bounded", options={"xatol": 1e-2}
        )
        width = float(np.exp(best.x))
        return self._within(pace, width, 0.0), width

    def averaged(self, pace: Pace, width: float) -> Pace:
        """The moving average of a pace over a time [s], slowed down where limits want it."""
        return self._within(pace, width, 1.0)

    def _within(self, pace: Pace, width: float, least: float) -> Pace:
        law = moving_average(pace, width, float(self.curve.pieces))
        share, jerk = self._shares(law)
        return law.slowed(max(least, np.sqrt(share), np.cbrt(jerk)))

    def _shares(self, law: Pace) -> tuple[float, float]:
        """Largest shares in use of limits on velocities and forces, and on jerk."""
        curve = self.curve
        times = law.times[:-1, None] + np.diff(law.times)[:, None] * _WITHIN
        piece = np.repeat(np.arange(len(law.begin)), len(_WITHIN))
        s, speed, acceleration = law.on(piece, times.ravel())
        path, dynamics = dynamics_at(curve, np.clip(s, 0.0, curve.pieces))
        wanted = demands(self.limits, path, dynamics, curve.robot.mass)
        jerks = self._jerk_shares(path, s, speed, acceleration, law.begin[piece, 3])
        return (
            _peak(wanted.shares(acceleration, speed**2)),
            _peak(jerks) * (1.0 + _MARGIN),
        )

    def _jerk_shares(
        self, path: Prescribed, s: Array, speed: Array, acceleration: Array, jerk: Array
    ) -> Array:
        """(N, 1 + nd) shares of the limits on the jerk of the base origin and of the joints.

        The third derivative of the curve jumps between its pieces, so those of the pieces of the
        samples before and after are both considered.
        """
        curve, limits = self.curve, self.limits.jerk[[0, *range(2, 2 + self.curve.robot.nd)]]
        first, second = (np.hstack([path.base[:, k], path.rates[:, k]]) for k in (0, 1))
        ends = curve.at(np.arange(curve.pieces + 1.0))
        third = np.diff(np.hstack([ends.base[:, 1], ends.rates[:, 1]]), axis=0)
        steady = first * jerk[:, None] + 3.0 * second * (speed * acceleration)[:, None]
        piece = np.clip(np.floor(s), 0, curve.pieces - 1).astype(np.int64)
        shares = np.zeros((len(s), len(limits)))
        for near in (np.append(piece[:1], piece[:-1]), np.append(piece[1:], piece[-1:])):
            whole = steady + third[near] * (speed**3)[:, None]
            sizes = np.hstack([np.linalg.norm(whole[:, :3], axis=1)[:, None], np.abs(whole[:, 3:])])
            shares = np.maximum(shares, sizes / limits)
        return shares


def moving_average(pace: Pace, width: float, end: float) -> Pace:
    """The mean of s over the last `width` seconds, from rest at s = 0 to rest at s = `end`."""
    knots = np.unique(np.concatenate([pace.times, pace.times + width]))
    knots = knots[np.append(np.diff(knots) > _SHORTEST * knots[-1], True)]
    knots[0] = 0.0
    middle = (knots[1:] + knots[:-1]) / 2.0

    def flown(times: Array, within: Array) -> tuple[Array, Array, Array]:
        """s, s' and s'' at times, on the pieces that `within` lies on; at rest outside."""
        before, after = within < 0.0, within > pace.duration
        s, speed, acceleration = pace.on(pace.piece(within), times)
        still = before | after
        s = np.where(before, 0.0, np.where(after, end, s))
        return s, np.where(still, 0.0, speed), np.where(still, 0.0, acceleration)

    now, past = flown(knots[:-1], middle), flown(knots[:-1] - width, middle - width)
    speed, acceleration, jerk = ((a - b) / width for a, b in zip(now, past, strict=True))
    lengths = np.diff(knots)
    grown = lengths * (speed + lengths * (acceleration / 2.0 + lengths * jerk / 6.0))
    s = np.concatenate([[0.0], np.cumsum(grown)])
    s *= end / s[-1]  # by rounding
    return Pace(knots, np.column_stack([s[:-1], speed, acceleration, jerk]))


def _peak(shares: Array) -> float:
    """Largest of shares (N, q) at five samples a piece, with a bound on peaks in between."""
    by_piece = shares.reshape(-1, len(_WITHIN), shares.shape[1])
    bends = by_piece[:, 2:] - 2.0 * by_piece[:, 1:-1] + by_piece[:, :-2]
    peaks = np.max(by_piece, axis=1) + _PEAK * np.max(np.maximum(-bends, 0.0), axis=1)
    return float(np.max(peaks, initial=0.0))
