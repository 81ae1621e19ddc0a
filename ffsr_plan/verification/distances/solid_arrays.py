"""Convex solids as arrays that compiled functions read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray


class SolidArrays(NamedTuple):
    """Solids: the hull of some corners, widened by a radius; in the frame of each solid.

    Attributes:
        corners: (n, 3) corners of all solids, one solid after another [m].
        starts: (s + 1,) first corner of each solid, and n.
        swells: (s,) radii by which the hulls are widened [m].
        halves: (s, 3) half sides of boxes about the frame's origin [m]; -1 for other solids.
        middles: (s, 3) a point inside each hull [m].
        radii: (s,) radius of the sphere about the middle that contains the solid [m].
    """

    corners: Array
    starts: IntArray
    swells: Array
    halves: Array
    middles: Array
    radii: Array


def solid_arrays(
    corners: Sequence[Array], swells: Sequence[float], halves: Sequence[Array | None]
) -> SolidArrays:
    """Put solids into arrays.

    Args:
        corners: (n, 3) of each solid [m].
        swells: radius by which each is widened [m].
        halves: (3,) half sides of each box [m], None for other solids.
    """
    middles = np.array([np.mean(points, axis=0) for points in corners]).reshape(-1, 3)
    return SolidArrays(
        corners=np.ascontiguousarray(np.vstack([np.zeros((0, 3)), *corners])),
        starts=np.cumsum([0, *map(len, corners)], dtype=np.int64),
        swells=np.array(swells, dtype=np.float64),
        halves=np.array([np.full(3, -1.0) if h is None else h for h in halves]).reshape(-1, 3),
        middles=middles,
        radii=np.array(
            [
                float(np.linalg.norm(points - middle, axis=1).max()) + swell
                for points, middle, swell in zip(corners, middles, swells, strict=True)
            ]
        ),
    )
