"""Meshcat objects: solids, spheres by the thousand, ribbons; and a log of the commands."""

from __future__ import annotations

import base64
from typing import Any

import coal
import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import Array


class CommandLog:
    """Stands in for meshcat's window: keeps the commands, in order, instead of sending them.

    meshcat names its objects by the clock and the machine; here they are numbered, so that the same
    plan gives the same page.
    """

    def __init__(self) -> None:
        self.commands: list[str] = []
        self._names: dict[str, str] = {}

    def send(self, command: Any) -> None:  # noqa: ANN401 - meshcat has no types
        """Keep a command, packed as meshcat would send it."""
        import umsgpack

        packed = umsgpack.packb(self._renumber(command.lower()))
        self.commands.append(base64.b64encode(packed).decode())

    def _renumber(self, value: Any) -> Any:  # noqa: ANN401 - any part of a command
        if isinstance(value, dict):
            return {key: self._name(entry) if key in ("uuid", "geometry", "material")
                    and isinstance(entry, str) else self._renumber(entry)
                    for key, entry in value.items()}  # fmt: skip
        if isinstance(value, list):
            return [self._renumber(entry) for entry in value]
        return value

    def _name(self, uuid: str) -> str:
        return self._names.setdefault(uuid, f"n{len(self._names)}")


def solids(shape: pin.GeometryObject) -> list[tuple[Any, Array]]:
    """Meshcat geometries of a shape, each with its placement in the shape's frame."""
    import meshcat.geometry as mg

    solid: Any = shape.geometry
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
        loose = corners[[[t[0], t[1], t[2]] for t in faces]].reshape(-1, 3)  # so edges stay sharp
        return [(mg.TriangularMeshGeometry(loose, np.arange(len(loose)).reshape(-1, 3)), np.eye(4))]
    faces = [solid.tri_indices(k) for k in range(solid.num_tris)]
    triangles = np.array([[t[0], t[1], t[2]] for t in faces])
    vertices = np.array(solid.vertices()) * np.asarray(shape.meshScale)
    return [(mg.TriangularMeshGeometry(vertices, triangles), np.eye(4))]


def instances(centers: Array, radii: Array, rings: int, material: Any) -> Any:  # noqa: ANN401
    """All spheres as copies of one: thousands are drawn in one go, and turn without stutter."""
    import meshcat.geometry as mg

    class Instances(mg.Mesh):  # type: ignore[misc]  # what three.js reads, meshcat does not know
        _type = "InstancedMesh"

        def lower(self) -> Any:  # noqa: ANN401
            placed = np.zeros((len(radii), 4, 4))
            placed[:, [0, 1, 2], [0, 1, 2]] = radii[:, None]
            placed[:, 3, :3], placed[:, 3, 3] = centers, 1.0  # by columns
            data = super().lower()
            data["object"] |= {
                "count": len(radii),
                "instanceMatrix": {"array": np.round(placed, 6).ravel().tolist()},
                "frustumCulled": False,  # it would be judged by the one sphere at the origin
            }
            return data

    return Instances(sphere(1.0, rings), material)


def ribbon(segments: Array, widths: Array, colours: Array, up: Array) -> Any:  # noqa: ANN401
    """One mesh of flat quads along segments (k, 2, 3), facing `up`."""
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


def sphere(radius: float, rings: int = 28) -> Any:  # noqa: ANN401 - meshcat has no types
    """A sphere of radius [m], round enough to be seen close up."""
    import meshcat.geometry as mg

    class Sphere(mg.Sphere):  # type: ignore[misc]  # meshcat has no types
        def lower(self, object_data: Any) -> Any:  # noqa: ANN401
            return super().lower(object_data) | {
                "widthSegments": rings * 10 // 7,
                "heightSegments": rings,
            }

    return Sphere(radius)


def _translation(vector: Any) -> Array:  # noqa: ANN401 - any three numbers
    placement = np.eye(4)
    placement[:3, 3] = vector
    return placement
