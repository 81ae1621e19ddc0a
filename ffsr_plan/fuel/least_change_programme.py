"""The linear programme for offsets of least change of velocity under linear clearances.

The change of velocity along a polygon of equal times is the sum of the lengths of m + 1 vectors:
the first step, the second differences, and the last step. With offsets x_i they are n_i + v_i(x),
n_i those without offsets and v_i those of the x alone, and a part d_i of each may lie across what
offsets can do. So it minimises

    sum over i = 0 .. m of sqrt(d_i^2 + |n_i + v_i(x)|^2),

clearances c + g (x - x_0) >= floor at the stations. On a lattice offsets are lateral: n_i = 0, and
the part d_i is the step along the way at both ends and 0 in between. Each norm is replaced by the
largest of its tangents, which are nowhere above it: in the plane those of the second differences
are exact. The programme begins with some tangents and the nearest clearances at each station. It is
solved again with tangents at its solution and with the clearances missed there, until none is left.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray

_DIRECTIONS = 8  # of tangents of a norm in two dimensions, at first
_SLOPES = (0.05, 0.15, 0.3, 0.6)  # of tangents of norms with a part across, at first
_NEAREST = 3  # clearances of each station, at first
_PRECISION, _MISSED, _MOST_SOLUTIONS = 5e-4, 1e-9, 4  # relative; [m]
_KEPT = 12  # tangents of a vector that are kept, beyond the first ones
_PENALTY = 30.0
"""Price of a missing clearance, in change of velocity: no path is worth more than it saves."""


class Cuts(NamedTuple):
    """C linear clearances in the offsets, which may be missed at a price.

    Attributes:
        points: (C, 4) the control points that each depends on.
        slopes: (C, 4, axes) gradient by their offsets.
        values: (C,) clearance at the present offsets, less what is asked for [m].
        stations: (C,) station that each belongs to, in ascending order; at one station the
            clearances ascend too.
    """

    points: IntArray
    slopes: Array
    values: Array
    stations: IntArray

    def some(self, which: Flags) -> Cuts:
        """Those (C,) that are true."""
        points, slopes, values, stations = self
        return Cuts(points[which], slopes[which], values[which], stations[which])

    def at(self, change: Array) -> Array:
        """(C,) clearances, less what is asked for, after a change of the offsets (m + 1, axes)."""
        moved: Array = self.values + np.sum(self.slopes * change[self.points], axis=(1, 2))
        return moved


class Programme:
    """Programmes for the offsets of a polygon of m edges.

    The change of velocity is per unit of path parameter here: times m, that of a flight of unit
    duration.
    """

    def __init__(self, nominal: Array, across: Array, low: Array, high: Array) -> None:
        """Prepare programmes.

        Args:
            nominal: (m + 1, axes) the vectors without offsets [m], m at least 2, 1 to 3 axes.
            across: (m + 1,) part of each that no offset changes [m].
            low: (m + 1, axes) least offsets [m].
            high: (m + 1, axes) greatest offsets [m].
        """
        self._divisions, self._nominal, self._across = len(nominal) - 1, nominal, across
        self._low, self._high = low, high
        directions = _directions(nominal.shape[1])
        bent = [np.vstack([slope * directions for slope in (0.0, *_SLOPES)]) * d for d in across]
        self._basic = [
            each if d > 0.0 else directions for d, each in zip(across, bent, strict=True)
        ]
        self._tangents = list(self._basic)

    @classmethod
    def lateral(cls, divisions: int, step: float, rim: Array) -> Programme:
        """Programmes for lateral offsets on a lattice.

        Args:
            divisions: m, at least 2.
            step: distance of two layers [m].
            rim: (axes,) largest offset to either side [m], one or two axes.
        """
        ends = np.zeros(divisions + 1)
        ends[[0, -1]] = step
        widest = np.tile(rim, (divisions + 1, 1))
        return cls(np.zeros_like(widest), ends, -widest, widest)

    def change(self, offsets: Array) -> float:
        """The sum of the norms at offsets (m + 1, axes) [m]."""
        return float(np.sum(np.hypot(self._across, np.linalg.norm(self._vectors(offsets), axis=1))))

    def _vectors(self, offsets: Array) -> Array:
        """(m + 1, axes) what the norms are taken of, without the parts across."""
        moved: Array = self._nominal + vectors_of(offsets)
        return moved

    def best(self, offsets: Array, cuts: Cuts, radius: float) -> Array:
        """The best offsets near the present ones.

        Args:
            offsets: (m + 1, axes) [m]; the first and the last stay as they are.
            cuts: clearances around them.
            radius: by how much an offset may change along an axis [m].

        Returns:
            (m + 1, axes) [m]; the present ones where the programme has no solution.
        """
        best = offsets
        self._add_tangents(offsets)
        first = np.searchsorted(cuts.stations, cuts.stations)
        active = np.arange(len(first)) < first + _NEAREST
        for _ in range(_MOST_SOLUTIONS):
            solution = self._solve(offsets, cuts.some(active), radius)
            if solution is None:
                return best
            best, value, missing = solution
            left = cuts.at(best - offsets) + missing[cuts.stations]
            worst = _least_of_each(left, cuts.stations)
            missed = worst[left[worst] < -_MISSED]
            if not len(missed) and self.change(best) <= value * (1.0 + _PRECISION):
                break
            active[missed] = True
            self._add_tangents(best)
        return best

    def _add_tangents(self, offsets: Array) -> None:
        """Tangents at offsets (m + 1, axes)."""
        for i, vector in enumerate(self._vectors(offsets)):
            if self._across[i] > 0.0 or (len(vector) > 1 and np.linalg.norm(vector) > 1e-9):
                basic, added = np.split(self._tangents[i], [len(self._basic[i])])
                self._tangents[i] = np.vstack([basic, added[1 - _KEPT :], vector])

    def _rows_of_norms(self) -> tuple[Any, Array]:
        """Tangents as rows over offsets and norms: rows @ (x, t) <= bounds."""
        from scipy.sparse import coo_matrix

        m, axes = self._divisions, self._nominal.shape[1]
        which = np.repeat(np.arange(m + 1), [len(each) for each in self._tangents])
        touched, across = np.concatenate(self._tangents), self._across[which]
        lengths = np.hypot(across, np.linalg.norm(touched, axis=1))
        slopes = touched / lengths[:, None]
        least = across**2 / lengths + np.sum(slopes * self._nominal[which], axis=1)
        points, factors = _stencils(m)
        columns = points[which][:, :, None] * axes + np.arange(axes)
        values = factors[which][:, :, None] * slopes[:, None, :]
        rows = np.broadcast_to(np.arange(len(which))[:, None, None], columns.shape)
        norms = (m + 1) * axes + which
        entries = np.concatenate([values.ravel(), np.full(len(which), -1.0)])
        places = (
            np.concatenate([rows.ravel(), np.arange(len(which))]),
            np.concatenate([columns.ravel(), norms]),
        )
        return coo_matrix((entries, places), (len(which), (m + 1) * (axes + 1))), -least

    def _solve(
        self, offsets: Array, cuts: Cuts, radius: float
    ) -> tuple[Array, float, Array] | None:
        """The best offsets (m + 1, axes), their change by tangents, and (S,) clearance missing."""
        from scipy.optimize import linprog
        from scipy.sparse import bmat, coo_matrix

        m, axes = self._divisions, self._nominal.shape[1]
        count, corners = len(cuts.values), (m + 1) * axes
        stations = int(cuts.stations.max(initial=-1)) + 1
        columns = cuts.points[:, :, None] * axes + np.arange(axes)
        rows = np.broadcast_to(np.arange(count)[:, None, None], columns.shape)
        shape = count, corners + m + 1
        clear = coo_matrix((-cuts.slopes.ravel(), (rows.ravel(), columns.ravel())), shape)
        slack = coo_matrix(
            (np.full(count, -1.0), (np.arange(count), cuts.stations)), (count, stations)
        )
        tangents, most = self._rows_of_norms()
        matrix = bmat([[tangents, None], [clear, slack]] if count else [[tangents]], format="csr")
        bounds = np.concatenate([most, cuts.at(-offsets)])
        low = np.maximum(offsets - radius, np.minimum(offsets, self._low))
        high = np.minimum(offsets + radius, np.maximum(offsets, self._high))
        for end in (0, m):
            low[end] = high[end] = offsets[end]
        least = np.concatenate([low.ravel(), np.zeros(m + 1 + stations)])
        greatest = np.concatenate([high.ravel(), np.full(m + 1 + stations, np.inf)])
        prices = np.repeat([0.0, 1.0, _PENALTY], [corners, m + 1, stations])
        limits = np.column_stack([least, greatest])
        found = linprog(prices, matrix, bounds, bounds=limits, method="highs-ds")
        if found.x is None:
            return None
        norms, missing = np.split(found.x[corners:], [m + 1])
        return found.x[:corners].reshape(m + 1, axes), float(norms.sum()), missing


def _least_of_each(values: Array, groups: IntArray) -> IntArray:
    """(g,) place of the least value (C,) of each group (C,), which are in ascending order."""
    order = np.lexsort((values, groups))
    firsts: IntArray = order[np.flatnonzero(np.diff(groups, prepend=-1))]
    return firsts


def vectors_of(corners: Array) -> Array:
    """(m + 1, k) first step, second differences, last step of a polygon (m + 1, k)."""
    steps = np.diff(corners, axis=0)
    return np.vstack([steps[:1], np.diff(steps, axis=0), steps[-1:]])


def _directions(axes: int) -> Array:
    """(d, axes) unit vectors all around."""
    if axes == 1:
        return np.array([[1.0], [-1.0]])
    if axes == 2:
        angles = np.arange(_DIRECTIONS) * (2.0 * math.pi / _DIRECTIONS)
        return np.column_stack([np.cos(angles), np.sin(angles)])
    sides = np.stack(np.meshgrid(*[(-1.0, 0.0, 1.0)] * axes), axis=-1).reshape(-1, axes)
    lengths = np.linalg.norm(sides, axis=1)
    return np.asarray(sides[lengths > 0.0] / lengths[lengths > 0.0, None])


def _stencils(divisions: int) -> tuple[IntArray, Array]:
    """(m + 1, 3) the offsets that each of `vectors_of` is made of, and their factors."""
    points = np.arange(divisions + 1)[:, None] + np.arange(-1, 2)
    factors = np.tile([1.0, -2.0, 1.0], (divisions + 1, 1))
    points[0], factors[0] = (0, 0, 1), (-1.0, 0.0, 1.0)
    points[-1] = divisions - 1, divisions, divisions
    factors[-1] = -1.0, 0.0, 1.0
    return points, factors
