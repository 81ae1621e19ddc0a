"""Compiled search for the sphere nearest to the robot's shapes.

Shapes are those of `shape_arrays`, spheres those of a `SphereTree`. Distances are signed: negative
by the depth of penetration.
"""

from __future__ import annotations

import math
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.kernels.compilation import inlined_kernel, kernel
from ffsr_plan.robots.shape_arrays import BOX
from ffsr_plan.scene.sphere_tree import SphereTree

STACK_SIZE = 64
"""Entries of a stack for `nearest_sphere`: a tree of halves has fewer levels than that."""

_NONE: Any = np.int64(-1)  # typed as other rows are: one signature to compile


class Spheres(Protocol):
    """Spheres to search: a `SphereTree`, or another named tuple with these arrays of one.

    Attributes:
        nodes: (M, 4) centre and radius of the sphere around each node [m].
        children: (M, 2) the two nodes below each, or the rows of a leaf.
        spheres: (N, 4) centre and radius of each obstacle [m].
    """

    @property
    def nodes(self) -> Array: ...  # noqa: D102

    @property
    def children(self) -> NDArray[np.int32]: ...  # noqa: D102

    @property
    def spheres(self) -> Array: ...  # noqa: D102


@inlined_kernel
def distance_to_sphere(kind: int, frame: Array, shift: Array, spheres: Array, row: int) -> float:
    """Signed distance from a shape to a sphere, in closed form.

    Args:
        kind: ROUND or BOX.
        frame: (15,) rotation, position and size of the shape, as in `Placements.frames`.
        shift: (3,) displacement of the shape [m].
        spheres: (N, 4) centre and radius [m].
        row: which of the spheres.

    Returns:
        The distance [m]; for a hull, that of the box around it, a lower bound.
    """
    x = spheres[row, 0] - frame[9] - shift[0]
    y = spheres[row, 1] - frame[10] - shift[1]
    z = spheres[row, 2] - frame[11] - shift[2]
    a = abs(frame[0] * x + frame[3] * y + frame[6] * z)
    b = abs(frame[1] * x + frame[4] * y + frame[7] * z)
    c = abs(frame[2] * x + frame[5] * y + frame[8] * z)
    radius: float = spheres[row, 3]
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


@kernel
def nearest_sphere(
    tree: Spheres,
    kind: int,
    frame: Array,
    shift: Array,
    least: float,
    nearest: int,
    stack: NDArray[np.int32],
    bounds: Array,
) -> tuple[float, int]:
    """Search the tree for a sphere nearer to a shape than `least`, nearer nodes first.

    Args:
        tree: spheres, at least one.
        kind: ROUND or BOX.
        frame: (15,) rotation, position and size of the shape, as in `Placements.frames`.
        shift: (3,) displacement of the shape [m].
        least: distance below which spheres count [m].
        nearest: row to return if no sphere is nearer.
        stack: (STACK_SIZE,) scratch memory for nodes.
        bounds: (STACK_SIZE,) scratch memory for their distances.

    Returns:
        The least distance [m], and the row of its sphere in `tree.spheres`.
    """
    nodes, children, spheres = tree.nodes, tree.children, tree.spheres
    bounds[0] = distance_to_sphere(kind, frame, shift, nodes, 0)
    stack[0] = 0
    top = 1
    while top > 0:
        top -= 1
        if bounds[top] >= least:
            continue
        left, right = children[stack[top], 0], children[stack[top], 1]
        if left < 0:
            for k in range(-1 - left, right):
                distance = distance_to_sphere(kind, frame, shift, spheres, k)
                if distance < least:
                    least, nearest = distance, k
            continue
        first = distance_to_sphere(kind, frame, shift, nodes, left)
        second = distance_to_sphere(kind, frame, shift, nodes, right)
        if first < second:
            left, right, first, second = right, left, second, first
        if first < least:
            stack[top], bounds[top] = left, first
            top += 1
        if second < least:
            stack[top], bounds[top] = right, second
            top += 1
    return least, nearest


def nearest_pairs(
    tree: SphereTree, kinds: IntArray, frames: Array, places: IntArray, shifts: Array
) -> tuple[Array, IntArray, IntArray, Array]:
    """Least distance over all shapes and spheres; see `nearest_pairs_from`."""
    return nearest_pairs_from(tree, kinds, frames, places, shifts, 0, 0)


@kernel
def nearest_pairs_from(
    tree: SphereTree,
    kinds: IntArray,
    frames: Array,
    places: IntArray,
    shifts: Array,
    which: int,
    row: int,
) -> tuple[Array, IntArray, IntArray, Array]:
    """Least distance over all shapes and spheres, for many placements of the robot.

    Args:
        tree: spheres, at least one.
        kinds: (g,) ROUND or BOX of the shapes, at least one.
        frames: (K, g, 15) rotation, position and size of the shapes, as in `Placements.frames`.
        places: (n,) row of `frames` for each query; fastest if successive rows are close in space.
        shifts: (n, 3) displacement of the whole robot for each query [m].
        which: shape of the nearest pair of the query before these, to begin with; 0 before any.
        row: its row of `tree.spheres`.

    Returns:
        (n,) least distance [m], (n,) its shape, (n,) its row of `tree.spheres`, and (n, 3) the
        centre of that sphere in the shape's frame [m].
    """
    spheres = tree.spheres
    count = len(places)
    least, shape, sphere = np.empty(count), np.empty(count, np.int64), np.empty(count, np.int64)
    local = np.empty((count, 3))
    stack, bounds = np.empty(STACK_SIZE, np.int32), np.empty(STACK_SIZE)
    for n in range(count):
        placed, shift = frames[places[n]], shifts[n]
        # the nearest pair of the previous query gives a small distance to start with
        best = distance_to_sphere(kinds[which], placed[which], shift, spheres, row)
        last = which
        for step in range(len(kinds)):
            i = last - step if step <= last else step
            distance, k = nearest_sphere(
                tree, kinds[i], placed[i], shift, best, _NONE, stack, bounds
            )
            if k >= 0:
                best, row, which = distance, k, i
        least[n], shape[n], sphere[n] = best, which, row
        frame = placed[which]
        for axis in range(3):
            local[n, axis] = 0.0
            for c in range(3):
                offset = spheres[row, c] - frame[9 + c] - shift[c]
                local[n, axis] += frame[3 * c + axis] * offset
    return least, shape, sphere, local


@kernel
def nearest_to_each(tree: SphereTree, kinds: IntArray, frames: Array, shift: Array) -> Array:
    """Least distance of each shape, for one placement of the robot.

    Args:
        tree: spheres, at least one.
        kinds: (g,) ROUND or BOX of the shapes.
        frames: (g, 15) rotation, position and size of the shapes.
        shift: (3,) displacement of the whole robot [m].

    Returns:
        (g,) least distance [m].
    """
    least = np.empty(len(kinds))
    stack, bounds = np.empty(STACK_SIZE, np.int32), np.empty(STACK_SIZE)
    row = 0
    for i in range(len(kinds)):
        start = distance_to_sphere(kinds[i], frames[i], shift, tree.spheres, row)
        least[i], row = nearest_sphere(tree, kinds[i], frames[i], shift, start, row, stack, bounds)
    return least


@kernel
def pairs_below(
    tree: SphereTree, kinds: IntArray, frames: Array, shift: Array, limit: float
) -> tuple[Array, IntArray, IntArray]:
    """All pairs whose distance, or lower bound on it, is below a limit.

    Args:
        tree: spheres, at least one.
        kinds: (g,) ROUND or BOX of the shapes.
        frames: (g, 15) rotation, position and size of the shapes.
        shift: (3,) displacement of the whole robot [m].
        limit: [m].

    Returns:
        (p,) distance [m], (p,) shape and (p,) row of `tree.spheres` of each pair.
    """
    nodes, children, spheres = tree.nodes, tree.children, tree.spheres
    distances, shape, sphere = [np.inf], [0], [0]  # first entries tell the compiler the types
    stack = np.empty(STACK_SIZE, np.int32)
    for i in range(len(kinds)):
        stack[0] = 0
        top = 1
        while top > 0:
            top -= 1
            node = stack[top]
            if distance_to_sphere(kinds[i], frames[i], shift, nodes, node) >= limit:
                continue
            left, right = children[node, 0], children[node, 1]
            if left >= 0:
                stack[top], stack[top + 1] = left, right
                top += 2
                continue
            for k in range(-1 - left, right):
                distance = distance_to_sphere(kinds[i], frames[i], shift, spheres, k)
                if distance < limit:
                    distances.append(distance)
                    shape.append(i)
                    sphere.append(k)
    return np.array(distances[1:]), np.array(shape[1:]), np.array(sphere[1:])
