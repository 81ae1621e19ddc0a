"""`TimeLaw`: when a motion is where, as fast as limits on speed, acceleration and jerk allow.

Along a straight run x is one number, and the fastest way along it has a closed form: full
acceleration, full speed, full braking. With a limit on jerk, Ruckig finds it (L. Berscheid and
T. Kroeger, "Jerk-limited Real-time Trajectory Generation with Arbitrary Target States", 2021).
Where runs may follow each other without a rest, the speeds in between are the highest from which
the robot can still brake and which it can reach: one pass forwards, one backwards. In the plane of
x and x'^2, where limits on acceleration are slopes, no curve runs above the one so found.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.errors import FfsrPlanError
from ffsr_plan.trajectory.straight_runs import StraightRuns

_NO_SPEED, _NO_ACCELERATION, _NO_JERK = 1e3, 1e6, 1e9
"""What counts as no limit in the units of `_s_curve`, where about 1 is needed: costs 1e-4 of the
duration at most, and keeps Ruckig within numbers that it can tell apart."""

_ROUNDING = 1e-12  # of a run's duration: no phase is as short


class TimeLaw(NamedTuple):
    """x(t), a cubic on each of K pieces."""

    times: Array
    """(K + 1,) where pieces begin and end [s]."""
    begin: Array
    """(K, 4) x, x', x'', x''' at the beginning of each piece."""
    run: IntArray
    """(K,) the straight run that each piece is on."""

    @property
    def duration(self) -> float:
        """[s]."""
        return float(self.times[-1])

    def piece(self, times: Array) -> IntArray:
        """(N,) piece at times (N,); where two meet, the later one."""
        found = np.searchsorted(self.times, times, side="right") - 1
        return np.clip(found, 0, len(self.run) - 1)

    def on(self, piece: IntArray, times: Array) -> tuple[Array, Array, Array]:
        """x, x' and x'' (N,) at times (N,) on pieces (N,)."""
        t = times - self.times[piece]
        x, speed, acceleration, jerk = self.begin[piece].T
        return (
            x + t * (speed + t * (acceleration / 2.0 + t * jerk / 6.0)),
            speed + t * (acceleration + t * jerk / 2.0),
            acceleration + t * jerk,
        )

    def slowed(self, factors: Array) -> TimeLaw:
        """The same way, every piece taking longer by factors (K,), equal between two rests."""
        times = np.concatenate([[0.0], np.cumsum(np.diff(self.times) * factors)])
        return TimeLaw(times, self.begin / factors[:, None] ** np.arange(4), self.run)


def time_law(
    runs: StraightRuns, limits: tuple[Array, Array, Array], velocity_jump: float
) -> tuple[TimeLaw, Array]:
    """The fastest law, and the speeds x' (r + 1,) at the beginning of runs and at the end.

    Args:
        runs: r of them, at least one.
        limits: (r,) most x', x'' and x''' of each run.
        velocity_jump: most that the base's velocity may change at once [m/s].
    """
    speeds = _speeds_between(runs, limits, velocity_jump)
    durations, begin, owner = [], [], []
    for k, length in enumerate(runs.lengths):
        top, push, jerk = (float(each[k]) for each in limits)
        if np.isinf(jerk):
            phases = _trapezoid(length, speeds[k], speeds[k + 1], top, push)
        else:
            phases = _s_curve(length, top, push, jerk)
        x, speed = runs.corners[runs.first[k]], speeds[k]
        rounding = _ROUNDING * sum(t for t, _, _ in phases)
        for t, acceleration, change in phases:
            if t > rounding:
                durations.append(t)
                begin.append([x, speed, acceleration, change])
                owner.append(k)
            x += t * (speed + t * (acceleration / 2.0 + t * change / 6.0))
            speed += t * (acceleration + t * change / 2.0)
    times = np.concatenate([[0.0], np.cumsum(durations)])
    return TimeLaw(times, np.array(begin), np.array(owner)), speeds


def _speeds_between(
    runs: StraightRuns, limits: tuple[Array, Array, Array], velocity_jump: float
) -> Array:
    """(r + 1,) highest x' at the ends of runs; zero is a rest."""
    top, push, _ = limits
    speeds = np.zeros(len(top) + 1)
    if len(top) > 1:
        jump = np.linalg.norm(runs.jumps(), axis=1)
        speeds[1:-1] = np.minimum(velocity_jump / jump, np.minimum(top[:-1], top[1:]))
    gain = 2.0 * push * runs.lengths
    for k in range(len(top)):
        speeds[k + 1] = min(speeds[k + 1], np.sqrt(speeds[k] ** 2 + gain[k]))
    for k in reversed(range(len(top))):
        speeds[k] = min(speeds[k], np.sqrt(speeds[k + 1] ** 2 + gain[k]))
    return speeds


Phase = tuple[float, float, float]
"""Duration [s], and x'' and x''' at its beginning."""


def _trapezoid(length: float, begin: float, end: float, top: float, push: float) -> list[Phase]:
    """Speed up from x' = `begin`, keep to `top` if it is reached, slow down to `end`."""
    peak = min(top, np.sqrt(push * length + (begin**2 + end**2) / 2.0))
    up, down = max(peak - begin, 0.0) / push, max(peak - end, 0.0) / push
    cruise = length - up * (peak + begin) / 2.0 - down * (peak + end) / 2.0
    return [(up, push, 0.0), (max(cruise, 0.0) / peak, 0.0, 0.0), (down, -push, 0.0)]


def _s_curve(length: float, top: float, push: float, jerk: float) -> list[Phase]:
    """From rest to rest in phases of constant jerk.

    Ruckig is asked in units of the length and of a time that every limit by itself demands.
    """
    from ruckig import InputParameter, Result, Ruckig, Trajectory

    second = max(length / top, np.sqrt(length / push), np.cbrt(length / jerk))
    query, answer = InputParameter(1), Trajectory(1)
    query.current_position, query.target_position = [0.0], [1.0]
    query.max_velocity = [min(top * second / length, _NO_SPEED)]
    query.max_acceleration = [min(push * second**2 / length, _NO_ACCELERATION)]
    query.max_jerk = [min(jerk * second**3 / length, _NO_JERK)]
    result = Ruckig(1).calculate(query, answer)
    if result not in (Result.Working, Result.Finished):
        raise FfsrPlanError(f"no time law for length {length:g} ({result})")
    profile = answer.profiles[0][0]
    phases: list[Phase] = []
    for t, a, j in zip(profile.t, profile.a, profile.j, strict=False):  # `a` has the end's too
        turn = -a / j if a * (a + j * t) < 0.0 else 0.0  # so that no piece pushes, then brakes
        parts = [(turn, a), (t - turn, 0.0)] if turn > 0.0 else [(t, a)]
        phases += [
            (float(part) * second, float(first) * length / second**2, j * length / second**3)
            for part, first in parts
        ]
    return phases
