"""Mesh files: triangles, and corners of convex hulls."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import is_lfs_pointer
from ffsr_plan.meshes.collada_files import read_dae
from ffsr_plan.meshes.mesh_addresses import found
from ffsr_plan.meshes.ply_files import read_ply
from ffsr_plan.meshes.triangle_files import read_obj, read_stl

MOST_BYTES, MOST_TRIANGLES = 100_000_000, 1_000_000
"""Limits of a mesh file, by which memory stays below 2 GB."""
FARTHEST = 1e9
"""Limit of coordinates in the unit of the file; beyond it the digits of a mesh are lost."""
_READERS = {".stl": read_stl, ".obj": read_obj, ".dae": read_dae, ".ply": read_ply}


def hull_corners(address: str, folders: Sequence[str], where: str) -> Array:
    """Corners of the convex hull of a mesh, before the scale of the URDF.

    The unit of length of a .dae file is applied; its up axis is ignored.

    Args:
        address: address of the file; see `mesh_addresses.find`.
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
        address: address of the file; see `mesh_addresses.find`.
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
    """Vertices (n, 3) [m], their unit applied, and triangles (k, 3); equal vertices are merged."""
    path = found(address, folders, where)
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise InvalidInput(where, address, f"a mesh file: {', '.join(_READERS)}")
    content = _content(path, address, where)
    try:
        vertices, faces = reader(content)
    except ValueError as error:
        raise InvalidInput(where, address, f"a mesh file that can be read ({error})") from None
    if len(faces) == 0:
        raise InvalidInput(where, f"{address} without triangles", "a mesh with triangles")
    if len(faces) > MOST_TRIANGLES:
        allowed = f"at most {MOST_TRIANGLES}; a coarser mesh"
        raise InvalidInput(where, f"{address} of {len(faces)} triangles", allowed)
    beyond = ~(np.abs(vertices) <= FARTHEST).all(axis=1)  # NaN too
    if beyond.any():
        k = int(np.argmax(beyond))
        allowed = f"a mesh of finite vertices, of at most {FARTHEST:g} in the unit of the file"
        raise InvalidInput(where, f"{address} with vertex {k} at {vertices[k].tolist()}", allowed)
    return _merged(vertices, faces)


def _content(path: Path, address: str, where: str) -> bytes:
    """All bytes of a file."""
    try:
        size = path.stat().st_size
        if size > MOST_BYTES:
            allowed = f"at most {MOST_BYTES / 1e6:g} MB; a coarser mesh"
            raise InvalidInput(where, f"{address} of {size / 1e6:g} MB", allowed)
        content = path.read_bytes()
    except OSError as error:
        reason = error.strerror or error
        raise InvalidInput(where, address, f"a mesh file that can be read ({reason})") from None
    if not content.strip():
        raise InvalidInput(where, f"{address}, an empty file", "a mesh file")
    if is_lfs_pointer(content):
        allowed = "the mesh itself: `git lfs pull` fetches it"
        raise InvalidInput(where, f"{address}, a pointer of Git LFS", allowed)
    return content


def _merged(vertices: Array, faces: IntArray) -> tuple[Array, IntArray]:
    """The same mesh, vertices that agree to 1e-8 made one: text files differ in the last digits."""
    keys = np.round(vertices * 1e8).astype(np.int64)
    order = np.lexsort(keys.T)  # equal keys stay in the order of the file
    differs = np.any(keys[order[1:]] != keys[order[:-1]], axis=1)
    group = np.concatenate([[0], np.cumsum(differs)])
    first = order[np.concatenate([[True], differs])]
    place = np.argsort(np.argsort(first))  # vertices stay in the order of the file
    inverse = np.empty(len(vertices), dtype=np.int64)
    inverse[order] = place[group]
    return vertices[np.sort(first)], inverse[faces]


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
