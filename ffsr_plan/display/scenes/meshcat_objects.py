"""Meshcat objects (solids, meshes, spheres, ribbons, lines) and a log of meshcat commands."""

from __future__ import annotations

import base64
from typing import Any, TypeAlias

import coal
import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array, IntArray

MeshcatNode: TypeAlias = Any
"""A node of meshcat's tree; meshcat has no types."""
MeshcatObject: TypeAlias = Any
"""A geometry, material or mesh of meshcat."""


class CommandLog:
    """Replacement of meshcat's window that keeps the commands in order instead of sending them.

    meshcat derives the names of its objects from the time and the machine. Here they are numbers,
    so that equal plans give equal pages.

    Attributes:
        commands: packed by msgpack and encoded as base64, ready for the page's script.
    """

    def __init__(self) -> None:
        self.commands: list[str] = []
        self._names: dict[str, str] = {}

    def send(self, command: MeshcatObject) -> None:
        """Keep a command, packed as meshcat would send it."""
        import umsgpack

        packed = umsgpack.packb(self._renumber(command.lower()))
        self.commands.append(base64.b64encode(packed).decode())

    def _renumber(self, value: MeshcatObject) -> MeshcatObject:
        """The same part of a command with numbered names."""
        if isinstance(value, dict):
            return {key: self._entry(key, entry) for key, entry in value.items()}
        if isinstance(value, list):
            return [self._renumber(entry) for entry in value]
        return value

    def _entry(self, key: str, value: MeshcatObject) -> MeshcatObject:
        if key not in ("uuid", "geometry", "material") or not isinstance(value, str):
            return self._renumber(value)
        return self._names.setdefault(value, f"n{len(self._names)}")


def solids(shape: pin.GeometryObject) -> list[tuple[MeshcatObject, Array]]:
    """Meshcat geometries of a shape, each with its placement (4, 4) in the shape's frame."""
    import meshcat.geometry as mg

    solid = shape.geometry
    if isinstance(solid, coal.Box):
        return [(mg.Box([float(2.0 * h) for h in solid.halfSide]), np.eye(4))]
    if isinstance(solid, coal.Sphere):
        return [(sphere(float(solid.radius)), np.eye(4))]
    if isinstance(solid, (coal.Cylinder, coal.Capsule)):
        upright = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1.0]])  # y to z
        half, radius = float(solid.halfLength), float(solid.radius)
        parts = [(mg.Cylinder(2.0 * half, radius), upright)]
        if isinstance(solid, coal.Capsule):
            parts += [(sphere(radius), _translation([0.0, 0.0, z])) for z in (-half, half)]
        return parts
    if isinstance(solid, coal.Convex):
        corners = np.array(solid.points())
        faces = [solid.polygons(k) for k in range(solid.num_polygons)]
        corners = corners[[[t[0], t[1], t[2]] for t in faces]].reshape(-1, 3)  # for sharp edges
        triangles = np.arange(len(corners)).reshape(-1, 3)
        return [(mg.TriangularMeshGeometry(corners, triangles), np.eye(4))]
    faces = [solid.tri_indices(k) for k in range(solid.num_tris)]
    triangles = np.array([[t[0], t[1], t[2]] for t in faces])
    vertices = np.array(solid.vertices()) * np.asarray(shape.meshScale)
    return [(mg.TriangularMeshGeometry(vertices, triangles), np.eye(4))]


def instances(centers: Array, radii: Array, rings: int, material: MeshcatObject) -> MeshcatObject:
    """Many spheres as instances of one, so that thousands are drawn in one call.

    Args:
        centers: (N, 3) [m].
        radii: (N,) [m].
        rings: parallels of latitude of the triangulated sphere.
        material: of all spheres.
    """
    import meshcat.geometry as mg

    class Instances(mg.Mesh):  # type: ignore[misc]  # three.js reads this type, meshcat lacks it
        _type = "InstancedMesh"

        def lower(self) -> MeshcatObject:
            placed = np.zeros((len(radii), 4, 4))
            placed[:, [0, 1, 2], [0, 1, 2]] = radii[:, None]
            placed[:, 3, :3], placed[:, 3, 3] = centers, 1.0  # by columns
            data = super().lower()
            data["object"] |= {
                "count": len(radii),
                "instanceMatrix": {"array": np.round(placed, 6).ravel().tolist()},
                "frustumCulled": False,  # three.js would test the one sphere at the origin
            }
            return data

    return Instances(sphere(1.0, rings), material)


def ribbon(segments: Array, widths: Array, colours: Array, up: Array) -> MeshcatObject:
    """One mesh of flat quadrilaterals along segments.

    Args:
        segments: (k, 2, 3) ends [m].
        widths: (k,) [m].
        colours: (k, 3) red, green, blue in [0, 1].
        up: (3,) unit vector that the quadrilaterals face.
    """
    import meshcat.geometry as mg

    along = segments[:, 1] - segments[:, 0]
    sideways = np.cross(up, along)
    size = np.linalg.norm(sideways, axis=1, keepdims=True)
    sideways = 0.5 * widths[:, None] * sideways / np.maximum(size, 1e-9)
    corners = np.stack(
        [
            segments[:, 0] - sideways,
            segments[:, 0] + sideways,
            segments[:, 1] + sideways,
            segments[:, 1] - sideways,
        ],
        axis=1,
    )
    first = 4 * np.arange(len(segments))[:, None]
    faces = np.concatenate([first + np.array(corner) for corner in ([0, 1, 2], [0, 2, 3])])
    return mg.TriangularMeshGeometry(
        corners.reshape(-1, 3), faces, color=np.repeat(colours, 4, axis=0)
    )


def triangle_mesh(vertices: Array, faces: IntArray) -> MeshcatObject:
    """A mesh of triangles, shaded by normals at its vertices.

    Args:
        vertices: (n, 3) [m].
        faces: (k, 3) vertices of each triangle, counter-clockwise from outside.
    """
    import meshcat.geometry as mg

    return mg.TriangularMeshGeometry(vertices, faces)


def lines(segments: Array, material: MeshcatObject) -> MeshcatObject:
    """Lines one pixel wide along segments (k, 2, 3) [m]."""
    import meshcat.geometry as mg

    return mg.LineSegments(mg.PointsGeometry(segments.reshape(-1, 3).T), material)


def sphere(radius: float, rings: int = 28) -> MeshcatObject:
    """A sphere of radius [m] with `rings` parallels of latitude."""
    import meshcat.geometry as mg

    class Sphere(mg.Sphere):  # type: ignore[misc]  # meshcat has no types
        def lower(self, object_data: MeshcatObject) -> MeshcatObject:
            return super().lower(object_data) | {
                "widthSegments": rings * 10 // 7,
                "heightSegments": rings,
            }

    return Sphere(radius)


def _translation(vector: ArrayLike) -> Array:
    placement = np.eye(4)
    placement[:3, 3] = vector
    return placement
