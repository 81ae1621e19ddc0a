"""Cover of a mesh by a few boxes, a shape that every reader of a URDF knows.

The mesh is cut into slabs across one of its axes, and the surface in each slab is put into a box
along the axes. The boxes contain all that a closed surface encloses: a line from an enclosed point
along one of the other two axes meets the surface on both sides of the point, within its slab.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray

MOST_BOXES = 3
"""Limit of the number of boxes around one mesh."""
LEAST_GAIN = 0.1
"""Least share of the volume that one more box must save."""
_SLABS = 24  # fine slabs, which boxes combine
_GRID = 1e-4  # [m], to which boxes are widened: short numbers, the same on every machine


class Box(NamedTuple):
    """A box along the axes of a mesh's frame.

    Attributes:
        low: (3,) least coordinates [m].
        high: (3,) greatest coordinates [m].
    """

    low: Array
    high: Array


def boxes_around(triangles: Array) -> list[Box]:
    """Cover a closed surface by up to `MOST_BOXES` boxes of little volume.

    Args:
        triangles: (k, 3, 3) corners of the surface's triangles [m].

    Returns:
        The boxes, in the order along one axis.
    """
    cost, best = np.inf, []
    for axis in range(3):
        lows, highs = _fine_slabs(triangles, axis)
        for boxes in _partitions(lows, highs):
            volume = sum(float(np.prod(box.high - box.low)) for box in boxes)
            # the first of partitions that are equal except for rounding wins
            weighed = volume * (1.0 - LEAST_GAIN) ** -len(boxes)
            if weighed < cost * (1.0 - 1e-6):
                cost, best = weighed, boxes
    return best


def _fine_slabs(triangles: Array, axis: int) -> tuple[Array, Array]:
    """Boxes around the surface between equidistant planes across an axis: corners (n, 3), (n, 3).

    Empty slabs are left out.
    """
    tails, tips = triangles.reshape(-1, 3), np.roll(triangles, -1, axis=1).reshape(-1, 3)
    planes = np.linspace(tails[:, axis].min(), tails[:, axis].max(), _SLABS + 1)
    lows, highs = np.full((_SLABS, 3), np.inf), np.full((_SLABS, 3), -np.inf)

    def enclose(points: Array, slab: IntArray) -> None:
        np.minimum.at(lows, slab, points)
        np.maximum.at(highs, slab, points)

    begin, end = (
        np.clip(np.searchsorted(planes, points[:, axis], side="right") - 1, 0, _SLABS - 1)
        for points in (tails, tips)
    )
    enclose(tails, begin)
    tails, tips = tails[begin != end], tips[begin != end]  # edges that cross planes
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
    """For 1 .. `MOST_BOXES` boxes, the partition of the slabs with the least total volume."""
    n = len(lows)
    low = [_down(np.minimum.accumulate(lows[i:])) for i in range(n)]
    high = [_up(np.maximum.accumulate(highs[i:])) for i in range(n)]
    volume = np.full((n + 1, n + 1), np.inf)  # of slabs i .. j - 1 in one box
    for i in range(n):
        high[i] = np.maximum(high[i], low[i] + _GRID)
        volume[i, i + 1 :] = np.prod(high[i] - low[i], axis=1)
    least, begins = volume[0], [[0] * (n + 1)]
    partitions = [_boxes(low, high, begins, n)]
    for _ in range(1, min(MOST_BOXES, n)):
        totals = least[:, None] + volume
        begins = [*begins, totals.argmin(axis=0).tolist()]  # first slab of the last box
        least = totals.min(axis=0)
        partitions.append(_boxes(low, high, begins, n))
    return partitions


def _boxes(low: list[Array], high: list[Array], begins: list[list[int]], end: int) -> list[Box]:
    """The boxes of a partition, traced back from the last slab."""
    boxes = []
    for begin in reversed(begins):
        first, last = begin[end], end - begin[end] - 1
        boxes.append(Box(low[first][last], high[first][last]))
        end = first
    return boxes[::-1]


def _down(values: Array) -> Array:
    """Round down to the grid; values just below a grid line count as on it."""
    return (np.floor(values / _GRID + 1e-6) * _GRID).round(7)


def _up(values: Array) -> Array:
    return -_down(-values)
