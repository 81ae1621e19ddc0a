"""The robot's collision shapes as arrays, in the terms that the compiled search understands.

A ball is a segment of length zero with a radius, a capsule a segment with a radius, a box is a box;
for these the distance to a sphere is a short closed form. A convex hull is represented by the box
around it: what the search finds for it is a lower bound, and Coal decides.
"""

from __future__ import annotations

from typing import NamedTuple

import coal
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ffsr_plan.core.arrays import Array, Flags, IntArray, frozen

ROUND, BOX = 0, 1


class Primitives(NamedTuple):
    """Collision shapes (g), in the order of the geometry model."""

    kinds: NDArray[np.int64]
    """(g,) ROUND (a segment along z with a radius) or BOX."""
    sizes: Array
    """(g, 3) radius, half length and zero, or half sides [m]."""
    exact: Flags
    """(g,) whether kind and size describe the shape itself, not only something around it."""
    links: IntArray
    """(g,) the link that carries the shape, numbered as in `kinematics`."""
    rotations: Array
    """(g, 3, 3) shape axes to link axes."""
    positions: Array
    """(g, 3) of the shape in the link's frame [m]."""


def primitives(geometry: pin.GeometryModel) -> Primitives:
    """The collision shapes of a geometry model."""
    shapes = list(geometry.geometryObjects)
    described = [_describe(shape.geometry) for shape in shapes]
    return Primitives(
        frozen(np.array([kind for kind, _, _ in described], dtype=np.int64)),
        frozen(np.array([size for _, size, _ in described], dtype=np.float64).reshape(-1, 3)),
        frozen(np.array([exact for _, _, exact in described], dtype=np.bool_)),
        frozen(np.array([shape.parentJoint - 1 for shape in shapes], dtype=np.int64)),
        frozen(np.array([s.placement.rotation for s in shapes]).reshape(-1, 3, 3)),
        frozen(np.array([s.placement.translation for s in shapes]).reshape(-1, 3)),
    )


def _describe(solid: coal.CollisionGeometry) -> tuple[int, tuple[float, ...], bool]:
    if isinstance(solid, coal.Sphere):
        return ROUND, (solid.radius, 0.0, 0.0), True
    if isinstance(solid, coal.Capsule):
        return ROUND, (solid.radius, solid.halfLength, 0.0), True
    if isinstance(solid, coal.Box):
        return BOX, tuple(solid.halfSide), True
    points = np.array([solid.point(k) for k in range(solid.num_points)])
    return BOX, tuple(np.abs(points).max(axis=0)), False
