"""Compiled lower bound on the clearance all along a path, on distances in closed form."""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.proof.kernels.course import Course, Memory, measure, memory_for, travel_of_shapes

_MOST_PARTS = 1024  # of an edge; with more the bound stays what it is by then


@kernel
def path_clearance(
    course: Course,
    speeds: Array,
    offsets: Array,
    clearances: Array,
    rounding: float,
    precision: float,
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

    Returns:
        The bound [m].
    """
    shapes, memory = len(course.shapes.kinds), memory_for(course)
    bound = least = float(np.min(clearances))
    step, distances = np.empty(3), np.empty((_MOST_PARTS + 2, shapes))
    parts = np.empty((_MOST_PARTS + 1, 3))  # begin, end and bound; part k ends at row k + 1
    starts = np.empty(_MOST_PARTS + 1, np.int64)  # and starts at this row
    for layer in range(len(speeds)):
        length, tail, head = 0.0, offsets[layer], offsets[layer + 1]
        for a in range(3):
            along = course.positions[layer + 1, a] - course.positions[layer, a]
            step[a] = 0.0 if course.base.floats else along + head[a] - tail[a]
            length += step[a] * step[a]
        speed, ends = math.sqrt(length) + speeds[layer], clearances[layer] + clearances[layer + 1]
        lowest = 0.5 * (ends - speed - rounding)
        if least - lowest > max(precision * least, rounding):
            measure(course, layer, 0.0, tail, memory, distances[0])
            measure(course, layer, 1.0, head, memory, distances[1])
            parts[0], starts[0] = (0.0, 1.0, 0.0), 0
            lowest, least = _refined(
                course, layer, (tail, head, step), (rounding, precision, speed), least, memory,
                distances, parts, starts,
            )  # fmt: skip
        bound = min(bound, lowest)
    return float(min(bound, least))


@kernel
def _refined(
    course: Course,
    layer: int,
    offsets: tuple[Array, Array, Array],
    numbers: tuple[float, float, float],
    least: float,
    memory: Memory,
    distances: Array,
    parts: Array,
    starts: IntArray,
) -> tuple[float, float]:
    """Lowest bound over the parts of an edge, and the least clearance met so far."""
    tail, head, step = offsets
    rounding, precision, speed = numbers
    shift, ways, count = np.empty(3), np.empty(distances.shape[1]), 1
    _bound_part(course, layer, 0, step, rounding, speed, memory, distances, parts, starts, ways)
    while True:
        k = int(np.argmin(parts[:count, 2]))
        lowest = parts[k, 2]
        if least - lowest <= max(precision * least, rounding) or count > _MOST_PARTS - 1:
            return lowest, least
        begin, end = parts[k, 0], parts[k, 1]
        middle = 0.5 * (begin + end)
        for a in range(3):
            shift[a] = (1.0 - middle) * tail[a] + middle * head[a]
        # the earlier half is new and ends at a new row; the later half keeps the end it had
        least = min(least, measure(course, layer, middle, shift, memory, distances[count + 1]))
        parts[count] = begin, middle, 0.0
        starts[count], starts[k], parts[k, 0] = starts[k], count + 1, middle
        for half in (k, count):
            _bound_part(
                course, layer, half, step, rounding, speed, memory, distances, parts, starts, ways
            )
        count += 1


@kernel
def _bound_part(
    course: Course,
    layer: int,
    k: int,
    step: Array,
    rounding: float,
    speed: float,
    memory: Memory,
    distances: Array,
    parts: Array,
    starts: IntArray,
    ways: Array,
) -> None:
    """Fill in the bound of part `k`: each shape's own, or that of the least distances."""
    begin, end = parts[k, 0], parts[k, 1]
    first, last = distances[starts[k]], distances[k + 1]
    travel_of_shapes(course, layer, begin, end, step, memory, ways)
    bound = np.inf
    for i in range(len(ways)):
        bound = min(bound, 0.5 * (first[i] + last[i] - ways[i] - rounding))
    together = 0.5 * (first.min() + last.min() - (end - begin) * speed - rounding)
    parts[k, 2] = max(bound, together)
