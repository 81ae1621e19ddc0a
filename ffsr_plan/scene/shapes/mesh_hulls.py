"""A mesh as convex hulls that cover it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike

from ffsr_plan.core.checks import finite_array, number, text, whole_number
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.meshes import mesh_files
from ffsr_plan.meshes.convex_pieces import convex_pieces
from ffsr_plan.scene.shapes.obstacle_shapes import Hull

_MOST_PIECES = 1000


def mesh_hulls(
    mesh: str | Path | Any,  # noqa: ANN401 - any object with `triangles`
    pieces: int = 16,
    *,
    scale: float = 1.0,
    position: ArrayLike = (0.0, 0.0, 0.0),
    attitude: ArrayLike = (0.0, 0.0, 0.0),
    name: str = "",
) -> list[Hull]:
    """Convex hulls that together cover what a closed mesh encloses.

    Planes across the mesh's axes cut it where that saves most volume of the hulls; cavities are
    filled. `Scene(shapes=mesh_hulls("station.stl"))` has them as obstacles.

    Args:
        mesh: path of a .stl, .obj, .dae or .ply file, or an object with `triangles` (k, 3, 3),
            such as a `trimesh.Trimesh`.
        pieces: number of hulls at most; fewer where more would hardly be closer.
        scale: metres per unit of length of the mesh, > 0.
        position: (3,) origin of the mesh in the world [m].
        attitude: of the mesh's axes: (3,) ZYX angles [rad], or (4,) quaternion (x, y, z, w).
        name: by which errors name the hulls; the name of the file without one.

    Returns:
        The hulls.

    Raises:
        InvalidInput: a mesh that cannot be read or is flat, or that has more connected parts than
            `pieces`.
    """
    name, most = (
        text("name", name),
        whole_number("pieces", pieces, at_least=1, at_most=_MOST_PIECES),
    )
    if isinstance(mesh, (str, Path)):
        file = checked_path("mesh", mesh)
        corners, name = mesh_files.surface(str(file.absolute()), [], "mesh"), name or file.name
    elif hasattr(mesh, "triangles"):
        corners = finite_array("mesh, triangles", mesh.triangles, (-1, 3, 3))
    else:
        raise InvalidInput("mesh", mesh, "a path, or an object with triangles")
    if len(corners) == 0:
        raise InvalidInput("mesh", "no triangle", "a mesh with triangles")
    factor = number("scale", scale, above=0.0, at_most=1e9)
    found = convex_pieces(factor * corners, most)
    return [Hull(points, position, attitude, name) for points in found]
