"""Spheres that cover a mesh which is given by a file or by its triangles."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from ffsr_plan.core import rotations
from ffsr_plan.core.checks import FARTHEST, finite_array, number, truth
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.meshes import mesh_files
from ffsr_plan.meshes.sphere_cover import Cover, cover

_LARGEST_SCALE = 1e9  # [m] per unit of a mesh


def covered(
    mesh: str | Path | Any,  # noqa: ANN401 - any object with `triangles`
    excess: float,
    scale: float,
    position: ArrayLike,
    attitude: ArrayLike,
    inside: bool,
) -> tuple[Cover, str]:
    """The spheres and the name of what they cover; arguments as of `Scene.from_mesh`.

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
    return spheres, name
