"""Compiled lower bound on the distance of two collision shapes of the robot."""

from __future__ import annotations

import math

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel

_PARALLEL = 1e-6  # length of a cross product below which two axes are parallel


@kernel
def core_gap(
    first: Array, second: Array, half: Array, other: Array, skins: float, enough: float
) -> float:
    """The largest gap along the axes that separate two boxes, less the distance around them.

    A shape is a box, or a segment along z, surrounded by a distance. The gap along any axis is a
    lower bound on the distance: tried are those of the separating axis theorem (Gottschalk, Lin
    and Manocha 1996) and the line between the middles, on which two spheres are measured exactly.

    Args:
        first: (15,) rotation and position of a shape, as of `Placements.frames`.
        second: (15,) of the other shape.
        half: (3,) half sides of the first shape's core [m].
        other: (3,) of the second's.
        skins: sum of the distances around both cores [m].
        enough: gap above which no larger one is looked for [m].
    """
    x, y, z = second[9] - first[9], second[10] - first[10], second[11] - first[11]
    far = math.sqrt(x * x + y * y + z * z)
    best = -skins
    if far > 0.0:
        best = axis_gap(x / far, y / far, z / far, x, y, z, first, second, half, other) - skins
    for k in range(3):
        if best > enough:
            return best
        gap = axis_gap(first[k], first[3 + k], first[6 + k], x, y, z, first, second, half, other)
        best = max(best, gap - skins)
        gap = axis_gap(second[k], second[3 + k], second[6 + k], x, y, z, first, second, half, other)
        best = max(best, gap - skins)
    for i in range(3):
        for j in range(3):
            if best > enough:
                return best
            a = first[3 + i] * second[6 + j] - first[6 + i] * second[3 + j]
            b = first[6 + i] * second[j] - first[i] * second[6 + j]
            c = first[i] * second[3 + j] - first[3 + i] * second[j]
            size = math.sqrt(a * a + b * b + c * c)
            if size > _PARALLEL:
                gap = axis_gap(
                    a / size, b / size, c / size, x, y, z, first, second, half, other
                )  # fmt: skip
                best = max(best, gap - skins)
    return best


@kernel
def axis_gap(
    a: float, b: float, c: float, x: float, y: float, z: float,
    first: Array, second: Array, half: Array, other: Array,
) -> float:  # fmt: skip
    """Gap between two boxes along a unit vector (a, b, c); (x, y, z) is between their middles."""
    gap = abs(a * x + b * y + c * z)
    for k in range(3):
        gap -= abs(a * first[k] + b * first[3 + k] + c * first[6 + k]) * half[k]
        gap -= abs(a * second[k] + b * second[3 + k] + c * second[6 + k]) * other[k]
    return gap
