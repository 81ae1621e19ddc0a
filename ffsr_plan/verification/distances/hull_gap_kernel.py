"""A lower bound on the distance of two hulls, by Wolfe's algorithm for the nearest point.

For any direction n the gap between the projections of both hulls on n is a lower bound on their
distance; whatever rounding does to the algorithm, only such gaps are returned. The directions are
those of the point nearest to the origin in the hull of a few differences of corners (Wolfe 1976).
The difference that lies least far along it is added to them, and those that do not carry the
nearest point are dropped, until no difference is nearer.

An ellipsoid may be added to the second hull (Minkowski sum): to one point, it is an ellipsoid; a
flat one added to a segment is a cylinder. The algorithm only asks for the point of a body that lies
least far along a direction, and an ellipsoid has such a point in closed form. It has no corners, so
the differences come ever closer to the nearest one and do not reach it: the gap, whose error is the
square of that of the direction, then stops to grow where rounding hides the rest.
"""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.kernels.compilation import kernel

_ROUNDS = 200
_PRECISION = 1e-13  # of the distance, relative, and in metres
_PATIENCE = 4  # rounds without a nearer point or a larger gap


@kernel
def hull_gap(
    a: Array, b: Array, semi_axes: Array, rotation: Array, shift: Array, enough: float
) -> float:
    """A lower bound on the signed distance of two hulls.

    Where they are apart it is their distance but for rounding, or at least `enough`. Where they
    overlap it is negative or zero, and at most minus the depth.

    Args:
        a: (n, 3) corners of the first hull [m].
        b: (m, 3) corners of the second hull in its own frame [m].
        semi_axes: (3,) of the ellipsoid that is added to the second hull, along the axes of its
            frame; zeros for none [m].
        rotation: (3, 3) from the second frame to the first.
        shift: (3,) origin of the second frame in the first [m].
        enough: bound at which to stop [m].
    """
    some, weights, near = np.empty((4, 3)), np.empty(4), np.empty(3)
    for k in range(3):
        some[0, k] = shift[k] - a[0, k]
        for i in range(3):
            some[0, k] += rotation[k, i] * b[0, i]
        near[k] = some[0, k]
    weights[0], count, best, idle = 1.0, 1, -np.inf, 0
    for _ in range(_ROUNDS):
        square = near[0] ** 2 + near[1] ** 2 + near[2] ** 2
        size = math.sqrt(square)
        if size < _PRECISION:
            break
        found = some[count]  # the place of the next difference
        before = best
        best = max(best, _least_along(a, b, semi_axes, rotation, shift, near, found) / size)
        if best >= enough or size - best <= _PRECISION * (1.0 + size):
            return best
        weights[count] = 0.0
        count = _nearest(some, weights, count + 1, near)
        if near[0] ** 2 + near[1] ** 2 + near[2] ** 2 < square or best > before:
            idle = 0  # directions still change where rounding hides it in the square of a length
        else:
            idle += 1
        if count == 4 or idle >= _PATIENCE:
            break
    best = max(best, _along_normals(a, b, semi_axes, rotation, shift, some, count))
    if best == -np.inf:  # a corner of one hull lies in the first corner of the other
        best = _along_axes(a, b, semi_axes, rotation, shift)
    return best


@kernel
def _least_along(
    a: Array,
    b: Array,
    semi_axes: Array,
    rotation: Array,
    shift: Array,
    along: Array,
    found: Array,
) -> float:
    """Least product of `along` (3,) with a difference of points, which is put into `found`."""
    most, best_a = -np.inf, 0
    for i in range(len(a)):
        value = a[i, 0] * along[0] + a[i, 1] * along[1] + a[i, 2] * along[2]
        if value > most:
            most, best_a = value, i
    x = rotation[0, 0] * along[0] + rotation[1, 0] * along[1] + rotation[2, 0] * along[2]
    y = rotation[0, 1] * along[0] + rotation[1, 1] * along[1] + rotation[2, 1] * along[2]
    z = rotation[0, 2] * along[0] + rotation[1, 2] * along[1] + rotation[2, 2] * along[2]
    least, best_b = np.inf, 0
    for i in range(len(b)):
        value = b[i, 0] * x + b[i, 1] * y + b[i, 2] * z
        if value < least:
            least, best_b = value, i
    u, v, w = semi_axes[0] * x, semi_axes[1] * y, semi_axes[2] * z
    size = math.sqrt(u * u + v * v + w * w)
    share = 1.0 / size if size > 0.0 else 0.0
    x = b[best_b, 0] - semi_axes[0] * u * share
    y = b[best_b, 1] - semi_axes[1] * v * share
    z = b[best_b, 2] - semi_axes[2] * w * share
    total = 0.0
    for k in range(3):
        found[k] = shift[k] - a[best_a, k]
        found[k] += rotation[k, 0] * x + rotation[k, 1] * y + rotation[k, 2] * z
        total += found[k] * along[k]
    return total


@kernel
def _nearest(some: Array, weights: Array, count: int, near: Array) -> int:
    """Put the nearest point of the hull of `some` (count, 3) into `near`; drop what is not needed.

    `weights` are those of a point of the hull, and become those of the nearest point. Returns the
    number of points left, 4 if the origin lies inside.
    """
    wanted = np.empty(4)
    while True:
        if not _affine(some, count, wanted):
            for k in range(count):
                wanted[k] = weights[k]
            wanted[np.argmin(weights[: count - 1])] = -1.0  # flat: without the least of the old
        share, leaving = 1.0, -1
        for k in range(count):
            if wanted[k] <= 0.0:
                step = weights[k] / (weights[k] - wanted[k]) if weights[k] > wanted[k] else 0.0
                if leaving < 0 or step < share:
                    share, leaving = step, k
        if leaving < 0:
            break
        for k in range(count):
            weights[k] += share * (wanted[k] - weights[k])
        count -= 1
        for k in range(leaving, count):
            weights[k] = weights[k + 1]
            some[k] = some[k + 1]
    for i in range(3):
        near[i] = 0.0
        for k in range(count):
            weights[k] = wanted[k]
            near[i] += wanted[k] * some[k, i]
    return count


@kernel
def _affine(some: Array, count: int, wanted: Array) -> bool:
    """Weights of the nearest point of the plane through `some` (count, 3); whether they exist."""
    if count == 1:
        wanted[0] = 1.0
        return True
    p, e = some[0], np.zeros((3, 3))
    for k in range(1, count):
        for i in range(3):
            e[k - 1, i] = some[k, i] - p[i]
    if count == 3:  # the normal closes the system, so that no squares of lengths are needed
        _cross(e[0], e[1], e[2])
    elif count == 2:
        square = e[0, 0] ** 2 + e[0, 1] ** 2 + e[0, 2] ** 2
        if square == 0.0:
            return False
        wanted[1] = -(p[0] * e[0, 0] + p[1] * e[0, 1] + p[2] * e[0, 2]) / square
        wanted[0] = 1.0 - wanted[1]
        return True
    normal = np.empty(3)
    _cross(e[0], e[1], normal)
    volume = normal[0] * e[2, 0] + normal[1] * e[2, 1] + normal[2] * e[2, 2]
    if volume == 0.0:
        return False
    total, turned = 0.0, np.empty(3)
    for k in range(count - 1):  # Cramer: t_k = -p . (e_{k+1} x e_{k+2}) / volume
        _cross(e[(k + 1) % 3], e[(k + 2) % 3], turned)
        wanted[k + 1] = -(p[0] * turned[0] + p[1] * turned[1] + p[2] * turned[2]) / volume
        total += wanted[k + 1]
    wanted[0] = 1.0 - total
    return True


@kernel
def _along_normals(
    a: Array, b: Array, semi_axes: Array, rotation: Array, shift: Array, some: Array, count: int
) -> float:
    """Largest gap along the normals of the triangles among `some` (count, 3), -inf without any.

    Where the hulls nearly touch, or overlap, these are sharper than the direction of a point.
    """
    best = -np.inf
    first, second, normal = np.empty(3), np.empty(3), np.empty(3)
    found = np.empty(3)
    for left_out in range(4 if count == 4 else count - 2):
        i, j, k = (left_out + 1) % 4, (left_out + 2) % 4, (left_out + 3) % 4
        if count == 3:
            i, j, k = 0, 1, 2
        for n in range(3):
            first[n], second[n] = some[j, n] - some[i, n], some[k, n] - some[i, n]
        _cross(first, second, normal)
        size = math.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
        if size > 0.0:
            for _ in range(2):
                gap = _least_along(a, b, semi_axes, rotation, shift, normal, found) / size
                best = max(best, gap)
                for n in range(3):
                    normal[n] = -normal[n]
    return best


@kernel
def _along_axes(a: Array, b: Array, semi_axes: Array, rotation: Array, shift: Array) -> float:
    """Largest gap along the axes of the first frame."""
    best, axis, found = -np.inf, np.empty(3), np.empty(3)
    for k in range(6):
        for i in range(3):
            axis[i] = 0.0
        axis[k % 3] = 1.0 if k < 3 else -1.0
        best = max(best, _least_along(a, b, semi_axes, rotation, shift, axis, found))
    return best


@kernel
def _cross(a: Array, b: Array, result: Array) -> None:
    result[0] = a[1] * b[2] - a[2] * b[1]
    result[1] = a[2] * b[0] - a[0] * b[2]
    result[2] = a[0] * b[1] - a[1] * b[0]
