"""Tables of a scenario file that make obstacles: spheres, files, meshes, shapes, generators."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.setting_rules import (
    ByKey,
    FilePath,
    Number,
    Numbers,
    Truth,
    Vector,
    WholeNumber,
)
from ffsr_plan.core.settings import settings
from ffsr_plan.scenario_files.shape_tables import (
    SHAPE_TABLES,
    BallTable,
    BoxTable,
    CapsuleTable,
    CylinderTable,
    EllipsoidTable,
    HullTable,
)
from ffsr_plan.scene import generators
from ffsr_plan.scene.scene import Scene

FileName = Annotated[str, FilePath()]


@settings
class Sphere:
    """The table `[[obstacles]]` of a sphere.

    Attributes:
        center: (3,) in the world [m].
        radius: [m].
    """

    center: Annotated[Vector, Numbers(3)]
    radius: Annotated[float, Number(above=0.0)]

    def scene(self, folder: Path) -> Scene:
        """The sphere; `folder` is not used."""
        return Scene([self.center], [self.radius])


@settings
class CsvFile:
    """The table `[[obstacles]]` of a CSV file of spheres.

    Attributes:
        csv: path of a table of x, y, z and radius [m], relative to the scenario file.
    """

    csv: FileName

    def scene(self, folder: Path) -> Scene:
        """The spheres of the file; its path is relative to `folder`."""
        return Scene.from_csv(folder / self.csv)


@settings
class NumpyFile:
    """The table `[[obstacles]]` of a numpy file of spheres.

    Attributes:
        numpy: path of a .npy file, (N, 4), or of a .npz file with centers and radii, relative to
            the scenario file.
    """

    numpy: FileName

    def scene(self, folder: Path) -> Scene:
        """The spheres of the file; its path is relative to `folder`."""
        return Scene.from_numpy(folder / self.numpy)


@settings
class MeshFile:
    """The table `[[obstacles]]` of a mesh, which spheres cover; see `Scene.from_mesh`.

    Attributes:
        mesh: path of a .stl, .obj, .dae or .ply file, relative to the scenario file.
        excess: most by which spheres may extend beyond the mesh [m].
        scale: factor on the coordinates of the file.
        position: (3,) origin of the mesh in the world [m].
        attitude: (3,) ZYX angles of the mesh [rad].
        inside: false to cover only the surface of the mesh.
    """

    mesh: FileName
    excess: Annotated[float, Number(above=0.0)]
    scale: Annotated[float, Number(above=0.0)] | None = None
    position: Annotated[Array, Numbers(3)] | None = None
    attitude: Annotated[Array, Numbers(3)] | None = None
    inside: Annotated[bool, Truth()] | None = None

    def scene(self, folder: Path) -> Scene:
        """The spheres that cover the mesh; its path is relative to `folder`."""
        given = _given(self)
        return Scene.from_mesh(folder / given.pop("mesh"), **given)


Obstacle = Annotated[
    Sphere
    | CsvFile
    | NumpyFile
    | MeshFile
    | BoxTable
    | BallTable
    | CapsuleTable
    | CylinderTable
    | EllipsoidTable
    | HullTable,
    ByKey(center=Sphere, csv=CsvFile, numpy=NumpyFile, mesh=MeshFile, **SHAPE_TABLES),
]


@settings
class CloudTable:
    """The table `[[clouds]]`: spheres drawn from a seed; see `generators.cloud`.

    Attributes:
        seed: of the random numbers.
        count: number of spheres.
        low: (3,) least coordinates of the centres [m].
        high: (3,) greatest coordinates of the centres [m].
        radii: (2,) least and greatest radius [m].
        spared: distance from the base at start and goal that no sphere comes within [m].
    """

    seed: Annotated[int, WholeNumber()]
    count: Annotated[int, WholeNumber()]
    low: Annotated[Vector, Numbers(3)]
    high: Annotated[Vector, Numbers(3)]
    radii: Annotated[Vector, Numbers(2)]
    spared: Annotated[float, Number(at_least=0.0)] = 0.0

    def scene(self, ends: Sequence[Array]) -> Scene:
        """The spheres; `ends` are the base positions (3,) at start and goal [m]."""
        return generators.cloud(**_given(self) | {"spared": [(end, self.spared) for end in ends]})


@settings
class BeltTable:
    """The table `[[belts]]`: debris in a ring, drawn from a seed; see `generators.belt`.

    Attributes:
        seed: of the random numbers.
        count: number of spheres.
        radius: major radius of the ring [m].
        thickness: minor radius of the ring [m].
        radii: (2,) least and greatest radius of a sphere [m].
        center: (3,) of the ring in the world [m].
        attitude: (3,) ZYX angles of the ring [rad].
        arc: (2,) first and last angle about the ring's z axis [rad].
        spared: distance from the base at start and goal that no sphere comes within [m].
    """

    seed: Annotated[int, WholeNumber()]
    count: Annotated[int, WholeNumber()]
    radius: Annotated[float, Number()]
    thickness: Annotated[float, Number()]
    radii: Annotated[Vector, Numbers(2)]
    center: Annotated[Array, Numbers(3)] | None = None
    attitude: Annotated[Array, Numbers(3)] | None = None
    arc: Annotated[Array, Numbers(2)] | None = None
    spared: Annotated[float, Number(at_least=0.0)] = 0.0

    def scene(self, ends: Sequence[Array]) -> Scene:
        """The spheres; `ends` are the base positions (3,) at start and goal [m]."""
        return generators.belt(**_given(self) | {"spared": [(end, self.spared) for end in ends]})


@settings
class ScatterTable:
    """The table `[[scatters]]`: a few spheres in the xy-plane; see `generators.scatter`.

    Attributes:
        seed: of the random numbers.
        counts: least and greatest number of spheres.
        low: (2,) least x and y of the centres [m].
        high: (2,) greatest x and y of the centres [m].
        radii: (2,) least and greatest radius [m].
    """

    seed: Annotated[int, WholeNumber()]
    counts: tuple[Annotated[int, WholeNumber()], Annotated[int, WholeNumber()]]
    low: Annotated[Vector, Numbers(2)]
    high: Annotated[Vector, Numbers(2)]
    radii: Annotated[Vector, Numbers(2)]

    def scene(self, ends: Sequence[Array]) -> Scene:
        """The spheres; `ends` is not used."""
        return generators.scatter(**_given(self))


@settings
class TrussTable:
    """The table `[[trusses]]`: a boom of struts; see `generators.truss`.

    Attributes:
        begin: (3,) middle of the first square, world [m].
        end: (3,) middle of the last square [m].
        width: edge of the squares [m].
        bays: number of bays.
        radius: of the spheres [m].
        roll: rotation about the boom [rad].
    """

    begin: Annotated[Vector, Numbers(3)]
    end: Annotated[Vector, Numbers(3)]
    width: Annotated[float, Number()]
    bays: Annotated[int, WholeNumber()]
    radius: Annotated[float, Number()]
    roll: Annotated[float, Number()] | None = None

    def scene(self, ends: Sequence[Array]) -> Scene:
        """The spheres; `ends` is not used."""
        return generators.truss(**_given(self))


@settings
class GateTable:
    """The table `[[gates]]`: two spheres with a gap between them; see `generators.gate`.

    Attributes:
        along: x of both centres [m].
        aside: y of the middle of the gap [m].
        opening: width of the gap [m].
        radius: of the spheres [m].
    """

    along: Annotated[float, Number()]
    aside: Annotated[float, Number()]
    opening: Annotated[float, Number()]
    radius: Annotated[float, Number()]

    def scene(self, ends: Sequence[Array]) -> Scene:
        """The spheres; `ends` is not used."""
        return generators.gate(**_given(self))


def _given(table: Any) -> dict[str, Any]:  # noqa: ANN401 - one of the classes above
    """Fields of a table without those that are None, which stay at the function's default."""
    values = {each.name: getattr(table, each.name) for each in fields(table)}
    return {name: value for name, value in values.items() if value is not None}
