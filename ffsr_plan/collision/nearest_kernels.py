"""The nearest sphere to a robot, compiled; imported when it is first needed.

Shapes are those of `primitives`, spheres those of a `SphereTree`. Distances are signed: negative by
the depth of penetration.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.robots.shape_arrays import BOX

_DEPTH = 64  # a tree of halves has fewer levels than that for any number of spheres


@njit(cache=True, nogil=True, inline="always")
def _distance(kind: int, frame: Array, shift: Array, balls: Array, k: int) -> float:
    """Signed distance [m] of a shape in its `frame`, displaced by `shift`, to row k of `balls`.

    A frame is a row of ``Placements.frames`; `balls` has rows of centre and radius.
    """
    x = balls[k, 0] - frame[9] - shift[0]
    y = balls[k, 1] - frame[10] - shift[1]
    z = balls[k, 2] - frame[11] - shift[2]
    a = abs(frame[0] * x + frame[3] * y + frame[6] * z)
    b = abs(frame[1] * x + frame[4] * y + frame[7] * z)
    c = abs(frame[2] * x + frame[5] * y + frame[8] * z)
    radius: float = balls[k, 3]
    if kind == BOX:
        a -= frame[12]
        b -= frame[13]
        c -= frame[14]
        inside = max(a, b, c)
        if inside <= 0.0:
            return float(inside) - radius
        a, b, c = max(a, 0.0), max(b, 0.0), max(c, 0.0)
    else:
        c = max(c - frame[13], 0.0)
        radius += frame[12]
    distance: float = math.sqrt(a * a + b * b + c * c)
    return distance - radius


@njit(cache=True, nogil=True)
def _search(
    nodes: Array,
    children: NDArray[np.int32],
    spheres: Array,
    kind: int,
    frame: Array,
    shift: Array,
    least: float,
    nearest: int,
    stack: NDArray[np.int32],
    bounds: Array,
) -> tuple[float, int]:
    """The least distance of one shape below `least`, nearer nodes first."""
    bounds[0] = _distance(kind, frame, shift, nodes, 0)
    stack[0] = 0
    top = 1
    while top > 0:
        top -= 1
        if bounds[top] >= least:
            continue
        left, right = children[stack[top], 0], children[stack[top], 1]
        if left < 0:
            for k in range(-1 - left, right):
                here = _distance(kind, frame, shift, spheres, k)
                if here < least:
                    least, nearest = here, k
            continue
        first = _distance(kind, frame, shift, nodes, left)
        second = _distance(kind, frame, shift, nodes, right)
        if first < second:
            left, right, first, second = right, left, second, first
        if first < least:
            stack[top], bounds[top] = left, first
            top += 1
        if second < least:
            stack[top], bounds[top] = right, second
            top += 1
    return least, nearest


@njit(cache=True, nogil=True)
def nearest_pairs(
    nodes: Array,
    children: NDArray[np.int32],
    spheres: Array,
    kinds: IntArray,
    frames: Array,
    places: IntArray,
    shifts: Array,
) -> tuple[Array, IntArray, IntArray, Array]:
    """Least distance over all shapes and spheres, for many places of the robot.

    Args:
        nodes: of a `SphereTree` with at least one sphere.
        children: of the same.
        spheres: of the same.
        kinds: (g,) of `Primitives` with at least one shape.
        frames: (K, g, 15) rotation, position and size of the shapes, as of `Placements`.
        places: (n,) which of the K is meant; neighbours in space are best neighbours here.
        shifts: (n, 3) displacement of the whole robot [m].

    Returns:
        (n,) least distance [m], (n,) shape and (n,) row of `spheres` where it is, and (n, 3) the
        centre of that sphere in the shape's frame [m].
    """
    count = len(places)
    least, shape, sphere = np.empty(count), np.empty(count, np.int64), np.empty(count, np.int64)
    local = np.empty((count, 3))
    stack, bounds = np.empty(_DEPTH, np.int32), np.empty(_DEPTH)
    near, which = 0, 0
    for n in range(count):
        here, shift = frames[places[n]], shifts[n]
        # the pair that was nearest in the last place is near in this one
        best = _distance(kinds[which], here[which], shift, spheres, near)
        last = which
        for step in range(len(kinds)):
            i = last - step if step <= last else step
            found, k = _search(
                nodes, children, spheres, kinds[i], here[i], shift, best, -1, stack, bounds
            )
            if k >= 0:
                best, near, which = found, k, i
        least[n], shape[n], sphere[n] = best, which, near
        frame = here[which]
        for axis in range(3):
            local[n, axis] = 0.0
            for c in range(3):
                apart = spheres[near, c] - frame[9 + c] - shift[c]
                local[n, axis] += frame[3 * c + axis] * apart
    return least, shape, sphere, local


@njit(cache=True, nogil=True)
def nearest_to_each(
    nodes: Array,
    children: NDArray[np.int32],
    spheres: Array,
    kinds: IntArray,
    frames: Array,
    shift: Array,
) -> Array:
    """(g,) least distance of each shape [m], in one place of the robot.

    Args:
        nodes: as all below, as for `nearest_pairs`.
        children: of the tree.
        spheres: of the tree.
        kinds: of the shapes.
        frames: (g, 15) of the shapes.
        shift: (3,) displacement of the whole robot [m].
    """
    count = len(kinds)
    least = np.empty(count)
    stack, bounds = np.empty(_DEPTH, np.int32), np.empty(_DEPTH)
    near = 0
    for i in range(count):
        start = _distance(kinds[i], frames[i], shift, spheres, near)
        least[i], near = _search(
            nodes, children, spheres, kinds[i], frames[i], shift, start, near, stack, bounds
        )
    return least


@njit(cache=True, nogil=True)
def pairs_below(
    nodes: Array,
    children: NDArray[np.int32],
    spheres: Array,
    kinds: IntArray,
    frames: Array,
    shift: Array,
    limit: float,
) -> tuple[Array, IntArray, IntArray]:
    """All pairs whose distance (or bound on it) lies below `limit` [m]: distance, shape, row."""
    found, shape, sphere = [np.inf], [0], [0]  # so that the compiler sees the types
    stack = np.empty(_DEPTH, np.int32)
    for i in range(len(kinds)):
        stack[0] = 0
        top = 1
        while top > 0:
            top -= 1
            node = stack[top]
            if _distance(kinds[i], frames[i], shift, nodes, node) >= limit:
                continue
            left, right = children[node, 0], children[node, 1]
            if left >= 0:
                stack[top], stack[top + 1] = left, right
                top += 2
                continue
            for k in range(-1 - left, right):
                here = _distance(kinds[i], frames[i], shift, spheres, k)
                if here < limit:
                    found.append(here)
                    shape.append(i)
                    sphere.append(k)
    return np.array(found[1:]), np.array(shape[1:]), np.array(sphere[1:])
