"""Rotations as unit quaternions (x, y, z, w): the algebra, and the ZYX angles of Eq. 2.

Every function works on arrays of any leading shape. Angles (alpha, beta, gamma) [rad] stand for
R = Rz(alpha) Ry(beta) Rx(gamma), which takes base coordinates to world coordinates.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])
IDENTITY.setflags(write=False)


def multiply(p: Array, q: Array) -> Array:
    """Composition p q: first q, then p, as for rotation matrices."""
    px, py, pz, pw = p[..., 0], p[..., 1], p[..., 2], p[..., 3]
    qx, qy, qz, qw = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    product = np.empty(np.broadcast_shapes(p.shape, q.shape))
    product[..., 0] = pw * qx + px * qw + py * qz - pz * qy
    product[..., 1] = pw * qy - px * qz + py * qw + pz * qx
    product[..., 2] = pw * qz + px * qy - py * qx + pz * qw
    product[..., 3] = pw * qw - px * qx - py * qy - pz * qz
    return product


def cross(a: Array, b: Array) -> Array:
    """Vector product along the last axis; `np.cross` takes far longer over small arrays."""
    product = np.empty(np.broadcast_shapes(a.shape, b.shape))
    product[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    product[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    product[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return product


def inverse(q: Array) -> Array:
    """The opposite rotation."""
    return np.concatenate([-q[..., :3], q[..., 3:]], axis=-1)


def exp(phi: Array) -> Array:
    """Rotation about phi/|phi| by |phi| [rad]."""
    phi = np.asarray(phi, dtype=np.float64)
    half = 0.5 * np.linalg.norm(phi, axis=-1, keepdims=True)
    return np.concatenate([0.5 * np.sinc(half / np.pi) * phi, np.cos(half)], axis=-1)


def log(q: Array) -> Array:
    """The rotation vector of length at most pi [rad] with exp(log(q)) = q or -q, the same pose."""
    q = np.where(q[..., 3:] < 0.0, -q, q)
    sine = np.linalg.norm(q[..., :3], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, q[..., 3:])
    tiny = sine < 1e-12
    return np.where(tiny, 2.0, angle / np.where(tiny, 1.0, sine)) * q[..., :3]


def matrix(q: Array) -> Array:
    """Rotation matrices (..., 3, 3)."""
    x, y, z, w = np.moveaxis(q, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def rotate(q: Array, vectors: Array) -> Array:
    """Vectors (..., 3) turned by rotations (..., 4)."""
    return np.asarray((matrix(q) @ vectors[..., None])[..., 0])


def angle_between(p: Array, q: Array) -> Array:
    """Angle [rad] of the rotation that leads from p to q, in [0, pi]."""
    return np.asarray(np.linalg.norm(log(multiply(inverse(p), q)), axis=-1))


def slerp(p: Array, q: Array, s: Array) -> Array:
    """The way from p to q at constant angular velocity, shorter way round, s in [0, 1]."""
    return multiply(p, exp(np.asarray(s)[..., None] * log(multiply(inverse(p), q))))


def from_angles(angles: Array) -> Array:
    """Quaternion of the ZYX angles (alpha, beta, gamma), Eq. 2."""
    a, b, c = np.moveaxis(np.asarray(angles, dtype=np.float64), -1, 0)
    zero = np.zeros_like(a)
    about_z = exp(np.stack([zero, zero, a], axis=-1))
    about_y = exp(np.stack([zero, b, zero], axis=-1))
    about_x = exp(np.stack([c, zero, zero], axis=-1))
    return multiply(about_z, multiply(about_y, about_x))


def to_angles(q: Array) -> Array:
    """ZYX angles (alpha, beta, gamma) [rad] of Eq. 2, beta in [-pi/2, pi/2].

    At beta = +-pi/2 the other two turn about one axis; gamma is then put to zero.
    """
    r = matrix(q)
    cos_beta = np.hypot(r[..., 0, 0], r[..., 1, 0])
    beta = np.arctan2(-r[..., 2, 0], cos_beta)
    regular = cos_beta > 1e-9
    alpha = np.where(
        regular,
        np.arctan2(r[..., 1, 0], r[..., 0, 0]),
        np.arctan2(-r[..., 0, 1], r[..., 1, 1]),
    )
    gamma = np.where(regular, np.arctan2(r[..., 2, 1], r[..., 2, 2]), 0.0)
    return np.stack([alpha, beta, gamma], axis=-1)


def angle_rate_matrix(angles: Array) -> Array:
    """E of Eq. 1, (3, 3): base angular velocity in the base frame = E (alpha', beta', gamma').

    Raises:
        InvalidInput: beta within 1e-6 rad of +-90 degrees, where E has no inverse.
    """
    _, beta, gamma = angles
    if abs(np.cos(beta)) < 1e-6:
        raise InvalidInput(
            "attitude (beta)", float(beta), "beta away from +-pi/2: Eq. 1 is singular there"
        )
    sb, cb, sg, cg = np.sin(beta), np.cos(beta), np.sin(gamma), np.cos(gamma)
    return np.array([[-sb, 0.0, 1.0], [cb * sg, cg, 0.0], [cb * cg, -sg, 0.0]])
