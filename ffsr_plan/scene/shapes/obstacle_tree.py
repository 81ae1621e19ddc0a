"""Obstacles as arrays for the compiled search: a tree of spheres around them, shapes, and zones.

A row of the tree is a sphere, or the sphere around a shape. Every shape is a box along its own axes
that is widened by a radius: exactly, or as a box around it. Zones are kept as planes and balls;
they have no end and are looked at one by one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.scene.shapes.keep_in_zones import Zone, planes_of
from ffsr_plan.scene.shapes.obstacle_shapes import Ball, ObstacleShape, placed_axes
from ffsr_plan.scene.shapes.sphere_tree import sphere_tree

SOLID_SIZE = 16
"""Numbers of a solid: rotation, row by row, middle, half sides and skin."""


class ObstacleTree(NamedTuple):
    """A binary tree over N spheres and shapes, and zones beside it.

    Attributes:
        nodes: (M, 4) centre and radius of the sphere around each node [m]; node 0 is the root.
        children: (M, 2) the two nodes below an inner node; (-1 - first, end) for a leaf, whose
            rows are first .. end - 1 of `spheres`.
        spheres: (N, 4) centre and radius of each sphere, or of that around a shape [m], in the
            order of the leaves.
        order: (N + P + B,) number in the scene of each row: of `spheres`, then of `planes`, then of
            `balls`.
        solid: (N,) row of `solids` for each row of `spheres`, -1 for spheres; without shapes it is
            empty.
        solids: (S, 16) the widened box of each shape, in world axes [m].
        planes: (P, 4) outward normals and offsets of the planes around zones [m].
        balls: (B, 4) centres and radii of the balls that are zones [m].
    """

    nodes: Array
    children: NDArray[np.int32]
    spheres: Array
    order: IntArray
    solid: NDArray[np.int32]
    solids: Array
    planes: Array
    balls: Array


def obstacle_tree(
    centers: Array,
    radii: Array,
    shapes: Sequence[ObstacleShape] = (),
    zones: Sequence[Zone] = (),
    growth: float = 0.0,
) -> ObstacleTree:
    """Build the tree. The same obstacles give the same tree.

    Args:
        centers: (n, 3) centres of the spheres [m].
        radii: (n,) their radii [m].
        shapes: the shapes.
        zones: zones that the robot stays in.
        growth: distance by which shapes are grown and zones shrunk [m].
    """
    solids, count = _solids(shapes, growth), len(radii)
    around = _around(solids)
    tree = sphere_tree(np.vstack([centers, around[:, :3]]), np.concatenate([radii, around[:, 3]]))
    solid = np.where(tree.order < count, -1, tree.order - count) if len(shapes) else np.zeros(0)
    planes, balls, numbers = np.zeros((0, 4)), np.zeros((0, 4)), list[int]()
    first = count + len(shapes)
    for k, zone in enumerate(zones):
        own = planes_of(zone)
        planes, numbers = np.vstack([planes, own]), numbers + [first + k] * len(own)
    planes[:, 3] -= growth
    for k, zone in enumerate(zones):
        if isinstance(zone, Ball):
            balls = np.vstack([balls, [*zone.position, zone.radius - growth]])
            numbers.append(first + k)
    return ObstacleTree(
        tree.nodes,
        tree.children,
        tree.spheres,
        frozen(np.concatenate([tree.order, np.array(numbers, dtype=np.int64)])),
        frozen(solid.astype(np.int32)),
        frozen(solids),
        frozen(planes),
        frozen(balls),
    )


def bounding_spheres(shapes: Sequence[ObstacleShape]) -> Array:
    """(n, 4) centre and radius of a sphere around each shape [m].

    Args:
        shapes: the shapes.
    """
    return _around(_solids(shapes, 0.0))


def _around(solids: Array) -> Array:
    """(n, 4) centre and radius of the sphere around each widened box [m]."""
    reaches = np.linalg.norm(solids[:, 12:15], axis=1) + solids[:, 15]
    return np.column_stack([solids[:, 9:12], reaches])


def _solids(shapes: Sequence[ObstacleShape], growth: float) -> Array:
    """(n, 16) the widened boxes of shapes."""
    return np.array([_solid(shape, growth) for shape in shapes]).reshape(-1, SOLID_SIZE)


def _solid(shape: ObstacleShape, growth: float) -> Array:
    """(16,) the widened box of a shape."""
    turn, middle = placed_axes(shape)
    return np.concatenate([turn.ravel(), middle, shape.half_sides, [shape.skin + growth]])
