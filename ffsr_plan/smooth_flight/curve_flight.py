"""`CurveFlight`: a smooth curve with a time law, and the forces needed to fly it.

The law changes only when the robot is where, so proofs of the curve remain valid.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import finite_array
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.inverse_dynamics import States, states_along
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.smooth_flight.curve_samples import Curve, dynamics_at
from ffsr_plan.smooth_flight.pace import Pace
from ffsr_plan.smooth_flight.pace_search import EndSpeeds
from ffsr_plan.smooth_flight.timed_curve import SMALLEST_RATE, pace_within
from ffsr_plan.trajectory.flight import Flight
from ffsr_plan.trajectory.flight_limits import FlightLimits
from ffsr_plan.trajectory.straight_flight import change_of_place, straight_delta_v
from ffsr_plan.trajectory.timetables import LawTimes

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(3)  # on each piece of the law


@dataclass(frozen=True, eq=False)
class CurveFlight(Flight):
    """A smooth curve flown within limits, at rest at its ends only; see `SmoothFlight`.

    Attributes:
        curve: the curve.
        delta_v: velocity change that the thrusters produce in translation: the integral of
            |thrust| / mass [m/s].
        straight_delta_v: what the same change of place needs in the same time and with the same
            limit on thrust along a straight line, if nothing is in its way: one push, a coast and
            one push against it [m/s]. No flight from rest to rest needs less.
    """

    curve: Curve
    delta_v: float
    straight_delta_v: float
    _pace: Pace = field(repr=False)

    def __repr__(self) -> str:
        return (
            f"{type(self).__name__}({self.duration:.4g} s, delta-v {self.delta_v:.4g} m/s, "
            f"{self.straight_delta_v:.4g} m/s along a straight line)"
        )

    @property
    def robot(self) -> SpaceRobot:
        """The robot."""
        return self.curve.robot

    @property
    def mode(self) -> Mode:
        """What actuates the base."""
        return self.curve.mode

    @property
    def duration(self) -> float:
        """Duration of the flight [s]."""
        return self._pace.duration

    @property
    def rests(self) -> Array:
        """(k,) times at which the robot rests on its way [s], where the curve has such places."""
        return _rests(self.curve, self._pace)

    @property
    def pulse_times(self) -> Array:
        """(0,) as in `TimedPlan`: a smooth flight has no pulses."""
        return np.zeros(0)

    @property
    def pulse_durations(self) -> Array:
        """(0,) as in `TimedPlan`."""
        return np.zeros(0)

    @property
    def pulses(self) -> Array:
        """(0, 3) as in `TimedPlan`."""
        return np.zeros((0, 3))

    @property
    def corner_cut(self) -> float:
        """0, as in `TimedPlan`: the robot is on the curve at all times [m]."""
        return 0.0

    @property
    def switch_times(self) -> Array:
        """(K + 1,) times between which acceleration and jerk do not jump [s].

        But for the jerk where a piece of the curve ends, at whole numbers of its parameter.
        """
        return self._pace.times

    def at(self, times: ArrayLike) -> States:
        """Configurations, velocities, accelerations, thrust and torques.

        Where the acceleration jumps, the value after the jump is returned.

        Args:
            times: (N,) times [s].

        Returns:
            The states at these times.

        Raises:
            InvalidInput: no times, or times outside [0, duration].
        """
        instants = self._instants(times)
        return _states(self.curve, self._pace, instants)

    @property
    def timetable(self) -> LawTimes:
        """The times at the places of its curve, without waits."""
        return self._pace.timetable(self.curve.pieces)

    def pulse_accelerations(self, times: ArrayLike) -> Array:
        """(N, 3) zeros at times (N,), as in `TimedPlan` between its pulses [m/s^2].

        Raises:
            InvalidInput: times that are not finite numbers.
        """
        return np.zeros((len(finite_array("times", times, (-1,))), 3))

    def speeds(self, times: ArrayLike) -> tuple[Array, Array, Array]:
        """The curve's parameter s, from 0 to the number of pieces, and its derivatives by time.

        Args:
            times: (N,) times [s].

        Returns:
            s, s' [1/s] and s'' [1/s^2], (N,) each.

        Raises:
            InvalidInput: no times, or times outside [0, duration].
        """
        instants = self._instants(times)
        return self._pace.on(self._pace.piece(instants), instants)


def curve_flight(
    curve: Curve,
    limits: FlightLimits,
    duration: float | None = None,
    ends: EndSpeeds = EndSpeeds(),  # noqa: B008 - it is immutable
) -> CurveFlight:
    """A curve flown from rest to rest; see `Plan.timed`.

    Args:
        curve: the curve.
        limits: the limits.
        duration: of the flight [s]; None for the shortest.
        ends: s' at both ends [1/s], where the flight does not rest there.

    Raises:
        InvalidInput: see `pace_within`.
    """
    return flight_at(curve, limits, pace_within(curve, limits, duration, ends), ends)


def flight_at(
    curve: Curve,
    limits: FlightLimits,
    pace: Pace,
    ends: EndSpeeds = EndSpeeds(),  # noqa: B008 - it is immutable
) -> CurveFlight:
    """A curve flown at a pace that keeps the limits.

    Args:
        curve: the curve.
        limits: the limits.
        pace: the pace.
        ends: s' at both ends [1/s].
    """
    straight = _straight_delta_v(curve, pace.duration, float(limits.acceleration[0]))
    if ends != EndSpeeds():
        straight = _delta_v_of_two_pulses(curve, pace)
    return CurveFlight(
        curve=curve, delta_v=_delta_v(curve, pace), straight_delta_v=straight, _pace=pace
    )


def _states(curve: Curve, pace: Pace, times: Array) -> States:
    s, speed, acceleration = pace.on(pace.piece(times), times)
    s = np.clip(s, 0.0, curve.pieces)
    path, dynamics = dynamics_at(curve, s)
    return states_along(path, dynamics, s / curve.pieces, speed, acceleration)


def _rests(curve: Curve, pace: Pace) -> Array:
    """(k,) times [s] of the ends of pieces at which nothing moves with s."""
    inner = np.arange(1.0, curve.pieces)
    if len(inner) == 0:
        return inner
    path = curve.at(inner)
    rates = np.hstack([path.base[:, 0], path.turn[:, 0], path.rates[:, 0]])
    return pace.times_at(inner[np.max(np.abs(rates), axis=1) <= SMALLEST_RATE])


def _delta_v(curve: Curve, pace: Pace) -> float:
    """Integral of |thrust| / mass [m/s], by Gauss quadrature on the pieces of the law."""
    if curve.mode.floats:
        return 0.0
    half = np.diff(pace.times)[:, None] / 2.0
    times = pace.times[:-1, None] + half * (1.0 + _POINTS)
    thrust = _states(curve, pace, times.ravel()).thrust
    pushes = np.linalg.norm(thrust, axis=1).reshape(times.shape) / curve.robot.mass
    return float(np.sum(half * _WEIGHTS * pushes))


def _straight_delta_v(curve: Curve, duration: float, strength: float) -> float:
    """Least delta-v [m/s] between the centres of mass at both ends, |thrust| / mass limited."""
    if curve.mode.floats:
        return 0.0
    return straight_delta_v(_change_of_place(curve), duration, strength)


def _delta_v_of_two_pulses(curve: Curve, pace: Pace) -> float:
    """Least delta-v [m/s] of any flight with these ends of the centre of mass, thrust unlimited.

    With the change of place d in the time t, from the velocity v to the velocity w: a pulse of
    d / t - v at the start, a coast, and a pulse of w - d / t at the end.
    """
    if curve.mode.floats:
        return 0.0
    ends = dynamics_at(curve, np.array([0.0, curve.pieces]))[1].thrust[:, 0] / curve.robot.mass
    last = pace.on(np.array([len(pace.begin) - 1]), pace.times[-1:])[1][0]
    mean = _change_of_place(curve) / pace.duration
    pulses = np.array([mean - ends[0] * pace.begin[0, 1], ends[1] * last - mean])
    return float(np.sum(np.linalg.norm(pulses, axis=1)))


def _change_of_place(curve: Curve) -> Array:
    """(3,) from the centre of mass at the start of a curve to that at its end, world axes [m]."""
    return change_of_place(curve.robot, curve.at(np.array([0.0, curve.pieces])).configurations)
