"""Obstacle shapes and keep-in zones as arrays that compiled functions read.

A shape is the hull of a few points along its own axes, to which an ellipsoid is added (Minkowski
sum) and which is widened by a radius: a capsule is a segment and a radius, a cylinder a segment and
a disc, an ellipsoid one point and itself. Only sizes, positions and attitudes are read from the
scene, none of what the planner derives from them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.scene.shapes.keep_in_zones import HalfSpace, Zone
from ffsr_plan.scene.shapes.obstacle_shapes import (
    Ball,
    Box,
    Capsule,
    Cylinder,
    Ellipsoid,
    Hull,
    ObstacleShape,
)
from ffsr_plan.verification.distances.sphere_blocks import SphereBlocks, sphere_blocks

BOX, CYLINDER, OTHER = 0, 1, 2
"""Kinds of shapes: widened boxes (capsules and balls too), cylinders, and others."""


class ShapeArrays(NamedTuple):
    """S shapes: the hull of points, with an ellipsoid added, widened by a radius.

    Attributes:
        kinds: (S,) `BOX`, `CYLINDER` or `OTHER`; a point's distance from the first two is a short
            closed form.
        corners: (n, 3) points of all shapes, one shape after another, along their own axes [m].
        starts: (S + 1,) first point of each shape, and n.
        semi_axes: (S, 3) of the ellipsoids that are added, along the same axes; zeros for none [m].
        skins: (S,) radii by which the shapes are widened [m].
        halves: (S, 3) half sides of the box about the middle that contains the shape without its
            skin, along the same axes [m].
        turns: (S, 3, 3) rotations of the axes, world axes.
        middles: (S, 3) the origins of the axes [m].
        radii: (S,) radius of the sphere about the middle that contains the shape [m].
    """

    kinds: IntArray
    corners: Array
    starts: IntArray
    semi_axes: Array
    skins: Array
    halves: Array
    turns: Array
    middles: Array
    radii: Array


class ZoneArrays(NamedTuple):
    """Planes and balls around zones.

    Attributes:
        planes: (p, 4) outward unit normals, and how far along them the planes lie [m].
        balls: (b, 4) centres and radii [m].
        plane_zones: (p,) number of the zone of each plane.
        ball_zones: (b,) number of the zone that is each ball.
    """

    planes: Array
    balls: Array
    plane_zones: IntArray
    ball_zones: IntArray

    def only(self, zone: int) -> ZoneArrays:
        """The arrays of one zone."""
        flat: Flags = self.plane_zones == zone
        round_: Flags = self.ball_zones == zone
        return ZoneArrays(
            self.planes[flat], self.balls[round_], self.plane_zones[flat], self.ball_zones[round_]
        )


class _Body(NamedTuple):
    """One shape, along its own axes through its middle; see `ShapeArrays`.

    Attributes:
        kind: its kind.
        corners: (n, 3) [m].
        semi_axes: (3,) [m].
        skin: [m].
        middle: (3,) from the shape's own origin [m].
        reach: radius of the sphere about the middle that contains it without its skin [m].
        inner: radius of a sphere about the middle inside it without its skin [m].
    """

    kind: int
    corners: Array
    semi_axes: Array
    skin: float
    middle: Array
    reach: float
    inner: float


def shape_arrays(
    shapes: Sequence[ObstacleShape], growth: float, origin: Array
) -> tuple[ShapeArrays, SphereBlocks]:
    """Put shapes into arrays.

    Args:
        shapes: the shapes.
        growth: distance by which they are grown on all sides [m].
        origin: (3,) point from which middles are counted, world [m].

    Returns:
        The shapes, and the spheres around them in blocks.
    """
    bodies = [_body(shape) for shape in shapes]
    turns = np.array([rotation(shape.attitude) for shape in shapes]).reshape(-1, 3, 3)
    places = np.array([shape.position - origin for shape in shapes]).reshape(-1, 3)
    inside = np.array([body.middle for body in bodies]).reshape(-1, 3)
    semi_axes = np.array([body.semi_axes for body in bodies]).reshape(-1, 3)
    farthest = [np.abs(body.corners).max(axis=0) for body in bodies]
    skins = np.array([body.skin + growth for body in bodies])
    arrays = ShapeArrays(
        kinds=np.array([body.kind for body in bodies], dtype=np.int64),
        corners=np.vstack([np.zeros((0, 3)), *(body.corners for body in bodies)]),
        starts=np.cumsum([0, *(len(body.corners) for body in bodies)], dtype=np.int64),
        semi_axes=semi_axes,
        skins=skins,
        halves=np.array(farthest).reshape(-1, 3) + semi_axes,
        turns=turns,
        middles=places + np.einsum("sij,sj->si", turns, inside),
        radii=np.array([body.reach for body in bodies]) + skins,
    )
    inner = np.array([body.inner for body in bodies]) + skins
    return arrays, sphere_blocks(arrays.middles, arrays.radii, inner)


def _body(shape: ObstacleShape) -> _Body:
    none = np.zeros(3)
    if isinstance(shape, Box):
        half = 0.5 * shape.size
        signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        corners = np.unique(signs * half, axis=0)  # fewer than eight if it is flat
        reach = float(np.linalg.norm(half))
        return _Body(BOX, corners, none, 0.0, none, reach, float(half.min()))
    if isinstance(shape, Ball):
        return _Body(BOX, np.zeros((1, 3)), none, shape.radius, none, 0.0, 0.0)
    if isinstance(shape, Capsule):
        ends, half_length = _segment(shape.length)
        return _Body(BOX, ends, none, shape.radius, none, half_length, 0.0)
    if isinstance(shape, Cylinder):
        ends, half_length = _segment(shape.length)
        disc, reach = (
            np.array([shape.radius, shape.radius, 0.0]),
            np.hypot(shape.radius, half_length),
        )
        inner = min(shape.radius, half_length)
        return _Body(CYLINDER, ends, disc, 0.0, none, float(reach), inner)
    if isinstance(shape, Ellipsoid):
        longest, shortest = float(shape.semi_axes.max()), float(shape.semi_axes.min())
        return _Body(OTHER, np.zeros((1, 3)), shape.semi_axes, 0.0, none, longest, shortest)
    if isinstance(shape, Hull):
        middle = np.mean(shape.points, axis=0)  # lies inside, unlike that of the box around it
        corners = shape.points - middle
        reach = float(np.linalg.norm(corners, axis=1).max())
        return _Body(OTHER, corners, none, 0.0, middle, reach, 0.0)
    raise TypeError(f"no distances from a {type(shape).__name__}")


def _segment(length: float) -> tuple[Array, float]:
    """Ends (2, 3) of a segment along z [m], and half its length [m]."""
    half = 0.5 * length
    return np.array([[0.0, 0.0, -half], [0.0, 0.0, half]]), half


def zone_arrays(zones: Sequence[Zone], growth: float, origin: Array) -> ZoneArrays:
    """Put zones into arrays.

    Args:
        zones: the zones.
        growth: distance by which they are shrunk [m].
        origin: (3,) point from which places are counted, world [m].
    """
    planes, balls = np.zeros((0, 4)), np.zeros((0, 4))
    plane_zones, ball_zones = list[int](), list[int]()
    for k, zone in enumerate(zones):
        middle = zone.position - origin
        if isinstance(zone, Ball):
            balls = np.vstack([balls, [*middle, zone.radius - growth]])
            ball_zones.append(k)
            continue
        if isinstance(zone, HalfSpace):
            normals, reach = zone.direction[None] / np.linalg.norm(zone.direction), np.zeros(1)
        else:
            axes = rotation(zone.attitude).T
            normals, reach = np.vstack([axes, -axes]), 0.5 * np.tile(zone.size, 2)
        offsets = normals @ middle + reach - growth
        planes = np.vstack([planes, np.column_stack([normals, offsets])])
        plane_zones += [k] * len(normals)
    return ZoneArrays(
        planes,
        balls,
        np.array(plane_zones, dtype=np.int64),
        np.array(ball_zones, dtype=np.int64),
    )


def rotation(quat_xyzw: Array) -> Array:
    """The matrix of a rotation.

    Args:
        quat_xyzw: (4,) unit quaternion.

    Returns:
        (3, 3); its columns are the rotated unit vectors.
    """
    vector, scalar = quat_xyzw[:3], float(quat_xyzw[3])
    turned = np.cross(vector, np.eye(3))
    rows: Array = np.eye(3) + 2.0 * (scalar * turned + np.cross(vector, turned))
    return rows.T.copy()
