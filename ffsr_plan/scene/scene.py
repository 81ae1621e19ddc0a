"""`Scene`: the obstacles, spheres at rest in the world."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import FARTHEST, finite_array, number, truth
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.meshes import mesh_files
from ffsr_plan.meshes.sphere_cover import cover
from ffsr_plan.scene import sphere_files
from ffsr_plan.scene.sphere_tree import SphereTree, sphere_tree


@dataclass(frozen=True, eq=False, init=False)
class Scene:
    """Sphere obstacles. `scene + other` holds the spheres of both, those of `scene` first.

    Attributes:
        centers: (N, 3) centres in the world [m].
        radii: (N,) radii [m], greater than zero.
        excess: how far at most the spheres reach beyond the bodies that they stand for [m]; zero
            where they are the obstacles themselves.
    """

    centers: Array
    radii: Array
    excess: float = 0.0

    def __init__(self, centers: ArrayLike = (), radii: ArrayLike = (), excess: float = 0.0) -> None:
        """Check and freeze the obstacles; N = 0 is an empty scene.

        Raises:
            InvalidInput: shapes that do not fit, not finite, or a radius <= 0, with its index.
        """
        if np.size(centers) == 0:  # so that [] will do for "no obstacle"
            centers = np.zeros((0, 3))
        c = finite_array("scene centers", centers, (-1, 3), FARTHEST)
        r = finite_array("scene radii", radii, (-1,))
        if len(c) != len(r):
            raise InvalidInput(
                "scene radii", f"{len(r)} radii", f"one for each of {len(c)} centers"
            )
        for i in np.flatnonzero(r <= 0.0)[:1]:
            raise InvalidInput(f"scene radii[{i}]", float(r[i]), "greater than 0 m")
        object.__setattr__(self, "centers", c)
        object.__setattr__(self, "radii", r)
        object.__setattr__(self, "excess", number("scene excess", excess, at_least=0.0))

    @classmethod
    def from_csv(cls, path: str | Path) -> Scene:
        """The spheres of a comma-separated table with the columns x, y, z and radius.

        A header such as `x [mm]` gives a unit (m, cm, mm, km); without one it is the metre.

        Raises:
            InvalidInput: naming file, line, column and value.
        """
        return cls(*sphere_files.read_csv(path))

    @classmethod
    def from_numpy(cls, path: str | Path) -> Scene:
        """The spheres of a `.npy` file, (N, 4), or of a `.npz` file with `centers` and `radii`.

        Raises:
            InvalidInput: naming the file, what it holds and what is allowed.
        """
        return cls(*sphere_files.read_numpy(path))

    @classmethod
    def from_mesh(
        cls,
        mesh: str | Path | Any,  # noqa: ANN401 - a trimesh object, which mypy knows nothing of
        excess: float,
        *,
        scale: float = 1.0,
        position: ArrayLike = (0.0, 0.0, 0.0),
        attitude: ArrayLike = (0.0, 0.0, 0.0),
        inside: bool = True,
    ) -> Scene:
        """Spheres around a closed mesh: its surface and all that it encloses lie in them.

        A hollow that has a wall of its own and does not reach the outside stays free. How it is
        done, and why it holds, is said in `mesh_cover`. Half the excess needs four times the
        spheres, or a little more.

        Args:
            mesh: path of a .stl, .obj, .dae or .ply file, or an object with `triangles`
                (k, 3, 3), such as a `trimesh.Trimesh`.
            excess: how far the spheres may reach beyond what the mesh encloses, world [m], > 0.
            scale: metres in a unit of length of the mesh, > 0; the unit that a .dae names is
                applied before it.
            position: (3,) of the mesh's origin, world [m].
            attitude: (3,) ZYX angles of the mesh's axes [rad].
            inside: False to cover the surface alone. That is all there is to an open mesh, which is
                refused otherwise; inside a closed one a robot would then count as free.

        Raises:
            InvalidInput: a mesh that cannot be read, is not closed or too large for the excess.
        """
        if isinstance(mesh, (str, Path)):
            given = mesh_files.surface(str(Path(mesh).absolute()), [], "mesh")
        elif hasattr(mesh, "triangles"):
            given = finite_array("mesh, triangles", mesh.triangles, (-1, 3, 3))
        else:
            raise InvalidInput("mesh", mesh, "a path, or an object with triangles")
        if len(given) == 0:
            raise InvalidInput("mesh", "no triangle", "a mesh with triangles")
        turned = rotations.from_angles(finite_array("attitude", attitude, (3,)))
        triangles = number("scale", scale, above=0.0) * given @ rotations.matrix(turned).T
        triangles = triangles + finite_array("position", position, (3,), FARTHEST)
        reach = number("mesh, excess", excess, above=0.0)
        found = cover(triangles, reach, truth("inside", inside))
        return cls(*found, excess=reach)

    def to_csv(self, path: str | Path) -> None:
        """Write a table that `from_csv` reads again bit for bit; `excess` is not kept.

        Raises:
            InvalidInput: a path that cannot be written.
        """
        sphere_files.write_csv(path, self.centers, self.radii)

    @cached_property
    def tree(self) -> SphereTree:
        """The spheres as a tree, built when it is first needed."""
        return sphere_tree(self.centers, self.radii)

    def __add__(self, other: Scene) -> Scene:
        if not isinstance(other, Scene):
            return NotImplemented
        return Scene(
            np.vstack([self.centers, other.centers]),
            np.concatenate([self.radii, other.radii]),
            max(self.excess, other.excess),
        )

    def __len__(self) -> int:
        return len(self.radii)
