"""Compiled lower bound on the clearance all along a path, on distances in closed form."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Records, records
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.proof.kernels.course import Course, Memory, measure, travel_of_shapes
from ffsr_plan.proof.kernels.edge_proof import set_step
from ffsr_plan.proof.kernels.passage import is_finest

_MOST_PARTS = 1024  # of an edge; with more the bound stays what it is by then

PART = np.dtype(
    [("begin", np.float64), ("end", np.float64), ("bound", np.float64), ("start", np.int64)]
)
"""A part of an edge: part k ends at row k + 1 of the distances.

    begin, end  times, in [0, 1]
    bound       on the clearance all along it [m]
    start       row of the distances at its start
"""


class Parts(NamedTuple):
    """Memory for the parts of an edge with g shapes.

    Attributes:
        parts: (_MOST_PARTS + 1,) records of `PART`.
        distances: (_MOST_PARTS + 2, g) of the shapes [m].
    """

    parts: Records
    distances: Array


def parts_for(course: Course) -> Parts:
    """Memory for the edges of a course."""
    distances = np.empty((_MOST_PARTS + 2, len(course.shapes)))
    return Parts(records(PART, _MOST_PARTS + 1), distances)


@kernel
def path_clearance(
    course: Course,
    speeds: Array,
    offsets: Array,
    clearances: Array,
    rounding: float,
    precision: float,
    memory: Memory,
    parts: Parts,
) -> float:
    """A proven lower bound on the clearance along a path.

    On each edge the part with the lowest bound is halved until that bound is within the share
    `precision` of the least clearance met on the path, see `interval_halving.clearance_bound`.

    Args:
        course: the motion that offsets are counted from.
        speeds: (m,) bound on the speed of any point over an edge, in addition to the base's [m].
        offsets: (m + 1, 3) offsets of the path's nodes [m].
        clearances: (m + 1,) clearances at the nodes [m].
        rounding: length added to every travel bound [m].
        precision: relative precision of the bound, between 0 and 1.
        memory: scratch memory.
        parts: scratch memory.

    Returns:
        The bound [m].
    """
    least, distances = clearances[0], parts.distances
    for layer in range(len(speeds)):
        least = min(least, clearances[layer + 1])
    bound = least
    for layer in range(len(speeds)):
        tail, head = offsets[layer], offsets[layer + 1]
        speed = set_step(course, layer, tail, head, memory) + speeds[layer]
        ends = clearances[layer] + clearances[layer + 1]
        lowest = 0.5 * (ends - speed - rounding)
        if least - lowest > max(precision * least, rounding):
            measure(course, layer, 0.0, tail, memory, distances[0])
            measure(course, layer, 1.0, head, memory, distances[1])
            numbers = rounding, precision, speed
            lowest, least = _refined(course, layer, tail, head, numbers, least, memory, parts)
        bound = min(bound, lowest)
    return min(bound, least)


@kernel
def edge_clearance(
    course: Course,
    layer: int,
    tail: Array,
    head: Array,
    numbers: tuple[float, float, float],
    least: float,
    memory: Memory,
    parts: Parts,
) -> tuple[float, float]:
    """A proven lower bound on the clearance along one edge of a path.

    Args:
        course: the motion that offsets are counted from.
        layer: the edge.
        tail: (3,) offset at its start [m].
        head: (3,) offset at its end [m].
        numbers: the rounding [m], the relative precision, and a bound on the speed of any point
            over the edge, the base's own included [m].
        least: the least clearance met on the path so far [m].
        memory: scratch memory.
        parts: scratch memory.

    Returns:
        The bound, and the least clearance met, this edge included [m].
    """
    set_step(course, layer, tail, head, memory)
    first = measure(course, layer, 0.0, tail, memory, parts.distances[0])
    last = measure(course, layer, 1.0, head, memory, parts.distances[1])
    return _refined(course, layer, tail, head, numbers, min(least, first, last), memory, parts)


@kernel
def _refined(
    course: Course,
    layer: int,
    tail: Array,
    head: Array,
    numbers: tuple[float, float, float],
    least: float,
    memory: Memory,
    parts: Parts,
) -> tuple[float, float]:
    """Lowest bound over the parts of an edge, and the least clearance met so far."""
    rounding, precision, speed = numbers
    shift, rows, distances, count = memory.vectors[2], parts.parts, parts.distances, 1
    rows[0].begin, rows[0].end, rows[0].start = 0.0, 1.0, 0
    _bound_part(course, layer, rows[0], distances[1], rounding, speed, memory, distances)
    while True:
        k = 0
        for other in range(1, count):
            if rows[other].bound < rows[k].bound:
                k = other
        lowest, part = rows[k].bound, rows[k]
        if least - lowest <= max(precision * least, rounding) or count > _MOST_PARTS - 1:
            return lowest, least
        if is_finest(course.passage, part.end - part.begin):
            return lowest, least
        middle = 0.5 * (part.begin + part.end)
        for a in range(3):
            shift[a] = (1.0 - middle) * tail[a] + middle * head[a]
        # the earlier half is new and ends at a new row; the later half keeps the end it had
        least = min(least, measure(course, layer, middle, shift, memory, distances[count + 1]))
        earlier = rows[count]
        earlier.begin, earlier.end, earlier.start = part.begin, middle, part.start
        part.begin, part.start = middle, count + 1
        for half in (k, count):
            last = distances[half + 1]
            _bound_part(course, layer, rows[half], last, rounding, speed, memory, distances)
        count += 1


@kernel
def _bound_part(
    course: Course,
    layer: int,
    part: Any,  # noqa: ANN401 - one record of PART
    last: Array,
    rounding: float,
    speed: float,
    memory: Memory,
    distances: Array,
) -> None:
    """Fill in the bound of a part: each shape's own, or that of the least distances."""
    ways, first = memory.ways, distances[part.start]
    travel_of_shapes(course, layer, part.begin, part.end, memory, ways)
    bound, start, end = np.inf, np.inf, np.inf
    for i in range(len(ways)):
        bound = min(bound, 0.5 * (first[i] + last[i] - ways[i] - rounding))
        start, end = min(start, first[i]), min(end, last[i])
    together = 0.5 * (start + end - (part.end - part.begin) * speed - rounding)
    part.bound = max(bound, together)
