"""Distances of many placed solids to obstacle shapes, and to the outside of keep-in zones."""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.verification.distances.hull_gap_kernel import hull_gap
from ffsr_plan.verification.distances.obstacle_arrays import (
    BOX,
    CYLINDER,
    ShapeArrays,
    ZoneArrays,
)
from ffsr_plan.verification.distances.point_distance_kernels import (
    apart,
    from_box,
    from_cylinder,
    from_solid,
    into_solid,
    out_of_solid,
)
from ffsr_plan.verification.distances.solid_arrays import SolidArrays


@kernel
def shape_distances(
    solids: SolidArrays,
    asked: IntArray,
    turns: Array,
    places: Array,
    base_turns: Array,
    base_places: Array,
    shapes: ShapeArrays,
    near: IntArray,
    ranges: IntArray,
    found: Array,
) -> Array:
    """Least distance of a solid to some shapes, for each question.

    Args:
        solids: the solids.
        asked: (q, 2) configuration and solid of each question.
        turns: (n, s, 3, 3) rotations of the solids, base axes.
        places: (n, s, 3) their origins from the base origin, base axes [m].
        base_turns: (n, 3, 3) rotations of the base, world axes.
        base_places: (n, 3) base origins [m].
        shapes: the shapes, their middles from the same point as `base_places`.
        near: numbers of shapes, lists one after another; each may be reordered.
        ranges: (q, 2) begin and end of each question's list.
        found: (q,) distances to other obstacles [m].

    Returns:
        (q,) signed distances to all these obstacles [m]. Where a solid and a shape overlap, the
        distance is a lower bound, which is not positive.
    """
    result = found.copy()
    solid_turn, rotation = np.empty((3, 3)), np.empty((3, 3))
    shift, between, middle, local = np.empty(3), np.empty(3), np.empty(3), np.empty((1, 3))
    for q in range(len(asked)):
        n, s = asked[q]
        begin, end = ranges[q]
        if begin == end:
            continue
        _product(base_turns[n], turns[n, s], solid_turn)
        out_of_solid(solids.middles[s], base_turns[n], turns[n, s], places[n, s], middle)
        for i in range(3):
            middle[i] += base_places[n, i]
        _put_nearest_first(near, begin, end, shapes, middle)
        for k in range(begin, end):
            shape = near[k]
            spheres = shapes.radii[shape] + solids.radii[s]
            if apart(shapes.middles[shape], middle) - spheres >= result[q]:
                continue
            for i in range(3):
                between[i] = shapes.middles[shape, i] - base_places[n, i]
            into_solid(between, base_turns[n], turns[n, s], places[n, s], shift)
            _product_of_transposed(solid_turn, shapes.turns[shape], rotation)
            distance = _to_shape(solids, s, shapes, shape, rotation, shift, result[q], local)
            result[q] = min(result[q], distance)
    return result


@kernel
def _put_nearest_first(
    near: IntArray, begin: int, end: int, shapes: ShapeArrays, middle: Array
) -> None:
    """Put the shape that seems nearest to a point (3,) in front: fewer are measured after it."""
    nearest, least = begin, math.inf
    for k in range(begin, end):
        bound = apart(shapes.middles[near[k]], middle) - shapes.radii[near[k]]
        if bound < least:
            nearest, least = k, bound
    near[begin], near[nearest] = near[nearest], near[begin]


@kernel
def _to_shape(
    solids: SolidArrays,
    s: int,
    shapes: ShapeArrays,
    k: int,
    rotation: Array,
    shift: Array,
    enough: float,
    local: Array,
) -> float:
    """Signed distance of solid `s` to shape `k`, or a lower bound of at least `enough`.

    The shape's axes have a rotation (3, 3) and an origin (3,) in the frame of the solid. The place
    `local` (1, 3) is written to.
    """
    taken = solids.swells[s] + shapes.skins[k]
    halves, semi_axes = shapes.halves[k], shapes.semi_axes[k]
    _into_shape(solids.middles[s], rotation, shift, local[0])
    bound = from_box(local[0], halves) - shapes.skins[k] - solids.radii[s]
    if bound >= enough:
        return bound
    corners = solids.corners[solids.starts[s] : solids.starts[s + 1]]
    if len(corners) == 1 and shapes.kinds[k] == BOX:
        _into_shape(corners[0], rotation, shift, local[0])
        return from_box(local[0], halves) - taken
    if len(corners) == 1 and shapes.kinds[k] == CYLINDER:
        _into_shape(corners[0], rotation, shift, local[0])
        return from_cylinder(local[0], halves[0], halves[2]) - taken
    points = shapes.corners[shapes.starts[k] : shapes.starts[k + 1]]
    if len(points) == 1 and shapes.kinds[k] == BOX:
        for i in range(3):
            local[0, i] = shift[i]
        return from_solid(local, corners, solids.halves[s], enough + taken) - taken
    return hull_gap(corners, points, semi_axes, rotation, shift, enough + taken) - taken


@kernel
def zone_distances(
    solids: SolidArrays,
    asked: IntArray,
    turns: Array,
    places: Array,
    base_turns: Array,
    base_places: Array,
    zones: ZoneArrays,
    found: Array,
) -> Array:
    """Least distance of a solid to the outside of zones, for each question.

    Args:
        solids: the solids.
        asked: (q, 2) configuration and solid of each question.
        turns: (n, s, 3, 3) rotations of the solids, base axes.
        places: (n, s, 3) their origins from the base origin, base axes [m].
        base_turns: (n, 3, 3) rotations of the base, world axes.
        base_places: (n, 3) base origins [m].
        zones: the zones, from the same point as `base_places`.
        found: (q,) distances to other obstacles [m].

    Returns:
        (q,) signed distances to all these obstacles [m]; where a solid leaves a zone, minus how far
        it is beyond a plane or a ball.
    """
    result = found.copy()
    solid_turn, middle = np.empty((3, 3)), np.empty(3)
    between, local = np.empty(3), np.empty(3)
    for q in range(len(asked)):
        n, s = asked[q]
        corners = solids.corners[solids.starts[s] : solids.starts[s + 1]]
        _product(base_turns[n], turns[n, s], solid_turn)
        out_of_solid(solids.middles[s], base_turns[n], turns[n, s], places[n, s], middle)
        for i in range(3):
            middle[i] += base_places[n, i]
        for p in range(len(zones.planes)):
            plane = zones.planes[p]
            room = plane[3]
            for i in range(3):
                room -= plane[i] * middle[i]
            if room - solids.radii[s] >= result[q]:
                continue
            beyond = _farthest_along(plane, solid_turn, corners, solids.middles[s], local)
            result[q] = min(result[q], room - beyond - solids.swells[s])
        for b in range(len(zones.balls)):
            ball = zones.balls[b]
            if ball[3] - apart(ball, middle) - solids.radii[s] >= result[q]:
                continue
            for i in range(3):
                between[i] = ball[i] - base_places[n, i]
            into_solid(between, base_turns[n], turns[n, s], places[n, s], local)
            away = 0.0
            for c in range(len(corners)):
                away = max(away, apart(corners[c], local))
            result[q] = min(result[q], ball[3] - away - solids.swells[s])
    return result


@kernel
def _farthest_along(
    normal: Array, solid_turn: Array, corners: Array, middle: Array, local: Array
) -> float:
    """How far corners (n, 3) of a solid lie along a world direction from a point of it, at most.

    The place `local` (3,) is written to.
    """
    for i in range(3):
        local[i] = 0.0
        for k in range(3):
            local[i] += solid_turn[k, i] * normal[k]
    most = -math.inf
    for c in range(len(corners)):
        along = 0.0
        for i in range(3):
            along += local[i] * (corners[c, i] - middle[i])
        most = max(most, along)
    return most


@kernel
def _into_shape(point: Array, rotation: Array, shift: Array, local: Array) -> None:
    """Put a point (3,) of a solid's frame into the axes of a shape."""
    for i in range(3):
        local[i] = 0.0
        for k in range(3):
            local[i] += rotation[k, i] * (point[k] - shift[k])


@kernel
def _product(a: Array, b: Array, result: Array) -> None:
    """Put a b, of matrices (3, 3), into `result`."""
    for i in range(3):
        for j in range(3):
            result[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


@kernel
def _product_of_transposed(a: Array, b: Array, result: Array) -> None:
    """Put a^T b, of matrices (3, 3), into `result`."""
    for i in range(3):
        for j in range(3):
            result[i, j] = a[0, i] * b[0, j] + a[1, i] * b[1, j] + a[2, i] * b[2, j]
