"""Fastest time law along straight runs within limits on speed, acceleration and jerk.

Along a straight run the position is one number x, and the fastest profile is a trapezoid or an
S-curve (`profiles`). If runs may follow each other without a rest, the speeds between them are the
highest from which the robot can still brake and which it can reach: one pass forwards, one
backwards. In the plane of x and x'^2, in which limits on acceleration are slopes, no admissible
curve lies above the result. The runs of a motion, rests between them and pulses at corners are
specific to this robot, so no library is used here; a law without rests (by TOPP-RA, for example)
would need a smoothed path.

If a corner is passed at the speed v = x', the base's velocity changes by J v, with the jump J per
unit of x'. With the acceleration a of the thrusters this pulse takes the time J v / a. Half of it
lies before the corner and half after it, and meanwhile x' is constant, so that all thrust serves
the pulse. On each side of the corner it takes the length J w / 2a in x, where w = v^2. Both pulses
of a run of length l and the change of speed between them, with the limit p on x'', have to fit in:

    J w / 2a + J' w' / 2a + |w' - w| / 2p <= l

These limits are linear in w, like those without pulses, and each half of a pulse gets half of a run
at most. Where J / a < 1 / p the largest w' rises with w; otherwise it is taken for the largest w
there may be. So two passes suffice here too. The higher a speed between runs, the shorter the law:
J / a is at most 1 / p + 1 / q for the runs on both sides, since no base accelerates by more than a,
and then the derivative of the duration by v is not positive.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.trajectory.cubic_pieces import evaluate
from ffsr_plan.trajectory.profiles import Phase, s_curve, trapezoid
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
        return evaluate(self.begin[piece], times - self.times[piece])

    def slowed(self, factors: Array) -> TimeLaw:
        """The law with each piece's duration multiplied by a factor.

        Args:
            factors: (K,) factors, equal for all pieces between two rests.
        """
        times = np.concatenate([[0.0], np.cumsum(np.diff(self.times) * factors)])
        return TimeLaw(times, self.begin / factors[:, None] ** np.arange(4), self.run)

    def after(self, wait: float) -> TimeLaw:
        """The law after a wait at its start [s], a piece of its own."""
        first = [[self.begin[0, 0], 0.0, 0.0, 0.0]]
        times = np.append(0.0, self.times + wait)
        return TimeLaw(times, np.vstack([first, self.begin]), np.append(self.run[:1], self.run))


class PulseLimits(NamedTuple):
    """Limits on the pulses of the thrusters at corners.

    Attributes:
        velocity_jump: largest change of the base's velocity at a corner [m/s].
        acceleration: acceleration of the base by the thrusters during a pulse [m/s^2].
    """

    velocity_jump: float
    acceleration: float


def time_law(
    runs: StraightRuns, limits: tuple[Array, Array, Array], pulses: PulseLimits
) -> tuple[TimeLaw, Array, Array]:
    """The fastest time law along straight runs.

    Args:
        runs: r runs, at least one.
        limits: (r,) each: limits on x', x'' and x''' of each run.
        pulses: limits on pulses.

    Returns:
        The law; the speeds x' (r + 1,) at the start of each run and at the end; and how long the
        pulse lasts there, (r + 1,) [s]. Over half of this time before a corner and half after it
        x' is constant.
    """
    turning = _turning_times(runs, pulses)
    speeds = _speeds_between(runs, limits, pulses.velocity_jump, turning)
    lasting = speeds * turning
    durations, begin, owner = [], [], []
    for k, length in enumerate(runs.lengths):
        top, push, jerk = (float(each[k]) for each in limits)
        if np.isinf(jerk):
            half, next_half = (float(lasting[i]) / 2.0 for i in (k, k + 1))
            between = length - half * speeds[k] - next_half * speeds[k + 1]
            phases = [
                Phase(half, 0.0, 0.0),
                *trapezoid(between, speeds[k], speeds[k + 1], top, push),
                Phase(next_half, 0.0, 0.0),
            ]
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
    return TimeLaw(times, np.array(begin), np.array(owner)), speeds, lasting


def _turning_times(runs: StraightRuns, pulses: PulseLimits) -> Array:
    """(r + 1,) duration of a pulse per unit of x' at each corner; 0 where the robot rests."""
    times = np.zeros(len(runs.first) + 1)
    if pulses.velocity_jump > 0.0 and len(times) > 2:
        jump = np.linalg.norm(runs.jumps(), axis=1)
        times[1:-1] = np.where(np.isfinite(jump), jump / pulses.acceleration, 0.0)
    return times


def _speeds_between(
    runs: StraightRuns,
    limits: tuple[Array, Array, Array],
    velocity_jump: float,
    turning: Array,
) -> Array:
    """(r + 1,) highest x' at the start of each run and at the end; zero is a rest."""
    (top, push, _), lengths = limits, runs.lengths
    squares = np.zeros(len(top) + 1)
    if len(top) > 1:
        jump = np.linalg.norm(runs.jumps(), axis=1)
        squares[1:-1] = np.minimum(velocity_jump / jump, np.minimum(top[:-1], top[1:])) ** 2
        with np.errstate(divide="ignore"):
            fitting = np.minimum(lengths[:-1], lengths[1:]) / turning[1:-1]
        squares[1:-1] = np.minimum(squares[1:-1], fitting)
    most = np.array(squares)
    for k in range(len(top)):
        other = _OtherEnd(squares[k], most[k], turning[k])
        squares[k + 1] = min(squares[k + 1], other.reaches(turning[k + 1], push[k], lengths[k]))
    for k in reversed(range(len(top))):
        other = _OtherEnd(squares[k + 1], most[k + 1], turning[k + 1])
        squares[k] = min(squares[k], other.reaches(turning[k], push[k], lengths[k]))
    return np.sqrt(squares)


class _OtherEnd(NamedTuple):
    """x'^2 at one end of a run, the most it may be, and a pulse's duration per unit of x'."""

    square: float
    most: float
    turning: float

    def reaches(self, turning: float, push: float, length: float) -> float:
        """The highest x'^2 at the other end, given the run's limit on x'' and its length."""
        gain = 1.0 / push - self.turning
        square = self.square if gain > 0.0 else self.most
        return (2.0 * length + gain * square) / (1.0 / push + turning)
