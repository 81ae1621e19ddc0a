"""Compiled values, rates and bounds of the cubic pieces of a curve.

A piece is run from time 0 to 1 and held in Bernstein form, so that what it does over any part of it
lies between its coefficients over that part. These are values of the polar form (blossom).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel

VALUES, RATES, BENDS, TURN, ROWS = 0, 4, 7, 9, 10
"""Rows of `Pieces` at which its parts begin, and their number."""
FIRST_JOINT = 3
"""Column of the first joint."""


class Pieces(NamedTuple):
    """The m cubic pieces of a curve; none where a motion has straight edges.

    The D = 3 + nd + 1 columns are the base origin where thrusters move it, or the centre of mass
    where nothing does (world axes) [m]; the joint values [rad or m]; and a share from 0 to 1 of the
    rotation by wheels, or where the base reacts of the way, which is the joints' if it is straight.

    Attributes:
        rows: (m, 10, D) Bernstein coefficients of the values, of their derivatives by time and of
            their second derivatives; in the last row the rotation by wheels from start to goal.
            They are one array because kernels hand every array on in a dozen numbers.
    """

    rows: Array

    @property
    def values(self) -> Array:
        """(m, 4, D) Bernstein coefficients."""
        return self.rows[:, VALUES:RATES]

    @property
    def rates(self) -> Array:
        """(m, 3, D) those of the derivative by time."""
        return self.rows[:, RATES:BENDS]

    @property
    def bends(self) -> Array:
        """(m, 2, D) those of the second derivative."""
        return self.rows[:, BENDS:TURN]

    @property
    def turn(self) -> Array:
        """(3,) rotation by wheels from start to goal, base axes [rad]; zero without."""
        return self.rows[0, TURN, :3]


@kernel
def value_at(pieces: Pieces, piece: int, time: float, column: int) -> float:
    """A column at a time in [0, 1] on a piece."""
    s, c = 1.0 - time, pieces.rows[piece]
    early = s * s * (s * c[0, column] + 3.0 * time * c[1, column])
    late = time * time * (3.0 * s * c[2, column] + time * c[3, column])
    return float(early + late)


@kernel
def rate_between(pieces: Pieces, piece: int, u: float, v: float, column: int) -> float:
    """Polar form of a column's derivative: its value where both times are the same.

    Its coefficients over an interval are those at (begin, begin), (begin, end) and (end, end).
    """
    c, both, neither = pieces.rows[piece], u * v, (1.0 - u) * (1.0 - v)
    mixed = (1.0 - u) * v + u * (1.0 - v)
    ends = neither * c[RATES, column] + both * c[RATES + 2, column]
    return float(ends + mixed * c[RATES + 1, column])


@kernel
def bend_at(pieces: Pieces, piece: int, time: float, column: int) -> float:
    """Second derivative of a column at a time on a piece; it is linear in time."""
    c = pieces.rows[piece]
    return float((1.0 - time) * c[BENDS, column] + time * c[BENDS + 1, column])


@kernel
def joints_at(pieces: Pieces, piece: int, time: float, values: Array, rates: Array) -> None:
    """Fill in joint values and rates (nd,) at a time on a piece."""
    for j in range(len(values)):
        values[j] = value_at(pieces, piece, time, FIRST_JOINT + j)
        rates[j] = rate_between(pieces, piece, time, time, FIRST_JOINT + j)


@kernel
def share_at(pieces: Pieces, piece: int, time: float) -> float:
    """The share, the last column, at a time on a piece."""
    return value_at(pieces, piece, time, pieces.rows.shape[2] - 1)


@kernel
def largest_rate(pieces: Pieces, piece: int, begin: float, end: float, column: int) -> float:
    """Bound on the magnitude of a column's derivative over a part of a piece."""
    first, last = (
        rate_between(pieces, piece, begin, begin, column),
        rate_between(pieces, piece, end, end, column),
    )
    return max(abs(first), abs(last), abs(rate_between(pieces, piece, begin, end, column)))


@kernel
def largest_bend(pieces: Pieces, piece: int, begin: float, end: float, column: int) -> float:
    """Bound on the magnitude of a column's second derivative over a part of a piece."""
    return max(abs(bend_at(pieces, piece, begin, column)), abs(bend_at(pieces, piece, end, column)))


@kernel
def largest_base_rates(pieces: Pieces, piece: int, begin: float, end: float) -> tuple[float, float]:
    """Bounds on the norms of the first and second derivative of the base origin over a part [m]."""
    first, mixed, last, bent, bending = 0.0, 0.0, 0.0, 0.0, 0.0
    for a in range(3):
        first += rate_between(pieces, piece, begin, begin, a) ** 2
        mixed += rate_between(pieces, piece, begin, end, a) ** 2
        last += rate_between(pieces, piece, end, end, a) ** 2
        bent += bend_at(pieces, piece, begin, a) ** 2
        bending += bend_at(pieces, piece, end, a) ** 2
    return math.sqrt(max(first, mixed, last)), math.sqrt(max(bent, bending))
