"""Fastest speed profiles along a straight run: trapezoid, and S-curve with a limit on jerk.

The S-curve is computed by Ruckig (L. Berscheid and T. Kroeger, "Jerk-limited Real-time Trajectory
Generation with Arbitrary Target States", 2021). The trapezoid is a closed form. Ruckig with an
infinite jerk agrees with it, except at end speeds that are just reachable within the run, which are
usual here: rounding then makes Ruckig move back and forth, which takes up to 1e6 times as long.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.errors import IntegrationError

_NO_SPEED, _NO_ACCELERATION, _NO_JERK = 1e3, 1e6, 1e9
"""Values for "no limit" in the units of `s_curve`, where about 1 is needed. They lengthen the
duration by 1e-4 at most and keep Ruckig within the range of its tolerances."""


class Phase(NamedTuple):
    """A part of a profile with constant jerk.

    Attributes:
        duration: duration [s].
        acceleration: x'' at its start.
        jerk: x'''.
    """

    duration: float
    acceleration: float
    jerk: float


def trapezoid(length: float, begin: float, end: float, top: float, push: float) -> list[Phase]:
    """Accelerate from one speed, cruise if the largest speed is reached, and decelerate.

    Args:
        length: length of the run in x.
        begin: x' at its start.
        end: x' at its end, reachable within the length.
        top: limit on x'.
        push: limit on x''.

    Returns:
        Three phases, some of which may have no duration.
    """
    peak = min(top, np.sqrt(push * length + (begin**2 + end**2) / 2.0))
    up, down = max(peak - begin, 0.0) / push, max(peak - end, 0.0) / push
    cruise = length - up * (peak + begin) / 2.0 - down * (peak + end) / 2.0
    return [
        Phase(up, push, 0.0),
        Phase(max(cruise, 0.0) / peak, 0.0, 0.0),
        Phase(down, -push, 0.0),
    ]


def s_curve(length: float, top: float, push: float, jerk: float) -> list[Phase]:
    """Move from rest to rest in phases of constant jerk.

    Ruckig works in units of the length and of the longest time that any one limit requires.

    Args:
        length: length of the run in x.
        top: limit on x'.
        push: limit on x''.
        jerk: limit on x'''.

    Returns:
        The phases, none of which contains a change of sign of the acceleration.

    Raises:
        IntegrationError: Ruckig finds no profile.
    """
    from ruckig import InputParameter, Result, Ruckig, Trajectory

    unit = max(length / top, np.sqrt(length / push), np.cbrt(length / jerk))
    query, answer = InputParameter(1), Trajectory(1)
    query.current_position, query.target_position = [0.0], [1.0]
    query.max_velocity = [min(top * unit / length, _NO_SPEED)]
    query.max_acceleration = [min(push * unit**2 / length, _NO_ACCELERATION)]
    query.max_jerk = [min(jerk * unit**3 / length, _NO_JERK)]
    result = Ruckig(1).calculate(query, answer)
    if result not in (Result.Working, Result.Finished):
        raise IntegrationError(f"no time law for length {length:g} ({result})")
    profile = answer.profiles[0][0]
    phases: list[Phase] = []
    for t, a, j in zip(profile.t, profile.a, profile.j, strict=False):  # `a` has the end's too
        zero = -a / j if a * (a + j * t) < 0.0 else 0.0  # time at which the acceleration is zero
        parts = [(zero, a), (t - zero, 0.0)] if zero > 0.0 else [(t, a)]
        phases += [
            Phase(float(part) * unit, float(first) * length / unit**2, j * length / unit**3)
            for part, first in parts
        ]
    return phases
