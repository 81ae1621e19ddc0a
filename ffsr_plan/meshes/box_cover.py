"""A few boxes around a mesh: plain shapes, which every reader of a URDF knows.

The mesh is cut into slabs across one of its axes, and each slab put into a box along the axes. All
that a closed surface encloses lies in the boxes: from a point inside, the surface is met within the
point's own slab both ways along the other two axes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray

MOST = 3
"""Boxes around one mesh."""
GAIN = 0.1
"""Least share of the volume that one more box must save."""
_CUTS = 24  # slabs to choose from
_GRID = 1e-4  # [m], to which boxes are widened: short numbers, the same on every machine


class Box(NamedTuple):
    """A box along the axes of a mesh's frame."""

    low: Array
    """(3,) [m]."""
    high: Array
    """(3,) [m]."""


def boxes_around(triangles: Array) -> list[Box]:
    """Up to `MOST` boxes of little volume around a surface of triangles (k, 3, 3) [m]."""
    cost, best = np.inf, []
    for axis in range(3):
        lows, highs = _fine_slabs(triangles, axis)
        for boxes in _partitions(lows, highs):
            volume = sum(float(np.prod(box.high - box.low)) for box in boxes)
            # what is equal but for rounding is decided by order
            weighed = volume * (1.0 - GAIN) ** -len(boxes)
            if weighed < cost * (1.0 - 1e-6):
                cost, best = weighed, boxes
    return best


def _fine_slabs(triangles: Array, axis: int) -> tuple[Array, Array]:
    """Boxes around the surface between equidistant planes across an axis: corners (n, 3), (n, 3).

    Slabs with nothing in them are left out.
    """
    tails, tips = triangles.reshape(-1, 3), np.roll(triangles, -1, axis=1).reshape(-1, 3)
    planes = np.linspace(tails[:, axis].min(), tails[:, axis].max(), _CUTS + 1)
    lows, highs = np.full((_CUTS, 3), np.inf), np.full((_CUTS, 3), -np.inf)

    def enclose(points: Array, slab: IntArray) -> None:
        np.minimum.at(lows, slab, points)
        np.maximum.at(highs, slab, points)

    begin, end = (
        np.clip(np.searchsorted(planes, points[:, axis], side="right") - 1, 0, _CUTS - 1)
        for points in (tails, tips)
    )
    enclose(tails, begin)
    tails, tips = tails[begin != end], tips[begin != end]  # the few edges from slab to slab
    low = np.minimum(tails[:, axis], tips[:, axis])
    high = np.maximum(tails[:, axis], tips[:, axis])
    for k, plane in enumerate(planes[1:-1]):
        cut = (low <= plane) & (plane <= high)
        share = (plane - tails[cut, axis]) / (tips[cut, axis] - tails[cut, axis])
        through = tails[cut] + share[:, None] * (tips[cut] - tails[cut])
        enclose(through, np.full(len(through), k))
        enclose(through, np.full(len(through), k + 1))
    full = np.isfinite(lows[:, 0])
    return lows[full], highs[full]


def _partitions(lows: Array, highs: Array) -> list[list[Box]]:
    """Neighbouring slabs put together into 1 .. `MOST` boxes, each of the least total volume."""
    n = len(lows)
    low = [_down(np.minimum.accumulate(lows[i:])) for i in range(n)]
    high = [_up(np.maximum.accumulate(highs[i:])) for i in range(n)]
    volume = np.full((n + 1, n + 1), np.inf)  # of slabs i .. j - 1 in one box
    for i in range(n):
        high[i] = np.maximum(high[i], low[i] + _GRID)
        volume[i, i + 1 :] = np.prod(high[i] - low[i], axis=1)
    least, found = volume[0], [[0] * (n + 1)]
    partitions = [_boxes(low, high, found, n)]
    for _ in range(1, min(MOST, n)):
        totals = least[:, None] + volume
        found = [*found, totals.argmin(axis=0).tolist()]  # where the last box begins
        least = totals.min(axis=0)
        partitions.append(_boxes(low, high, found, n))
    return partitions


def _boxes(low: list[Array], high: list[Array], begins: list[list[int]], end: int) -> list[Box]:
    """The boxes of a partition, traced back from its end."""
    boxes = []
    for begin in reversed(begins):
        first, last = begin[end], end - begin[end] - 1
        boxes.append(Box(low[first][last], high[first][last]))
        end = first
    return boxes[::-1]


def _down(values: Array) -> Array:
    """To the grid; what is a hair below a line of it counts as on it."""
    return np.asarray((np.floor(values / _GRID + 1e-6) * _GRID).round(7))


def _up(values: Array) -> Array:
    return -_down(-values)
