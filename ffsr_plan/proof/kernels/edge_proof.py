"""Compiled interval halving over many edges, on distances in closed form.

What these distances decide by more than their error is decided here; the rest is left to the proof
on distances by Coal (`interval_halving`). docs/proof.md, section 2, has the criterion.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Records
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.bodies import norm_of
from ffsr_plan.proof.kernels.course import Course, Memory, measure, travel_of_shapes
from ffsr_plan.proof.kernels.passage import is_finest, way_over

OPEN, PROVEN, TOUCHED = 0, 1, 2
"""What became of an edge: left to Coal; free; a configuration was found that touches."""
MARGIN = 1e-8
"""Length [m] by which distances in closed form have to decide, far above their error and Coal's."""
_DEEPEST = 40  # halvings


EDGE = np.dtype(
    [
        ("layer", np.int64),
        ("tail", np.float64, 3),
        ("head", np.float64, 3),
        ("ends", np.float64, 2),
        ("state", np.int64),
        ("least", np.float64),
        ("time", np.float64),
        ("count", np.int64),
    ]
)
"""An edge to prove, and what became of it.

    layer       between which corners of the course it is
    tail, head  (3,) offsets at its start and end [m]
    ends        (2,) clearances there [m]
    state       OPEN, PROVEN or TOUCHED
    least       least clearance met [m]
    time        when, in [0, 1]
    count       configurations measured
"""


class Intervals(NamedTuple):
    """Memory for the halving of an edge with g shapes.

    Attributes:
        times: (depth, 2) starts and ends.
        distances: (depth, g) of the shapes, at the ends [m].
    """

    times: Array
    distances: Array


def intervals_for(course: Course) -> Intervals:
    """Memory for the edges of a course."""
    distances = np.empty((_DEEPEST + 3, len(course.shapes)))
    return Intervals(np.empty((_DEEPEST + 2, 2)), distances)


@kernel
def _sum_above(first: Array, last: Array, ways: Array, more: float) -> float:
    """Least value over the shapes of both distances less the travel and `more`."""
    least = np.inf
    for i in range(len(ways)):
        least = min(least, first[i] + last[i] - ways[i] - more)
    return least


@kernel
def set_step(course: Course, layer: int, tail: Array, head: Array, memory: Memory) -> float:
    """Fill in the displacement of the base origin over an edge, and return its length [m]."""
    begin, end, step = course.positions[layer], course.positions[layer + 1], memory.vectors[1]
    for a in range(3):
        step[a] = 0.0 if course.base.floats else end[a] - begin[a] + head[a] - tail[a]
        step[a] -= course.passage.step[a]
    return norm_of(step)


@kernel
def prove(
    course: Course,
    speeds: Array,
    edges: Records,
    rounding: float,
    tolerance: float,
    memory: Memory,
    intervals: Intervals,
) -> None:
    """Halve each of k edges until it is decided.

    Args:
        course: the motion that offsets are counted from.
        speeds: (m,) bound on the speed of any point over an edge, in addition to the base's [m].
        edges: (k,) records of `EDGE`; their states are OPEN, and what became of them is filled in.
        rounding: length added to every travel bound [m].
        tolerance: clearance below which an edge is left to Coal [m].
        memory: scratch memory.
        intervals: scratch memory.
    """
    for k in range(len(edges)):
        edge, ends = edges[k], edges[k].ends
        step = set_step(course, edge.layer, edge.tail, edge.head, memory)
        step += way_over(course.passage, 0.0, 1.0)
        edge.least, edge.time = ends[0], 0.0
        if ends[1] < ends[0]:
            edge.least, edge.time = ends[1], 1.0
        if edge.least <= max(tolerance, MARGIN):
            continue
        if ends[0] + ends[1] > step + speeds[edge.layer] + rounding + MARGIN:
            edge.state = PROVEN
            continue
        _halve(course, edge, rounding, tolerance, memory, intervals)


@kernel
def _halve(
    course: Course,
    edge: Any,  # noqa: ANN401 - one record of EDGE
    rounding: float,
    tolerance: float,
    memory: Memory,
    intervals: Intervals,
) -> None:
    """Interval halving of one edge, the earlier half first.

    Row d of `distances` belongs to the end of the interval at depth d of the stack, and `first` to
    the start of the one on top.
    """
    layer, tail, head, shift = edge.layer, edge.tail, edge.head, memory.vectors[2]
    first, ways, times, distances = memory.first, memory.ways, intervals.times, intervals.distances
    measure(course, layer, 0.0, tail, memory, first)
    measure(course, layer, 1.0, head, memory, distances[0])
    times[0, 0], times[0, 1] = 0.0, 1.0
    depth = 0
    while depth >= 0:
        begin, end, last = times[depth, 0], times[depth, 1], distances[depth]
        travel_of_shapes(course, layer, begin, end, memory, ways)
        if _sum_above(first, last, ways, rounding + 2.0 * MARGIN) > 0.0:
            for i in range(len(first)):
                first[i] = last[i]
            depth -= 1
            continue
        if longest(ways) <= 2.0 * max(tolerance, rounding) or depth >= _DEEPEST:
            return
        if is_finest(course.passage, end - begin):
            return
        middle = 0.5 * (begin + end)
        for a in range(3):
            shift[a] = (1.0 - middle) * tail[a] + middle * head[a]
        times[depth, 0] = middle  # the later half waits below
        depth += 1
        times[depth, 0], times[depth, 1] = begin, middle
        least = measure(course, layer, middle, shift, memory, distances[depth])
        edge.count += 1
        if least < edge.least:
            edge.least, edge.time = least, middle
        if least <= max(tolerance, MARGIN):
            if least < -MARGIN:
                edge.state = TOUCHED
            return
    edge.state = PROVEN


@kernel
def longest(ways: Array) -> float:
    """Largest of some lengths."""
    result = 0.0
    for i in range(len(ways)):
        result = max(result, ways[i])
    return result
