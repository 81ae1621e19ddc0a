"""The first contact on an edge of a motion, by interval halving from its begin on.

Just before a contact distances are below the tolerance, and nothing is proven there. So the answer
has two times: until the first all is proven free, at the second something touches. Between them
nothing was found to touch, and an earlier contact is not ruled out.
"""

from __future__ import annotations

from typing import NamedTuple

from ffsr_plan.proof.interval_halving import Edge

_FINEST = 2.0**-50  # intervals of [0, 1] that can still be halved


class Search(NamedTuple):
    """What was found on an edge.

    Attributes:
        contact: time in [0, 1] at which something touches, and did not at some time less than the
            resolution before it. None without a contact.
        near: time until which all is proven free: there the contact begins, or the clearance is so
            small that it could not be proven positive. None if the whole edge is proven free.
    """

    contact: float | None
    near: float | None


def first_contact(edge: Edge, tolerance: float, resolution: float, until: float = 1.0) -> Search:
    """Look for the first time at which something touches.

    Args:
        edge: the edge.
        tolerance: clearance that need not be proven [m].
        resolution: of the time, in units of the edge's time.
        until: time up to which contacts are looked for, in [0, 1].
    """
    near, first, last = None, edge.clearance(0.0), edge.clearance(1.0)
    if first <= 0.0:
        return Search(0.0, 0.0)
    resolution = max(resolution, _FINEST)
    stack = [(0.0, 1.0, first, last)]
    while stack:
        begin, end, first, last = stack.pop()
        if begin > until:
            break
        if last > 0.0 and _is_free(edge, begin, end, first, last):
            continue
        small = _travel(edge, begin, end) <= 2.0 * max(tolerance, edge.rounding)
        if last <= 0.0 and end - begin <= resolution:
            return Search(end, begin if near is None else near)
        if last > 0.0 and small:
            near = begin if near is None else near
            continue
        middle = 0.5 * (begin + end)
        clearance = edge.clearance(middle)
        if clearance > 0.0:
            stack.append((middle, end, clearance, last))
        stack.append((begin, middle, first, clearance))
    return Search(None, near)


def _is_free(edge: Edge, begin: float, end: float, first: float, last: float) -> bool:
    """Whether an interval is proven free by the clearances at its ends."""
    if first + last > (end - begin) * edge.speed + edge.rounding:
        return True
    each = edge.travel(begin, end) + edge.rounding
    if first + last > float(each.max(initial=0.0)):
        return True
    return bool((edge.margins(begin, end, each) > 0.0).all())


def _travel(edge: Edge, begin: float, end: float) -> float:
    coarse = (end - begin) * edge.speed + edge.rounding
    return min(coarse, float(edge.travel(begin, end).max(initial=0.0)) + edge.rounding)
