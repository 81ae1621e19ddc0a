"""Meshes that a URDF names: where they lie, their triangles, the corners of their convex hulls."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.core.errors import InvalidInput

_SUFFIXES = (".stl", ".obj", ".dae", ".ply")


def find(address: str, folders: Sequence[str]) -> Path | None:
    """The file behind `package://...`, `file://...` or a plain path; None where there is none.

    Nothing is ever fetched: any other scheme has no file.
    """
    scheme, divider, rest = address.rpartition("://")
    if divider and scheme not in ("package", "file"):
        return None
    whole = scheme == "file" or Path(rest).is_absolute()
    places = [Path(rest)] if whole else [Path(folder) / rest for folder in folders]
    return next((place for place in places if place.is_file()), None)


def hull_corners(address: str, folders: Sequence[str], where: str) -> Array:
    """(n, 3) corners of a mesh's convex hull [m], before the URDF's scale, in the mesh's frame.

    The unit of length that a .dae names is applied; its upward axis is not.

    Raises:
        InvalidInput: `where` (link), the address, and what is wrong with it.
    """
    vertices = _mesh(address, folders, where)[0]
    return frozen(hull(vertices, where, address)[0])


def surface(address: str, folders: Sequence[str], where: str) -> Array:
    """(k, 3, 3) corners of a mesh's triangles [m]; see `hull_corners`."""
    vertices, triangles = _mesh(address, folders, where)
    return frozen(vertices[triangles])


def _mesh(address: str, folders: Sequence[str], where: str) -> tuple[Array, IntArray]:
    """Vertices (n, 3) [m], their unit applied, and triangles (k, 3)."""
    path = find(address, folders)
    if path is None:
        looked = ", ".join(folders) or "no folder"
        raise InvalidInput(
            where, address, f"a file of this machine (package:// and plain paths: in {looked})"
        )
    if path.suffix.lower() not in _SUFFIXES:
        raise InvalidInput(where, address, f"a mesh file: {', '.join(_SUFFIXES)}")
    try:
        vertices, triangles = _read(path)
    except Exception as error:  # whatever a parser trips over in a file of any content
        raise InvalidInput(where, address, f"a mesh file that can be read ({error})") from None
    if len(vertices) < 4 or not np.isfinite(vertices).all():
        raise InvalidInput(where, address, "a mesh of at least four finite vertices")
    return vertices, triangles


def _read(path: Path) -> tuple[Array, IntArray]:
    import trimesh

    scene = trimesh.load_scene(path)
    scale = trimesh.units.unit_conversion(scene.units, "meters") if scene.units else 1.0
    mesh = scene.to_mesh()
    vertices = np.asarray(mesh.vertices, dtype=np.float64) * scale
    return vertices, np.asarray(mesh.faces, dtype=np.int64)


def hull(points: Array, where: str, address: str) -> tuple[Array, Array]:
    """Corners (n, 3) and outward triangles (k, 3) of the convex hull of points.

    Raises:
        InvalidInput: the points span no volume.
    """
    from scipy.spatial import ConvexHull, QhullError

    try:
        found = ConvexHull(points)
    except QhullError:
        raise InvalidInput(where, address, "a mesh that is not flat") from None
    place = np.full(len(points), -1)
    place[found.vertices] = np.arange(len(found.vertices))
    triangles = place[found.simplices]
    corners = points[found.vertices]
    a, b, c = corners[triangles.T]
    inward = np.sum(np.cross(b - a, c - a) * found.equations[:, :3], axis=1) < 0.0
    triangles[inward] = triangles[inward][:, ::-1]
    return corners, triangles
