"""Distances along a flight: dense samples, halved where a contact could fit between two.

The way of a shape between two samples is taken to be that of its middle plus its rotation times its
radius. Where the distances at both are less together than that way and a tenth more, a sample is
taken in the middle. Unlike the travel bound of `sweep` this is a measurement and not a bound: the
curve's proof is the planner's, and this looks for what contradicts it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.verification.flights.flown_flight import FlownFlight
from ffsr_plan.verification.motion_samples import Samples, samples_of
from ffsr_plan.verification.separation import SampledDistances
from ffsr_plan.verification.urdf_reading import Bodies

_SPARE = 1.1  # of the way between two samples
_FINEST = 1e-6  # [m] way below which an interval is not halved
_MOST_SAMPLES = 100_000
_AT_ONCE = 1000


class Nearest(NamedTuple):
    """A least distance.

    Attributes:
        distance: [m].
        time: [s].
        names: of the link, or of both links.
    """

    distance: float
    time: float
    names: tuple[str, ...]


class FlownDistances(NamedTuple):
    """Distances along a flight.

    Attributes:
        clearance: the least distance to an obstacle; None without any.
        separation: the least distance of two links that must not touch; None without any.
        samples: number of configurations.
    """

    clearance: Nearest | None
    separation: Nearest | None
    samples: int


class _Measured(NamedTuple):
    """Distances (N, parts) at times (N,), middles (N, s, 3) and turns (N, s, 3, 3) of shapes."""

    times: Array
    distances: Array
    middles: Array
    turns: Array

    def merged(self, other: _Measured) -> _Measured:
        order = np.argsort(np.concatenate([self.times, other.times]), kind="stable")
        return _Measured(*(np.concatenate(each)[order] for each in zip(self, other, strict=True)))


class _Flown:
    """Measurements of one flight."""

    def __init__(self, flight: FlownFlight, bodies: Bodies) -> None:
        self._flight, self._bodies = flight, bodies
        self._origin = flight.problem.start[:3]
        self.distances = SampledDistances(bodies, flight.problem.obstacles, self._origin)
        self._radii = np.array([_radius(shape.points) + shape.swell for shape in bodies.shapes])

    def at(self, times: Array) -> _Measured:
        blocks = [self._block(times[k : k + _AT_ONCE]) for k in range(0, len(times), _AT_ONCE)]
        return _Measured(*(np.concatenate(each) for each in zip(*blocks, strict=True)))

    def _block(self, times: Array) -> _Measured:
        q = self._flight.at(times).configurations
        samples = samples_of(self._flight.problem.robot, self._bodies, self._origin, q)
        distances, count = self.distances, len(times)
        order, parts = np.arange(count), np.arange(distances.parts)
        middles = distances.middles(samples)
        distances.stretches(order, middles, np.zeros((count, distances.shapes)))
        which, part = np.repeat(order, len(parts)), np.tile(parts, count)
        far = np.full(len(which), np.inf)
        values = distances.at(samples, which, part, which, far).reshape(count, len(parts))
        return _Measured(times, values, middles, _world_turns(samples))

    def ways(self, found: _Measured) -> Array:
        """(N - 1, parts) ways between neighbouring samples [m]; of pairs, of both together."""
        moved = np.linalg.norm(np.diff(found.middles, axis=0), axis=2)
        apart = np.linalg.norm(np.diff(found.turns, axis=0), axis=(2, 3)) / np.sqrt(8.0)
        ways = moved + 2.0 * np.arcsin(np.minimum(apart, 1.0)) * self._radii
        pairs = self.distances.pairs
        both = ways[:, pairs[:, 0]] + ways[:, pairs[:, 1]]
        return np.hstack([ways[:, : self.distances.shapes], both])

    def least(self, found: _Measured, parts: IntArray) -> Nearest | None:
        """The least distance of some parts."""
        if not len(parts):
            return None
        row, column = np.unravel_index(
            np.argmin(found.distances[:, parts]), (len(found.times), len(parts))
        )
        part = int(parts[column])
        return Nearest(
            float(found.distances[row, part]), float(found.times[row]), self.distances.names[part]
        )


def flown_distances(flight: FlownFlight, bodies: Bodies, samples: int) -> FlownDistances:
    """Measure distances along a flight.

    Args:
        flight: the flight.
        bodies: its robot, from the URDF.
        samples: number of equal time steps at first.
    """
    flown = _Flown(flight, bodies)
    found = flown.at(np.linspace(0.0, flight.duration, samples + 1))
    while len(found.times) < _MOST_SAMPLES:
        ways = _SPARE * flown.ways(found)
        room = found.distances[:-1] + found.distances[1:]
        touching = np.minimum(found.distances[:-1], found.distances[1:]) <= 0.0
        hidden = np.any((room <= ways) & (ways > _FINEST) & ~touching, axis=1)
        if not hidden.any():
            break
        middles = 0.5 * (found.times[:-1] + found.times[1:])[hidden]
        found = found.merged(flown.at(middles))
    parts, shapes = np.arange(flown.distances.parts), flown.distances.shapes
    return FlownDistances(
        flown.least(found, parts[:shapes]), flown.least(found, parts[shapes:]), len(found.times)
    )


def _world_turns(samples: Samples) -> Array:
    """(N, s, 3, 3) rotations of the shapes, world axes."""
    turns: Array = samples.base_turns[:, None] @ samples.turns
    return turns


def _radius(points: Array) -> float:
    return float(np.linalg.norm(points - np.mean(points, axis=0), axis=1).max())
