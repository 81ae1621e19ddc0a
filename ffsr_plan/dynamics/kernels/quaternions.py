"""Compiled rotations: unit quaternions (x, y, z, w), each of an array (4,)."""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel

_SMALL = 1e-9  # [rad] below which sin(x) / x is one


@kernel
def add_product(result: Array, p: Array, x: float, y: float, z: float) -> None:
    """Add the quaternion product p (x, y, z, 0), (4,), to `result`."""
    result[0] += p[3] * x + p[1] * z - p[2] * y
    result[1] += p[3] * y - p[0] * z + p[2] * x
    result[2] += p[3] * z + p[0] * y - p[1] * x
    result[3] -= p[0] * x + p[1] * y + p[2] * z


@kernel
def multiply(result: Array, p: Array, q: Array) -> None:
    """The quaternion product p q, all (4,); `result` is neither of them."""
    for a in range(4):
        result[a] = q[3] * p[a]
    add_product(result, p, q[0], q[1], q[2])


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
def turn_by(quat: Array, x: float, y: float, z: float, memory: Array) -> None:
    """Turn an attitude (4,) by a rotation vector (x, y, z) in its own axes [rad].

    `memory` is scratch memory (4,).
    """
    half = 0.5 * math.sqrt(x * x + y * y + z * z)
    share = 0.5 if half < _SMALL else 0.5 * math.sin(half) / half
    scale = math.cos(half)
    for a in range(4):
        memory[a] = quat[a]
        quat[a] *= scale
    add_product(quat, memory, share * x, share * y, share * z)
    normalise(quat)


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
    back = second.copy()
    inverse(back)
    step = np.empty(4)
    multiply(step, back, third)
    multiply(result, first, step)


@kernel
def fill_matrix(quat: Array, rotation: Array) -> None:
    """The rotation matrix (3, 3) of a unit quaternion (4,)."""
    x, y, z, w = quat[0], quat[1], quat[2], quat[3]
    a, b, c = rotation[0], rotation[1], rotation[2]
    a[0], a[1], a[2] = 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)
    b[0], b[1], b[2] = 2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)
    c[0], c[1], c[2] = 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)


@kernel
def fill_rotation_vector(first: Array, second: Array, vector: Array) -> None:
    """The rotation (3,) that takes attitude `first` (4,) to `second`, world axes [rad]."""
    back, turn = first.copy(), np.empty(4)
    inverse(back)
    multiply(turn, second, back)
    sine = math.sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2])
    cosine = abs(turn[3])
    scale = 2.0 if sine < _SMALL else 2.0 * math.atan2(sine, cosine) / sine
    if turn[3] < 0.0:
        scale = -scale
    for a in range(3):
        vector[a] = scale * turn[a]
