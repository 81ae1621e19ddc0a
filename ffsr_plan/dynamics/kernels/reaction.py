"""Compiled integration of the base's rotation along straight joint segments.

A segment is cut into substeps over which a polynomial of degree 12 through 13 Gauss points
approximates the angular velocity within the tolerance, which is proven (`rate_bound`). With
that polynomial the rotation is a power series, whose remainder has a bound too. docs/proof.md,
section 9, has the mathematics.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.dynamics.kernels.bodies import (
    LinkStates,
    base_rate,
    link_states,
    move_links,
    rate_rounding,
    weigh_links,
)
from ffsr_plan.dynamics.kernels.rate_bound import (
    Excursions,
    excursions,
    excursions_of_links,
    rate_bound,
)
from ffsr_plan.dynamics.kernels.rotation_series import (
    POINTS,
    TERMS,
    end_to_end,
    inverse,
    multiply,
    normalise,
    rotation_series,
)
from ffsr_plan.robots.kinematics import Bodies

MOST_SUBSTEPS = 4096
"""Substeps of one segment at most."""
INTERPOLATION = 7.2
"""1 plus the Lebesgue constant of 13 Gauss points, which is 6.10."""
_LARGEST_TWIST, _NEXT_TWIST = 2.0, 0.5  # imaginary joint rotations [rad] to try for the bound
_LEAST_RHO = 2.5  # below, the bound is not small
_ABSOLUTE = 2.0  # integral of the absolute value of a Lagrange polynomial, relative to its weight
_ROUNDING = 32.0 * np.finfo(np.float64).eps  # [rad] of the quaternions of one substep


class Points(NamedTuple):
    """Where omega is evaluated over a substep, local times from -1 to 1.

    Attributes:
        times: (13,) the Gauss points.
        weights: (13,) their weights.
        monomials: (13, 13) from values at the points to the coefficients of powers.
    """

    times: Array
    weights: Array
    monomials: Array


def gauss_points() -> Points:
    """The points and their interpolation."""
    times, weights = legendre.leggauss(POINTS)
    powers = np.zeros((POINTS, POINTS))  # of the Legendre polynomials
    for k in range(POINTS):
        powers[: k + 1, k] = legendre.leg2poly(np.eye(POINTS)[k])[: k + 1]
    values = legendre.legvander(times, POINTS - 1) * weights[:, None]
    return Points(times, weights, powers @ (values * (np.arange(POINTS) + 0.5)).T)


class Substeps(NamedTuple):
    """S substeps of segments, in the order of the segments and of time.

    Attributes:
        segments: (S,) the segment.
        begins: (S,) time at its start, in [0, 1].
        lengths: (S,) in units of the segment's time; 0 in place of a segment that needs too many.
        errors: (S,) bound on the angle that the polynomial misses [rad].
    """

    segments: IntArray
    begins: Array
    lengths: Array
    errors: Array


@kernel
def _approximation_error(
    bodies: Bodies,
    rates: Array,
    half: float,
    tolerance: float,
    least: float,
    states: LinkStates,
    moved: Excursions,
) -> float:
    """Bound on the largest difference of omega from its polynomial over a substep [rad].

    Args:
        bodies: the links.
        rates: (nd,) joint rates.
        half: half the length of the substep.
        tolerance: a bound below it is good enough.
        least: least eigenvalue of the inertia in the middle, from below [kg m^2].
        states: the links in the middle.
        moved: scratch memory.
    """
    largest = 0.0  # joint rotation from the base to any link, and sliding, over the substep's half
    for j in range(1, len(bodies.parents)):
        p = bodies.parents[j]
        moved.turn[j] = moved.turn[p] + abs(rates[j - 1]) * half
        largest = max(largest, moved.turn[j])
    if largest == 0.0:
        return 0.0
    error, twist = np.inf, _LARGEST_TWIST
    while True:
        imaginary = twist / largest  # of the ellipse with foci -1 and 1 whose axes sum to rho
        rho = imaginary + math.sqrt(imaginary * imaginary + 1.0)
        if rho < _LEAST_RHO:
            return error
        real = half * 0.5 * (rho + 1.0 / rho)
        excursions_of_links(bodies, rates, real, half * imaginary, states, moved)
        size = rate_bound(bodies, least, states, moved)
        found = 2.0 * INTERPOLATION * size * rho ** (1 - POINTS) / (rho - 1.0)
        if found <= tolerance or found > error:
            return min(found, error)
        error, twist = found, twist * _NEXT_TWIST


@kernel
def cut(bodies: Bodies, begin: Array, steps: Array, tolerance: float) -> Substeps:
    """Halve segments until the polynomials are close enough to omega.

    Args:
        bodies: the links.
        begin: (m, nd) joint values at the start of each segment [rad or m].
        steps: (m, nd) their change over it.
        tolerance: for the error over a whole segment [rad].
    """
    states, moved = link_states(len(bodies.parents)), excursions(len(bodies.parents))
    values, rate, count = np.empty(begin.shape[1]), np.empty(3), 0
    size = 2 * len(begin) + 64
    segments, table = np.empty(size, np.int64), np.empty((size, 3))
    left = np.empty((64, 2))
    for k in range(len(begin)):
        first, top = count, 1
        left[0] = 0.0, 1.0
        while top > 0:
            top -= 1
            start, length = left[top, 0], left[top, 1]
            for j in range(len(values)):
                values[j] = begin[k, j] + (start + 0.5 * length) * steps[k, j]
            move_links(bodies, values, steps[k], states)
            weigh_links(bodies, states)
            least = base_rate(states, rate)
            error = _approximation_error(
                bodies, steps[k], 0.5 * length, tolerance, least, states, moved
            )
            if not error <= tolerance and length > 2.0**-50 and count - first < MOST_SUBSTEPS:
                left[top] = start + 0.5 * length, 0.5 * length
                left[top + 1] = start, 0.5 * length
                top += 2
                continue
            if not error <= tolerance:  # the segment is given up
                count, top, length, error = first, 0, 0.0, np.inf
            if count == size:
                segments = np.concatenate((segments, np.empty(size, np.int64)))
                table = np.concatenate((table, np.empty((size, 3))))
                size *= 2
            segments[count] = k
            table[count] = start, length, error * length
            count += 1
    return Substeps(
        segments[:count], table[:count, 0].copy(), table[:count, 1].copy(), table[:count, 2].copy()
    )


class Rotations(NamedTuple):
    """The base's rotation over S substeps.

    Attributes:
        turns: (S, 4) rotation over the whole substep, in the base frame at its start (xyzw).
        backs: (S, 4) rotation from the middle back to the start (xyzw).
        series: (S, TERMS, 4) power series of the rotation from the middle to local times from -1 to
            1; (0, TERMS, 4) if it is not kept.
        errors: (S,) bound on the error of the rotation over the substep [rad].
    """

    turns: Array
    backs: Array
    series: Array
    errors: Array


@kernel
def expand(
    bodies: Bodies, begin: Array, steps: Array, substeps: Substeps, points: Points, keep: bool
) -> Rotations:
    """Integrate the rotation over substeps.

    Args:
        bodies: the links.
        begin: (m, nd) joint values at the start of each segment [rad or m].
        steps: (m, nd) their change over it.
        substeps: of the segments.
        points: from `gauss_points`.
        keep: whether to keep the series.
    """
    states, values = link_states(len(bodies.parents)), np.empty(begin.shape[1])
    count, rates = len(substeps.segments), np.empty((POINTS, 3))
    turns, backs, errors = np.empty((count, 4)), np.empty((count, 4)), substeps.errors.copy()
    series = np.empty((count if keep else 0, TERMS, 4))
    terms, sizes, powers = np.empty((TERMS, 4)), np.empty(TERMS), np.empty((POINTS, 3))
    for s in range(count):
        k, half, rounding = substeps.segments[s], 0.5 * substeps.lengths[s], 0.0
        for n in range(POINTS):
            time = substeps.begins[s] + half * (1.0 + points.times[n])
            for j in range(len(values)):
                values[j] = begin[k, j] + time * steps[k, j]
            move_links(bodies, values, steps[k], states)
            weigh_links(bodies, states)
            least = base_rate(states, rates[n])
            rounding += points.weights[n] * rate_rounding(bodies, states, rates[n], least)
        for i in range(POINTS):
            for a in range(3):
                powers[i, a] = 0.0
                for n in range(POINTS):
                    powers[i, a] += 0.5 * half * points.monomials[i, n] * rates[n, a]
        remainder = rotation_series(powers, terms, sizes)
        errors[s] += _ABSOLUTE * half * rounding + 4.0 * remainder + _ROUNDING
        end_to_end(terms, turns[s], backs[s])
        if keep:
            series[s] = terms
    return Rotations(turns, backs, series, errors)


@kernel
def chained(segments: IntArray, rotations: Rotations, count: int) -> tuple[Array, Array, Array]:
    """Rotations over whole segments.

    Args:
        segments: (S,) of the substeps.
        rotations: over the substeps.
        count: m, number of segments.

    Returns:
        (m, 4) rotation over each segment; (S, 4) rotation from its start to the middle of each
        substep (both xyzw); and (m,) bound on the error of any rotation within it [rad].
    """
    whole, middles = np.zeros((count, 4)), np.empty((len(segments), 4))
    errors, place = np.zeros(count), np.empty(4)
    whole[:, 3] = 1.0
    for s in range(len(segments)):
        k = segments[s]
        place[:] = rotations.backs[s]
        inverse(place)
        multiply(middles[s], whole[k], place)
        multiply(place, whole[k], rotations.turns[s])
        normalise(place)
        whole[k] = place
        errors[k] += rotations.errors[s]
    return whole, middles, errors
