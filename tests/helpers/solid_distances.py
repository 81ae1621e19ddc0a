"""Distances of the verification's solids: to spheres by plain numpy, of pairs by its kernel."""

import numpy as np
from scipy.spatial import ConvexHull

from ffsr_plan.verification.distances.solid_distance_kernels import pair_distances
from ffsr_plan.verification.separation import arrays_of

PAIRS_AT_ONCE = 200_000  # pairs of a point and a triangle, to limit memory use


def sphere_distance(shape, placed, centers, radii):
    """(N, K) signed distances of a shape at poses (N, 4, 4) to K spheres [m]."""
    away = centers[None] - placed[:, None, :3, 3]
    local = np.einsum("nji,nkj->nki", placed[:, :3, :3], away)
    if shape.half is not None:
        beyond = np.abs(local) - shape.half
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
        distance = outside + np.minimum(np.max(beyond, axis=-1), 0.0)
    elif len(shape.points) > 2:
        distance = _from_hull(shape.points, local.reshape(-1, 3)).reshape(local.shape[:2])
    else:
        distance = _from_segment(shape.points[0], shape.points[-1], local)
    return distance - shape.swell - radii


def least_sphere_distance(shape, placed, centers, radii):
    """The least entry of `sphere_distance` [m]."""
    return float(sphere_distance(shape, placed, centers, radii).min())


def separation(a, pose_a, b, pose_b):
    """(N,) lower bounds on the signed distance of two shapes at poses (N, 4, 4) [m]."""
    count = len(pose_a)
    poses = np.stack([pose_a, pose_b], axis=1)
    return pair_distances(
        arrays_of([a, b]),
        np.column_stack([np.arange(count), np.zeros(count, dtype=np.int64)]),
        np.array([[0, 1]]),
        np.ascontiguousarray(poses[..., :3, :3]),
        np.ascontiguousarray(poses[..., :3, 3]),
        np.full(count, np.inf),
    )


def _from_hull(corners, points):
    """(n,) signed distance of points (n, 3) from the hull of corners."""
    hull = ConvexHull(corners)
    depth = np.max(points @ hull.equations[:, :3].T + hull.equations[:, 3], axis=1)
    outside = depth > 0.0
    rest, triangles = points[outside], corners[hull.simplices]
    parts = np.array_split(rest, 1 + len(rest) * len(triangles) // PAIRS_AT_ONCE)
    depth[outside] = np.concatenate([_nearest_triangle(triangles, part) for part in parts])
    return depth


def _from_segment(a, b, points):
    """Distance of points (..., 3) from segments (..., 3) to (..., 3)."""
    along = b - a
    square = np.sum(along * along, axis=-1)
    share = np.sum((points - a) * along, axis=-1) / np.where(square > 0.0, square, 1.0)
    nearest = a + np.clip(share, 0.0, 1.0)[..., None] * along
    return np.linalg.norm(points - nearest, axis=-1)


def _nearest_triangle(triangles, points):
    """(n,) least distance of points (n, 3) from triangles (k, 3, 3)."""
    corners = [triangles[:, k] for k in range(3)]
    a, b, c = corners
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    least = np.full((len(points), len(triangles)), np.inf)
    over = np.broadcast_to(size > 0.0, least.shape).copy()
    for begin, end in zip(corners, [b, c, a], strict=True):
        least = np.minimum(least, _from_segment(begin, end, points[:, None]))
        inward = np.cross(normal, end - begin)
        over &= points @ inward.T - np.sum(begin * inward, axis=1) >= 0.0
    height = np.abs(points @ normal.T - np.sum(a * normal, axis=1)) / np.where(size > 0, size, 1.0)
    return np.min(np.where(over, np.minimum(least, height), least), axis=1)
