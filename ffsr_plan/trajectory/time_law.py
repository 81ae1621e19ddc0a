"""Fastest time law along straight runs within limits on speed, acceleration and jerk.

Along a straight run the position is one number x, and the fastest profile is a trapezoid or an
S-curve (`profiles`). If runs may follow each other without a rest, the speeds between them are the
highest from which the robot can still brake and which it can reach: one pass forwards, one
backwards. In the plane of x and x'^2, in which limits on acceleration are slopes, no admissible
curve lies above the result. The runs of a motion, rests between them and pulses at corners are
specific to this robot, so no library is used here; a law without rests (by TOPP-RA, for example)
would need a smoothed path.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.trajectory.profiles import s_curve, trapezoid
from ffsr_plan.trajectory.straight_runs import StraightRuns

_SHORTEST_PHASE = 1e-12  # share of a run's duration below which a phase is a rounding error


class TimeLaw(NamedTuple):
    """The position x(t), a cubic polynomial on each of K pieces.

    Attributes:
        times: (K + 1,) times between the pieces [s].
        begin: (K, 4) x, x', x'', x''' at the start of each piece.
        run: (K,) the straight run of each piece.
    """

    times: Array
    begin: Array
    run: IntArray

    @property
    def duration(self) -> float:
        """Duration of the whole law [s]."""
        return float(self.times[-1])

    def piece(self, times: Array) -> IntArray:
        """(N,) pieces at times (N,) [s]; between two pieces, the later one."""
        pieces = np.searchsorted(self.times, times, side="right") - 1
        return np.clip(pieces, 0, len(self.run) - 1)

    def on(self, piece: IntArray, times: Array) -> tuple[Array, Array, Array]:
        """Position, speed and acceleration on given pieces.

        Args:
            piece: (N,) pieces.
            times: (N,) times on them [s].

        Returns:
            x, x' and x'', (N,) each.
        """
        t = times - self.times[piece]
        x, speed, acceleration, jerk = self.begin[piece].T
        return (
            x + t * (speed + t * (acceleration / 2.0 + t * jerk / 6.0)),
            speed + t * (acceleration + t * jerk / 2.0),
            acceleration + t * jerk,
        )

    def slowed(self, factors: Array) -> TimeLaw:
        """The law with each piece's duration multiplied by a factor.

        Args:
            factors: (K,) factors, equal for all pieces between two rests.
        """
        times = np.concatenate([[0.0], np.cumsum(np.diff(self.times) * factors)])
        return TimeLaw(times, self.begin / factors[:, None] ** np.arange(4), self.run)


def time_law(
    runs: StraightRuns, limits: tuple[Array, Array, Array], velocity_jump: float
) -> tuple[TimeLaw, Array]:
    """The fastest time law along straight runs.

    Args:
        runs: r runs, at least one.
        limits: (r,) each: limits on x', x'' and x''' of each run.
        velocity_jump: largest change of the base's velocity at a corner [m/s].

    Returns:
        The law, and the speeds x' (r + 1,) at the start of each run and at the end.
    """
    speeds = _speeds_between(runs, limits, velocity_jump)
    durations, begin, owner = [], [], []
    for k, length in enumerate(runs.lengths):
        top, push, jerk = (float(each[k]) for each in limits)
        if np.isinf(jerk):
            phases = trapezoid(length, speeds[k], speeds[k + 1], top, push)
        else:
            phases = s_curve(length, top, push, jerk)
        x, speed = runs.corners[runs.first[k]], speeds[k]
        shortest = _SHORTEST_PHASE * sum(phase.duration for phase in phases)
        for t, acceleration, change in phases:
            if t > shortest:
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
    """(r + 1,) highest x' at the start of each run and at the end; zero is a rest."""
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
