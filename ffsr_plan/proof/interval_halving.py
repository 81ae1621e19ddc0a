"""Edges proven free by interval halving (Schwarzer, Saha and Latombe 2005).

If a link's clearances at both ends of an interval sum to more than any of its points can travel in
it, none can have reached an obstacle in between: to touch, it would have had to cover the clearance
at one end to get there and that at the other to get back. Where the sums do not suffice, Coal is
asked at the middle, and both halves are looked at again. Links that must not touch each other are
judged by the same criterion, in pairs.
"""

from __future__ import annotations

import heapq
from typing import NamedTuple, Protocol

import numpy as np

from ffsr_plan.core.arrays import Array

ROUNDING = 1e-9
"""Travel [m] added to every bound: far above the errors of distances within `inputs.FARTHEST`."""


class Edge(Protocol):
    """What halving asks of an edge, in times from 0 to 1. Its parts are links, or pairs of them."""

    @property
    def speed(self) -> float:
        """Distance [m] that no part outruns per unit of time: a first, quick bound."""

    @property
    def rounding(self) -> float:
        """Travel [m] to be added to every bound, for the errors of floating-point numbers."""

    def clearance(self, time: float) -> float:
        """Least distance over all parts [m], by Coal."""

    def parts(self, time: float) -> Array:
        """(p,) lower bound on the distance of each part [m]."""

    def travel(self, begin: float, end: float) -> Array:
        """(p,) bound on how far each part travels between two times [m]."""


class Verdict(NamedTuple):
    """What interval halving found out about one edge."""

    free: bool
    least_clearance: float
    """The least clearance met [m]; what lies between was only shown to be greater than zero."""
    time: float
    """Where on the edge that was, in [0, 1]."""
    queries: int
    """Configurations between the ends at which Coal was asked."""


def certify(edge: Edge, ends: tuple[float, float], tolerance: float) -> Verdict:
    """Prove that an edge keeps clear, or find where it does not.

    Touching counts as blocked. An edge is refused only where its clearance is at most `tolerance`
    somewhere (or the edge's margin for rounding, where that is more); with more than that all
    along, it is always proven free.

    Args:
        edge: the edge.
        ends: clearances [m] at times 0 and 1.
        tolerance: clearance [m] below which an edge may be refused.
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
    edge: Edge, ends: tuple[float, float], met: float, slack: float
) -> tuple[float, float]:
    """A proven lower bound on the clearance along an edge of a path, near the path's least.

    The interval whose bound is lowest is halved until that bound is close to the least clearance
    met on the path: within the share `slack` of it, so that a path that keeps clear gets a bound
    greater than zero. An edge that is clear by more than that is left at once.

    Args:
        edge: the edge.
        ends: clearances [m] at times 0 and 1.
        met: the least clearance met on the path so far.
        slack: between 0 and 1.

    Returns:
        The bound, and the least clearance met by now.
    """
    met = min(met, *ends)
    near = 1.0 - slack
    heap = [(_proven(edge, 0.0, 1.0, *ends, near * met)[0], 0.0, 1.0, *ends)]
    while met - heap[0][0] > max(slack * met, edge.rounding):
        _, begin, end, first, last = heapq.heappop(heap)
        middle = 0.5 * (begin + end)
        clearance = edge.clearance(middle)
        met = min(met, clearance)
        for half in ((begin, middle, first, clearance), (middle, end, clearance, last)):
            heapq.heappush(heap, (_proven(edge, *half, near * met)[0], *half))
    return min(heap[0][0], met), met


def _proven(
    edge: Edge, begin: float, end: float, first: float, last: float, enough: float
) -> tuple[float, float]:
    """A lower bound on the clearance over an interval, and the bound on travel that it rests on.

    The work stops at the first bound that is greater than `enough`: the least clearances against
    the quick bound on travel, against the sharp one, and at last each part's own clearances.
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
    spare = edge.parts(begin) + edge.parts(end) - each
    return max(bound, 0.5 * float(spare.min(initial=np.inf))), travel
