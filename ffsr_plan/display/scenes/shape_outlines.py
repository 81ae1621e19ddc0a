"""Meshes, flat outlines and labels of obstacle shapes, from which all pictures draw them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.display.scenes.projection import convex_outline
from ffsr_plan.meshes import mesh_files
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.keep_in_zones import HalfSpace
from ffsr_plan.scene.shapes.obstacle_shapes import (
    Ball,
    Box,
    Capsule,
    Cylinder,
    Ellipsoid,
    Hull,
    ObstacleShape,
    placed_axes,
)

ROUND = 24
"""Parallels of latitude at which polygons look round."""
_THINNEST = 0.005  # half of the side of a drawn box [m], so that flat panels are visible edge-on
_TURN = np.linspace(0.0, 2.0 * np.pi, 120, endpoint=False)
_CIRCLE = np.column_stack([np.cos(_TURN), np.sin(_TURN)])
_CUBE = np.array(list(product((-1.0, 1.0), repeat=3)))
_SIDES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)  # corners of a cube's sides, counter-clockwise from outside


class Mesh(NamedTuple):
    """Triangles around a convex body.

    Attributes:
        vertices: (n, 3) in the world [m]. One on a sharp edge is there once for each side, so that
            shading by normals at vertices leaves the edge sharp.
        faces: (k, 3) vertices of each triangle, counter-clockwise from outside.
    """

    vertices: Array
    faces: IntArray

    @property
    def triangles(self) -> Array:
        """(k, 3, 3) corners of the triangles in the world [m]."""
        corners: Array = self.vertices[self.faces]
        return corners


def mesh_of(shape: ObstacleShape, rings: int = ROUND) -> Mesh:
    """The mesh of a shape; vertices of round ones lie on its surface.

    Args:
        shape: the shape, or a zone that is a box or a ball.
        rings: parallels of latitude of round shapes; twice as many meridians.
    """
    if isinstance(shape, Hull):
        corners, triangles = mesh_files.hull(shape.points, "", "")
        vertices, faces = _sharp(corners[triangles])
    elif isinstance(shape, Box):
        cube = np.maximum(shape.half_sides, _THINNEST) * _CUBE
        halves = cube[_SIDES[:, [[0, 1, 2], [0, 2, 3]]]]
        vertices, faces = _sharp(halves.reshape(-1, 3, 3))
    else:
        vertices, faces = _round(shape, max(2 * (rings // 2), 4))
    turn = rotations.matrix(shape.attitude)
    return Mesh(vertices @ turn.T + shape.position, faces)


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """One mesh of several, at least one."""
    counts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [mesh.faces + first for mesh, first in zip(meshes, counts, strict=False)]
    return Mesh(np.vstack([mesh.vertices for mesh in meshes]), np.vstack(faces))


def outline_of(shape: ObstacleShape, view: Array) -> Array:
    """Outline of a shape as it is seen in a picture.

    Args:
        shape: the shape, or a zone that is a box or a ball.
        view: (2, 3) directions to the right and upwards.

    Returns:
        (k, 2) corners, counter-clockwise [m].
    """
    if isinstance(shape, (Box, Hull)):
        return convex_outline(mesh_of(shape).vertices @ view.T)
    middle, turn = view @ shape.position, view @ rotations.matrix(shape.attitude)
    if isinstance(shape, Ellipsoid):
        stretched = turn * shape.semi_axes  # a projection of an ellipsoid is an ellipse
        corners: Array = _CIRCLE @ np.linalg.cholesky(stretched @ stretched.T).T + middle
        return corners
    if isinstance(shape, Cylinder):
        rim = shape.radius * _CIRCLE @ turn[:, :2].T
    else:
        rim = shape.skin * _CIRCLE
    lift = turn[:, 2] * shape.half_sides[2]
    return convex_outline(np.vstack([rim - lift, rim + lift]) + middle)


def shaded_sides(shape: ObstacleShape, axes: Array, light: Array) -> tuple[Array, Array]:
    """Triangles of a shape that face the viewer.

    Args:
        shape: the shape.
        axes: (3, 3) view axes, see `view_axes`.
        light: (3,) unit vector towards the light, along the view axes.

    Returns:
        (k, 3, 2) triangles in the picture [m], and (k,) how much light they get, 0 to 1.
    """
    triangles = mesh_of(shape).triangles @ axes.T
    normals = unit_normals(triangles)
    seen = normals[:, 2] > 0.0
    return triangles[seen][..., :2], np.clip(normals[seen] @ light, 0.0, 1.0)


def unit_normals(polygons: Array) -> Array:
    """(k, 3) outward normals of polygons (k, m, 3) that are counter-clockwise from outside."""
    normals = np.cross(polygons[:, 1] - polygons[:, 0], polygons[:, 2] - polygons[:, 1])
    unit: Array = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return unit


def section(shape: ObstacleShape, axes: Array, height: float) -> Array:
    """Where a plane parallel to the picture cuts a shape.

    Args:
        shape: the shape.
        axes: (3, 3) view axes, see `view_axes`.
        height: of the plane towards the viewer [m].

    Returns:
        (k, 2) corners of the cut, counter-clockwise [m]; none where the plane misses the shape.
    """
    triangles = mesh_of(shape).triangles @ axes.T
    tails, heads = triangles.reshape(-1, 3), np.roll(triangles, -1, axis=1).reshape(-1, 3)
    below, above = tails[:, 2] - height, heads[:, 2] - height
    crossing = (below < 0.0) != (above < 0.0)  # one of them may be on the plane
    share = (below[crossing] / (below[crossing] - above[crossing]))[:, None]
    points = tails[crossing] + share * (heads[crossing] - tails[crossing])
    return convex_outline(points[:, :2]) if len(points) else np.zeros((0, 2))


def points_of_extent(scene: Scene) -> Array:
    """(n, 3) points that pictures have to hold beside the spheres [m]: shapes, zones that end."""
    bodies = [*scene.shapes, *(zone for zone in scene.keep_in if not isinstance(zone, HalfSpace))]
    vertices = [mesh_of(body, 8 if len(bodies) > 100 else ROUND).vertices for body in bodies]
    return np.vstack([np.zeros((0, 3)), *vertices])


class Label(NamedTuple):
    """What is written at a shape.

    Attributes:
        text: its name; without one its number among the obstacles of the scene.
        at: (3,) its middle in the world [m].
        top: greatest z of it [m].
        is_name: whether the text is a name.
    """

    text: str
    at: Array
    top: float
    is_name: bool


def labels(scene: Scene) -> list[Label]:
    """The labels of all shapes of a scene, in order."""
    found = []
    for k, shape in enumerate(scene.shapes, start=len(scene.radii)):
        top = float(mesh_of(shape).vertices[:, 2].max())
        found.append(Label(shape.name or str(k), placed_axes(shape)[1], top, bool(shape.name)))
    return found


def _sharp(triangles: Array) -> tuple[Array, IntArray]:
    """Vertices and faces of triangles (k, 3, 3) that share no vertex."""
    return triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)


def _round(shape: ObstacleShape, rings: int) -> tuple[Array, IntArray]:
    """Vertices and faces of a shape with an axis, along its own axes; `rings` is even."""
    rise = np.linspace(-0.5 * np.pi, 0.5 * np.pi, rings + 1)
    arc = np.column_stack([np.cos(rise), np.sin(rise)])
    arc[[0, -1], 0] = 0.0
    if isinstance(shape, Cylinder):
        r, h = shape.radius, 0.5 * shape.length
        rims = np.array([[0.0, -h], [r, -h], [r, h], [0.0, h]])
        return _turned([rims[:2], rims[1:3], rims[2:]], 2 * rings)
    if isinstance(shape, Capsule):
        half, lift = rings // 2, [0.0, 0.5 * shape.length]
        ends = shape.radius * arc
        return _turned([np.vstack([ends[: half + 1] - lift, ends[half:] + lift])], 2 * rings)
    vertices, faces = _turned([arc], 2 * rings)
    if isinstance(shape, Ellipsoid):
        return vertices * shape.semi_axes, faces
    assert isinstance(shape, Ball)
    return vertices * shape.radius, faces


def _turned(profiles: Sequence[Array], count: int) -> tuple[Array, IntArray]:
    """Vertices and faces of surfaces of revolution.

    Args:
        profiles: (m, 2) distances from the z axis and heights [m], with the outside on the right
            when followed; surfaces of several meet at sharp edges.
        count: number of meridians.
    """
    turn = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    circle = np.stack([np.cos(turn), np.sin(turn), np.ones(count)], axis=1)
    vertices, faces, first = [], [], 0
    here, following = np.arange(count), np.roll(np.arange(count), -1)
    for profile in profiles:
        vertices.append((circle * profile[:, None][..., [0, 0, 1]]).reshape(-1, 3))
        for k, (low, high) in enumerate(zip(profile[:-1, 0], profile[1:, 0], strict=True)):
            below, above = first + count * k, first + count * (k + 1)
            if low > 0.0:  # at a pole, one of the two triangles is a line
                faces.append([below + here, below + following, above + following])
            if high > 0.0:
                faces.append([below + here, above + following, above + here])
        first += count * len(profile)
    return np.vstack(vertices), np.hstack(faces).T
