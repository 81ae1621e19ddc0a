"""Lower bounds on the distance of two convex solids, for verification.

For any direction n, the gap between the projections of both solids on n is a lower bound on their
distance. The directions join two points, one of each hull, that are moved closer to each other. The
bound is valid for any direction, so it does not depend on the convergence of these points.

This is written by hand on purpose: python-fcl is the library from which Coal, the planner's, was
derived, and would not be independent of it.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.verification.solids import Shape, sphere_distance

_PRECISION = 1e-7  # [m] of the bounds, or a tenth of the distance if that is more
_MOST_FACES = 500  # hulls with more faces are finely curved: no face is large enough to help
_ROUNDS = 40  # for all configurations at once; the others then follow one at a time


def separation(a: Shape, pose_a: Array, b: Shape, pose_b: Array) -> Array:
    """Lower bound on the distance of two shapes.

    It is positive whenever the shapes are more than a micrometre apart. Boxes use the
    separating-axis theorem, spheres closed forms, all others `_gap`.

    Args:
        a: the first shape.
        pose_a: (N, 4, 4) poses of it.
        b: the second shape.
        pose_b: (N, 4, 4) poses of it.

    Returns:
        (N,) bounds [m], negative in penetration.
    """
    if len(b.points) == 1:
        each = [
            sphere_distance(a, pose_a[n : n + 1], pose_b[n : n + 1, :3, 3], np.array([b.swell]))
            for n in range(len(pose_a))
        ]
        return np.array(each)[:, 0, 0]
    if len(a.points) == 1:
        return separation(b, pose_b, a, pose_a)
    if a.half is not None and b.half is not None:
        return _boxes(a.half, pose_a, b.half, pose_b)
    to_a = np.swapaxes(pose_a[:, :3, :3], 1, 2)
    rotation = to_a @ pose_b[:, :3, :3]
    shift = np.einsum("nij,nj->ni", to_a, pose_b[:, :3, 3] - pose_a[:, :3, 3])
    best = np.full(len(shift), -np.inf)
    if len(a.points) > 2:
        best = _along_faces(a, b, rotation, shift)
    if len(b.points) > 2:
        back = np.swapaxes(rotation, 1, 2)
        best = np.maximum(best, _along_faces(b, a, back, -np.einsum("nij,nj->ni", back, shift)))
    return _gap(a.points, b.points, rotation, shift, a.swell + b.swell, best)


def _boxes(half_a: Array, pose_a: Array, half_b: Array, pose_b: Array) -> Array:
    """(N,) lower bound on the distance of two boxes by the separating-axis theorem."""
    ra, rb = pose_a[:, :3, :3], pose_b[:, :3, :3]
    between = pose_b[:, :3, 3] - pose_a[:, :3, 3]
    best = np.full(len(between), -np.inf)
    axes = [ra[:, :, k] for k in range(3)] + [rb[:, :, k] for k in range(3)]
    axes += [np.cross(ra[:, :, i], rb[:, :, j]) for i, j in product(range(3), repeat=2)]
    for axis in axes:
        size = np.linalg.norm(axis, axis=1)
        usable = size > 1e-9  # parallel edges have no cross product
        axis = axis / np.where(usable, size, 1.0)[:, None]
        extent = np.abs(np.einsum("ni,nij->nj", axis, ra)) @ half_a
        extent += np.abs(np.einsum("ni,nij->nj", axis, rb)) @ half_b
        gap = np.abs(np.sum(axis * between, axis=1)) - extent
        best = np.where(usable, np.maximum(best, gap), best)
    return best


def _along_faces(a: Shape, b: Shape, rotation: Array, shift: Array) -> Array:
    """(N,) largest distance of the second shape beyond a face of the first [m]."""
    normals, offsets = a.faces
    best = np.full(len(shift), -np.inf)
    if len(normals) > _MOST_FACES:
        return best
    for normal, offset in zip(normals, offsets, strict=True):
        nearest = np.min(normal @ rotation @ b.points.T, axis=1)
        best = np.maximum(best, nearest + shift @ normal - offset)
    return best - a.swell - b.swell


def _gap(a: Array, b: Array, rotation: Array, shift: Array, swell: float, best: Array) -> Array:
    """(N,) lower bound on the distance of hulls (n, 3) and (m, 3), less `swell`.

    Points of the second hull are `rotation` (N, 3, 3) times the given ones plus `shift` (N, 3).
    Each hull's point is a weighted mean of its corners. In turn, weight moves from the corner that
    is farthest to the one that is nearest (Mitchell, Demyanov and Malozemov).
    """
    count = len(shift)
    weights = [np.zeros((count, len(a))), np.zeros((count, len(b)))]
    weights[0][:, 0] = weights[1][:, 0] = 1.0
    open_ = np.arange(count)
    for _ in range(_ROUNDS):
        r, d = rotation[open_], shift[open_]
        wa, wb = weights[0][open_], weights[1][open_]
        between = np.einsum("nij,nj->ni", r, wb @ b) + d - wa @ a  # from the first to the second
        size = np.linalg.norm(between, axis=1)
        inward = np.einsum("nji,nj->ni", r, between)
        reach_a, reach_b = between @ a.T, inward @ b.T
        free = reach_b.min(axis=1) + np.sum(between * d, axis=1) - reach_a.max(axis=1)
        bound = free / np.maximum(size, 1e-300) - swell
        best[open_] = np.maximum(best[open_], bound)
        above, below = size - swell, best[open_]
        going = (above - below > _PRECISION) & (below < 0.9 * above) & (above > 0.0)
        if not going.any():
            break
        _shift_weight(wa, reach_a, a, size)
        between = np.einsum("nij,nj->ni", r, wb @ b) + d - wa @ a
        _shift_weight(wb, -np.einsum("nji,nj->ni", r, between) @ b.T, b, size)
        weights[0][open_], weights[1][open_] = wa, wb
        open_ = open_[going]
    else:
        for n in open_:
            moved = b @ rotation[n].T + shift[n]
            best[n] = max(best[n], _nearest_bound(a, moved) - swell)
    return best


def _nearest_bound(a: Array, b: Array) -> float:
    """A lower bound on the distance of two hulls (n, 3) and (m, 3) [m].

    Nonnegative least squares give the point nearest to the origin in the hull of a few differences
    of corners. The difference with the least projection on that point is then added to them.
    """
    from scipy.optimize import nnls

    chosen, best = [b[0] - a[0]], 0.0
    nearest = chosen[0]
    for _ in range(100):
        size = float(np.linalg.norm(nearest))
        if size < 1e-12:
            break
        difference = b[np.argmin(b @ nearest)] - a[np.argmax(a @ nearest)]
        best = max(best, float(difference @ nearest) / size)
        if size - best < 0.1 * _PRECISION:
            break
        chosen.append(difference)
        columns = np.vstack([np.array(chosen).T / size, np.ones(len(chosen))])
        weights, _ = nnls(columns, np.array([0.0, 0.0, 0.0, 1.0]))
        nearest = columns[:3] @ weights / weights.sum() * size
        chosen = [c for c, weight in zip(chosen, weights, strict=True) if weight > 0.0]
    return best


def _shift_weight(weight: Array, gain: Array, corners: Array, size: Array) -> None:
    """Move weight (N, n), in place, from the worst corner in use to the best: the optimal step."""
    rows = np.arange(len(weight))
    best = np.argmax(gain, axis=1)
    worst = np.argmin(np.where(weight > 0.0, gain, np.inf), axis=1)
    change = corners[best] - corners[worst]
    slope = gain[rows, best] - gain[rows, worst]
    square = np.sum(change * change, axis=1)
    step = np.clip(slope / np.where(square > 0.0, square, 1.0), 0.0, weight[rows, worst])
    weight[rows, worst] -= step
    weight[rows, best] += step
