"""Rotations as unit quaternions (x, y, z, w), and the ZYX angles of Eq. 2.

All functions work on arrays of any leading shape. `scipy.spatial.transform.Rotation` is not used:
in scipy 1.13, the oldest supported version, it takes one leading dimension at most, and a product
of small arrays takes several times longer, because each is wrapped in an object. The angles
(alpha, beta, gamma) [rad] denote

    R = Rz(alpha) Ry(beta) Rx(gamma),

the matrix that maps base coordinates to world coordinates.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])
IDENTITY.setflags(write=False)
_HALF_TURN_BAND = 1e-10  # of the cosine of half the angle
_LEAST_COMPONENT = 1e-6  # share of a rotation vector; smaller components are zero but for rounding


def multiply(p: Array, q: Array) -> Array:
    """Quaternion product p q, the rotation by q followed by p.

    Args:
        p: (..., 4) unit quaternions.
        q: (..., 4) unit quaternions.

    Returns:
        (..., 4) unit quaternions.
    """
    px, py, pz, pw = p[..., 0], p[..., 1], p[..., 2], p[..., 3]
    qx, qy, qz, qw = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    product = np.empty(np.broadcast_shapes(p.shape, q.shape))
    product[..., 0] = pw * qx + px * qw + py * qz - pz * qy
    product[..., 1] = pw * qy - px * qz + py * qw + pz * qx
    product[..., 2] = pw * qz + px * qy - py * qx + pz * qw
    product[..., 3] = pw * qw - px * qx - py * qy - pz * qz
    return product


def cross(a: Array, b: Array) -> Array:
    """Cross product along the last axis, much faster than `np.cross` for small arrays.

    Args:
        a: (..., 3).
        b: (..., 3).

    Returns:
        (..., 3) a x b.
    """
    product = np.empty(np.broadcast_shapes(a.shape, b.shape))
    product[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    product[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    product[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return product


def inverse(q: Array) -> Array:
    """Inverse rotations (..., 4) of unit quaternions (..., 4)."""
    return np.concatenate([-q[..., :3], q[..., 3:]], axis=-1)


def exp(phi: Array) -> Array:
    """Exponential map: the rotation about phi/|phi| by |phi|.

    Args:
        phi: (..., 3) rotation vectors [rad].

    Returns:
        (..., 4) unit quaternions.
    """
    phi = np.asarray(phi, dtype=np.float64)
    half = 0.5 * np.linalg.norm(phi, axis=-1, keepdims=True)
    return np.concatenate([0.5 * np.sinc(half / np.pi) * phi, np.cos(half)], axis=-1)


def log(q: Array) -> Array:
    """Logarithm: the rotation vector with exp(log(q)) = q or -q, which are the same rotation.

    Args:
        q: (..., 4) unit quaternions.

    Returns:
        (..., 3) rotation vectors of length at most pi [rad].
    """
    q = np.where(q[..., 3:] < 0.0, -q, q)
    sine = np.linalg.norm(q[..., :3], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, q[..., 3:])
    tiny = sine < 1e-12
    return np.where(tiny, 2.0, angle / np.where(tiny, 1.0, sine)) * q[..., :3]


def matrix(q: Array) -> Array:
    """Rotation matrices (..., 3, 3) of unit quaternions (..., 4)."""
    x, y, z, w = np.moveaxis(q, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def rotate(q: Array, vectors: Array) -> Array:
    """Rotate vectors.

    Args:
        q: (..., 4) unit quaternions.
        vectors: (..., 3).

    Returns:
        (..., 3) R(q) v.
    """
    return (matrix(q) @ vectors[..., None])[..., 0]


def angle_between(p: Array, q: Array) -> Array:
    """Angle of the rotation from p to q.

    Args:
        p: (..., 4) unit quaternions.
        q: (..., 4) unit quaternions.

    Returns:
        (...) angles in [0, pi] [rad].
    """
    return np.linalg.norm(log(multiply(inverse(p), q)), axis=-1)


def rotation_vector(p: Array, q: Array) -> Array:
    """Rotation vector from p to q, through the smaller angle.

    The two senses of a half turn lead to the same attitude. Within 2e-10 rad of one, where rounding
    would decide between them, that sense is taken in which the rotation is positive about the first
    of the axes x, y, z of p that it does not leave out.

    Args:
        p: (..., 4) unit quaternions.
        q: (..., 4) unit quaternions.

    Returns:
        (..., 3) rotation vectors, axes of p [rad]; of length at most pi + 2e-10.
    """
    between = multiply(inverse(p), q)
    vector = log(between)
    angle = np.linalg.norm(vector, axis=-1, keepdims=True)
    counts = np.abs(vector) > _LEAST_COMPONENT * angle
    first = np.argmax(counts, axis=-1)[..., None]
    negative = np.take_along_axis(vector, first, axis=-1) < 0.0
    flipped = (np.abs(between[..., 3:]) < _HALF_TURN_BAND) & negative
    return np.where(flipped, vector * (1.0 - 2.0 * np.pi / np.maximum(angle, 1.0)), vector)


def slerp(p: Array, q: Array, s: Array) -> Array:
    """Spherical interpolation: constant angular velocity along `rotation_vector`.

    Args:
        p: (..., 4) rotation at s = 0.
        q: (..., 4) rotation at s = 1.
        s: (...) parameter in [0, 1].

    Returns:
        (..., 4) unit quaternions.
    """
    return multiply(p, exp(np.asarray(s)[..., None] * rotation_vector(p, q)))


def level_direction(direction: Array) -> Array:
    """The horizontal unit vector perpendicular to a direction.

    Args:
        direction: (3,) unit vector d, world axes.

    Returns:
        (3,) z x d normalised, z being the world's vertical; the world's x if d is vertical.
    """
    level = np.array([-direction[1], direction[0], 0.0])
    length = float(np.linalg.norm(level))
    return level / length if length > 1e-9 else np.array([1.0, 0.0, 0.0])


def from_angles(angles: Array) -> Array:
    """Quaternions of ZYX angles, Eq. 2.

    Args:
        angles: (..., 3) alpha, beta, gamma [rad].

    Returns:
        (..., 4) unit quaternions.
    """
    a, b, c = np.moveaxis(np.asarray(angles, dtype=np.float64), -1, 0)
    zero = np.zeros_like(a)
    about_z = exp(np.stack([zero, zero, a], axis=-1))
    about_y = exp(np.stack([zero, b, zero], axis=-1))
    about_x = exp(np.stack([c, zero, zero], axis=-1))
    return multiply(about_z, multiply(about_y, about_x))


def to_angles(q: Array) -> Array:
    """ZYX angles of rotations, Eq. 2.

    At beta = +-pi/2 alpha and gamma are angles about the same axis; gamma is then zero.

    Args:
        q: (..., 4) unit quaternions.

    Returns:
        (..., 3) alpha, beta, gamma [rad], beta in [-pi/2, pi/2].
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
    """E of Eq. 1: base angular velocity in the base frame = E (alpha', beta', gamma').

    Args:
        angles: (3,) alpha, beta, gamma [rad].

    Returns:
        (3, 3) E.

    Raises:
        InvalidInput: cos(beta) below 1e-6, where E has no inverse.
    """
    _, beta, gamma = angles
    if abs(np.cos(beta)) < 1e-6:
        raise InvalidInput(
            "attitude (beta)", float(beta), "beta away from +-pi/2: Eq. 1 is singular there"
        )
    sb, cb, sg, cg = np.sin(beta), np.cos(beta), np.sin(gamma), np.cos(gamma)
    return np.array([[-sb, 0.0, 1.0], [cb * sg, cg, 0.0], [cb * cg, -sg, 0.0]])
