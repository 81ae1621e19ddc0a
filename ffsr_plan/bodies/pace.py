"""The pace at which a path is run: the time at every place on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ffsr_plan.core.arrays import Array


class Mover(Protocol):
    """A body that moves, or debris."""

    @property
    def speed(self) -> float:
        """The largest speed of any of its points [m/s]."""


class Timetable(Protocol):
    """When a path of m edges is where: what a proof past bodies that move asks of a pace."""

    def instants(self, places: Array) -> Array:
        """(...) times [s] at places (...) from 0 to m, which do not fall from start to goal."""

    def is_even(self, edge: int) -> bool:
        """Whether progress is uniform in time over an edge."""


@dataclass(frozen=True)
class Pace:
    """A path of m equal edges, run in a given time.

    Its progress speeds up evenly in the first share of the time, stays, and slows down evenly in
    the last share. So a layer has one time, and time never runs back along an edge.

    Attributes:
        duration: of the whole path [s].
        ramp: share of the duration in which it speeds up, and in which it slows down, 0 to 0.5.
        edges: m, number of edges.
    """

    duration: float
    ramp: float
    edges: int

    def instants(self, places: Array) -> Array:
        """Times at places on the path.

        Args:
            places: (...) from 0, the start, to m, the goal.

        Returns:
            (...) times [s].
        """
        share = np.asarray(places) / self.edges
        if self.ramp == 0.0:
            return share * self.duration
        nearer = np.minimum(share, 1.0 - share)  # to start or goal
        speed, ramp = 1.0 / (1.0 - self.ramp), self.ramp
        slow = np.sqrt(np.maximum(2.0 * ramp * nearer / speed, 0.0))
        time = np.where(nearer < 0.5 * speed * ramp, slow, nearer / speed + 0.5 * ramp)
        return self.duration * np.where(share <= 0.5, time, 1.0 - time)

    def places(self, times: Array) -> Array:
        """Places on the path at times: the inverse of `instants`.

        Args:
            times: (...) from 0 to the duration [s].

        Returns:
            (...) places, from 0, the start, to m, the goal.
        """
        share = np.asarray(times) / self.duration
        if self.ramp == 0.0:
            return share * self.edges
        nearer = np.minimum(share, 1.0 - share)  # to begin or end
        speed, ramp = 1.0 / (1.0 - self.ramp), self.ramp
        run = np.where(nearer < ramp, 0.5 * nearer**2 / ramp, nearer - 0.5 * ramp)
        return self.edges * np.where(share <= 0.5, speed * run, 1.0 - speed * run)

    def is_even(self, edge: int) -> bool:
        """Whether progress is uniform in time over an edge.

        Args:
            edge: its number.
        """
        nearer = min(edge, self.edges - 1 - edge) / self.edges
        return self.ramp == 0.0 or nearer >= 0.5 * self.ramp / (1.0 - self.ramp)


def slip(bodies: Sequence[Mover], clearance: float) -> float:
    """Time by which a run may be early or late and is still free of bodies that move [s].

    The robot is then where it was proven free, and no body has come nearer than it can move in that
    time.

    Args:
        bodies: the bodies, and debris.
        clearance: proven all along the run [m].
    """
    fastest = max((body.speed for body in bodies), default=0.0)
    return clearance / fastest if fastest > 0.0 else np.inf
