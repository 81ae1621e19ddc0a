"""How far convex bodies extend along directions, exactly: by their support functions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.scene.shapes.obstacle_shapes import Cylinder, Ellipsoid, Hull, ObstacleShape


def extents(shapes: Sequence[ObstacleShape], axes: Array | None = None) -> Array:
    """Least and greatest coordinates of shapes.

    Args:
        shapes: the shapes, or zones that are boxes and balls.
        axes: (d, 3) unit vectors along which the coordinates count; those of the world without any.

    Returns:
        (n, 2, d) [m].
    """
    along = np.eye(3) if axes is None else axes
    found = [_extent(shape, along) for shape in shapes]
    return np.array(found).reshape(-1, 2, len(along))


def _extent(shape: ObstacleShape, axes: Array) -> Array:
    """(2, d) least and greatest coordinates of a shape along axes (d, 3) [m]."""
    local = axes @ rotations.matrix(shape.attitude)
    place = axes @ shape.position
    if isinstance(shape, Hull):
        points = local @ shape.points.T
        return np.stack([place + points.min(axis=1), place + points.max(axis=1)])
    if isinstance(shape, Ellipsoid):
        reach = np.linalg.norm(local * shape.semi_axes, axis=1)
    elif isinstance(shape, Cylinder):
        aside = np.linalg.norm(local[:, :2], axis=1)
        reach = shape.radius * aside + 0.5 * shape.length * np.abs(local[:, 2])
    else:
        reach = np.abs(local) @ shape.half_sides + shape.skin
    return np.stack([place - reach, place + reach])


def bounds_of(
    centers: Array, radii: Array, shapes: Sequence[ObstacleShape], growth: float
) -> Array:
    """Least and greatest coordinates of spheres and shapes.

    Args:
        centers: (n, 3) of the spheres [m].
        radii: (n,) of the spheres [m].
        shapes: the shapes.
        growth: distance by which the shapes are grown [m].

    Returns:
        (2, 3) [m]; (0, 3) without any.
    """
    ends = extents(shapes)
    low = np.vstack([centers - radii[:, None], ends[:, 0] - growth])
    high = np.vstack([centers + radii[:, None], ends[:, 1] + growth])
    return np.stack([low.min(axis=0), high.max(axis=0)]) if len(low) else np.zeros((0, 3))
