"""`Descent`: offsets of control points, round by round to a smaller change of velocity.

Round by round the clearances at stations are replaced by linear functions that are nowhere above
them (`collision.near_pairs`), and the best offsets under these are taken
(`least_change_programme`): where a path has been clear at all stations it stays so, and its change
of velocity falls.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.collision.near_pairs import NearPairs
from ffsr_plan.collision.shape_placements import Placements
from ffsr_plan.core.arrays import Array
from ffsr_plan.fuel.least_change_programme import Cuts, Programme
from ffsr_plan.fuel.stations import Stations

_ROUNDS, _LEAST_GAIN = 40, 1e-3  # of one descent; relative, over which it goes on
_LEAST_RISE = 0.1  # of the least clearance, in the clearance asked for, over which it goes on
_REACH, _SHRINKING, _LEAST_REACH = 1.0, 0.85, 0.2
"""Largest change of an offset in a round, in steps along the way: at first, the factor by which it
shrinks after a round of little gain, and at least."""
_LARGE_GAIN = 0.05  # relative, after which it does not shrink


class Descent:
    """Descents of the offsets of one polygon among the same obstacles."""

    def __init__(
        self, programme: Programme, pairs: NearPairs, directions: Array, step: float
    ) -> None:
        """Prepare descents.

        Args:
            programme: the linear programmes.
            pairs: measures clearances.
            directions: (axes, 3) orthonormal directions of the offsets, world axes.
            step: distance of two control points along the way [m].
        """
        self._programme, self._pairs = programme, pairs
        self._directions, self._step = directions, step

    def descended(
        self, placed: Placements, stations: Stations, offsets: Array, spare: float
    ) -> Array:
        """Offsets after rounds that end where little is gained.

        Args:
            placed: placements of the robot's shapes at the stations without offsets.
            stations: where clearance counts.
            offsets: (m + 1, axes) at first [m].
            spare: clearance asked for [m].

        Returns:
            (m + 1, axes) offsets [m]; a station may lack clearance.
        """
        last, worst, reach = np.inf, -np.inf, _REACH
        for _ in range(_ROUNDS):
            cuts = self._cuts(placed, stations, offsets, spare, reach * self._step)
            offsets = self._programme.best(offsets, cuts, reach * self._step)
            value, least = self._programme.change(offsets), float(np.min(cuts.values, initial=0.0))
            stuck = least > -0.1 * spare or least - worst < _LEAST_RISE * spare
            if stuck and abs(last - value) < _LEAST_GAIN * value:
                break
            if last - value < _LARGE_GAIN * value:
                reach = max(reach * _SHRINKING, _LEAST_REACH)
            last, worst = value, least
        return offsets

    def _cuts(
        self, placed: Placements, stations: Stations, offsets: Array, spare: float, radius: float
    ) -> Cuts:
        """Linear clearances of all pairs that a round may bring together."""
        directions = self._directions
        shifts = stations.displaced(offsets) @ directions
        limit = spare + radius * np.sqrt(len(directions))
        points, slopes, values, of_station = [], [], [], []
        for k, shift in enumerate(shifts):
            gaps = self._pairs.at(placed, k, shift, limit)
            across = gaps.gradients @ directions.T
            points.append(np.tile(stations.points[k], (len(across), 1)))
            slopes.append(stations.shares[k][None, :, None] * across[:, None, :])
            values.append(gaps.distances - spare)
            of_station.append(np.full(len(across), k))
        return Cuts(*map(np.concatenate, (points, slopes, values, of_station)))
