"""How far apart two convex solids are, for verification: lower bounds that hold by themselves.

For any direction n, what the one solid reaches along n and the other leaves free is a lower bound
on their distance. Directions come from bringing two points, one of each hull, closer to each other;
whatever these do, the bound is sound.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.verification.solids import Shape, sphere_distance

_FINE = 1e-7  # bounds are sharp to this [m], or to a tenth of the distance
_MANY = 500
_ROUNDS = 40  # of all configurations at once, before the rest is taken one by one


def separation(a: Shape, pose_a: Array, b: Shape, pose_b: Array) -> Array:
    """(N,) lower bound on the distance of two shapes at poses (N, 4, 4).

    Positive whenever they are apart by more than a micrometre. Boxes by the separating-axis
    theorem, spheres in closed form, all others by `_gap`.
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
    turn = np.swapaxes(pose_a[:, :3, :3], 1, 2)
    rotation = turn @ pose_b[:, :3, :3]
    shift = np.einsum("nij,nj->ni", turn, pose_b[:, :3, 3] - pose_a[:, :3, 3])
    best = np.full(len(shift), -np.inf)
    if len(a.points) > 2:
        best = _along_faces(a, b, rotation, shift)
    if len(b.points) > 2:
        back = np.swapaxes(rotation, 1, 2)
        best = np.maximum(best, _along_faces(b, a, back, -np.einsum("nij,nj->ni", back, shift)))
    return _gap(a.points, b.points, rotation, shift, a.swell + b.swell, best)


def _boxes(half_a: Array, pose_a: Array, half_b: Array, pose_b: Array) -> Array:
    ra, rb = pose_a[:, :3, :3], pose_b[:, :3, :3]
    apart = pose_b[:, :3, 3] - pose_a[:, :3, 3]
    best = np.full(len(apart), -np.inf)
    axes = [ra[:, :, k] for k in range(3)] + [rb[:, :, k] for k in range(3)]
    axes += [np.cross(ra[:, :, i], rb[:, :, j]) for i, j in product(range(3), repeat=2)]
    for axis in axes:
        size = np.linalg.norm(axis, axis=1)
        usable = size > 1e-9  # parallel edges span no axis of their own
        axis = axis / np.where(usable, size, 1.0)[:, None]
        reach = np.abs(np.einsum("ni,nij->nj", axis, ra)) @ half_a
        reach += np.abs(np.einsum("ni,nij->nj", axis, rb)) @ half_b
        gap = np.abs(np.sum(axis * apart, axis=1)) - reach
        best = np.where(usable, np.maximum(best, gap), best)
    return best


def _along_faces(a: Shape, b: Shape, rotation: Array, shift: Array) -> Array:
    """(N,) how far the second shape lies beyond a face of the first: sharp where faces are near."""
    normals, offsets = a.faces
    best = np.full(len(shift), -np.inf)
    if len(normals) > _MANY:  # finely curved: no face is large enough to matter
        return best
    for normal, offset in zip(normals, offsets, strict=True):
        reach = np.min(normal @ rotation @ b.points.T, axis=1)
        best = np.maximum(best, reach + shift @ normal - offset)
    return best - a.swell - b.swell


def _gap(a: Array, b: Array, rotation: Array, shift: Array, swell: float, best: Array) -> Array:
    """(N,) lower bound on the distance of hulls (n, 3) and (m, 3), less `swell`.

    Points of the second hull are `rotation` (N, 3, 3) times the given ones plus `shift` (N, 3).
    Each hull's point is a mean of its corners; in turn, weight moves from the corner that holds it
    back most to the one that brings it nearest (Mitchell, Demyanov and Malozemov).
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
        going = (above - below > _FINE) & (below < 0.9 * above) & (above > 0.0)
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
    """The distance of two hulls (n, 3) and (m, 3), from below.

    The point nearest to the origin in the hull of a few differences of corners, by nonnegative
    least squares; then the difference that lies farthest against it joins them.
    """
    from scipy.optimize import nnls

    chosen, best = [b[0] - a[0]], 0.0
    nearest = chosen[0]
    for _ in range(100):
        size = float(np.linalg.norm(nearest))
        if size < 1e-12:
            break
        to, since = b[np.argmin(b @ nearest)], a[np.argmax(a @ nearest)]
        best = max(best, float((to - since) @ nearest) / size)
        if size - best < 0.1 * _FINE:
            break
        chosen.append(to - since)
        columns = np.vstack([np.array(chosen).T / size, np.ones(len(chosen))])
        weights, _ = nnls(columns, np.array([0.0, 0.0, 0.0, 1.0]))
        nearest = columns[:3] @ weights / weights.sum() * size
        chosen = [c for c, weight in zip(chosen, weights, strict=True) if weight > 0.0]
    return best


def _shift_weight(weight: Array, gain: Array, corners: Array, size: Array) -> None:
    """Move weight (N, n), in place, from the worst corner in use to the best, as far as it pays."""
    rows = np.arange(len(weight))
    to = np.argmax(gain, axis=1)
    since = np.argmin(np.where(weight > 0.0, gain, np.inf), axis=1)
    change = corners[to] - corners[since]
    slope = gain[rows, to] - gain[rows, since]
    square = np.sum(change * change, axis=1)
    step = np.clip(slope / np.where(square > 0.0, square, 1.0), 0.0, weight[rows, since])
    weight[rows, since] -= step
    weight[rows, to] += step
