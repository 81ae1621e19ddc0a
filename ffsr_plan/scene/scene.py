"""Obstacles: spheres at rest in the world."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, content
from ffsr_plan.core.checks import FARTHEST, finite_array, number, truth, whole_number
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.cost_estimate import check_memory
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import counted, html_table
from ffsr_plan.meshes import mesh_files
from ffsr_plan.meshes.sphere_cover import cover
from ffsr_plan.scene import sphere_files
from ffsr_plan.scene.sphere_tree import SphereTree, sphere_tree

_LARGEST_SCALE = 1e9  # [m] per unit of a mesh


@dataclass(frozen=True, eq=False, init=False)
class Scene:
    """Sphere obstacles. `scene + other` holds the spheres of both, those of `scene` first.

    Two scenes are equal if they hold the same spheres in the same order.

    Attributes:
        centers: (N, 3) centres in the world [m].
        radii: (N,) radii [m], greater than zero.
        excess: greatest distance by which the spheres protrude from the bodies that they cover [m];
            zero if the spheres are the obstacles themselves.
        sources: what the spheres come from, in their order: pairs of a name, such as that of a
            mesh file, and a number of spheres. Errors name obstacles by them. Empty if unknown.
    """

    centers: Array
    radii: Array
    excess: float = 0.0
    sources: tuple[tuple[str, int], ...] = ()

    def __init__(
        self,
        centers: ArrayLike = (),
        radii: ArrayLike = (),
        excess: float = 0.0,
        sources: Sequence[tuple[str, int]] = (),
    ) -> None:
        """Check the obstacles and make them read-only; N = 0 is an empty scene.

        Args:
            centers: (N, 3) centres in the world [m].
            radii: (N,) radii [m].
            excess: see the class.
            sources: see the class; the numbers sum to N.

        Raises:
            InvalidInput: shapes that do not fit; or a number that is not finite, or a radius <= 0,
                with the index of the sphere.
        """
        check_memory(
            "scene", {"spheres": _rows(radii)}, sphere_files.BYTES_PER_SPHERE, "fewer spheres"
        )
        c, r = sphere_files.checked_spheres("scene ", centers, radii, "sphere")
        object.__setattr__(self, "centers", c)
        object.__setattr__(self, "radii", r)
        object.__setattr__(self, "excess", number("scene excess", excess, at_least=0.0))
        object.__setattr__(self, "sources", _checked_sources(sources, len(r)))

    def grown(self, by: float) -> Scene:
        """The same spheres with larger radii; the names of their sources say so.

        Args:
            by: what is added to all radii [m]; with 0 it is the same scene.
        """
        if by == 0.0:
            return self
        names = self.sources or (("the scene", len(self.radii)),) * (len(self.radii) > 0)
        sources = [(f"{name}, grown by {by:g} m", count) for name, count in names]
        return Scene(self.centers, self.radii + by, self.excess, sources)

    @classmethod
    def from_csv(cls, path: str | Path) -> Scene:
        """Read spheres from a comma-separated table with the columns x, y, z and radius.

        Args:
            path: the file. A header such as `x [mm]` gives a unit (m, cm, mm, km); the default is
                the metre.

        Raises:
            InvalidInput: names file, line, column and value.
        """
        return cls(*sphere_files.read_csv(path)).named(Path(path).name)

    @classmethod
    def from_numpy(cls, path: str | Path) -> Scene:
        """Read spheres from a NumPy file [m].

        Args:
            path: a `.npy` file with an array (N, 4) of x, y, z, radius, or a `.npz` file with the
                arrays `centers` (N, 3) and `radii` (N,).

        Raises:
            InvalidInput: names the file, its content and what is allowed.
        """
        return cls(*sphere_files.read_numpy(path)).named(Path(path).name)

    @classmethod
    def from_mesh(
        cls,
        mesh: str | Path | Any,  # noqa: ANN401 - any object with `triangles`
        excess: float,
        *,
        scale: float = 1.0,
        position: ArrayLike = (0.0, 0.0, 0.0),
        attitude: ArrayLike = (0.0, 0.0, 0.0),
        inside: bool = True,
    ) -> Scene:
        """Spheres that cover the surface of a closed mesh and the volume that it encloses.

        A cavity inside the mesh, bounded by its own closed surface, stays free. `sphere_cover`
        contains the proof. Half the excess needs about four times the spheres.

        Args:
            mesh: path of a .stl, .obj, .dae or .ply file, or an object with `triangles`
                (k, 3, 3), such as a `trimesh.Trimesh`.
            excess: greatest distance by which the spheres may protrude from the enclosed volume,
                world [m], > 0.
            scale: metres per unit of length of the mesh, > 0; the unit that a .dae file names is
                applied before it.
            position: (3,) origin of the mesh in the world [m].
            attitude: (3,) ZYX angles of the mesh's axes [rad].
            inside: whether to cover the enclosed volume too. An open mesh needs False; with False,
                a robot inside a closed mesh counts as free.

        Returns:
            The scene; its `excess` is the argument.

        Raises:
            InvalidInput: a mesh that cannot be read, is not closed, or is too large for the excess.
        """
        where = "mesh"
        if isinstance(mesh, (str, Path)):
            file = checked_path("mesh", mesh)
            where = f"mesh {mesh}"
            corners = mesh_files.surface(str(file.absolute()), [], "mesh")
        elif hasattr(mesh, "triangles"):
            corners = finite_array("mesh, triangles", mesh.triangles, (-1, 3, 3))
        else:
            raise InvalidInput("mesh", mesh, "a path, or an object with triangles")
        if len(corners) == 0:
            raise InvalidInput("mesh", "no triangle", "a mesh with triangles")
        axes = rotations.matrix(rotations.from_angles(finite_array("attitude", attitude, (3,))))
        factor = number("scale", scale, above=0.0, at_most=_LARGEST_SCALE)
        triangles = factor * corners @ axes.T + finite_array("position", position, (3,), FARTHEST)
        finite_array("mesh, corners in the world", triangles, (-1, 3, 3), FARTHEST)
        excess = number(f"{where}, excess", excess, above=0.0, at_most=FARTHEST)
        spheres = cover(triangles, excess, truth("inside", inside), where)
        name = Path(mesh).name if isinstance(mesh, (str, Path)) else "mesh"
        return cls(spheres.centers, spheres.radii, excess).named(name)

    def named(self, source: str) -> Scene:
        """The same spheres, by which errors name this source.

        Args:
            source: such as the name of a part.
        """
        sources = [(source, len(self))] if len(self) else []
        return Scene(self.centers, self.radii, self.excess, sources)

    def source_of(self, sphere: int) -> str:
        """What a sphere comes from; empty if that is unknown.

        Args:
            sphere: its index.
        """
        end = 0
        for name, count in self.sources:
            end += count
            if sphere < end:
                return name
        return ""

    def to_csv(self, path: str | Path) -> None:
        """Write a table that `from_csv` reads again bit for bit; `excess` is not written.

        Args:
            path: the file, replaced if it exists.

        Raises:
            InvalidInput: a path that cannot be written.
        """
        sphere_files.write_csv(path, self.centers, self.radii)

    @cached_property
    def tree(self) -> SphereTree:
        """The spheres as a tree, built at the first use."""
        return sphere_tree(self.centers, self.radii)

    def __add__(self, other: Scene) -> Scene:
        if not isinstance(other, Scene):
            return NotImplemented
        return Scene(
            np.vstack([self.centers, other.centers]),
            np.concatenate([self.radii, other.radii]),
            max(self.excess, other.excess),
            (*self._all_sources(), *other._all_sources()),
        )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Scene):
            return NotImplemented
        return self._content() == other._content()

    def __hash__(self) -> int:
        return hash(self._content())

    def _content(self) -> object:
        return content((self.centers, self.radii, self.excess, self.sources))

    def _all_sources(self) -> tuple[tuple[str, int], ...]:
        return self.sources or ((("", len(self)),) if len(self) else ())

    def __repr__(self) -> str:
        extent = f", {self._extent()}" if len(self) else ""
        return f"Scene({counted(len(self), 'sphere')}{extent})"

    def _repr_html_(self) -> str:
        rows = {"spheres": str(len(self)), "extent": self._extent() if len(self) else "empty"}
        if self.excess:
            rows["excess"] = f"{self.excess:g} m"
        return html_table("Scene", rows)

    def _extent(self) -> str:
        low = (self.centers - self.radii[:, None]).min(axis=0)
        high = (self.centers + self.radii[:, None]).max(axis=0)
        sides = zip("xyz", low, high, strict=True)
        return ", ".join(f"{axis} {a:.4g} to {b:.4g} m" for axis, a, b in sides)

    def __len__(self) -> int:
        return len(self.radii)


def _rows(values: object) -> int:
    rows = isinstance(values, (list, tuple)) or (isinstance(values, np.ndarray) and values.ndim)
    return len(values) if rows else 0  # type: ignore[arg-type]


def _checked_sources(
    sources: Sequence[tuple[str, int]], spheres: int
) -> tuple[tuple[str, int], ...]:
    """The sources, neighbours of one name together; nothing if no sphere has a name."""
    merged: list[tuple[str, int]] = []
    try:
        pairs = [(name, count) for name, count in sources]
    except (TypeError, ValueError):
        raise InvalidInput("scene sources", sources, "pairs of a name and a number") from None
    for name, count in pairs:
        if not isinstance(name, str):
            raise InvalidInput("scene sources", name, "a name and a number of spheres")
        whole_number("scene sources", count, at_least=0)
        if merged and merged[-1][0] == name == "":
            merged[-1] = name, merged[-1][1] + count
        elif count:
            merged.append((name, count))
    total = sum(count for _, count in merged)
    if merged and total != spheres:
        raise InvalidInput("scene sources", f"{total} spheres", f"all {spheres} of the scene")
    return tuple(merged) if any(name for name, _ in merged) else ()
