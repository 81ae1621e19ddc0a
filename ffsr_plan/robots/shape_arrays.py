"""Collision shapes as arrays for the compiled search.

A sphere is a segment of length zero with a radius, a capsule a segment with a radius, a box is a
box: for these the distance to a sphere is a short closed form. A convex hull is represented by the
box around it: the search then returns a lower bound, and Coal measures the distance.
"""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import coal
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ffsr_plan.core.arrays import Array, Flags, IntArray, frozen

ROUND, BOX = 0, 1


class Primitives(NamedTuple):
    """The g collision shapes of a robot, in the order of its geometry model.

    Attributes:
        kinds: (g,) ROUND (a segment along z with a radius) or BOX.
        sizes: (g, 3) radius, half length and zero of round shapes; half sides of boxes [m].
        exact: (g,) whether kind and size describe the shape itself, not only a box around it.
        links: (g,) the link of the shape, numbered as in `kinematics`.
        rotations: (g, 3, 3) shape axes to link axes.
        positions: (g, 3) origin of the shape in the link's frame [m].
        corners: (g,) number of `hull_points` of each shape.
        points: (P, 3) all of them, in the frames of the links [m].
    """

    kinds: NDArray[np.int64]
    sizes: Array
    exact: Flags
    links: IntArray
    rotations: Array
    positions: Array
    corners: IntArray
    points: Array


def primitives(geometry: pin.GeometryModel) -> Primitives:
    """Collision shapes of a geometry model as arrays.

    Args:
        geometry: spheres, capsules, boxes and convex hulls.
    """
    shapes = list(geometry.geometryObjects)
    described = [_describe(shape.geometry) for shape in shapes]
    corners = [hull_points(shape) for shape in shapes]
    return Primitives(
        frozen(np.array([kind for kind, _, _ in described], dtype=np.int64)),
        frozen(np.array([size for _, size, _ in described], dtype=np.float64).reshape(-1, 3)),
        frozen(np.array([exact for _, _, exact in described], dtype=np.bool_)),
        frozen(np.array([shape.parentJoint - 1 for shape in shapes], dtype=np.int64)),
        frozen(np.array([s.placement.rotation for s in shapes]).reshape(-1, 3, 3)),
        frozen(np.array([s.placement.translation for s in shapes]).reshape(-1, 3)),
        frozen(np.array([len(each) for each in corners], dtype=np.int64)),
        frozen(np.concatenate([np.zeros((0, 3)), *corners])),
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


def hull_points(geometry: pin.GeometryObject) -> Array:
    """Points whose convex hull, widened by a sphere's or capsule's radius, contains the shape.

    Args:
        geometry: a collision shape on its link.

    Returns:
        (N, 3) points in the frame of the link [m].
    """
    shape, placement = geometry.geometry, geometry.placement
    if isinstance(shape, coal.Sphere):
        local = np.zeros((1, 3))
    elif isinstance(shape, coal.Capsule):
        local = np.array([[0.0, 0.0, -shape.halfLength], [0.0, 0.0, shape.halfLength]])
    else:  # boxes and hulls: the corners of the bounding box along their own axes
        shape.computeLocalAABB()
        box = np.array([shape.aabb_local.min_, shape.aabb_local.max_])
        local = np.array(list(product(*box.T)))
    points: Array = local @ placement.rotation.T + placement.translation
    return points
