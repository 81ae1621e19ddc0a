"""Cubic polynomials of time, given by their derivatives at the start."""

from __future__ import annotations

from ffsr_plan.core.arrays import Array


def evaluate(begin: Array, time: Array) -> tuple[Array, Array, Array]:
    """Value and derivatives.

    Args:
        begin: (N, 4) value and first three derivatives at time 0.
        time: (N,) [s].

    Returns:
        Value, first and second derivative, (N,) each.
    """
    x, speed, acceleration, jerk = begin.T
    return (
        x + time * (speed + time * (acceleration / 2.0 + time * jerk / 6.0)),
        speed + time * (acceleration + time * jerk / 2.0),
        acceleration + time * jerk,
    )
