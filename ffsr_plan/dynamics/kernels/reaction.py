"""Compiled integration of the base's rotation along straight joint segments.

A segment is cut into substeps over which a polynomial of degree 12 through 13 Gauss points
approximates the angular velocity within the tolerance, which is proven (`rate_bound`). With
that polynomial the rotation is a power series, whose remainder has a bound too. docs/proof.md,
section 9, has the mathematics.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import legendre

from ffsr_plan.core.arrays import Array, Records, records
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.bodies import (
    LINK_STATE,
    ROBOT_STATE,
    base_at_rest,
    base_rate,
    move_links,
    rate_rounding,
    weigh_links,
)
from ffsr_plan.dynamics.kernels.quaternions import inverse, multiply, normalise
from ffsr_plan.dynamics.kernels.rate_bound import (
    EXCURSION,
    excursions_of_links,
    rate_bound,
)
from ffsr_plan.dynamics.kernels.rotation_series import (
    POINTS,
    TERMS,
    end_to_end,
    rotation_series,
)

MOST_SUBSTEPS = 4096
"""Substeps of one segment at most."""
INTERPOLATION = 7.2
"""1 plus the Lebesgue constant of 13 Gauss points, which is 6.10."""
LARGEST_TWIST, NEXT_TWIST = 2.0, 0.5  # imaginary joint rotations [rad] to try for the bound
LEAST_RHO = 2.5  # below, the bound is not small
_ABSOLUTE = 2.0  # integral of the absolute value of a Lagrange polynomial, relative to its weight
_ROUNDING = 32.0 * np.finfo(np.float64).eps  # [rad] of the quaternions of one substep


POINT = np.dtype([("time", np.float64), ("weight", np.float64), ("monomials", np.float64, POINTS)])
"""Where omega is evaluated over a substep, local times from -1 to 1.

    time        the Gauss point
    weight      its weight
    monomials   (13,) from values at the points to the coefficient of the power of its number
"""

EXPANSION = np.dtype(
    [
        ("rates", np.float64, (POINTS, 3)),
        ("powers", np.float64, (POINTS, 3)),
        ("terms", np.float64, (TERMS, 4)),
        ("sizes", np.float64, TERMS),
        ("quat", np.float64, 4),
    ]
)
"""Memory for one substep: omega at the points, as a power series, and the rotation's series."""


class Memory(NamedTuple):
    """Scratch memory for a robot with n links.

    Attributes:
        values: (nd,) joint values.
        links: (n,) records of `LINK_STATE`.
        robot: (1,) of `ROBOT_STATE`.
        moved: (n,) of `EXCURSION`.
        left: (64, 2) starts and lengths of substeps.
        expansion: (1,) of `EXPANSION`.
    """

    values: Array
    links: Records
    robot: Records
    moved: Records
    left: Array
    expansion: Records


def memory_for(count: int) -> Memory:
    """Memory for `count` links."""
    return Memory(
        np.empty(count - 1),
        base_at_rest(records(LINK_STATE, count)),
        records(ROBOT_STATE, 1),
        records(EXCURSION, count),
        np.empty((64, 2)),
        records(EXPANSION, 1),
    )


def gauss_points() -> Records:
    """(13,) the points and their interpolation, records of `POINT`."""
    points = records(POINT, POINTS)
    points["time"], points["weight"] = legendre.leggauss(POINTS)
    powers = np.zeros((POINTS, POINTS))  # of the Legendre polynomials
    for k in range(POINTS):
        powers[: k + 1, k] = legendre.leg2poly(np.eye(POINTS)[k])[: k + 1]
    values = legendre.legvander(points["time"], POINTS - 1) * points["weight"][:, None]
    points["monomials"] = powers @ (values * (np.arange(POINTS) + 0.5)).T
    return points


@kernel
def _approximation_error(
    bodies: Records,
    rates: Array,
    half: float,
    tolerance: float,
    least: float,
    links: Records,
    moved: Records,
) -> float:
    """Bound on the largest difference of omega from its polynomial over a substep [rad].

    Args:
        bodies: the links.
        rates: (nd,) joint rates.
        half: half the length of the substep.
        tolerance: a bound below it is good enough.
        least: least eigenvalue of the inertia in the middle, from below [kg m^2].
        links: in the middle.
        moved: scratch memory.
    """
    largest = 0.0  # joint rotation from the base to any link, and sliding, over the substep's half
    moved[0].turn = 0.0
    for j in range(1, len(bodies)):
        turn = moved[bodies[j].parent].turn + abs(rates[j - 1]) * half
        moved[j].turn = turn
        largest = max(largest, turn)
    if largest == 0.0:
        return 0.0
    error, twist = np.inf, LARGEST_TWIST
    while True:
        imaginary = twist / largest  # of the ellipse with foci -1 and 1 whose axes sum to rho
        rho = imaginary + math.sqrt(imaginary * imaginary + 1.0)
        if rho < LEAST_RHO:
            return error
        real = half * 0.5 * (rho + 1.0 / rho)
        excursions_of_links(bodies, rates, real, half * imaginary, links, moved)
        size = rate_bound(bodies, least, links, moved)
        found = 2.0 * INTERPOLATION * size * rho ** (1 - POINTS) / (rho - 1.0)
        if found <= tolerance or found > error:
            return min(found, error)
        error, twist = found, twist * NEXT_TWIST


@kernel
def cut(
    bodies: Records,
    begin: Array,
    steps: Array,
    tolerance: float,
    memory: Memory,
    segment: int,
    count: int,
    substeps: Records,
) -> tuple[int, int]:
    """Halve segments until the polynomials are close enough to omega.

    Args:
        bodies: the links.
        begin: (m, nd) joint values at the start of each segment [rad or m].
        steps: (m, nd) their change over it.
        tolerance: for the error over a whole segment [rad].
        memory: scratch memory.
        segment: the first to cut.
        count: number of substeps of those before it.
        substeps: filled in from there: segment, begin, length and error.

    Returns:
        The first segment that is not cut because there is no room left, or m; and the number of
        substeps of those before it.
    """
    values, links, robot, left = memory.values, memory.links, memory.robot, memory.left
    for k in range(segment, len(begin)):
        first, top = count, 1
        left[0, 0], left[0, 1] = 0.0, 1.0
        while top > 0:
            if count == len(substeps):
                return k, first
            top -= 1
            start, length = left[top, 0], left[top, 1]
            for j in range(len(values)):
                values[j] = begin[k, j] + (start + 0.5 * length) * steps[k, j]
            move_links(bodies, values, steps[k], links)
            weigh_links(bodies, links, robot)
            least = base_rate(robot)
            error = _approximation_error(
                bodies, steps[k], 0.5 * length, tolerance, least, links, memory.moved
            )
            if not error <= tolerance and length > 2.0**-50 and count - first < MOST_SUBSTEPS:
                left[top, 0], left[top, 1] = start + 0.5 * length, 0.5 * length
                left[top + 1, 0], left[top + 1, 1] = start, 0.5 * length
                top += 2
                continue
            if not error <= tolerance:  # the segment is given up
                count, top, length, error = first, 0, 0.0, np.inf
            substep = substeps[count]
            substep.segment, substep.begin, substep.length = k, start, length
            substep.error = error * length
            count += 1
    return len(begin), count


@kernel
def rate_at_point(bodies: Records, values: Array, rates: Array, n: int, memory: Memory) -> float:
    """Angular velocity of the base at the nth point of a substep, and its rounding error [rad].

    Args:
        bodies: the links.
        values: (nd,) joint values there [rad or m].
        rates: (nd,) their rates.
        n: the point.
        memory: the nth rate of its expansion is filled in.
    """
    links, robot, own = memory.links, memory.robot, memory.expansion[0]
    move_links(bodies, values, rates, links)
    weigh_links(bodies, links, robot)
    least = base_rate(robot)
    for a in range(3):
        own.rates[n, a] = robot[0].rate[a]
    return rate_rounding(bodies, links, robot, least)


@kernel
def integrate(
    points: Records,
    half: float,
    rounding: float,
    own: Any,  # noqa: ANN401 - one record of EXPANSION
    substep: Any,  # noqa: ANN401 - one record of SUBSTEP
) -> None:
    """The rotation over a substep from the angular velocities at its points.

    Args:
        points: (13,) of `gauss_points`.
        half: half the length of the substep.
        rounding: integral of the rates' rounding errors over local time.
        own: with the rates; the series is filled in.
        substep: turn and back are filled in, the error is added to.
    """
    for i in range(POINTS):
        for a in range(3):
            power = 0.0
            for n in range(POINTS):
                power += 0.5 * half * points[i].monomials[n] * own.rates[n, a]
            own.powers[i, a] = power
    remainder = rotation_series(own.powers, own.terms, own.sizes)
    substep.error += _ABSOLUTE * half * rounding + 4.0 * remainder + _ROUNDING
    end_to_end(own.terms, substep.turn, substep.back, own.quat)


@kernel
def expand(
    bodies: Records,
    begin: Array,
    steps: Array,
    points: Records,
    memory: Memory,
    substeps: Records,
    series: Array,
) -> None:
    """Integrate the rotation over substeps.

    Args:
        bodies: the links.
        begin: (m, nd) joint values at the start of each segment [rad or m].
        steps: (m, nd) their change over it.
        points: (13,) of `gauss_points`.
        memory: scratch memory.
        substeps: (S,) of the segments; turns and backs are filled in, errors added to.
        series: (S, TERMS, 4) the series, filled in; (0, TERMS, 4) to drop it.
    """
    values, own = memory.values, memory.expansion[0]
    for s in range(len(substeps)):
        substep, rounding = substeps[s], 0.0
        k, half = substep.segment, 0.5 * substep.length
        for n in range(POINTS):
            time = substep.begin + half * (1.0 + points[n].time)
            for j in range(len(values)):
                values[j] = begin[k, j] + time * steps[k, j]
            rounding += points[n].weight * rate_at_point(bodies, values, steps[k], n, memory)
        integrate(points, half, rounding, own, substep)
        if len(series) > 0:
            for i in range(TERMS):
                for a in range(4):
                    series[s, i, a] = own.terms[i, a]


@kernel
def chain(substeps: Records, memory: Memory, whole: Array, errors: Array) -> None:
    """Rotations over whole segments.

    Args:
        substeps: (S,) of the segments; the middles are filled in.
        memory: scratch memory.
        whole: (m, 4) rotation over each segment (xyzw), filled in; at first the identity.
        errors: (m,) bound on the error of any rotation within each [rad], filled in; at first zero.
    """
    place = memory.expansion[0].quat
    for s in range(len(substeps)):
        substep, turn = substeps[s], whole[substeps[s].segment]
        for a in range(4):
            place[a] = substep.back[a]
        inverse(place)
        multiply(substep.middle, turn, place)
        multiply(place, turn, substep.turn)
        normalise(place)
        for a in range(4):
            turn[a] = place[a]
        errors[substep.segment] += substep.error
