"""Distances of a point: to another one, and to solids in closed form; points in other frames."""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.verification.distances.hull_gap_kernel import hull_gap


@kernel
def into_solid(point: Array, base: Array, turn: Array, place: Array, local: Array) -> None:
    """Put a point, from the base origin and in world axes, into the frame of a solid.

    Args:
        point: (3,) from the base origin, world axes [m].
        base: (3, 3) rotation of the base, world axes.
        turn: (3, 3) rotation of the solid, base axes.
        place: (3,) origin of the solid from the base origin, base axes [m].
        local: (3,) the point in the frame of the solid, filled in [m].
    """
    x = base[0, 0] * point[0] + base[1, 0] * point[1] + base[2, 0] * point[2] - place[0]
    y = base[0, 1] * point[0] + base[1, 1] * point[1] + base[2, 1] * point[2] - place[1]
    z = base[0, 2] * point[0] + base[1, 2] * point[1] + base[2, 2] * point[2] - place[2]
    for i in range(3):
        local[i] = turn[0, i] * x + turn[1, i] * y + turn[2, i] * z


@kernel
def out_of_solid(local: Array, base: Array, turn: Array, place: Array, point: Array) -> None:
    """Put a point in the frame of a solid into world axes, from the base origin.

    Args:
        local: (3,) in the frame of the solid [m].
        base: (3, 3) rotation of the base, world axes.
        turn: (3, 3) rotation of the solid, base axes.
        place: (3,) origin of the solid from the base origin, base axes [m].
        point: (3,) from the base origin, world axes, filled in [m].
    """
    for i in range(3):
        point[i] = 0.0
    for k in range(3):
        along = place[k]
        for i in range(3):
            along += turn[k, i] * local[i]
        for i in range(3):
            point[i] += base[i, k] * along


@kernel
def apart(a: Array, b: Array) -> float:
    """Distance of two points (3,)."""
    return math.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2)


@kernel
def from_solid(local: Array, corners: Array, half: Array, enough: float) -> float:
    """Signed distance of a point from a solid without its swell, or at least `enough`.

    Args:
        local: (1, 3) the point in the frame of the solid [m].
        corners: (n, 3) of the solid [m].
        half: (3,) half sides of a box; -1 for other solids [m].
        enough: bound that will do [m].
    """
    if half[0] >= 0.0:
        return from_box(local[0], half)
    if len(corners) <= 2:
        return _from_segment(local[0], corners[0], corners[-1])
    return hull_gap(corners, local, np.zeros(3), np.eye(3), np.zeros(3), enough)


@kernel
def from_box(point: Array, half: Array) -> float:
    """Signed distance of a point (3,) from a box about the origin with half sides (3,)."""
    outside, inside = 0.0, -np.inf
    for i in range(3):
        beyond = abs(point[i]) - half[i]
        outside += max(beyond, 0.0) ** 2
        inside = max(inside, beyond)
    return math.sqrt(outside) + min(inside, 0.0)


@kernel
def _from_segment(point: Array, a: Array, b: Array) -> float:
    """Distance of a point from a segment."""
    square, along = 0.0, 0.0
    for i in range(3):
        square += (b[i] - a[i]) ** 2
        along += (b[i] - a[i]) * (point[i] - a[i])
    share = min(max(along / square, 0.0), 1.0) if square > 0.0 else 0.0
    total = 0.0
    for i in range(3):
        total += (point[i] - a[i] - share * (b[i] - a[i])) ** 2
    return math.sqrt(total)


@kernel
def from_cylinder(point: Array, radius: float, half_length: float) -> float:
    """Signed distance of a point (3,) from a cylinder about the origin, along z."""
    aside = math.sqrt(point[0] ** 2 + point[1] ** 2) - radius
    beyond = abs(point[2]) - half_length
    outside = math.sqrt(max(aside, 0.0) ** 2 + max(beyond, 0.0) ** 2)
    return outside + min(max(aside, beyond), 0.0)
