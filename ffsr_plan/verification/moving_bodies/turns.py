"""Rotations as matrices: of rotation vectors, of quaternions, and the angles between them."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array


def turns_by(vectors: Array) -> Array:
    """Rotations by Rodrigues' formula.

    Args:
        vectors: (N, 3) rotation vectors [rad].

    Returns:
        (N, 3, 3); the columns are the rotated unit vectors.
    """
    angles = np.linalg.norm(vectors, axis=1)
    axes = vectors / np.where(angles > 0.0, angles, 1.0)[:, None]
    skew = _skew(axes)
    sine, rest = np.sin(angles), 2.0 * np.sin(0.5 * angles) ** 2
    turned: Array = np.eye(3) + sine[:, None, None] * skew + rest[:, None, None] * (skew @ skew)
    return turned


def turns_of(quaternions: Array) -> Array:
    """Rotations of quaternions, which are made unit.

    Args:
        quaternions: (N, 4) xyzw.

    Returns:
        (N, 3, 3); the columns are the rotated unit vectors.
    """
    x, y, z, w = (quaternions / np.linalg.norm(quaternions, axis=1)[:, None]).T
    rows = [
        [w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    return np.ascontiguousarray(np.moveaxis(np.array(rows), 2, 0))


def angles_between(one: Array, other: Array) -> Array:
    """Angles between rotations.

    Args:
        one: (..., 3, 3).
        other: (..., 3, 3).

    Returns:
        (...) angles from 0 to pi [rad].
    """
    sine = np.linalg.norm(one - other, axis=(-2, -1)) / np.sqrt(8.0)  # of half the angle
    return np.asarray(2.0 * np.arcsin(np.minimum(sine, 1.0)))


def _skew(v: Array) -> Array:
    """(N, 3, 3) matrices whose products with vectors are cross products with v (N, 3)."""
    result = np.zeros((len(v), 3, 3))
    for row, column, axis, sign in ((0, 1, 2, -1), (0, 2, 1, 1), (1, 2, 0, -1)):
        result[:, row, column] = sign * v[:, axis]
        result[:, column, row] = -sign * v[:, axis]
    return result
