"""Simpler convex solids around hulls of many corners, and distances of points from a hull.

Mesh simplification in trimesh and its companions moves corners to either side of the surface. Here
the simpler solid must contain the hull, so that a proof for the solid holds for the hull.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.core.arrays import Array

if TYPE_CHECKING:
    from scipy.spatial import ConvexHull

MOST_CORNERS = 250
"""Hulls with more corners are reduced: Coal refuses corners with 255 neighbours, and thousands of
corners slow it down."""
_MOST_FACES = 125  # a convex solid of k faces has at most 2 k - 4 corners
_CUTS_PER_ROUND = 4  # corners cut off before the corners of the solid are computed again
_LEAST_GAP = 1e-9  # share of the size; corners closer to the hull are not cut off
_ROUNDING = 1e-11  # share of the size by which faces are moved outwards for rounding


def reduced(corners: Array) -> Array:
    """Corners of a convex solid that contains a hull and has at most `MOST_CORNERS` corners.

    The solid starts as the box around the hull. Repeatedly, the corners farthest from the hull are
    cut off, each by the plane through the point of the hull nearest to it and normal to the line
    between them. Large flat faces of the hull become faces of the solid.

    Args:
        corners: (n, 3) corners of the hull [m].

    Returns:
        (k, 3) corners of the solid [m]; the same array if the hull has few corners.
    """
    from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

    if len(corners) <= MOST_CORNERS:
        return corners
    low, high = corners.min(axis=0), corners.max(axis=0)
    size, middle = float((high - low).max()), 0.5 * (low + high)
    inner = (corners - middle) / size
    half = 0.5 * (high - low) / size + _ROUNDING
    solid = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    planes = np.vstack([np.column_stack([sign * np.eye(3), -half]) for sign in (1.0, -1.0)])
    hull = ConvexHull(inner)
    known: dict[bytes, tuple[Array, float]] = {}
    while len(planes) < _MOST_FACES:
        for point in solid:
            if point.tobytes() not in known:
                known[point.tobytes()] = _nearest(inner, hull, point)
        nearest = [known[point.tobytes()] for point in solid]
        gaps = np.array([gap for _, gap in nearest])
        # rounded, ties by position, so that the order is the same on every machine
        order = np.lexsort((*np.round(solid, 6).T, -np.round(gaps, 7)))[
            : min(_CUTS_PER_ROUND, _MOST_FACES - len(planes))
        ]
        order = order[gaps[order] > max(_LEAST_GAP, 0.5 * gaps.max())]
        if not len(order):
            break
        normals = np.array([(solid[k] - nearest[k][0]) / nearest[k][1] for k in order])
        offsets = (normals @ inner.T).max(axis=1) + _ROUNDING
        more = np.vstack([planes, np.column_stack([normals, -offsets])])
        try:
            cut = HalfspaceIntersection(more, inner.mean(axis=0)).intersections
        except QhullError:  # a hull too thin for Qhull: the present solid contains it as well
            break
        if not np.isfinite(cut).all():
            break
        planes, solid = more, np.unique(np.round(cut, 12), axis=0)
    return solid * size + middle


def beyond(corners: Array, points: Array) -> Array:
    """Signed distances of points from a convex hull.

    Args:
        corners: (k, 3) points that span the hull [m].
        points: (n, 3) [m].

    Returns:
        (n,) distances [m], negative inside.
    """
    from scipy.spatial import ConvexHull

    hull = ConvexHull(corners)
    return np.array([_nearest(corners, hull, point)[1] for point in points])


def _nearest(corners: Array, hull: ConvexHull, point: Array) -> tuple[Array, float]:
    """The point of a hull nearest to a point, and its distance; inside: itself and minus its depth.

    The nearest point lies on a face whose outer side the point faces.
    """
    from trimesh.triangles import closest_point

    ahead = hull.equations[:, :3] @ point + hull.equations[:, 3]
    faces = corners[hull.simplices[ahead > 0.0]]
    if not len(faces):
        return point, float(ahead.max())
    points = np.broadcast_to(point, (len(faces), 3))
    touched = closest_point(faces, points)  # type: ignore[no-untyped-call]
    distances = np.linalg.norm(touched - point, axis=1)
    distances[np.isnan(distances)] = np.inf  # a sliver; its sides belong to other triangles too
    k = int(np.argmin(distances))
    return touched[k], float(distances[k])
