"""Strict readers of STL and OBJ files.

Trimesh's readers skip what they do not understand: at a number that is none, the rest of a solid is
lost, and an index of zero means the last vertex. A part that is lost in silence is an obstacle that
is not avoided, so these readers refuse the file. Of OBJ files they read vertices and faces; points
and lines, colours, normals and textures do not matter here.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray

_STL_HEADER, _STL_TRIANGLE = 84, 50  # bytes
_STL_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_STL_LINES = {  # first word of a line: what it may follow
    b"solid": (b"", b"endsolid"),
    b"facet": (b"solid", b"endfacet"),
    b"outer": (b"facet",),
    b"vertex": (b"outer", b"vertex"),
    b"endloop": (b"vertex",),
    b"endfacet": (b"endloop",),
    b"endsolid": (b"solid", b"endfacet"),
}
_OBJ_IGNORED = frozenset(
    b"vt vn vp g o s mtllib usemtl usemap maplib l p mg bevel c_interp d_interp lod "
    b"shadow_obj trace_obj".split()
)


class Triangles(NamedTuple):
    """A mesh as its file states it.

    Attributes:
        vertices: (n, 3) in the unit of the file; they may be anything that a float can be.
        faces: (k, 3) indices of vertices.
    """

    vertices: Array
    faces: IntArray


def read_stl(content: bytes) -> Triangles:
    """Read a binary or text STL file.

    Args:
        content: all bytes of the file.

    Raises:
        ValueError: what is wrong with the file.
    """
    room = (len(content) - _STL_HEADER) / _STL_TRIANGLE
    stated = int.from_bytes(content[_STL_HEADER - 4 : _STL_HEADER], "little")
    if len(content) >= _STL_HEADER and room == stated:
        records = np.frombuffer(content, _STL_RECORD, offset=_STL_HEADER)
        return _apart(records["corners"].astype(np.float64).reshape(-1, 3))
    start = content[:512].lstrip().lower()
    if start.startswith(b"solid") and (b"\n" in start or b"\r" in start):
        return _apart(_stl_text(content.splitlines()))
    if len(content) < _STL_HEADER:
        raise ValueError(f"{len(content)} bytes, which is no STL file")
    raise ValueError(f"a binary STL file that states {stated} triangles has room for {room:g}")


def read_obj(content: bytes) -> Triangles:
    """Read vertices and faces of an OBJ file; polygons are divided into triangles.

    Args:
        content: all bytes of the file.

    Raises:
        ValueError: what is wrong with the file, with the line.
    """
    vertices, corners = array("d"), array("q")
    lines = content.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ").splitlines()
    for number, line in enumerate(lines, 1):
        words = line.split(b"#", 1)[0].split()
        if not words or words[0] in _OBJ_IGNORED:
            continue
        try:
            if words[0] == b"v":
                vertices.extend(_floats(words[1:4]))
            elif words[0] == b"f":
                corners.extend(fan(_indices(words[1:], len(vertices) // 3)))
            else:
                raise ValueError
        except ValueError:
            raise ValueError(f"line {number}: {shown(line)}") from None
    faces = np.array(corners, dtype=np.int64).reshape(-1, 3)
    if faces.size and int(faces.max()) >= len(vertices) // 3:
        raise ValueError(f"a face of vertex {int(faces.max()) + 1} of {len(vertices) // 3}")
    return Triangles(np.array(vertices, dtype=np.float64).reshape(-1, 3), faces)


def _apart(corners: Array) -> Triangles:
    """Triangles that share no vertices, from their corners (3 k, 3)."""
    return Triangles(corners, np.arange(len(corners)).reshape(-1, 3))


def _stl_text(lines: Iterable[bytes]) -> Array:
    """(3 k, 3) corners of the triangles of a text STL file."""
    corners, last, count = array("d"), b"", 0
    for number, line in enumerate(lines, 1):
        words = line.split()
        if not words:
            continue
        first = words[0].lower()
        count = count + 1 if first == b"vertex" else 0 if first == b"outer" else count
        try:
            if last not in _STL_LINES[first] or count > 3 or (first == b"endloop" and count < 3):
                raise ValueError
            if first == b"vertex":
                corners.extend(_floats(words[1:]))
        except (KeyError, ValueError):
            raise ValueError(f"line {number}: {shown(line)}") from None
        last = first
    if last != b"endsolid":
        raise ValueError("it ends before 'endsolid'")
    return np.array(corners, dtype=np.float64).reshape(-1, 3)


def fan(polygon: list[int]) -> list[int]:
    """Triangles of a polygon, all from its first corner, in a row.

    Args:
        polygon: indices of its corners.

    Raises:
        ValueError: fewer than three corners.
    """
    if len(polygon) == 3:
        return polygon
    if len(polygon) < 3:
        raise ValueError
    pairs = pairwise(polygon[1:])
    return [corner for second, third in pairs for corner in (polygon[0], second, third)]


def _floats(words: list[bytes]) -> list[float]:
    """Three numbers; Python's underscores are refused."""
    if len(words) != 3 or any(b"_" in word for word in words):
        raise ValueError
    return [float(word) for word in words]


def _indices(words: list[bytes], count: int) -> list[int]:
    """Indices from 0 of corners `vertex/texture/normal`; negative ones count back from `count`."""
    indices = [int(word.split(b"/", 1)[0]) for word in words]
    places = [index - 1 if index > 0 else count + index for index in indices]
    if 0 in indices or min(places, default=-1) < 0 or any(b"_" in word for word in words):
        raise ValueError
    return places


def shown(line: bytes) -> str:
    """The begin of a line, for messages.

    Args:
        line: the line.
    """
    return repr(line.strip()[:60].decode("ascii", "replace"))
