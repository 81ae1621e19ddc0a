"""Compiled integration of the base's rotation along curved joint pieces.

As along straight segments (`dynamics.kernels.reaction`), but joint values are cubic polynomials of
time, so that their excursions at complex times are those of cubics; docs/proof.md, section 10.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Records
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.curves.kernels.pieces import (
    FIRST_JOINT,
    Pieces,
    bend_at,
    joints_at,
    rate_between,
)
from ffsr_plan.dynamics.kernels.bodies import base_rate, move_links, weigh_links
from ffsr_plan.dynamics.kernels.rate_bound import excursion_of_link, rate_bound
from ffsr_plan.dynamics.kernels.reaction import (
    INTERPOLATION,
    LARGEST_TWIST,
    LEAST_RHO,
    MOST_SUBSTEPS,
    NEXT_TWIST,
    Memory,
    integrate,
    memory_for,
    rate_at_point,
)
from ffsr_plan.dynamics.kernels.rotation_series import POINTS, TERMS


class CurveMemory(NamedTuple):
    """Scratch memory for a robot with n links.

    Attributes:
        straight: of the integration along straight segments.
        rates: (nd,) joint rates.
        powers: (3, nd) joint values over a substep as power series of local time, but for the
            constant: coefficients of u, u^2 and u^3.
    """

    straight: Memory
    rates: Array
    powers: Array


def curve_memory_for(count: int) -> CurveMemory:
    """Memory for `count` links."""
    return CurveMemory(memory_for(count), np.empty(count - 1), np.empty((3, count - 1)))


@kernel
def _expand_joints(pieces: Pieces, piece: int, middle: float, half: float, powers: Array) -> None:
    """Fill in the power series (3, nd) of the joint values about the middle of a substep."""
    for j in range(powers.shape[1]):
        column = FIRST_JOINT + j
        third = bend_at(pieces, piece, 1.0, column) - bend_at(pieces, piece, 0.0, column)
        powers[0, j] = half * rate_between(pieces, piece, middle, middle, column)
        powers[1, j] = half * half * bend_at(pieces, piece, middle, column) / 2.0
        powers[2, j] = half * half * half * third / 6.0


@kernel
def _move_away(
    bodies: Records,
    powers: Array,
    half: float,
    rho: float,
    imaginary: float,
    links: Records,
    moved: Records,
) -> None:
    """Excursions of all links while local time is inside an ellipse.

    Args:
        bodies: (n,) the links, `BODY`.
        powers: (3, nd) joint values as power series of local time.
        half: half the length of the substep.
        rho: sum of the half-axes of the ellipse with the foci -1 and 1.
        imaginary: its imaginary half-axis.
        links: (n,) `LINK_STATE` in the middle.
        moved: (n,) `EXCURSION`, filled in.
    """
    real = 0.5 * (rho + 1.0 / rho)
    excursion_of_link(bodies, 0, 0.0, 0.0, 0.0, links, moved)
    for j in range(1, len(bodies)):
        a, b, c = abs(powers[0, j - 1]), abs(powers[1, j - 1]), abs(powers[2, j - 1])
        speed = (a + real * (2.0 * b + real * 3.0 * c)) / half
        away = real * (a + real * (b + real * c))
        sideways = imaginary * (a + real * b + (imaginary * imaginary + 1.5) * c)
        if speed > 0.0:
            excursion_of_link(bodies, j, speed, away / speed, sideways / speed, links, moved)
        else:
            excursion_of_link(bodies, j, 0.0, 0.0, 0.0, links, moved)


@kernel
def _approximation_error(
    bodies: Records, half: float, tolerance: float, least: float, memory: CurveMemory
) -> float:
    """Bound on the largest difference of omega from its polynomial over a substep [rad].

    Args:
        bodies: the links.
        half: half the length of the substep.
        tolerance: a bound below it is good enough.
        least: least eigenvalue of the inertia in the middle, from below [kg m^2].
        memory: with the links and the joints' power series in the middle.
    """
    links, moved, powers = memory.straight.links, memory.straight.moved, memory.powers
    largest = 0.0  # joint rotation from the base to any link, and sliding, over the substep's half
    moved[0].turn = 0.0
    for j in range(1, len(bodies)):
        turn = abs(powers[0, j - 1]) + abs(powers[1, j - 1]) + abs(powers[2, j - 1])
        moved[j].turn = turn + moved[bodies[j].parent].turn
        largest = max(largest, moved[j].turn)
    if largest == 0.0:
        return 0.0
    error, twist = np.inf, LARGEST_TWIST
    while True:
        imaginary = twist / largest  # of the ellipse with foci -1 and 1 whose axes sum to rho
        rho = imaginary + math.sqrt(imaginary * imaginary + 1.0)
        if rho < LEAST_RHO:
            return error
        _move_away(bodies, powers, half, rho, imaginary, links, moved)
        size = rate_bound(bodies, least, links, moved)
        found = 2.0 * INTERPOLATION * size * rho ** (1 - POINTS) / (rho - 1.0)
        if found <= tolerance or found > error:
            return min(found, error)
        error, twist = found, twist * NEXT_TWIST


@kernel
def cut_curves(
    bodies: Records,
    pieces: Pieces,
    tolerance: float,
    memory: CurveMemory,
    piece: int,
    count: int,
    substeps: Records,
) -> tuple[int, int]:
    """Halve pieces until the polynomials are close enough to omega.

    Args:
        bodies: the links.
        pieces: the curve.
        tolerance: for the error over a whole piece [rad].
        memory: scratch memory.
        piece: the first to cut.
        count: number of substeps of those before it.
        substeps: filled in from there: segment, begin, length and error.

    Returns:
        The first piece that is not cut because there is no room left, or m; and the number of
        substeps of those before it.
    """
    values, links, robot = memory.straight.values, memory.straight.links, memory.straight.robot
    left = memory.straight.left
    for k in range(piece, len(pieces.rows)):
        first, top = count, 1
        left[0, 0], left[0, 1] = 0.0, 1.0
        while top > 0:
            if count == len(substeps):
                return k, first
            top -= 1
            start, length = left[top, 0], left[top, 1]
            middle = start + 0.5 * length
            joints_at(pieces, k, middle, values, memory.rates)
            _expand_joints(pieces, k, middle, 0.5 * length, memory.powers)
            move_links(bodies, values, memory.rates, links)
            weigh_links(bodies, links, robot)
            least = base_rate(robot)
            error = _approximation_error(bodies, 0.5 * length, tolerance, least, memory)
            if not error <= tolerance and length > 2.0**-50 and count - first < MOST_SUBSTEPS:
                left[top, 0], left[top, 1] = start + 0.5 * length, 0.5 * length
                left[top + 1, 0], left[top + 1, 1] = start, 0.5 * length
                top += 2
                continue
            if not error <= tolerance:  # the piece is given up
                count, top, length, error = first, 0, 0.0, np.inf
            substep = substeps[count]
            substep.segment, substep.begin, substep.length = k, start, length
            substep.error = error * length
            count += 1
    return len(pieces.rows), count


@kernel
def expand_curves(
    bodies: Records,
    pieces: Pieces,
    points: Records,
    memory: CurveMemory,
    substeps: Records,
    series: Array,
) -> None:
    """Integrate the rotation over substeps.

    Args:
        bodies: the links.
        pieces: the curve.
        points: (13,) of `gauss_points`.
        memory: scratch memory.
        substeps: (S,) of the pieces; turns and backs are filled in, errors added to.
        series: (S, TERMS, 4) the series, filled in.
    """
    values, rates, straight = memory.straight.values, memory.rates, memory.straight
    own = straight.expansion[0]
    for s in range(len(substeps)):
        substep, rounding = substeps[s], 0.0
        k, half = substep.segment, 0.5 * substep.length
        for n in range(POINTS):
            time = substep.begin + half * (1.0 + points[n].time)
            joints_at(pieces, k, time, values, rates)
            rounding += points[n].weight * rate_at_point(bodies, values, rates, n, straight)
        integrate(points, half, rounding, own, substep)
        for i in range(TERMS):
            for a in range(4):
                series[s, i, a] = own.terms[i, a]
