"""Compiled proof that pairs of links keep apart along edges, on lower bounds of their distances.

Each shape is a box, rounded by a radius: a capsule is a box without width, a hull lies in the box
around it. Two such boxes are apart by at least the gap between their shadows on any line.
"""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.proof.kernels.course import Course, memory_for, place_shapes, travel_of_shapes
from ffsr_plan.robots.shape_arrays import BOX

DEEPEST = 5
"""Halvings of an edge at most."""
_PARALLEL = 1e-6  # sine of the angle between edges below which their cross product is left out
_MARGIN = 1e-8  # [m]


@kernel
def _half(kind: int, frame: Array, axis: int) -> float:
    """Half of a side of a shape's box without its rounding [m]."""
    if kind == BOX:
        return float(frame[12 + axis])
    return float(frame[13]) if axis == 2 else 0.0


@kernel
def _gap_along(
    first: int, one: Array, second: int, other: Array, x: float, y: float, z: float
) -> float:
    """Gap between the shadows of two shapes, without rounding, on a line of unit direction [m]."""
    apart = abs(x * (other[9] - one[9]) + y * (other[10] - one[10]) + z * (other[11] - one[11]))
    for a in range(3):
        apart -= _half(first, one, a) * abs(x * one[a] + y * one[3 + a] + z * one[6 + a])
        apart -= _half(second, other, a) * abs(x * other[a] + y * other[3 + a] + z * other[6 + a])
    return apart


@kernel
def least_gap(first: int, one: Array, second: int, other: Array) -> float:
    """A lower bound on the distance of two shapes.

    The lines are the axes of both boxes, the common perpendiculars of their edges, and the line
    between their centres.

    Args:
        first: kind of the first shape.
        one: (15,) its placement and size, as in `Placements.frames`.
        second: kind of the second shape.
        other: (15,) its placement and size.

    Returns:
        The bound [m]; it says nothing if it is not positive.
    """
    x, y, z = other[9] - one[9], other[10] - one[10], other[11] - one[11]
    length = math.sqrt(x * x + y * y + z * z)
    best = -np.inf
    if length > 0.0:
        best = _gap_along(first, one, second, other, x / length, y / length, z / length)
    for a in range(3):
        best = max(best, _gap_along(first, one, second, other, one[a], one[3 + a], one[6 + a]))
        best = max(
            best, _gap_along(first, one, second, other, other[a], other[3 + a], other[6 + a])
        )
        for b in range(3):
            x = one[3 + a] * other[6 + b] - one[6 + a] * other[3 + b]
            y = one[6 + a] * other[b] - one[a] * other[6 + b]
            z = one[a] * other[3 + b] - one[3 + a] * other[b]
            length = math.sqrt(x * x + y * y + z * z)
            if length > _PARALLEL:
                gap = _gap_along(first, one, second, other, x / length, y / length, z / length)
                best = max(best, gap)
    for kind, frame in ((first, one), (second, other)):
        best -= 0.0 if kind == BOX else frame[12]
    return best


@kernel
def prove_apart(course: Course, pairs: IntArray, rounding: float) -> Flags:
    """Halve every edge for each pair until the pair is proven apart, or not worth more halvings.

    Args:
        course: the motion as seen from the base.
        pairs: (p, 2) the shapes of each pair.
        rounding: length added to the travel of two shapes together [m].

    Returns:
        (m, p) whether the pair is proven apart all along the edge.
    """
    edges, parts, shapes = len(course.values) - 1, 2**DEEPEST, len(course.shapes.kinds)
    memory, still, proven = memory_for(course), np.zeros(3), np.ones((edges, len(pairs)), np.bool_)
    frames, known = np.empty((parts + 1, shapes, 15)), np.empty(parts + 1, np.bool_)
    ways, bounded = np.empty((2 * parts, shapes)), np.empty(2 * parts, np.bool_)
    stack = np.empty((DEEPEST + 2, 2), np.int64)
    for layer in range(edges):
        known[:], bounded[:] = False, False
        for k in range(len(pairs)):
            i, j = pairs[k]
            stack[0], top = (0, parts), 1
            while top > 0:
                top -= 1
                begin, end = stack[top]
                size, total = end - begin, 0.0
                for at in (begin, end):
                    if not known[at]:
                        place_shapes(course, layer, at / parts, memory)
                        frames[at], known[at] = memory.frames, True
                    kinds, placed = course.shapes.kinds, frames[at]
                    total += max(least_gap(kinds[i], placed[i], kinds[j], placed[j]), 0.0)
                number = (parts + begin) // size  # of the interval, as in a heap
                if not bounded[number]:
                    span = begin / parts, end / parts
                    travel_of_shapes(course, layer, *span, still, memory, ways[number])
                    bounded[number] = True
                if total > ways[number, i] + ways[number, j] + rounding + _MARGIN:
                    continue
                if size == 1:
                    proven[layer, k] = False
                    break
                middle = (begin + end) // 2
                stack[top], stack[top + 1] = (middle, end), (begin, middle)
                top += 2
    return proven
