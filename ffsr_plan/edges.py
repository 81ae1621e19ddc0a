"""Edges proven free by interval halving (Schwarzer, Saha and Latombe 2005).

If the clearances at both ends of an interval sum to more than any point can travel in it, no point
can have reached an obstacle in between: to touch, it would have had to cover the clearance at one
end to get there and that at the other to get back. Where the sum does not suffice, Coal is asked at
the middle, and both halves are looked at again.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable
from typing import NamedTuple

ROUNDING = 1e-9
"""Travel [m] added to every bound: far above the errors of distances and attitudes."""


class Verdict(NamedTuple):
    """What interval halving found out about one edge."""

    free: bool
    least_clearance: float
    """The least clearance met [m]; what lies between was only shown to be greater than zero."""
    time: float
    """Where on the edge that was, in [0, 1]."""


def certify(
    clearance_at: Callable[[float], float],
    ends: tuple[float, float],
    speed: float,
    tolerance: float,
) -> Verdict:
    """Prove that an edge keeps clear, or find where it does not.

    Touching counts as blocked. An edge is refused only where its clearance is at most `tolerance`
    somewhere; with more than that all along, it is always proven free.

    Args:
        clearance_at: clearance [m] at a time in (0, 1).
        ends: clearances at times 0 and 1.
        speed: bound on the distance that any point travels over the edge [m].
        tolerance: clearance [m] below which an edge may be refused.
    """
    least = min((ends[0], 0.0), (ends[1], 1.0))
    if least[0] <= 0.0:
        return Verdict(False, *least)
    stack = [(0.0, 1.0, ends[0], ends[1])]
    while stack:
        begin, end, first, last = stack.pop()
        travel = (end - begin) * speed + ROUNDING
        if first + last > travel:
            continue
        # here min(first, last) <= travel / 2: at or below the tolerance once the interval is short
        if travel <= 2.0 * tolerance:
            return Verdict(False, *min((first, begin), (last, end)))
        middle = 0.5 * (begin + end)
        clearance = clearance_at(middle)
        least = min(least, (clearance, middle))
        if clearance <= 0.0:
            return Verdict(False, *least)
        stack.append((middle, end, clearance, last))
        stack.append((begin, middle, first, clearance))
    return Verdict(True, *least)


def clearance_bound(
    clearance_at: Callable[[float], float],
    ends: tuple[float, float],
    speed: float,
    met: float,
    slack: float,
) -> tuple[float, float]:
    """A proven lower bound on the clearance along an edge of a path, near the path's least.

    The interval whose bound is lowest is halved until that bound is close to the least clearance
    met on the path: within the share `slack` of it, so that a path that keeps clear gets a bound
    greater than zero. An edge that is clear by more than that is left at once.

    Args:
        clearance_at: clearance [m] at a time in (0, 1).
        ends: clearances at times 0 and 1.
        speed: bound on the distance that any point travels over the edge [m].
        met: the least clearance met on the path so far.
        slack: between 0 and 1.

    Returns:
        The bound, and the least clearance met by now.
    """

    def interval(
        begin: float, end: float, first: float, last: float
    ) -> tuple[float, float, float, float, float]:
        bound = 0.5 * (first + last - (end - begin) * speed - ROUNDING)
        return (bound, begin, end, first, last)

    met = min(met, *ends)
    heap = [interval(0.0, 1.0, *ends)]
    while met - heap[0][0] > max(slack * met, ROUNDING):
        _, begin, end, first, last = heapq.heappop(heap)
        middle = 0.5 * (begin + end)
        clearance = clearance_at(middle)
        met = min(met, clearance)
        heapq.heappush(heap, interval(begin, middle, first, clearance))
        heapq.heappush(heap, interval(middle, end, clearance, last))
    return min(heap[0][0], met), met
