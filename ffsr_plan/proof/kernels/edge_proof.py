"""Compiled interval halving over many edges, on distances in closed form.

What these distances decide by more than their error is decided here; the rest is left to the proof
on distances by Coal (`interval_halving`). docs/proof.md, section 2, has the criterion.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.proof.kernels.course import Course, Memory, measure, memory_for, travel_of_shapes

OPEN, PROVEN, TOUCHED = 0, 1, 2
"""What became of an edge: left to Coal; free; a configuration was found that touches."""
MARGIN = 1e-8
"""Length [m] by which distances in closed form have to decide, far above their error and Coal's."""
_DEEPEST = 40  # halvings


class Decisions(NamedTuple):
    """What became of k edges.

    Attributes:
        states: (k,) OPEN, PROVEN or TOUCHED.
        least: (k,) least clearance met [m].
        times: (k,) when, in [0, 1].
        counts: (k,) configurations measured.
    """

    states: NDArray[np.int64]
    least: Array
    times: Array
    counts: IntArray


@kernel
def _sum_above(first: Array, last: Array, ways: Array, more: float) -> float:
    """Least value over the shapes of both distances less the travel and `more`."""
    least = np.inf
    for i in range(len(ways)):
        least = min(least, first[i] + last[i] - ways[i] - more)
    return least


@kernel
def prove(
    course: Course,
    speeds: Array,
    layers: IntArray,
    tails: Array,
    heads: Array,
    ends: Array,
    rounding: float,
    tolerance: float,
) -> Decisions:
    """Halve each of k edges until it is decided.

    Args:
        course: the motion that offsets are counted from.
        speeds: (m,) bound on the speed of any point over an edge, in addition to the base's [m].
        layers: (k,) the edges.
        tails: (k, 3) offsets at their starts [m].
        heads: (k, 3) offsets at their ends [m].
        ends: (k, 2) clearances there [m].
        rounding: length added to every travel bound [m].
        tolerance: clearance below which an edge is left to Coal [m].
    """
    count, memory = len(layers), memory_for(course)
    found = Decisions(
        np.zeros(count, np.int64), np.empty(count), np.empty(count), np.zeros(count, np.int64)
    )
    step, times = np.empty(3), np.empty((_DEEPEST + 2, 2))
    distances = np.empty((_DEEPEST + 3, len(course.shapes.kinds)))
    for k in range(count):
        layer, length = layers[k], 0.0
        for a in range(3):
            along = course.positions[layer + 1, a] - course.positions[layer, a]
            step[a] = 0.0 if course.base.floats else along + heads[k, a] - tails[k, a]
            length += step[a] * step[a]
        found.least[k], found.times[k] = ends[k, 0], 0.0
        if ends[k, 1] < ends[k, 0]:
            found.least[k], found.times[k] = ends[k, 1], 1.0
        if found.least[k] <= max(tolerance, MARGIN):
            continue
        coarse = math.sqrt(length) + speeds[layer] + rounding
        if ends[k, 0] + ends[k, 1] > coarse + MARGIN:
            found.states[k] = PROVEN
            continue
        _halve(
            course, layer, (tails[k], heads[k], step), rounding, tolerance, memory, times,
            distances, k, found,
        )  # fmt: skip
    return found


@kernel
def _halve(
    course: Course,
    layer: int,
    offsets: tuple[Array, Array, Array],
    rounding: float,
    tolerance: float,
    memory: Memory,
    times: Array,
    distances: Array,
    k: int,
    found: Decisions,
) -> None:
    """Interval halving of one edge, the earlier half first; rows of `distances` belong to times.

    Row d + 1 of `distances` belongs to the end of the interval at depth d of the stack, and row
    `free` to the start of the one on top.
    """
    tail, head, step = offsets
    shift, ways, first = np.empty(3), np.empty(distances.shape[1]), np.empty(distances.shape[1])
    measure(course, layer, 0.0, tail, memory, first)
    measure(course, layer, 1.0, head, memory, distances[0])
    times[0] = 0.0, 1.0
    depth = 0
    while depth >= 0:
        begin, end = times[depth, 0], times[depth, 1]
        travel_of_shapes(course, layer, begin, end, step, memory, ways)
        if _sum_above(first, distances[depth], ways, rounding + 2.0 * MARGIN) > 0.0:
            first[:] = distances[depth]
            depth -= 1
            continue
        if ways.max() <= 2.0 * max(tolerance, rounding) or depth >= _DEEPEST:
            return
        middle = 0.5 * (begin + end)
        for a in range(3):
            shift[a] = (1.0 - middle) * tail[a] + middle * head[a]
        times[depth, 0] = middle  # the later half waits below
        depth += 1
        times[depth] = begin, middle
        least = measure(course, layer, middle, shift, memory, distances[depth])
        found.counts[k] += 1
        if least < found.least[k]:
            found.least[k], found.times[k] = least, middle
        if least <= max(tolerance, MARGIN):
            if least < -MARGIN:
                found.states[k] = TOUCHED
            return
    found.states[k] = PROVEN
