"""`Stations`: places on a control polygon, and on the curve that it draws, where clearance counts.

The curve is the uniform cubic B-spline with these control points, a phantom point reflected at each
end. Control points on a line at equal steps give that line, so a displacement of the control points
displaces the curve alone: by weights of the displacements of four of them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray


class Stations(NamedTuple):
    """S places along a motion of m edges.

    Attributes:
        edges: (S,) edge of each.
        times: (S,) time on it, from 0 to 1.
        points: (S, 4) control points whose displacement displaces it.
        shares: (S, 4) by what share; together 1.
    """

    edges: IntArray
    times: Array
    points: IntArray
    shares: Array

    def with_others(self, others: Stations) -> Stations:
        """These stations and others."""
        return Stations(*(np.concatenate(pair) for pair in zip(self, others, strict=True)))

    def displaced(self, offsets: Array) -> Array:
        """(S, k) displacement of the stations by those of the control points (m + 1, k)."""
        moved: Array = np.einsum("sj,sjk->sk", self.shares, offsets[self.points])
        return moved


def on_polygon(edges: IntArray, times: Array) -> Stations:
    """Stations on the edges of the polygon.

    Args:
        edges: (S,).
        times: (S,) from 0 to 1.
    """
    points = np.stack([edges, edges, edges + 1, edges + 1], axis=1)
    none = np.zeros(len(edges))
    return Stations(edges, times, points, np.stack([1.0 - times, none, times, none], axis=1))


def on_curve(divisions: int, edges: IntArray, times: Array) -> Stations:
    """Stations on the pieces of the curve.

    Args:
        divisions: m.
        edges: (S,) pieces.
        times: (S,) from 0 to 1.
    """
    t = times
    basis = [
        (1.0 - t) ** 3 / 6.0,
        (3.0 * t**3 - 6.0 * t**2 + 4.0) / 6.0,
        (-3.0 * t**3 + 3.0 * t**2 + 3.0 * t + 1.0) / 6.0,
        t**3 / 6.0,
    ]
    points, shares = edges[:, None] + np.arange(-1, 3), np.stack(basis, axis=1)
    for row, end, inner in ((0, 1, 2), (3, 2, 1)):
        phantom = (points[:, row] < 0) | (points[:, row] > divisions)
        share = np.where(phantom, shares[:, row], 0.0)  # of 2 P_end - P_inner
        shares[:, end] += 2.0 * share
        shares[:, inner] -= share
        shares[:, row] -= share
    return Stations(edges, times, np.clip(points, 0, divisions), shares)


def usual_stations(divisions: int) -> Stations:
    """The inner corners of the polygon, and the inner knots and the middles of the curve's pieces.

    Args:
        divisions: m, at least 2.
    """
    inner = np.arange(1, divisions)
    return on_polygon(inner, np.zeros(len(inner))).with_others(curve_stations(divisions))


def curve_stations(divisions: int) -> Stations:
    """The inner knots and the middles of the curve's pieces.

    Args:
        divisions: m, at least 2.
    """
    inner, every = np.arange(1, divisions), np.arange(divisions)
    knots = on_curve(divisions, inner, np.zeros(len(inner)))
    return knots.with_others(on_curve(divisions, every, np.full(divisions, 0.5)))
