"""Interval halving: proofs that an edge is free (Schwarzer, Saha and Latombe 2005).

If a link's clearances at both ends of an interval sum to more than any of its points can travel in
it, the link touches no obstacle inside the interval: to touch, a point would have to cover the
clearance at one end to get there, and that at the other end to get back. If the sums do not
suffice, the clearance at the middle is computed and both halves are examined. Pairs of links that
must not touch each other are judged by the same criterion.
"""

from __future__ import annotations

import heapq
from typing import NamedTuple, Protocol

import numpy as np

from ffsr_plan.core.arrays import Array

ROUNDING = 1e-9
"""Length [m] added to every travel bound: far above the rounding errors of distances at coordinates
up to `core.checks.FARTHEST`."""


class Edge(Protocol):
    """An edge run from time 0 to 1. Its parts are links, or pairs of links.

    Attributes:
        speed: bound on the travel of any part per unit of time [m]: a first, coarse bound.
        rounding: length added to every travel bound for floating-point errors [m].
    """

    @property
    def speed(self) -> float:
        """Bound on the travel of any part per unit of time [m]."""

    @property
    def rounding(self) -> float:
        """Length added to every travel bound for floating-point errors [m]."""

    def clearance(self, time: float) -> float:
        """Least distance over all parts, computed by Coal [m]."""

    def travel(self, begin: float, end: float) -> Array:
        """(p,) upper bound on the travel of each part between two times [m]."""

    def margins(self, begin: float, end: float, ways: Array) -> Array:
        """(p,) by how much the distances of each part at two times exceed its travel [m].

        With d of them, no part is nearer than half of the least d in between. `ways` (p,) is what
        `travel` says of the interval, the rounding included.
        """


class Verdict(NamedTuple):
    """Result of interval halving for one edge.

    Attributes:
        free: whether the edge is proven free.
        least_clearance: least clearance computed [m]; elsewhere it is only proven positive.
        time: the time in [0, 1] of that clearance.
        queries: number of configurations between the ends at which a clearance was computed.
    """

    free: bool
    least_clearance: float
    time: float
    queries: int


def certify(edge: Edge, ends: tuple[float, float], tolerance: float) -> Verdict:
    """Prove that an edge is free of collisions, or refuse it.

    Touching counts as a collision. An edge is refused only if its clearance is at most `tolerance`
    somewhere (or the edge's rounding, if that is larger). An edge whose clearance is larger
    everywhere is always proven free.

    Args:
        edge: the edge.
        ends: clearances at times 0 and 1 [m].
        tolerance: clearance below which an edge may be refused [m].

    Returns:
        The verdict, with the least clearance that was computed.
    """
    least, queries = min((ends[0], 0.0), (ends[1], 1.0)), 0
    if least[0] <= 0.0:
        return Verdict(False, *least, queries)
    stack = [(0.0, 1.0, ends[0], ends[1])]
    while stack:
        begin, end, first, last = stack.pop()
        bound, travel = _proven(edge, begin, end, first, last, 0.0)
        if bound > 0.0:
            continue
        # here min(first, last) <= travel / 2: at or below the tolerance once the interval is short
        if travel <= 2.0 * max(tolerance, edge.rounding):
            return Verdict(False, *min((first, begin), (last, end)), queries)
        middle = 0.5 * (begin + end)
        clearance = edge.clearance(middle)
        queries += 1
        least = min(least, (clearance, middle))
        if clearance <= 0.0:
            return Verdict(False, *least, queries)
        stack.append((middle, end, clearance, last))
        stack.append((begin, middle, first, clearance))
    return Verdict(True, *least, queries)


def clearance_bound(
    edge: Edge, ends: tuple[float, float], least: float, precision: float
) -> tuple[float, float]:
    """A proven lower bound on the clearance along an edge of a path.

    The interval with the lowest bound is halved until that bound is within the share `precision`
    of the least clearance computed on the path. So a path whose clearance is positive gets a
    positive bound. An edge whose clearance is larger than the path's least is finished at once.

    Args:
        edge: the edge.
        ends: clearances at times 0 and 1 [m].
        least: least clearance computed on the path so far [m].
        precision: relative precision of the bound, between 0 and 1.

    Returns:
        The bound [m], and the least clearance computed on the path, this edge included [m].
    """
    least = min(least, *ends)
    share = 1.0 - precision
    heap = [(_proven(edge, 0.0, 1.0, *ends, share * least)[0], 0.0, 1.0, *ends)]
    while least - heap[0][0] > max(precision * least, edge.rounding):
        _, begin, end, first, last = heapq.heappop(heap)
        middle = 0.5 * (begin + end)
        clearance = edge.clearance(middle)
        least = min(least, clearance)
        for half in ((begin, middle, first, clearance), (middle, end, clearance, last)):
            heapq.heappush(heap, (_proven(edge, *half, share * least)[0], *half))
    return min(heap[0][0], least), least


def _proven(
    edge: Edge, begin: float, end: float, first: float, last: float, enough: float
) -> tuple[float, float]:
    """A lower bound on the clearance over an interval, and the travel bound behind it.

    Three bounds are computed in turn until one exceeds `enough`: the least clearances with the
    coarse travel bound, the least clearances with the sharp one, and each part's own clearances.
    """
    travel = (end - begin) * edge.speed + edge.rounding
    bound = 0.5 * (first + last - travel)
    if bound > enough:
        return bound, travel
    each = edge.travel(begin, end) + edge.rounding
    travel = min(travel, float(each.max(initial=0.0)))
    bound = 0.5 * (first + last - travel)
    if bound > enough:
        return bound, travel
    margins = edge.margins(begin, end, each)
    return max(bound, 0.5 * float(margins.min(initial=np.inf))), travel
