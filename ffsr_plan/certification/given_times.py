"""`GivenTimes`: the pace of a motion whose corners have given times."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ffsr_plan.bodies.pace import Pace
from ffsr_plan.core.arrays import Array


@dataclass(frozen=True, eq=False)
class GivenTimes(Pace):
    """The pace at which edge k is run evenly from the k-th to the next of given times.

    Attributes:
        times: (m + 1,) of the corners, increasing [s].
    """

    times: Array

    @classmethod
    def at(cls, times: Array) -> GivenTimes:
        """The pace with corners at times (m + 1,) [s]."""
        return cls(float(times[-1] - times[0]), 0.0, len(times) - 1, times)

    def instants(self, places: Array) -> Array:
        """Times [s] at places (...) from 0, the start, to m, the end."""
        found: Array = np.interp(places, np.arange(self.edges + 1.0), self.times)
        return found

    def places(self, times: Array) -> Array:
        """Places (...) from 0 to m at times [s]: the inverse of `instants`."""
        found: Array = np.interp(times, self.times, np.arange(self.edges + 1.0))
        return found

    def is_even(self, edge: int) -> bool:
        """Whether progress is uniform in time over an edge: it is."""
        return True
