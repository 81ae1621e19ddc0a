"""`Pace`: the curve parameter as a function of time, cubic on every piece."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.trajectory.cubic_pieces import evaluate
from ffsr_plan.trajectory.timetables import LawTimes

_HALVINGS = 60  # of a piece, to the last digit of a time


class Pace(NamedTuple):
    """The curve parameter s(t), a cubic polynomial on each of K pieces.

    Attributes:
        times: (K + 1,) times between the pieces [s].
        begin: (K, 4) s, s', s'', s''' at the start of each piece.
    """

    times: Array
    begin: Array

    @property
    def duration(self) -> float:
        """Duration of the whole law [s]."""
        return float(self.times[-1])

    def piece(self, times: Array) -> IntArray:
        """(N,) pieces at times (N,) [s]; between two pieces, the later one."""
        pieces = np.searchsorted(self.times, times, side="right") - 1
        return np.clip(pieces, 0, len(self.begin) - 1)

    def on(self, piece: IntArray, times: Array) -> tuple[Array, Array, Array]:
        """(N,) each: s, s' and s'' at times (N,) on given pieces (N,)."""
        return evaluate(self.begin[piece], times - self.times[piece])

    def times_at(self, s: Array) -> Array:
        """(N,) times [s] at which the law is at parameters (N,), between those of its ends."""
        piece = np.searchsorted(self.begin[:, 0], s, side="right") - 1
        low, high = self.times[piece], self.times[piece + 1]
        for _ in range(_HALVINGS):
            middle = (low + high) / 2.0
            passed = self.on(piece, middle)[0] > s
            low, high = np.where(passed, low, middle), np.where(passed, middle, high)
        return low

    def timetable(self, pieces: int) -> LawTimes:
        """The times at the places of a curve of so many pieces, without waits."""
        return LawTimes(self.times, self.begin, np.arange(pieces + 1.0))

    def slowed(self, factor: float) -> Pace:
        """The law with all durations multiplied by a factor."""
        return Pace(self.times * factor, self.begin / factor ** np.arange(4))

    def after(self, wait: float) -> Pace:
        """The law after a wait at its start [s], a piece of its own."""
        first = [[self.begin[0, 0], 0.0, 0.0, 0.0]]
        return Pace(np.append(0.0, self.times + wait), np.vstack([first, self.begin]))

    def ending_at(self, time: float) -> Pace:
        """The same law with its last time [s] to the last digit; it differs by rounding alone."""
        return self._replace(times=np.append(self.times[:-1], time))


def pace_of(s: Array, squares: Array) -> Pace:
    """The law with constant s'' between given parameters.

    Args:
        s: (S + 1,) parameters, increasing.
        squares: (S + 1,) s'^2 there [1/s^2]; not zero at two successive ones.
    """
    speeds, lengths = np.sqrt(squares), np.diff(s)
    durations = 2.0 * lengths / (speeds[1:] + speeds[:-1])
    accelerations = np.diff(squares) / (2.0 * lengths)
    begin = np.column_stack([s[:-1], speeds[:-1], accelerations, np.zeros(len(lengths))])
    return Pace(np.concatenate([[0.0], np.cumsum(durations)]), begin)
