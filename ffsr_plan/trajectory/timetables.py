"""When a path is where: the times at its places by a time law, or by the pace of a plan.

A proof past bodies that move needs no more of a flight than that (`bodies.pace.Timetable`). Where
the law rests, times are known to the square root of a rounding error only; but the flight is at the
place in question at the time found, up to rounding, and this is what the proof is about.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.bodies.pace import Pace
from ffsr_plan.core.arrays import Array
from ffsr_plan.trajectory.cubic_pieces import evaluate

_HALVINGS = 60  # of a piece, to the last digit of a time


class LawTimes(NamedTuple):
    """The times of a path that a time law x(t) runs, cubic on each of K pieces.

    Where the law waits, a place has the last of its times.

    Attributes:
        times: (K + 1,) between the pieces [s].
        begin: (K, 4) x, x', x'', x''' at the start of each piece; x does not fall.
        corners: (m + 1,) x at the ends of the path's edges, which are straight in x.
    """

    times: Array
    begin: Array
    corners: Array

    def instants(self, places: Array) -> Array:
        """(...) times [s] at places (...) from 0 to m."""
        x = np.interp(places, np.arange(float(len(self.corners))), self.corners)
        piece = np.clip(np.searchsorted(self.begin[:, 0], x, side="right") - 1, 0, None)
        low, high = self.times[piece], self.times[piece + 1]
        begin = self.begin[piece].reshape(-1, 4)
        for _ in range(_HALVINGS):
            middle = (low + high) / 2.0
            since = np.ravel(middle - self.times[piece])
            passed = evaluate(begin, since)[0].reshape(np.shape(x)) > x
            low, high = np.where(passed, low, middle), np.where(passed, middle, high)
        return np.where(x >= self.corners[-1], self.times[-1], low)

    def is_even(self, edge: int) -> bool:
        """False: a law may change its speed anywhere."""
        return False


class NodeTimes(NamedTuple):
    """The times of a curve along a path that is run at a pace of its own.

    Attributes:
        nodes: (m + 1,) places on the curve that belong to the nodes of the path, rising.
        pace: of the path, m edges.
    """

    nodes: Array
    pace: Pace

    def instants(self, places: Array) -> Array:
        """(...) times [s] at places (...) on the curve."""
        return self.pace.instants(np.interp(places, self.nodes, np.arange(float(len(self.nodes)))))

    def is_even(self, edge: int) -> bool:
        """Whether progress is uniform in time over a piece of the curve."""
        inside = np.any((self.nodes > edge) & (self.nodes < edge + 1))
        return self.pace.ramp == 0.0 and not inside
