"""Compiled search for the obstacle nearest to the robot's shapes.

The robot's shapes are those of `shape_arrays`, obstacles those of an `ObstacleTree`. Distances are
signed: negative by the depth of penetration. Every body is a box widened by a radius, or lies in
one.
"""

from __future__ import annotations

import math
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.collision.shape_gap_kernels import half_shadow, half_sides
from ffsr_plan.collision.widened_box_kernels import box_distance
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.kernels.compilation import inlined_kernel, kernel
from ffsr_plan.robots.shape_arrays import BOX
from ffsr_plan.scene.shapes.obstacle_tree import ObstacleTree

STACK_SIZE = 64
"""Entries of a stack for `nearest_obstacle`: a tree of halves has fewer levels than that."""

_NONE: Any = np.int64(-1)  # typed as other rows are: one signature to compile


class Obstacles(Protocol):
    """Obstacles to search: an `ObstacleTree`, or another named tuple with these arrays of one."""

    @property
    def nodes(self) -> Array: ...  # noqa: D102

    @property
    def children(self) -> NDArray[np.int32]: ...  # noqa: D102

    @property
    def spheres(self) -> Array: ...  # noqa: D102

    @property
    def solid(self) -> NDArray[np.int32]: ...  # noqa: D102

    @property
    def solids(self) -> Array: ...  # noqa: D102

    @property
    def planes(self) -> Array: ...  # noqa: D102

    @property
    def balls(self) -> Array: ...  # noqa: D102


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
def distance_to_solid(kind: int, frame: Array, shift: Array, solid: Array, enough: float) -> float:
    """Signed distance of a shape and a widened box, in closed form.

    Args:
        kind: ROUND or BOX.
        frame: (15,) rotation, position and size of the shape, as in `Placements.frames`.
        shift: (3,) displacement of the shape [m].
        solid: (16,) row of `ObstacleTree.solids`.
        enough: where the distance is larger, a lower bound of at least this will do [m].

    Returns:
        The distance [m] or such a bound; of a body that only lies in its box, a lower bound.
    """
    skins = solid[15] + (0.0 if kind == BOX else frame[12])
    others = solid[12], solid[13], solid[14]
    between = box_distance(frame, half_sides(kind, frame), solid, others, shift, enough + skins)
    return between - skins


@kernel
def distance_in_plane(kind: int, frame: Array, shift: Array, plane: Array) -> float:
    """Signed distance of a shape from the far side of a plane that it should stay behind [m].

    Args:
        kind: ROUND or BOX.
        frame: (15,) rotation, position and size of the shape.
        shift: (3,) displacement of the shape [m].
        plane: (4,) outward unit normal and offset.
    """
    room: float = plane[3] - half_shadow(kind, frame, plane[0], plane[1], plane[2])
    for a in range(3):
        room -= plane[a] * (frame[9 + a] + shift[a])
    return room if kind == BOX else room - frame[12]


@kernel
def distance_in_ball(kind: int, frame: Array, shift: Array, ball: Array) -> float:
    """Signed distance of a shape from the outside of a ball that it should stay in [m].

    The corner farthest from the middle decides.

    Args:
        kind: ROUND or BOX.
        frame: (15,) rotation, position and size of the shape.
        shift: (3,) displacement of the shape [m].
        ball: (4,) centre and radius.
    """
    sides, square = half_sides(kind, frame), 0.0
    for b in range(3):
        along = 0.0
        for a in range(3):
            along += frame[3 * a + b] * (frame[9 + a] + shift[a] - ball[a])
        square += (abs(along) + sides[b]) ** 2
    room: float = ball[3] - math.sqrt(square)
    return room if kind == BOX else room - frame[12]


@kernel
def distance_to_obstacle(
    tree: Obstacles, kind: int, frame: Array, shift: Array, row: int, enough: float
) -> float:
    """Signed distance of a shape and an obstacle, in closed form.

    Args:
        tree: the obstacles.
        kind: ROUND or BOX.
        frame: (15,) rotation, position and size of the shape, as in `Placements.frames`.
        shift: (3,) displacement of the shape [m].
        row: of the obstacle: a row of `tree.spheres`, or behind them of `planes` and `balls`.
        enough: where the distance is larger, a lower bound of at least this will do [m].

    Returns:
        The distance [m] or such a bound; of a body that only lies in its box, a lower bound.
    """
    zone = row - len(tree.spheres)
    if zone >= len(tree.planes):
        return distance_in_ball(kind, frame, shift, tree.balls[zone - len(tree.planes)])
    if zone >= 0:
        return distance_in_plane(kind, frame, shift, tree.planes[zone])
    if len(tree.solid) > 0 and tree.solid[row] >= 0:
        return distance_to_solid(kind, frame, shift, tree.solids[tree.solid[row]], enough)
    return distance_to_sphere(kind, frame, shift, tree.spheres, row)


@kernel
def nearest_obstacle(
    tree: Obstacles,
    kind: int,
    frame: Array,
    shift: Array,
    least: float,
    nearest: int,
    stack: NDArray[np.int32],
    bounds: Array,
) -> tuple[float, int]:
    """Search for an obstacle nearer to a shape than `least`, nearer nodes of the tree first.

    Args:
        tree: the obstacles.
        kind: ROUND or BOX.
        frame: (15,) rotation, position and size of the shape, as in `Placements.frames`.
        shift: (3,) displacement of the shape [m].
        least: distance below which obstacles count [m].
        nearest: row to return if no obstacle is nearer.
        stack: (STACK_SIZE,) scratch memory for nodes.
        bounds: (STACK_SIZE,) scratch memory for their distances.

    Returns:
        The least distance [m], and the row of its obstacle, see `distance_to_obstacle`.
    """
    nodes, children, spheres, solid = tree.nodes, tree.children, tree.spheres, tree.solid
    count, top = len(spheres), 0
    for k in range(len(tree.planes) + len(tree.balls)):
        distance = distance_to_obstacle(tree, kind, frame, shift, count + k, least)
        if distance < least:
            least, nearest = distance, count + k
    if count > 0:
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
                if distance < least and len(solid) > 0 and solid[k] >= 0:
                    own = tree.solids[solid[k]]
                    distance = distance_to_solid(kind, frame, shift, own, least)
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
    tree: ObstacleTree, kinds: IntArray, frames: Array, places: IntArray, shifts: Array
) -> tuple[Array, IntArray, IntArray, Array]:
    """Least distance over all shapes and obstacles; see `nearest_pairs_from`."""
    return nearest_pairs_from(tree, kinds, frames, places, shifts, 0, 0)


@kernel
def nearest_pairs_from(
    tree: ObstacleTree,
    kinds: IntArray,
    frames: Array,
    places: IntArray,
    shifts: Array,
    which: int,
    row: int,
) -> tuple[Array, IntArray, IntArray, Array]:
    """Least distance over all shapes and obstacles, for many placements of the robot.

    Args:
        tree: obstacles, at least one.
        kinds: (g,) ROUND or BOX of the shapes, at least one.
        frames: (K, g, 15) rotation, position and size of the shapes, as in `Placements.frames`.
        places: (n,) row of `frames` for each query; fastest if successive rows are close in space.
        shifts: (n, 3) displacement of the whole robot for each query [m].
        which: shape of the nearest pair of the query before these, to begin with; 0 before any.
        row: the row of its obstacle.

    Returns:
        (n,) least distance [m], (n,) its shape, (n,) the row of its obstacle, and (n, 3) the centre
        of that sphere in the shape's frame [m], zero for a zone.
    """
    spheres = tree.spheres
    count = len(places)
    least, shape, sphere = np.empty(count), np.empty(count, np.int64), np.empty(count, np.int64)
    local = np.empty((count, 3))
    stack, bounds = np.empty(STACK_SIZE, np.int32), np.empty(STACK_SIZE)
    for n in range(count):
        placed, shift = frames[places[n]], shifts[n]
        # the nearest pair of the previous query gives a small distance to start with
        best = distance_to_obstacle(tree, kinds[which], placed[which], shift, row, np.inf)
        last = which
        for step in range(len(kinds)):
            i = last - step if step <= last else step
            distance, k = nearest_obstacle(
                tree, kinds[i], placed[i], shift, best, _NONE, stack, bounds
            )
            if k >= 0:
                best, row, which = distance, k, i
        least[n], shape[n], sphere[n] = best, which, row
        frame = placed[which]
        for axis in range(3):
            local[n, axis] = 0.0
            for c in range(3 if row < len(spheres) else 0):
                offset = spheres[row, c] - frame[9 + c] - shift[c]
                local[n, axis] += frame[3 * c + axis] * offset
    return least, shape, sphere, local


@kernel
def nearest_to_each(tree: ObstacleTree, kinds: IntArray, frames: Array, shift: Array) -> Array:
    """Least distance of each shape, for one placement of the robot.

    Args:
        tree: obstacles, at least one.
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
        start = distance_to_obstacle(tree, kinds[i], frames[i], shift, row, np.inf)
        least[i], row = nearest_obstacle(
            tree, kinds[i], frames[i], shift, start, row, stack, bounds
        )
    return least


@kernel
def pairs_below(
    tree: ObstacleTree, kinds: IntArray, frames: Array, shift: Array, limit: float
) -> tuple[Array, IntArray, IntArray]:
    """All pairs whose distance, or lower bound on it, is below a limit.

    Args:
        tree: obstacles, at least one.
        kinds: (g,) ROUND or BOX of the shapes.
        frames: (g, 15) rotation, position and size of the shapes.
        shift: (3,) displacement of the whole robot [m].
        limit: [m].

    Returns:
        (p,) distance [m], (p,) shape and (p,) row of the obstacle of each pair.
    """
    nodes, children, spheres = tree.nodes, tree.children, tree.spheres
    distances, shape, sphere = [np.inf], [0], [0]  # first entries tell the compiler the types
    stack, zones = np.empty(STACK_SIZE, np.int32), len(tree.planes) + len(tree.balls)
    for i in range(len(kinds)):
        for k in range(len(spheres), len(spheres) + zones):
            distance = distance_to_obstacle(tree, kinds[i], frames[i], shift, k, limit)
            if distance < limit:
                distances.append(distance)
                shape.append(i)
                sphere.append(k)
        stack[0] = 0
        top = 1 if len(spheres) > 0 else 0
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
                if distance_to_sphere(kinds[i], frames[i], shift, spheres, k) >= limit:
                    continue
                distance = distance_to_obstacle(tree, kinds[i], frames[i], shift, k, limit)
                if distance < limit:
                    distances.append(distance)
                    shape.append(i)
                    sphere.append(k)
    return np.array(distances[1:]), np.array(shape[1:]), np.array(sphere[1:])
