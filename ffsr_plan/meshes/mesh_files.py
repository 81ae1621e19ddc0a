"""Mesh files: addresses as in a URDF, triangles, and corners of convex hulls."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.core.errors import InvalidInput

_SUFFIXES = (".stl", ".obj", ".dae", ".ply")


def find(address: str, folders: Sequence[str]) -> Path | None:
    """Look up a mesh address.

    Nothing is downloaded: an address with another scheme has no file.

    Args:
        address: `package://...`, `file://...` or a plain path.
        folders: folders in which package and relative addresses are looked up, in this order.

    Returns:
        Path of the file; None if there is none.
    """
    scheme, divider, rest = address.rpartition("://")
    if divider and scheme not in ("package", "file"):
        return None
    whole = scheme == "file" or Path(rest).is_absolute()
    places = [Path(rest)] if whole else [Path(folder) / rest for folder in folders]
    return next((place for place in places if place.is_file()), None)


def hull_corners(address: str, folders: Sequence[str], where: str) -> Array:
    """Corners of the convex hull of a mesh, before the scale of the URDF.

    The unit of length of a .dae file is applied; its up axis is ignored.

    Args:
        address: address of the file; see `find`.
        folders: folders in which it is looked up.
        where: robot and link, for the message.

    Returns:
        (n, 3) corners in the mesh's frame [m].

    Raises:
        InvalidInput: no such file, one that cannot be read, or a flat mesh.
    """
    vertices = _mesh(address, folders, where)[0]
    return frozen(hull(vertices, where, address)[0])


def surface(address: str, folders: Sequence[str], where: str) -> Array:
    """Triangles of a mesh, before the scale of the URDF; see `hull_corners`.

    Args:
        address: address of the file; see `find`.
        folders: folders in which it is looked up.
        where: robot and link, for the message.

    Returns:
        (k, 3, 3) corners of the triangles in the mesh's frame [m].

    Raises:
        InvalidInput: no such file, or one that cannot be read.
    """
    vertices, triangles = _mesh(address, folders, where)
    return frozen(vertices[triangles])


def _mesh(address: str, folders: Sequence[str], where: str) -> tuple[Array, IntArray]:
    """Vertices (n, 3) [m], their unit applied, and triangles (k, 3)."""
    path = find(address, folders)
    if path is None:
        searched = ", ".join(folders) or "no folder"
        raise InvalidInput(
            where, address, f"a file of this machine (package:// and plain paths: in {searched})"
        )
    if path.suffix.lower() not in _SUFFIXES:
        raise InvalidInput(where, address, f"a mesh file: {', '.join(_SUFFIXES)}")
    try:
        vertices, triangles = _read(path)
    except Exception as error:  # parsers raise many types for a file of arbitrary content
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
    """Convex hull of points.

    Args:
        points: (m, 3) [m].
        where: robot and link, for the message.
        address: name of the mesh, for the message.

    Returns:
        (n, 3) corners [m], and (k, 3) indices of the corners of its triangles, counterclockwise
        from outside.

    Raises:
        InvalidInput: the points span no volume.
    """
    from scipy.spatial import ConvexHull, QhullError

    try:
        qhull = ConvexHull(points)
    except QhullError:
        raise InvalidInput(where, address, "a mesh that is not flat") from None
    index = np.full(len(points), -1)
    index[qhull.vertices] = np.arange(len(qhull.vertices))
    triangles = index[qhull.simplices]
    corners = points[qhull.vertices]
    a, b, c = corners[triangles.T]
    inward = np.sum(np.cross(b - a, c - a) * qhull.equations[:, :3], axis=1) < 0.0
    triangles[inward] = triangles[inward][:, ::-1]
    return corners, triangles
