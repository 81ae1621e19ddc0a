"""Compiled proof that pairs of links keep apart along edges, on lower bounds of their distances.

Each shape is a box, rounded by a radius: a capsule is a box without width, a hull lies in the box
around it. Two such boxes are apart by at least the gap between their shadows on any line.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.proof.kernels.course import Course, Memory, place_shapes, travel_of_shapes
from ffsr_plan.robots.shape_arrays import BOX

DEEPEST = 9
"""Halvings of an edge at most: with these a long edge takes no longer than the same cut up."""
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


class Known(NamedTuple):
    """Memory for what is computed once for all pairs of g shapes on an edge.

    Attributes:
        frames: (2^DEEPEST + 1, g, 15) placements of the shapes.
        placed: (2^DEEPEST + 1,) whether they have been computed.
        ways: (2^(DEEPEST + 1), g) travel of the shapes over intervals, numbered as in a heap [m].
        bounded: (2^(DEEPEST + 1),) whether it has been computed.
        stack: (DEEPEST + 2, 2) intervals.
    """

    frames: Array
    placed: Flags
    ways: Array
    bounded: Flags
    stack: IntArray


def known_for(course: Course) -> Known:
    """Memory for the edges of a course."""
    shapes, parts = len(course.shapes), 2**DEEPEST
    return Known(
        np.empty((parts + 1, shapes, 15)),
        np.empty(parts + 1, np.bool_),
        np.empty((2 * parts, shapes)),
        np.empty(2 * parts, np.bool_),
        np.empty((DEEPEST + 2, 2), np.int64),
    )


@kernel
def prove_apart(
    course: Course, pairs: IntArray, rounding: float, memory: Memory, known: Known, proven: Flags
) -> None:
    """Halve every edge for each pair until the pair is proven apart, or not worth more halvings.

    Args:
        course: the motion as seen from the base.
        pairs: (p, 2) the shapes of each pair.
        rounding: length added to the travel of two shapes together [m].
        memory: scratch memory, in which the base is not displaced.
        known: scratch memory.
        proven: (m, p) whether the pair is proven apart all along the edge, filled in.
    """
    for layer in range(len(proven)):
        for n in range(len(known.placed)):
            known.placed[n] = False
        for n in range(len(known.bounded)):
            known.bounded[n] = False
        for k in range(len(pairs)):
            proven[layer, k] = _apart(
                course, layer, pairs[k, 0], pairs[k, 1], rounding, memory, known
            )


@kernel
def _apart(
    course: Course, layer: int, i: int, j: int, rounding: float, memory: Memory, known: Known
) -> bool:
    """Whether two shapes are proven apart all along an edge."""
    stack, ways, parts, top = known.stack, known.ways, len(known.placed) - 1, 1
    first, second = course.shapes[i].kind, course.shapes[j].kind
    stack[0, 0], stack[0, 1] = 0, parts
    while top > 0:
        top -= 1
        begin, end = stack[top, 0], stack[top, 1]
        size, total = end - begin, 0.0
        for step in range(2):
            at = begin + step * size
            if not known.placed[at]:
                place_shapes(course, layer, at / parts, memory)
                _copy(memory.frames, known.frames[at])
                known.placed[at] = True
            frames = known.frames[at]
            total += max(least_gap(first, frames[i], second, frames[j]), 0.0)
        number = (parts + begin) // size  # of the interval, as in a heap
        if not known.bounded[number]:
            travel_of_shapes(course, layer, begin / parts, end / parts, memory, ways[number])
            known.bounded[number] = True
        if total > ways[number, i] + ways[number, j] + rounding + _MARGIN:
            continue
        if size == 1:
            return False
        middle = (begin + end) // 2
        stack[top, 0], stack[top, 1] = middle, end
        stack[top + 1, 0], stack[top + 1, 1] = begin, middle
        top += 2
    return True


@kernel
def _copy(source: Array, target: Array) -> None:
    """Copy a matrix."""
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            target[i, j] = source[i, j]
