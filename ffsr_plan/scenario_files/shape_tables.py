"""Tables of a scenario file that make obstacles of other shapes than spheres, and keep-in zones."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path
from typing import Annotated

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import ByKey, FilePath, Number
from ffsr_plan.core.settings import setting, settings
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.keep_in_zones import HalfSpace, Zone
from ffsr_plan.scene.shapes.obstacle_shapes import (
    Ball,
    Box,
    Capsule,
    Cylinder,
    Ellipsoid,
    Hull,
    Name,
    ObstacleShape,
    Place,
    Turn,
)


class _OneShape:
    """A table `[[obstacles]]` with a single field: a shape."""

    def shape(self, folder: Path) -> ObstacleShape:
        """The shape; paths in it are relative to `folder`."""
        (only,) = fields(self)  # type: ignore[arg-type]
        found: ObstacleShape = getattr(self, only.name)
        return found

    def scene(self, folder: Path) -> Scene:
        """The shape alone; paths in it are relative to `folder`."""
        return Scene(shapes=[self.shape(folder)])


@settings
class BoxTable(_OneShape):
    """The table `[[obstacles]]` of a box.

    Attributes:
        box: its size, position, attitude and name.
    """

    box: Box


@settings
class BallTable(_OneShape):
    """The table `[[obstacles]]` of a ball.

    Attributes:
        ball: its radius, position and name.
    """

    ball: Ball


@settings
class CapsuleTable(_OneShape):
    """The table `[[obstacles]]` of a capsule.

    Attributes:
        capsule: its radius, length, position, attitude and name.
    """

    capsule: Capsule


@settings
class CylinderTable(_OneShape):
    """The table `[[obstacles]]` of a cylinder.

    Attributes:
        cylinder: its radius, length, position, attitude and name.
    """

    cylinder: Cylinder


@settings
class EllipsoidTable(_OneShape):
    """The table `[[obstacles]]` of an ellipsoid.

    Attributes:
        ellipsoid: its semi_axes, position, attitude and name.
    """

    ellipsoid: Ellipsoid


@settings
class MeshHullTable:
    """The table `hull` of the convex hull of a mesh; see `Hull.from_mesh`.

    Attributes:
        mesh: path of a .stl, .obj, .dae or .ply file, relative to the scenario file.
        scale: metres per unit of length of the mesh.
        position: (3,) origin of the mesh in the world [m].
        attitude: of the mesh: (3,) ZYX angles [rad], or (4,) quaternion (x, y, z, w).
        name: by which errors name it; the name of the file without one.
    """

    mesh: Annotated[str, FilePath()]
    scale: Annotated[float, Number(above=0.0, at_most=1e9)] = 1.0
    position: Place = setting(default=(0.0, 0.0, 0.0))
    attitude: Turn = setting(default=(0.0, 0.0, 0.0, 1.0))
    name: Name = ""

    def hull(self, folder: Path) -> Hull:
        """The hull; the path of the mesh is relative to `folder`."""
        return Hull.from_mesh(
            folder / self.mesh,
            scale=self.scale,
            position=self.position,
            attitude=self.attitude,
            name=self.name,
        )


@settings
class HullTable(_OneShape):
    """The table `[[obstacles]]` of a convex hull.

    Attributes:
        hull: its points, or the mesh that it is around with a scale; position, attitude and name.
    """

    hull: Annotated[Hull | MeshHullTable, ByKey(points=Hull, mesh=MeshHullTable)]

    def shape(self, folder: Path) -> ObstacleShape:
        """The hull; paths in it are relative to `folder`."""
        if isinstance(self.hull, Hull):
            return self.hull
        try:
            return self.hull.hull(folder)
        except InvalidInput as error:
            raise InvalidInput(f"hull.{error.what}", error.value, error.allowed) from error


SHAPE_TABLES: dict[str, type] = {
    "box": BoxTable,
    "ball": BallTable,
    "capsule": CapsuleTable,
    "cylinder": CylinderTable,
    "ellipsoid": EllipsoidTable,
    "hull": HullTable,
}
"""Tables of shapes, by the key that tells them apart."""


class _OneZone:
    """A table `[[keep_in]]` with a single field: a zone."""

    @property
    def zone(self) -> Zone:
        """The zone."""
        (only,) = fields(self)  # type: ignore[arg-type]
        found: Zone = getattr(self, only.name)
        return found


@settings
class BoxZoneTable(_OneZone):
    """The table `[[keep_in]]` of a box.

    Attributes:
        box: its size, position, attitude and name.
    """

    box: Box


@settings
class BallZoneTable(_OneZone):
    """The table `[[keep_in]]` of a ball.

    Attributes:
        ball: its radius, position and name.
    """

    ball: Ball


@settings
class HalfSpaceTable(_OneZone):
    """The table `[[keep_in]]` of a half-space.

    Attributes:
        half_space: its direction, outwards, a position on its boundary, and its name.
    """

    half_space: HalfSpace


KeepIn = Annotated[
    BoxZoneTable | BallZoneTable | HalfSpaceTable,
    ByKey(box=BoxZoneTable, ball=BallZoneTable, half_space=HalfSpaceTable),
]


def with_names(scene: Scene, name: str) -> Scene:
    """The same obstacles; a shape without a name gets one.

    Args:
        scene: the obstacles.
        name: such as that of a table of the scenario file.
    """
    shapes = [each if each.name else replace(each, name=name) for each in scene.shapes]  # type: ignore[type-var]
    return replace(scene, shapes=tuple(shapes))
