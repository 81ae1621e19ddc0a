"""Compiled signed distance of two boxes that are widened by radii: boxes, capsules, balls.

Along any direction n, the gap between the shadows of two convex bodies on n is at most their signed
distance, and the largest gap is that distance. Where the boxes overlap, n is a normal of a side or
perpendicular to an edge of each (the separating axes of `shape_gap_kernels`). Where they do not,
the nearest points are a corner and a point of the other box, or points of two edges: those that lie
farthest along the common perpendicular of both.
"""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.collision.shape_gap_kernels import gap_across_edges, gap_along_sides
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import inlined_kernel, kernel

_PARALLEL = 1e-10  # sine of the angle between edges that count as parallel: corners decide then
_LEVEL = 1e-5  # cosine to the common perpendicular below which both edges of a side are tried


@kernel
def box_distance(
    one: Array, halves: tuple[float, float, float], other: Array,
    others: tuple[float, float, float], shift: Array, enough: float,
) -> float:  # fmt: skip
    """Signed distance of two boxes.

    Args:
        one: rotation (9, row by row) and middle (3) of the first box.
        halves: half sides of the first [m], zero or more.
        other: the same of the second.
        others: half sides of the second [m].
        shift: (3,) displacement of the first box [m].
        enough: where the distance is larger, a lower bound of at least this will do [m].

    Returns:
        The distance [m], negative by the depth of penetration, or a lower bound above `enough`.
    """
    cosines, between = np.empty((3, 3)), np.empty(3)
    x, y = other[9] - one[9] - shift[0], other[10] - one[10] - shift[1]
    z = other[11] - one[11] - shift[2]
    for a in range(3):
        between[a] = x * one[a] + y * one[3 + a] + z * one[6 + a]
        for b in range(3):
            cosines[a, b] = (
                one[a] * other[b] + one[3 + a] * other[3 + b] + one[6 + a] * other[6 + b]
            )
    best = gap_along_sides(cosines, between, halves, others)
    if best > enough:
        return best
    for a in range(3):
        best = max(best, gap_across_edges(cosines, between, halves, others, a))
        if best > enough:
            return best
    if best <= 0.0:
        return best
    return math.sqrt(squared_gap(cosines, between, halves, others))


@kernel
def squared_gap(
    cosines: Array,
    between: Array,
    halves: tuple[float, float, float],
    others: tuple[float, float, float],
) -> float:
    """Square of the distance of two boxes that do not overlap [m^2].

    Args:
        cosines: (3, 3) between the axes of both.
        between: (3,) from middle to middle along the axes of the first [m].
        halves: half sides of the first [m].
        others: half sides of the second [m].
    """
    best = np.inf
    for i in range(8):
        first, second, third = _sign(i, 0), _sign(i, 1), _sign(i, 2)
        u, v, w = first * others[0], second * others[1], third * others[2]
        total = 0.0
        for a in range(3):  # a corner of the second, in axes of the first
            place = between[a] + cosines[a, 0] * u + cosines[a, 1] * v + cosines[a, 2] * w
            beyond = max(abs(place) - halves[a], 0.0)
            total += beyond * beyond
        best = min(best, total)
        u, v, w = first * halves[0], second * halves[1], third * halves[2]
        total = 0.0
        for b in range(3):  # a corner of the first, in axes of the second
            place = (
                cosines[0, b] * (u - between[0])
                + cosines[1, b] * (v - between[1])
                + cosines[2, b] * (w - between[2])
            )
            beyond = max(abs(place) - others[b], 0.0)
            total += beyond * beyond
        best = min(best, total)
    for a in range(3):
        for b in range(3):
            best = min(best, _between_edges(cosines, between, halves, others, a, b, best))
    return best


@inlined_kernel
def _sign(number: int, bit: int) -> float:
    return 1.0 if (number >> bit) & 1 else -1.0


@kernel
def _between_edges(
    cosines: Array, between: Array, halves: tuple[float, float, float],
    others: tuple[float, float, float], a: int, b: int, best: float,
) -> float:  # fmt: skip
    """Least squared distance of edges along axis `a` of the first and `b` of the second box [m^2].

    Of each four edges only those count that lie farthest along the common perpendicular, towards
    the other box; at most `best` is returned.
    """
    i, j = (a + 1) % 3, (a + 2) % 3
    k, m = (b + 1) % 3, (b + 2) % 3
    # n = e_a x f_b, in axes of the first: across a, with the components -second and first
    first, second = cosines[i, b], cosines[j, b]
    sine = math.sqrt(first * first + second * second)
    if sine <= _PARALLEL:
        return best
    along_i, along_j = -second / sine, first / sine
    if between[i] * along_i + between[j] * along_j < 0.0:
        along_i, along_j = -along_i, -along_j
    along_k = along_i * cosines[i, k] + along_j * cosines[j, k]
    along_m = along_i * cosines[i, m] + along_j * cosines[j, m]
    for corner in range(16):
        si, sj, sk, sm = _sign(corner, 0), _sign(corner, 1), _sign(corner, 2), _sign(corner, 3)
        if si * along_i < -_LEVEL or sj * along_j < -_LEVEL:
            continue
        if sk * along_k > _LEVEL or sm * along_m > _LEVEL:
            continue
        # from the middle of the first edge to that of the second, in axes of the first
        x = between[a] + sk * others[k] * cosines[a, k] + sm * others[m] * cosines[a, m]
        y = between[i] + sk * others[k] * cosines[i, k] + sm * others[m] * cosines[i, m]
        z = between[j] + sk * others[k] * cosines[j, k] + sm * others[m] * cosines[j, m]
        y -= si * halves[i]
        z -= sj * halves[j]
        found = segment_gap(x, y, z, halves[a], cosines[a, b], first, second, others[b])
        best = min(best, found)
    return best


@kernel
def segment_gap(
    x: float, y: float, z: float, half: float, p: float, q: float, r: float, other: float
) -> float:
    """Squared distance of a segment along the first axis about the origin and another one [m^2].

    Args:
        x: middle of the other segment [m].
        y: middle of the other segment [m].
        z: middle of the other segment [m].
        half: half length of the first [m].
        p: direction of the other, a unit vector.
        q: direction of the other.
        r: direction of the other.
        other: half length of the other [m].
    """
    across = y * q + z * r
    square, time = q * q + r * r, 0.0
    if square > 0.0:
        time = min(max(-across / square, -other), other)
    place = min(max(x + time * p, -half), half)
    time = min(max((place - x) * p - across, -other), other)
    place = min(max(x + time * p, -half), half)
    u, v, w = x + time * p - place, y + time * q, z + time * r
    return u * u + v * v + w * w
