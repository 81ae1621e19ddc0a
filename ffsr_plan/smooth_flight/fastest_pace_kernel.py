"""Compiled search for the fastest pace along a curve, by reachability.

With x = s'^2 and u = s'' = (dx/ds) / 2, constant over a step, every limit is a convex set in the
plane of u and x (`step_limits`) that contains the origin, at which the robot rests. The highest x
at the start of each step from which the rest of the curve can be flown follows from that at its
end; so does, forwards, the highest x that is reached. Both passes together give the fastest law
over these steps (Pham and Pham, "A New Approach to Time-Optimal Path Parameterization Based on
Reachability Analysis", 2018). In the plane at one x, u is restricted to an interval in closed form;
the highest x is found by bisection.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel

HIGHEST = 1e30
"""x where nothing limits it [1/s^2]; its root and its reciprocal are still ordinary numbers."""
_CLOSE = 1e-13  # relative width at which bisection ends
_NEVER = 1e300


class StepLimits(NamedTuple):
    """Limits over the S steps of a curve, each asked for at P points of the step.

    x is that at the start of the step: at the point a distance d later, it is x + 2 d u.

    Attributes:
        lengths: (S,) of the steps in s.
        ahead: (S, P) distance of the points from the start of the step.
        highest: (S, P) highest x at the points.
        discs: (S, P, D, 3) products a.a, a.b and b.b of vectors with |a u + b x| <= 1.
        lines: (S, P, L, 2) numbers a and b with |a u + b x| <= 1.
        share: (S,) of the limits that may be used, instead of 1.
    """

    lengths: Array
    ahead: Array
    highest: Array
    discs: Array
    lines: Array
    share: Array


@kernel
def fastest_squares(
    limits: StepLimits, begin: float, end: float, most: Array, squares: Array
) -> None:
    """The highest x between the steps.

    Args:
        limits: the limits.
        begin: x at the start; less where the rest of the curve cannot be flown from it.
        end: x at the end; less where it cannot be reached.
        most: (S + 1,) filled in: the highest x from which the rest can be flown.
        squares: (S + 1,) filled in: x of the fastest law.
    """
    count = len(limits.lengths)
    most[count] = end
    for step in range(count - 1, -1, -1):
        most[step] = _highest_start(limits, step, most[step + 1])
    squares[0] = min(begin, most[0])
    for step in range(count):
        low, high = _interval(limits, step, squares[step])
        less = 1e-14
        while low > high:  # by rounding
            squares[step] *= 1.0 - less
            less *= 2.0
            low, high = _interval(limits, step, squares[step])
        reached = squares[step] + 2.0 * limits.lengths[step] * high
        squares[step + 1] = max(min(reached, most[step + 1]), 0.0)


@kernel
def _highest_start(limits: StepLimits, step: int, end: float) -> float:
    """The highest x at the start of a step from which it can be flown to at most `end`."""
    top = min(limits.highest[step, 0] * limits.share[step], HIGHEST)
    low, _ = _interval(limits, step, 0.0)
    begin, beyond = 0.0, min(2.0 * (end - 2.0 * limits.lengths[step] * low), top)
    while _can_be_flown(limits, step, beyond, end):
        if beyond >= top:
            return top
        begin, beyond = beyond, min(2.0 * beyond, top)
    while beyond - begin > _CLOSE * beyond:
        middle = 0.5 * (begin + beyond)
        if _can_be_flown(limits, step, middle, end):
            begin = middle
        else:
            beyond = middle
    return begin


@kernel
def _can_be_flown(limits: StepLimits, step: int, x: float, end: float) -> bool:
    """Whether a step can be flown from x to something from 0 to `end`."""
    low, high = _interval(limits, step, x)
    twice = 2.0 * limits.lengths[step]
    return bool(max(low, -x / twice) <= min(high, (end - x) / twice))


@kernel
def _interval(limits: StepLimits, step: int, x: float) -> tuple[float, float]:
    """Least and largest u over a step from x; the first is larger where there is none."""
    low, high, share = -_NEVER, _NEVER, limits.share[step]
    for p in range(limits.ahead.shape[1]):
        ahead = limits.ahead[step, p]
        if ahead > 0.0:
            high = min(high, (limits.highest[step, p] * share - x) / (2.0 * ahead))
        for d in range(limits.discs.shape[2]):
            aa, ab, bb = limits.discs[step, p, d]
            if aa <= 0.0:
                if bb * x * x > share * share:
                    return 1.0, -1.0
                continue
            middle = -ab * x / aa
            square = middle * middle - (bb * x * x - share * share) / aa
            if square < 0.0:
                return 1.0, -1.0
            low, high = max(low, middle - math.sqrt(square)), min(high, middle + math.sqrt(square))
        for k in range(limits.lines.shape[2]):
            a, along = limits.lines[step, p, k, 0], limits.lines[step, p, k, 1] * x
            if a == 0.0:
                if abs(along) > share:
                    return 1.0, -1.0
                continue
            half = abs(share / a)
            low, high = max(low, -along / a - half), min(high, -along / a + half)
        if low > high:
            return low, high
    return low, high


def squares_of(limits: StepLimits, begin: float, end: float) -> tuple[Array, Array]:
    """The fastest law's x (S + 1,), and the highest x from which the rest can be flown."""
    most, squares = np.empty((2, len(limits.lengths) + 1))
    fastest_squares(limits, begin, end, most, squares)
    return squares, most
