"""The pace along a curve within given limits: the fastest, or the calmest in a given time."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from ffsr_plan.core.arrays import Array, Flags
from ffsr_plan.core.checks import number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.smooth_flight.averaged_pace import JerkLimits
from ffsr_plan.smooth_flight.curve_samples import Curve, CurveSamples, curve_samples
from ffsr_plan.smooth_flight.limits_on_pace import demands
from ffsr_plan.smooth_flight.pace import Pace, pace_of
from ffsr_plan.smooth_flight.pace_search import EndSpeeds, Search
from ffsr_plan.trajectory.flight_limits import FlightLimits, check_limits

SMALLEST_RATE = 1e-12
"""Rate [m or rad per unit of s] below which something counts as at rest."""
_SAME = 1e-4  # relative tolerance of the duration before a law is slowed down to it
_ROUNDING = 1e-9
_LONGEST = 1e9  # [s] beyond which the squares of speeds come close to the least numbers


def pace_within(
    curve: Curve,
    limits: FlightLimits,
    duration: float | None = None,
    ends: EndSpeeds = EndSpeeds(),  # noqa: B008 - it is immutable
) -> Pace:
    """The fastest pace along a curve within limits, or the calmest that takes a given time.

    Args:
        curve: the curve.
        limits: the limits; pulses are none of them.
        duration: of the whole flight [s]; None for the shortest.
        ends: s' at both ends; only at rest, jerk can be limited.

    Raises:
        InvalidInput: a limit that is needed and not given, a duration shorter than the shortest, or
            longer than the speeds at the ends allow, a speed at an end that the limits do not
            allow, or a curve along which nothing moves.
    """
    samples = curve_samples(curve)
    moves = _moving(samples)
    if not np.any(moves):
        raise InvalidInput("plan", "one in which nothing moves", "a plan in which something moves")
    check_limits(limits, moves, curve.robot, curve.mode.floats)
    wanted = demands(limits, samples.path, samples.dynamics, curve.robot.mass)
    search, at_rest = Search(samples, wanted, ends), ends == EndSpeeds()
    jerks = bool(np.any(np.isfinite(limits.jerk) & moves))
    if not at_rest and jerks:
        raise InvalidInput("ends", ends, "zero with a limit on jerk")
    fastest = pace_of(samples.ends, search.fastest())
    if jerks:
        return _with_jerk(JerkLimits(curve, limits), search, fastest, duration)
    if duration is None:
        return fastest
    check_duration(duration, fastest.duration)
    if not at_rest:
        return pace_of(samples.ends, search.on_time(duration)).ending_at(duration)
    calm = pace_of(samples.ends, search.calmest(duration))
    return calm.slowed(max(duration / calm.duration, 1.0))


def _with_jerk(jerks: JerkLimits, search: Search, fastest: Pace, duration: float | None) -> Pace:
    """The same with limits on jerk, which averages over time keep."""
    shortest, width = jerks.fastest(fastest)
    if duration is None:
        return shortest
    check_duration(duration, shortest.duration)
    ends = search.samples.ends

    def law(logarithm: float) -> Pace:
        calm = search.ceiled(float(np.exp(logarithm)))
        return jerks.averaged(pace_of(ends, calm.fastest()), width)

    def late(logarithm: float) -> float:
        return float(np.log(law(logarithm).duration / duration))

    highest = float(np.log(np.max(fastest.begin[:, 1])))
    if late(highest) >= 0.0:
        return shortest.slowed(max(duration / shortest.duration, 1.0))
    lowest = float(np.log(0.5 * (ends[-1] - ends[0]) / duration))
    found = float(brentq(late, lowest, highest, xtol=_SAME, rtol=_SAME))
    while late(found) > 0.0:
        found += _SAME
    calm = law(found)
    return calm.slowed(max(duration / calm.duration, 1.0))


def check_duration(duration: float, shortest: float) -> None:
    """Raise `InvalidInput` for a duration in which a curve cannot be flown.

    Args:
        duration: the duration [s].
        shortest: that of the fastest flight within limits [s].
    """
    number("duration", duration, above=0.0, at_most=_LONGEST)
    if duration < shortest * (1.0 - _ROUNDING):
        allowed = f"at least {shortest:.6g} s, the fastest flight within these limits"
        raise InvalidInput("duration", duration, allowed)


def _moving(samples: CurveSamples) -> Flags:
    """(2 + nd,) whether thrusters move the base, wheels turn it, and each joint moves."""
    path = samples.path
    norms: list[Array] = [np.linalg.norm(each[:, 0], axis=1) for each in (path.base, path.turn)]
    rates = np.column_stack([*norms, np.abs(path.rates[:, 0])])
    return np.asarray(np.max(rates, axis=0) > SMALLEST_RATE)
