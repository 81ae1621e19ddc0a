"""Compiled rotations as power series of quaternions, and products of quaternions (xyzw)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray, Records
from ffsr_plan.core.kernels.compilation import kernel

POINTS = 13
"""Values of omega over a substep; odd, so that one is in the middle."""
TERMS = 2 * POINTS + 4
"""Terms of the power series of a rotation."""


@kernel
def _add_product(result: Array, p: Array, x: float, y: float, z: float) -> None:
    """Add the quaternion product p (x, y, z, 0), (4,), to `result`."""
    result[0] += p[3] * x + p[1] * z - p[2] * y
    result[1] += p[3] * y - p[0] * z + p[2] * x
    result[2] += p[3] * z + p[0] * y - p[1] * x
    result[3] -= p[0] * x + p[1] * y + p[2] * z


@kernel
def rotation_series(powers: Array, terms: Array, sizes: Array) -> float:
    """The rotation Y(u) with Y' = Y omega / 2 and Y(0) = 1 as a power series of quaternions.

    Args:
        powers: (13, 3) half of omega as a power series of u.
        terms: (TERMS, 4) the coefficients (xyzw), filled in.
        sizes: (TERMS,) scratch memory.

    Returns:
        Bound on the terms left out, at any u from -1 to 1.
    """
    for a in range(4):
        terms[0, a] = 0.0
    terms[0, 3], sizes[0] = 1.0, 1.0
    exponent, total = 0.0, 1.0
    for j in range(POINTS):
        x, y, z = powers[j, 0], powers[j, 1], powers[j, 2]
        exponent += math.sqrt(x * x + y * y + z * z) / (j + 1)
    for k in range(TERMS - 1):
        term, sizes[k + 1] = terms[k + 1], 0.0
        for a in range(4):
            term[a] = 0.0
        for j in range(min(k + 1, POINTS)):
            x, y, z = powers[j, 0], powers[j, 1], powers[j, 2]
            _add_product(term, terms[k - j], x, y, z)
            sizes[k + 1] += sizes[k - j] * math.sqrt(x * x + y * y + z * z)
        for a in range(4):
            term[a] /= k + 1
        sizes[k + 1] /= k + 1
        total += sizes[k + 1]
    return max(math.exp(exponent) - total, 0.0)


@kernel
def end_to_end(terms: Array, turn: Array, back: Array, ahead: Array) -> None:
    """Rotations (4,) over a substep and from its middle to its start, from the series.

    `ahead` is scratch memory (4,).
    """
    for a in range(4):
        ahead[a], back[a] = 0.0, 0.0
    for k in range(TERMS - 1, -1, -1):
        for a in range(4):
            ahead[a] += terms[k, a]
            back[a] += terms[k, a] if k % 2 == 0 else -terms[k, a]
    normalise(ahead)
    normalise(back)
    inverse(back)
    multiply(turn, back, ahead)
    inverse(back)


@kernel
def inverse(q: Array) -> None:
    """Invert a rotation (4,)."""
    q[0], q[1], q[2] = -q[0], -q[1], -q[2]


@kernel
def normalise(q: Array) -> None:
    """Divide a quaternion (4,) by its norm."""
    norm = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    for a in range(4):
        q[a] /= norm


@kernel
def multiply(result: Array, p: Array, q: Array) -> None:
    """The quaternion product p q, all (4,); `result` is neither of them."""
    for a in range(4):
        result[a] = q[3] * p[a]
    _add_product(result, p, q[0], q[1], q[2])


SUBSTEP = np.dtype(
    [
        ("segment", np.int64),
        ("begin", np.float64),
        ("length", np.float64),
        ("error", np.float64),
        ("turn", np.float64, 4),
        ("back", np.float64, 4),
        ("middle", np.float64, 4),
    ]
)
"""A part of a segment over which one polynomial is close to omega.

    segment     the segment
    begin       time at its start, in [0, 1]
    length      in units of the segment's time; 0 in place of a segment that needs too many
    error       bound on the error of the rotation over it [rad]
    turn        (4,) rotation over the whole substep, in the base frame at its start (xyzw)
    back        (4,) rotation from its middle back to its start (xyzw)
    middle      (4,) rotation from the start of the segment to its middle (xyzw)
"""


class Partial(NamedTuple):
    """What rotations within m segments of S substeps are computed from.

    Attributes:
        first: (m + 1,) first substep of each segment.
        substeps: (S,) records of `SUBSTEP`, in the order of the segments and of time.
        series: (S, TERMS, 4) power series of the rotation from the middle of each substep to local
            times from -1 to 1; (0, TERMS, 4) if it is not kept.
    """

    first: IntArray
    substeps: Records
    series: Array


@kernel
def rotation_at(partial: Partial, segment: int, time: float, local: Array, result: Array) -> None:
    """Rotation from the start of a segment.

    Args:
        partial: of all segments.
        segment: which one.
        time: on it, in [0, 1].
        local: (4,) scratch memory.
        result: (4,) the rotation (xyzw), filled in.
    """
    low, high = partial.first[segment], partial.first[segment + 1] - 1
    substeps, series = partial.substeps, partial.series
    while low < high:
        middle = (low + high + 1) // 2
        if substeps[middle].begin <= time:
            low = middle
        else:
            high = middle - 1
    u = 2.0 * (time - substeps[low].begin) / substeps[low].length - 1.0
    for a in range(4):
        local[a] = 0.0
    for k in range(TERMS - 1, -1, -1):
        for a in range(4):
            local[a] = local[a] * u + series[low, k, a]
    multiply(result, substeps[low].middle, local)
    normalise(result)


@kernel
def rotations_at(
    partial: Partial, segments: IntArray, times: Array, local: Array, result: Array
) -> None:
    """Rotations from the start of segments.

    Args:
        partial: of all segments.
        segments: (N,) which segments.
        times: (N,) times on them, in [0, 1].
        local: (4,) scratch memory.
        result: (N, 4) rotations (xyzw), filled in.
    """
    for n in range(len(segments)):
        rotation_at(partial, segments[n], times[n], local, result[n])
