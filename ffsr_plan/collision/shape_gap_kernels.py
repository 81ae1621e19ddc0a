"""Compiled lower bound on the distance of two collision shapes.

Each shape is a box, rounded by a radius: a capsule is a box without width, a hull lies in the box
around it. Two such boxes are apart by at least the gap between their shadows on any line.
"""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import inlined_kernel, kernel
from ffsr_plan.robots.shape_arrays import BOX

_PARALLEL = 1e-6  # sine of the angle between edges below which their cross product is left out


@kernel
def least_gap(first: int, one: Array, second: int, other: Array, enough: float) -> float:
    """A lower bound on the distance of two shapes.

    The lines are the line between their centres, on which two spheres are measured exactly, the
    axes of both boxes, and the common perpendiculars of their edges: the axes of the separating
    axis theorem (Gottschalk, Lin and Manocha 1996).

    Args:
        first: kind of the first shape.
        one: (15,) its placement and size, as in `Placements.frames`.
        second: kind of the second shape.
        other: (15,) its placement and size.
        enough: bound above which no better one is looked for [m].

    Returns:
        The bound [m]; it says nothing if it is not positive.
    """
    skins = (0.0 if first == BOX else one[12]) + (0.0 if second == BOX else other[12])
    x, y, z = other[9] - one[9], other[10] - one[10], other[11] - one[11]
    length, best = math.sqrt(x * x + y * y + z * z), -np.inf
    if length > 0.0:
        x, y, z = x / length, y / length, z / length
        best = length - half_shadow(first, one, x, y, z) - half_shadow(second, other, x, y, z)
    if best - skins > enough:
        return best - skins
    cosines, between = np.empty((3, 3)), np.empty(3)
    halves, others = half_sides(first, one), half_sides(second, other)
    for a in range(3):
        between[a] = length * (x * one[a] + y * one[3 + a] + z * one[6 + a])
        for b in range(3):
            cosines[a, b] = (
                one[a] * other[b] + one[3 + a] * other[3 + b] + one[6 + a] * other[6 + b]
            )
    best = max(best, gap_along_sides(cosines, between, halves, others))
    for a in range(3):
        if best - skins > enough:
            break
        best = max(best, gap_across_edges(cosines, between, halves, others, a))
    return best - skins


@inlined_kernel
def half_sides(kind: int, frame: Array) -> tuple[float, float, float]:
    """Half sides of a shape's box without its rounding [m]; a segment lies along its z axis."""
    if kind == BOX:
        return frame[12], frame[13], frame[14]
    return 0.0, 0.0, frame[13]


@inlined_kernel
def half_shadow(kind: int, frame: Array, x: float, y: float, z: float) -> float:
    """Half of the shadow of a shape without its rounding on a line of unit direction [m]."""
    sides, shadow = half_sides(kind, frame), 0.0
    for a in range(3):
        shadow += sides[a] * abs(x * frame[a] + y * frame[3 + a] + z * frame[6 + a])
    return shadow


@kernel
def gap_along_sides(
    cosines: Array,
    between: Array,
    halves: tuple[float, float, float],
    others: tuple[float, float, float],
) -> float:
    """The largest gap between two boxes on lines along their sides [m].

    Args:
        cosines: (3, 3) between the axes of both.
        between: (3,) from middle to middle along the axes of the first [m].
        halves: half sides of the first [m].
        others: half sides of the second [m].
    """
    best = -np.inf
    for a in range(3):
        gap, along, shadow = abs(between[a]) - halves[a], 0.0, others[a]
        for b in range(3):
            gap -= others[b] * abs(cosines[a, b])
            along += between[b] * cosines[b, a]
            shadow += halves[b] * abs(cosines[b, a])
        best = max(best, gap, abs(along) - shadow)
    return best


@kernel
def gap_across_edges(
    cosines: Array,
    between: Array,
    halves: tuple[float, float, float],
    others: tuple[float, float, float],
    a: int,
) -> float:
    """The largest gap on lines across edge `a` of the first box and one of the second [m].

    Args:
        cosines: (3, 3) between the axes of both.
        between: (3,) from middle to middle along the axes of the first [m].
        halves: half sides of the first [m].
        others: half sides of the second [m].
        a: the axis of the first box.
    """
    i, j, best = (a + 1) % 3, (a + 2) % 3, -np.inf
    for b in range(3):
        first, second = cosines[i, b], cosines[j, b]
        sine = math.sqrt(first * first + second * second)
        if sine > _PARALLEL:
            k, m = (b + 1) % 3, (b + 2) % 3
            gap = abs(between[j] * first - between[i] * second)
            gap -= halves[i] * abs(second) + halves[j] * abs(first)
            gap -= others[k] * abs(cosines[a, m]) + others[m] * abs(cosines[a, k])
            best = max(best, gap / sine)
    return best
