"""Convex solids for verification, and their distances to spheres in closed form.

A solid is the hull of its points, widened by a radius: one point and a radius are a sphere, two a
capsule, many without a radius a polytope. The distances are plain numpy over many poses at once.
Coal and its ancestor python-fcl are not used, so that the verification is independent of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ffsr_plan.core.arrays import Array

_PAIRS_AT_ONCE = 200_000  # pairs of a point and a triangle, to limit memory use
_FACE_VALUES_AT_ONCE = 4_000_000  # pairs of a point and a face, to limit memory use
_BATCH = 64  # points measured before the bounds of the others are compared


@dataclass(frozen=True, eq=False)
class Shape:
    """A collision shape on a link.

    Attributes:
        link: name of the link.
        placement: (4, 4) pose of the shape in the link's frame.
        points: (n, 3) corners of the hull, in the shape's frame [m].
        swell: radius by which the hull is widened [m].
        half: (3,) half sides of a box [m]; None for other shapes.
    """

    link: str
    placement: Array
    points: Array
    swell: float = 0.0
    half: Array | None = None

    @cached_property
    def radius(self) -> float:
        """Radius of a sphere about the frame's origin that contains the shape [m]."""
        return float(np.linalg.norm(self.points, axis=1).max()) + self.swell

    @cached_property
    def faces(self) -> tuple[Array, Array]:
        """Outward unit normals (k, 3) and offsets (k,) of a polytope: inside is n x <= offset."""
        return self._hull[0], self._hull[1]

    @cached_property
    def triangles(self) -> Array:
        """(k, 3, 3) corners of the surface's triangles."""
        return self._hull[2]

    @cached_property
    def _hull(self) -> tuple[Array, Array, Array]:
        from scipy.spatial import ConvexHull

        hull = ConvexHull(self.points)
        return hull.equations[:, :3], -hull.equations[:, 3], self.points[hull.simplices]


def box(link: str, placement: Array, half: Array) -> Shape:
    """A box.

    Args:
        link: name of the link.
        placement: (4, 4) pose in the link's frame.
        half: (3,) half sides [m].
    """
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return Shape(link, placement, signs * half, 0.0, half)


def ball(link: str, placement: Array, radius: float) -> Shape:
    """A sphere.

    Args:
        link: name of the link.
        placement: (4, 4) pose in the link's frame.
        radius: radius [m].
    """
    return Shape(link, placement, np.zeros((1, 3)), radius)


def capsule(link: str, placement: Array, radius: float, length: float) -> Shape:
    """A capsule along z: a cylinder with a hemisphere at each end.

    Args:
        link: name of the link.
        placement: (4, 4) pose in the link's frame.
        radius: radius [m].
        length: length of the cylinder [m].
    """
    return Shape(link, placement, np.array([[0, 0, -0.5 * length], [0, 0, 0.5 * length]]), radius)


def sphere_distance(shape: Shape, placed: Array, centers: Array, radii: Array) -> Array:
    """Signed distance of a shape to spheres.

    Args:
        shape: the shape.
        placed: (N, 4, 4) poses of the shape in the world.
        centers: (K, 3) centres of the spheres [m].
        radii: (K,) radii [m].

    Returns:
        (N, K) distances [m], negative in penetration.
    """
    local = _local(placed, centers)
    if shape.half is None and len(shape.points) > 2:
        flat = local.reshape(-1, 3)
        depth = _beyond_faces(shape, flat)
        outside = depth > 0.0
        depth[outside] = _from_triangles(shape.triangles, flat[outside])
        return depth.reshape(local.shape[:2]) - shape.swell - radii
    return _simple_distance(shape, local) - shape.swell - radii


def least_sphere_distance(shape: Shape, placed: Array, centers: Array, radii: Array) -> float:
    """The least entry of `sphere_distance`, computed for few pairs of a polytope only.

    Args:
        shape: the shape.
        placed: (N, 4, 4) poses of the shape in the world.
        centers: (K, 3) centres of the spheres [m].
        radii: (K,) radii [m].

    Returns:
        The distance [m], negative in penetration.
    """
    local = _local(placed, centers)
    if shape.half is not None or len(shape.points) <= 2:
        return float(np.min(_simple_distance(shape, local) - shape.swell - radii))
    flat = local.reshape(-1, 3)
    taken = shape.swell + np.tile(radii, len(local))
    bound = _beyond_faces(shape, flat) - taken  # at most the distance, equal to it inside
    order = np.argsort(bound)
    least = np.inf
    for some in np.array_split(order, 1 + len(order) // _BATCH):
        if bound[some[0]] >= least:
            break
        depth = bound[some] + taken[some]
        outside = _from_triangles(shape.triangles, flat[some])
        least = min(least, float(np.min(np.where(depth > 0.0, outside, depth) - taken[some])))
    return least


def _local(placed: Array, centers: Array) -> Array:
    """(N, K, 3) points in the shape's frame."""
    away = centers[None] - placed[:, None, :3, 3]
    return np.einsum("nji,nkj->nki", placed[:, :3, :3], away)


def _simple_distance(shape: Shape, local: Array) -> Array:
    """Signed distance of points (..., 3) from a box, or distance from a point or segment."""
    if shape.half is not None:
        beyond = np.abs(local) - shape.half
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
        return outside + np.minimum(np.max(beyond, axis=-1), 0.0)
    return _from_segment(shape.points[0], shape.points[-1], local)


def _beyond_faces(shape: Shape, points: Array) -> Array:
    """(n,) largest distance beyond a face's plane: minus the depth inside, a bound outside [m]."""
    normals, offsets = shape.faces
    parts = np.array_split(points, 1 + len(points) * len(offsets) // _FACE_VALUES_AT_ONCE)
    return np.concatenate([np.max(part @ normals.T - offsets, axis=1) for part in parts])


def _from_segment(a: Array, b: Array, points: Array) -> Array:
    """Distance of points (..., 3) from segments (..., 3) to (..., 3)."""
    along = b - a
    square = np.sum(along * along, axis=-1)
    share = np.sum((points - a) * along, axis=-1) / np.where(square > 0.0, square, 1.0)
    nearest = a + np.clip(share, 0.0, 1.0)[..., None] * along
    return np.linalg.norm(points - nearest, axis=-1)


def _from_triangles(triangles: Array, points: Array) -> Array:
    """(n,) least distance of points (n, 3) from triangles (k, 3, 3)."""
    parts = np.array_split(points, 1 + len(points) * len(triangles) // _PAIRS_AT_ONCE)
    return np.concatenate([_nearest_triangle(triangles, part) for part in parts])


def _nearest_triangle(triangles: Array, points: Array) -> Array:
    """(n,) the same, all pairs at once."""
    corners = [triangles[:, k] for k in range(3)]
    a, b, c = corners
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    away = points[:, None]
    least = np.full((len(points), len(triangles)), np.inf)
    over = np.broadcast_to(size > 0.0, least.shape).copy()
    for begin, end in zip(corners, [b, c, a], strict=True):
        least = np.minimum(least, _from_segment(begin, end, away))
        inward = np.cross(normal, end - begin)
        over &= points @ inward.T - np.sum(begin * inward, axis=1) >= 0.0
    height = np.abs(points @ normal.T - np.sum(a * normal, axis=1)) / np.where(size > 0, size, 1.0)
    return np.min(np.where(over, np.minimum(least, height), least), axis=1)


def covers_points(shape: Shape, points: Array) -> bool:
    """Whether a shape contains points, with a tolerance of a nanometre.

    Args:
        shape: the shape.
        points: (n, 3) points in the shape's frame [m].
    """
    polytope = shape.half is None and len(shape.points) > 2
    beyond = _beyond_faces(shape, points) if polytope else _simple_distance(shape, points)
    return bool(np.all(beyond <= shape.swell + 1e-9))


def covers_cylinder(shape: Shape, radius: float, length: float) -> bool:
    """Whether a shape contains the cylinder about z of its frame, to a nanometre.

    A polytope does if no face cuts the cylinder. A capsule does if it has the cylinder's axis and
    contains its rims.

    Args:
        shape: the shape.
        radius: radius of the cylinder [m].
        length: its length [m].
    """
    if len(shape.points) > 2:
        normals, offsets = shape.faces
        rim = radius * np.hypot(normals[:, 0], normals[:, 1]) + 0.5 * length * np.abs(normals[:, 2])
        return bool(np.all(rim <= offsets + shape.swell + 1e-9))
    if np.abs(shape.points[:, :2]).max() > 1e-9:
        return False
    rims = np.array([[radius, 0.0, -0.5 * length], [radius, 0.0, 0.5 * length]])
    return covers_points(shape, rims)
