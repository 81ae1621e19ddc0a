"""Edges proven free by interval halving (Schwarzer, Saha and Latombe 2005).

If the clearances at both ends of an interval sum to more than any point can travel in it, no point
can have reached an obstacle in between: to touch, it would have had to cover the clearance at one
end to get there and that at the other to get back. Where the sum does not suffice, Coal is asked at
the middle, and both halves are looked at again.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

ROUNDING = 1e-9
"""Travel [m] added to every bound: far above the errors of distances and attitudes."""


class Verdict(NamedTuple):
    """What interval halving found out about one edge."""

    free: bool
    least_clearance: float
    """If free, a lower bound on the clearance along the edge; else the least one met [m]."""
    time: float
    """Where on the edge that was, in [0, 1]."""


def certify(
    clearance_at: Callable[[float], float], ends: tuple[float, float], speed: float, tolerance: float
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
    least, least_time = min((ends[0], 0.0), (ends[1], 1.0))
    if least <= 0.0:
        return Verdict(False, least, least_time)
    proven, proven_time = float("inf"), 0.0
    stack = [(0.0, 1.0, ends[0], ends[1])]
    while stack:
        begin, end, first, last = stack.pop()
        spare = first + last - (end - begin) * speed - ROUNDING
        middle = 0.5 * (begin + end)
        if spare > 0.0:
            if 0.5 * spare < proven:
                proven, proven_time = 0.5 * spare, middle
            continue
        # here min(first, last) <= travel / 2: at or below the tolerance once the interval is short
        if (end - begin) * speed + ROUNDING <= 2.0 * tolerance:
            return Verdict(False, *min((first, begin), (last, end)))
        clearance = clearance_at(middle)
        if clearance <= 0.0:
            return Verdict(False, clearance, middle)
        stack.append((middle, end, clearance, last))
        stack.append((begin, middle, first, clearance))
    return Verdict(True, min(proven, least), proven_time)
