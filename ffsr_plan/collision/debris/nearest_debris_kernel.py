"""Compiled search for the drifting sphere nearest to the robot's shapes.

Times count from the middle time of the tree. Over a length of time, the `spread`, each sphere is
inflated by half of its own path: with 0 it is as large as it is.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.bodies.debris.drifting_tree import DriftingTree
from ffsr_plan.collision.nearest_obstacle_kernels import STACK_SIZE, distance_to_sphere
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.kernels.compilation import kernel


@kernel
def distance_to_drifting(
    kind: int,
    frame: Array,
    shift: Array,
    spheres: Array,
    drifts: Array,
    row: int,
    time: float,
    spread: float,
    apart: Array,
) -> float:
    """Signed distance from a shape to a drifting sphere, or to that around a node.

    Args:
        kind: ROUND or BOX.
        frame: (15,) rotation, position and size of the shape, as in `Placements.frames`.
        shift: (3,) displacement of the shape [m].
        spheres: (N, 4) centres and radii at the middle time [m].
        drifts: (N, 5) velocities, growths and speeds [m/s].
        row: which of the spheres.
        time: from the middle time on [s].
        spread: time over which it is inflated by half of its path [s].
        apart: (3,) scratch memory.

    Returns:
        The distance [m]; for a hull, that of the box around it, a lower bound.
    """
    for a in range(3):
        apart[a] = shift[a] - time * drifts[row, a]
    grown = abs(time) * drifts[row, 3] + 0.5 * spread * drifts[row, 4]
    return distance_to_sphere(kind, frame, apart, spheres, row) - grown


@kernel
def nearest_drifting(
    tree: DriftingTree,
    kind: int,
    frame: Array,
    shift: Array,
    when: tuple[float, float],
    least: float,
    nearest: int,
    stack: NDArray[np.int32],
    bounds: Array,
    apart: Array,
) -> tuple[float, int]:
    """Search for a sphere nearer to a shape than `least`, nearer nodes of the tree first.

    Args:
        tree: the spheres.
        kind: ROUND or BOX.
        frame: (15,) rotation, position and size of the shape.
        shift: (3,) displacement of the shape [m].
        when: time and spread [s].
        least: distance below which spheres count [m].
        nearest: row to return if no sphere is nearer.
        stack: (STACK_SIZE,) scratch memory for nodes.
        bounds: (STACK_SIZE,) scratch memory for their distances.
        apart: (3,) scratch memory.

    Returns:
        The least distance [m], and the row of its sphere.
    """
    children, (time, spread) = tree.children, when
    around, flow, spheres, drifts = tree.nodes, tree.node_drifts, tree.spheres, tree.drifts
    bounds[0] = distance_to_drifting(kind, frame, shift, around, flow, 0, time, spread, apart)
    stack[0], top = 0, 1
    while top > 0:
        top -= 1
        if bounds[top] >= least:
            continue
        left, right = children[stack[top], 0], children[stack[top], 1]
        if left < 0:
            for k in range(-1 - left, right):
                distance = distance_to_drifting(
                    kind, frame, shift, spheres, drifts, k, time, spread, apart
                )
                if distance < least:
                    least, nearest = distance, k
            continue
        first = distance_to_drifting(kind, frame, shift, around, flow, left, time, spread, apart)
        second = distance_to_drifting(kind, frame, shift, around, flow, right, time, spread, apart)
        if first < second:
            left, right, first, second = right, left, second, first
        if first < least:
            stack[top], bounds[top] = left, first
            top += 1
        if second < least:
            stack[top], bounds[top] = right, second
            top += 1
    return least, nearest


@kernel
def nearest_drifting_pairs(
    tree: DriftingTree,
    kinds: IntArray,
    frames: Array,
    places: IntArray,
    shifts: Array,
    times: Array,
    spread: Array,
    least: Array,
) -> tuple[IntArray, IntArray]:
    """Least distance over all shapes and spheres, for many placements, each at its own time.

    Args:
        tree: the spheres.
        kinds: (g,) ROUND or BOX of the shapes.
        frames: (K, g, 15) rotation, position and size of the shapes, as in `Placements.frames`.
        places: (n,) row of `frames` for each query; fastest if successive rows are close in space.
        shifts: (n, 3) displacement of the whole robot for each query [m].
        times: (n,) from the middle time on [s].
        spread: (n,) time over which spheres are inflated by half of their paths [s].
        least: (n,) distances below which spheres count; the least distances, filled in [m].

    Returns:
        (n,) shape and (n,) row of the sphere of each; -1 where none is nearer.
    """
    count = len(places)
    shape, sphere = np.full(count, -1), np.full(count, -1)
    stack, bounds, apart = np.empty(STACK_SIZE, np.int32), np.empty(STACK_SIZE), np.empty(3)
    which, row = 0, -1
    for n in range(count):
        placed, shift, when, best = frames[places[n]], shifts[n], (times[n], spread[n]), least[n]
        last = which
        if row >= 0:  # the nearest pair of the query before gives a small distance to start with
            start = distance_to_drifting(
                kinds[which], placed[which], shift, tree.spheres, tree.drifts, row, *when, apart
            )
            if start < best:
                best, shape[n], sphere[n] = start, which, row
        for step in range(len(kinds)):
            i = last - step if step <= last else step
            best, k = nearest_drifting(
                tree, kinds[i], placed[i], shift, when, best, -1, stack, bounds, apart
            )
            if k >= 0:
                shape[n], sphere[n] = i, k
        if sphere[n] >= 0:
            which, row = shape[n], sphere[n]
        least[n] = best
    return shape, sphere


@kernel
def nearest_drifting_to_each(
    tree: DriftingTree, kinds: IntArray, frames: Array, shift: Array, when: tuple[float, float]
) -> Array:
    """Least distance of each shape, for one placement of the robot.

    Args:
        tree: the spheres.
        kinds: (g,) ROUND or BOX of the shapes.
        frames: (g, 15) rotation, position and size of the shapes.
        shift: (3,) displacement of the whole robot [m].
        when: time and spread [s].

    Returns:
        (g,) least distance [m].
    """
    found = np.empty(len(kinds))
    stack, bounds, apart = np.empty(STACK_SIZE, np.int32), np.empty(STACK_SIZE), np.empty(3)
    for i in range(len(kinds)):
        found[i], _ = nearest_drifting(
            tree, kinds[i], frames[i], shift, when, np.inf, -1, stack, bounds, apart
        )
    return found


@kernel
def drifting_pairs_below(
    tree: DriftingTree,
    kinds: IntArray,
    frames: Array,
    shift: Array,
    when: tuple[float, float],
    limit: float,
) -> tuple[Array, IntArray, IntArray]:
    """All pairs whose distance, or lower bound on it, is below a limit.

    Args:
        tree: the spheres.
        kinds: (g,) ROUND or BOX of the shapes.
        frames: (g, 15) rotation, position and size of the shapes.
        shift: (3,) displacement of the whole robot [m].
        when: time and spread [s].
        limit: [m].

    Returns:
        (p,) distance [m], (p,) shape and (p,) row of the sphere of each pair.
    """
    children, (time, spread) = tree.children, when
    around, flow, spheres, drifts = tree.nodes, tree.node_drifts, tree.spheres, tree.drifts
    distances, shape, sphere = [np.inf], [0], [0]  # first entries tell the compiler the types
    stack, apart = np.empty(STACK_SIZE, np.int32), np.empty(3)
    for i in range(len(kinds)):
        kind, frame = kinds[i], frames[i]
        stack[0], top = 0, 1
        while top > 0:
            top -= 1
            node = stack[top]
            bound = distance_to_drifting(
                kind, frame, shift, around, flow, node, time, spread, apart
            )
            if bound >= limit:
                continue
            left, right = children[node, 0], children[node, 1]
            if left >= 0:
                stack[top], stack[top + 1] = left, right
                top += 2
                continue
            for k in range(-1 - left, right):
                distance = distance_to_drifting(
                    kind, frame, shift, spheres, drifts, k, time, spread, apart
                )
                if distance < limit:
                    distances.append(distance)
                    shape.append(i)
                    sphere.append(k)
    return np.array(distances[1:]), np.array(shape[1:]), np.array(sphere[1:])
