"""Distances of many placed solids: to spheres, and to one another."""

from __future__ import annotations

import math

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.verification.distances.hull_gap_kernel import hull_gap
from ffsr_plan.verification.distances.point_distance_kernels import (
    apart,
    from_solid,
    into_solid,
    out_of_solid,
)
from ffsr_plan.verification.distances.solid_arrays import SolidArrays
from ffsr_plan.verification.distances.sphere_blocks import BLOCK, SphereBlocks


@kernel
def sphere_distances(
    solids: SolidArrays,
    asked: IntArray,
    turns: Array,
    places: Array,
    base_turns: Array,
    base_places: Array,
    centers: Array,
    radii: Array,
    near: IntArray,
    ranges: IntArray,
) -> Array:
    """Least distance of a solid to some spheres, for each question.

    Args:
        solids: the solids.
        asked: (q, 2) configuration and solid of each question.
        turns: (n, s, 3, 3) rotations of the solids, base axes.
        places: (n, s, 3) their origins from the base origin, base axes [m].
        base_turns: (n, 3, 3) rotations of the base, world axes.
        base_places: (n, 3) base origins [m].
        centers: (k, 3) centres of the spheres, from the same point as `base_places` [m].
        radii: (k,) [m].
        near: numbers of spheres, lists one after another.
        ranges: (q, 2) begin and end of each question's list.

    Returns:
        (q,) signed distances [m], infinite for an empty list. Where a centre lies inside a hull,
        the distance is a lower bound, which is negative.
    """
    result = np.full(len(asked), np.inf)
    local, between, middle = np.empty((1, 3)), np.empty(3), np.empty(3)
    for q in range(len(asked)):
        n, s = asked[q]
        begin, end = ranges[q]
        corners = solids.corners[solids.starts[s] : solids.starts[s + 1]]
        out_of_solid(solids.middles[s], base_turns[n], turns[n, s], places[n, s], middle)
        for i in range(3):
            middle[i] += base_places[n, i]
        nearest, least = -1, np.inf
        for k in range(begin, end):  # the sphere that seems nearest is measured first
            bound = apart(centers[near[k]], middle) - radii[near[k]]
            if bound < least:
                nearest, least = k, bound
        if nearest >= 0:
            near[begin], near[nearest] = near[nearest], near[begin]
        for k in range(begin, end):
            sphere = near[k]
            bound = apart(centers[sphere], middle) - radii[sphere] - solids.radii[s]
            if bound >= result[q] and k != begin:
                continue
            for i in range(3):
                between[i] = centers[sphere, i] - base_places[n, i]
            into_solid(between, base_turns[n], turns[n, s], places[n, s], local[0])
            taken = solids.swells[s] + radii[sphere]
            distance = from_solid(local, corners, solids.halves[s], result[q] + taken)
            result[q] = min(result[q], distance - taken)
    return result


@kernel
def pair_distances(
    solids: SolidArrays,
    asked: IntArray,
    pairs: IntArray,
    turns: Array,
    places: Array,
    enough: Array,
) -> Array:
    """Lower bounds on the distances of pairs of solids.

    Args:
        solids: the solids.
        asked: (q, 2) configuration and pair of each question.
        pairs: (p, 2) the solids of each pair.
        turns: (n, s, 3, 3) rotations of the solids, axes of any common frame.
        places: (n, s, 3) their origins [m].
        enough: (q,) bound that will do [m].

    Returns:
        (q,) bounds on the signed distances [m]; exact to rounding where they are below `enough`.
    """
    result = np.empty(len(asked))
    rotation, shift, between = np.empty((3, 3)), np.empty(3), np.empty(3)
    none = np.zeros(3)
    for q in range(len(asked)):
        n, pair = asked[q]
        a, b = pairs[pair]
        for i in range(3):
            between[i] = places[n, b, i] - places[n, a, i]
        for i in range(3):
            shift[i] = 0.0
            for j in range(3):
                shift[i] += turns[n, a, j, i] * between[j]
                rotation[i, j] = 0.0
                for k in range(3):
                    rotation[i, j] += turns[n, a, k, i] * turns[n, b, k, j]
        for i in range(3):
            between[i] = shift[i]
            for j in range(3):
                between[i] += rotation[i, j] * solids.middles[b, j]
        gap = apart(between, solids.middles[a]) - solids.radii[a] - solids.radii[b]
        if gap < enough[q]:
            swell = solids.swells[a] + solids.swells[b]
            gap = -swell + hull_gap(
                solids.corners[solids.starts[a] : solids.starts[a + 1]],
                solids.corners[solids.starts[b] : solids.starts[b + 1]],
                none,
                rotation,
                shift,
                enough[q] + swell,
            )
        result[q] = gap
    return result


@kernel
def near_spheres(middles: Array, reaches: Array, sizes: Array, blocks: SphereBlocks):  # type: ignore[no-untyped-def]  # noqa: ANN201
    """Spheres that can be the nearest one to a solid on some stretch of its way.

    If they are spheres around obstacles, the obstacles may be as far as the spheres inside them.

    Args:
        middles: (t, 3) a point close to the solid's middle all along each stretch [m].
        reaches: (t,) largest distance of the solid's middle from it on the stretch [m].
        sizes: (t,) radius of the sphere about the middle that contains the solid [m].
        blocks: the spheres.

    Returns:
        Numbers of spheres, lists one after another, and (t + 1,) where each list begins.
    """
    centers, radii = blocks.centers, blocks.radii
    starts = np.zeros(len(middles) + 1, dtype=np.int64)
    numbers = np.empty(0, dtype=np.int64)
    limits = np.full(len(middles), np.inf)
    for fill in range(3):
        for t in range(len(middles)):
            limit, found = limits[t], starts[t]
            for block in range(len(blocks.largest)):
                if _to_block(middles[t], blocks, block) > limit:
                    continue
                for k in range(BLOCK * block, min(BLOCK * (block + 1), len(radii))):
                    radius = blocks.inner[k] if fill == 0 else radii[k]
                    distance = apart(centers[k], middles[t]) - radius
                    if fill == 0:  # the distance of the nearest one is at most this
                        limit = min(limit, distance + 2.0 * reaches[t] + sizes[t])
                    elif distance <= limit:
                        if fill == 2:
                            numbers[found] = k
                        found += 1
            limits[t] = limit
            if fill == 1:
                starts[t + 1] = found
        if fill == 1:
            numbers = np.empty(starts[-1], dtype=np.int64)
    return numbers, starts


@kernel
def _to_block(point: Array, blocks: SphereBlocks, block: int) -> float:
    """Lower bound on the distance of a point from all spheres of a block, less than zero inside."""
    total = 0.0
    for i in range(3):
        beyond = max(blocks.lows[block, i] - point[i], point[i] - blocks.highs[block, i])
        total += max(beyond, 0.0) ** 2
    return math.sqrt(total) - blocks.largest[block]
