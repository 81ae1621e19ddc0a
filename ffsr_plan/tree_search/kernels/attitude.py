"""Compiled attitudes: quaternions (x, y, z, w), each of an array (4,)."""

from __future__ import annotations

import math

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel

_SMALL = 1e-9  # [rad] below which sin(x) / x is one


@kernel
def turn_by(quat: Array, x: float, y: float, z: float) -> None:
    """Turn an attitude by a rotation vector (x, y, z) in its own axes [rad]; keeps its norm."""
    half = 0.5 * math.sqrt(x * x + y * y + z * z)
    share = 0.5 if half < _SMALL else 0.5 * math.sin(half) / half
    a, b, c, d = share * x, share * y, share * z, math.cos(half)
    p, q, r, s = quat[0], quat[1], quat[2], quat[3]
    p, q, r, s = (
        s * a + p * d + q * c - r * b,
        s * b - p * c + q * d + r * a,
        s * c + p * b - q * a + r * d,
        s * d - p * a - q * b - r * c,
    )
    size = 1.0 / math.sqrt(p * p + q * q + r * r + s * s)
    quat[0], quat[1], quat[2], quat[3] = p * size, q * size, r * size, s * size


@kernel
def angle_of(first: Array, second: Array) -> float:
    """Angle between two attitudes [rad], precise to about 1e-8."""
    dot = 0.0
    for a in range(4):
        dot += first[a] * second[a]
    return 2.0 * math.acos(min(1.0, abs(dot)))


@kernel
def turned_back(first: Array, second: Array, third: Array, result: Array) -> None:
    """`result` = first second^-1 third: where `third` lies if `second` is moved to `first`.

    Args:
        first: (4,).
        second: (4,).
        third: (4,).
        result: (4,) filled in; none of the others.
    """
    x, y, z, w = -second[0], -second[1], -second[2], second[3]
    p, q, r, s = (
        w * third[0] + x * third[3] + y * third[2] - z * third[1],
        w * third[1] - x * third[2] + y * third[3] + z * third[0],
        w * third[2] + x * third[1] - y * third[0] + z * third[3],
        w * third[3] - x * third[0] - y * third[1] - z * third[2],
    )
    x, y, z, w = first[0], first[1], first[2], first[3]
    result[0] = w * p + x * s + y * r - z * q
    result[1] = w * q - x * r + y * s + z * p
    result[2] = w * r + x * q - y * p + z * s
    result[3] = w * s - x * p - y * q - z * r


@kernel
def matrix_of(quat: Array, result: Array) -> None:
    """Rotation matrix of an attitude, row by row into the first nine of `result`."""
    x, y, z, w = quat[0], quat[1], quat[2], quat[3]
    result[0], result[1] = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w)
    result[2], result[3] = 2.0 * (x * z + y * w), 2.0 * (x * y + z * w)
    result[4], result[5] = 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)
    result[6], result[7] = 2.0 * (x * z - y * w), 2.0 * (y * z + x * w)
    result[8] = 1.0 - 2.0 * (x * x + y * y)
