"""Simpler convex solids around hulls of many corners, and how far points lie beyond a hull."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.core.arrays import Array

if TYPE_CHECKING:
    from scipy.spatial import ConvexHull

MOST_CORNERS = 250
"""Coal takes no corner with 255 neighbours or more, and thousands of corners slow it down."""
_FACES = 125  # a convex solid of k faces has at most 2 k - 4 corners
_AT_ONCE = 4  # corners that are cut off before the solid is worked out again
_CLOSE = 1e-9  # of the size: nearer there is nothing to gain
_ROUNDING = 1e-11  # of the size: what faces are moved outwards for rounding


def reduced(corners: Array) -> Array:
    """The same corners (n, 3) of a hull, or those of a solid of at most 125 faces that holds it.

    From the box around the hull, the corners farthest from it are cut off again and again, each by
    the plane that touches the hull where it is nearest to the corner. A flat face that matters is
    thereby found as it is.
    """
    from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

    if len(corners) <= MOST_CORNERS:
        return corners
    low, high = corners.min(axis=0), corners.max(axis=0)
    size, middle = float((high - low).max()), 0.5 * (low + high)
    inner = (corners - middle) / size
    half = 0.5 * (high - low) / size + _ROUNDING
    found = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    planes = np.vstack([np.column_stack([sign * np.eye(3), -half]) for sign in (1.0, -1.0)])
    hull = ConvexHull(inner)
    known: dict[bytes, tuple[Array, float]] = {}
    while len(planes) < _FACES:
        for point in found:
            if point.tobytes() not in known:
                known[point.tobytes()] = _nearest(inner, hull, point)
        near = [known[point.tobytes()] for point in found]
        gaps = np.array([gap for _, gap in near])
        # coarsely, by place where equal, so that rounding on another machine changes nothing
        order = np.lexsort((*np.round(found, 6).T, -np.round(gaps, 7)))[
            : min(_AT_ONCE, _FACES - len(planes))
        ]
        order = order[gaps[order] > max(_CLOSE, 0.5 * gaps.max())]
        if not len(order):
            break
        normals = np.array([(found[k] - near[k][0]) / near[k][1] for k in order])
        offsets = (normals @ inner.T).max(axis=1) + _ROUNDING
        more = np.vstack([planes, np.column_stack([normals, -offsets])])
        try:
            cut = HalfspaceIntersection(more, inner.mean(axis=0)).intersections
        except QhullError:  # a hull too thin for it: what was found so far holds it as well
            break
        if not np.isfinite(cut).all():
            break
        planes, found = more, np.unique(np.round(cut, 12), axis=0)
    return np.asarray(found * size + middle)


def beyond(corners: Array, points: Array) -> Array:
    """(n,) signed distances of points (n, 3) from the hull of corners, negative inside."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(corners)
    return np.array([_nearest(corners, hull, point)[1] for point in points])


def _nearest(corners: Array, hull: ConvexHull, point: Array) -> tuple[Array, float]:
    """The nearest point of a hull to one outside, and its distance; of one inside, minus its depth.

    The nearest point lies on a face that the point is in front of.
    """
    from trimesh.triangles import closest_point

    ahead = hull.equations[:, :3] @ point + hull.equations[:, 3]
    faces = corners[hull.simplices[ahead > 0.0]]
    if not len(faces):
        return point, float(ahead.max())
    points = np.broadcast_to(point, (len(faces), 3))
    touched = closest_point(faces, points)  # type: ignore[no-untyped-call]
    away = np.linalg.norm(touched - point, axis=1)
    away[np.isnan(away)] = np.inf  # a sliver; its sides are those of other triangles
    k = int(np.argmin(away))
    return touched[k], float(away[k])
