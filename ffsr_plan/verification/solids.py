"""Convex solids for verification, and whether they contain what they replace.

A solid is the hull of its points, widened by a radius: one point and a radius are a sphere, two a
capsule, many without a radius a polytope.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ffsr_plan.core.arrays import Array

_FACE_VALUES_AT_ONCE = 4_000_000  # pairs of a point and a face, to limit memory use


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
    def faces(self) -> tuple[Array, Array]:
        """Outward unit normals (k, 3) and offsets (k,) of a polytope: inside is n x <= offset."""
        from scipy.spatial import ConvexHull

        equations = ConvexHull(self.points).equations
        return equations[:, :3], -equations[:, 3]


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


def covers_points(shape: Shape, points: Array) -> bool:
    """Whether a capsule or a polytope contains points, with a tolerance of a nanometre.

    Args:
        shape: the solid.
        points: (n, 3) points in the shape's frame [m].
    """
    if len(shape.points) > 2:
        beyond = _beyond_faces(shape, points)
    else:
        beyond = _from_segment(shape.points[0], shape.points[-1], points)
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
