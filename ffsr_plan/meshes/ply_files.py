"""A strict reader of PLY files; see `triangle_files` for the reason."""

from __future__ import annotations

from array import array
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.core.arrays import IntArray
from ffsr_plan.meshes.triangle_files import Triangles, fan, shown

Columns = dict[str, NDArray[Any]]
_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1",
    "short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2",
    "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
_FORMATS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_FACES = ("vertex_indices", "vertex_index")
_LONGEST_HEADER = 100_000  # bytes


@dataclass
class _Element:
    """A table of the file.

    Attributes:
        name: `vertex`, `face` or another.
        count: number of its rows.
        columns: name and type of each property; for a list, the types of its length and its items.
    """

    name: str
    count: int
    columns: dict[str, tuple[str, ...]] = field(default_factory=dict)


def read_ply(content: bytes) -> Triangles:
    """Read vertices and faces of a PLY file; polygons are divided into triangles.

    Args:
        content: all bytes of the file.

    Raises:
        ValueError: what is wrong with the file.
    """
    order, elements, body = _header(content)
    if sum(element.count for element in elements) > len(body):  # a row has a byte at least
        counts = ", ".join(f"{each.count} of {each.name}" for each in elements)
        raise ValueError(f"{len(body)} bytes after the header are too few for {counts}")
    tables = _binary(elements, body, order) if order else _text(elements, body)
    vertices = np.column_stack([_column(tables, "vertex", (axis,)) for axis in "xyz"])
    faces: IntArray = _column(tables, "face", _FACES).astype(np.int64)
    if faces.size and not (int(faces.min()) >= 0 and int(faces.max()) < len(vertices)):
        raise ValueError(f"a face of vertex {int(faces.max())} of {len(vertices)}, from 0")
    return Triangles(vertices.astype(np.float64), faces)


def _header(content: bytes) -> tuple[str, list[_Element], bytes]:
    """Byte order, empty for text, the elements, and what follows the header."""
    end = content.find(b"end_header", 0, _LONGEST_HEADER)
    after = content.find(b"\n", end)
    if not content.startswith(b"ply") or end < 0 or after < 0:
        raise ValueError("no PLY header that ends with 'end_header'")
    order, elements = "?", list[_Element]()
    for line in content[:end].decode("utf-8", "replace").splitlines()[1:]:
        words = line.split()
        try:
            if not words or words[0] in ("comment", "obj_info"):
                continue
            if words[0] == "format":
                order = _FORMATS[words[1]]
            elif words[0] == "element":
                elements.append(_Element(words[1], _count(words[2])))
            elif words[0] == "property":
                types = words[2:-1] if words[1] == "list" else words[1:-1]
                if len(types) != (2 if words[1] == "list" else 1):
                    raise ValueError
                elements[-1].columns[words[-1]] = tuple(_TYPES[each] for each in types)
            else:
                raise ValueError
        except (IndexError, KeyError, ValueError):
            raise ValueError(f"header: {line[:60]!r}") from None
    if order == "?":
        raise ValueError("no format in the header")
    return order, elements, content[after + 1 :]


def _count(word: str) -> int:
    if not (word.isascii() and word.isdigit() and len(word) < 12):
        raise ValueError
    return int(word)


def _text(elements: list[_Element], body: bytes) -> dict[str, Columns]:
    """Columns of a text file by element; of lists those of the faces only, as triangles."""
    lines = iter([line for line in body.splitlines() if line.strip()])
    tables = {}
    for element in elements:
        rows = _words(element, lines)
        if any(len(kinds) == 2 for kinds in element.columns.values()):
            tables[element.name] = _text_lists(element, rows)
            continue
        flat = array("d")
        for number, words in rows:
            try:
                if len(words) != len(element.columns):
                    raise ValueError
                flat.extend(map(float, words))
            except ValueError:
                raise ValueError(_bad_row(element, number, words)) from None
        columns = np.array(flat, dtype=np.float64).reshape(-1, max(1, len(element.columns))).T
        tables[element.name] = dict(zip(element.columns, columns, strict=False))
    left = next(lines, None)
    if left is not None:
        raise ValueError(f"a line after the last element: {shown(left)}")
    return tables


def _words(element: _Element, lines: Iterator[bytes]) -> Iterator[tuple[int, list[bytes]]]:
    """Number and words of each row of an element."""
    number = 0
    for number, line in enumerate(islice(lines, element.count), 1):
        yield number, line.replace(b"_", b"?").split()  # Python's floats have underscores
    if number < element.count:
        raise ValueError(f"{number} lines of {element.count} of {element.name}")


def _text_lists(element: _Element, rows: Iterator[tuple[int, list[bytes]]]) -> Columns:
    """Triangles of the faces of an element with lists, all words of which are checked."""
    triangles = array("q")
    for number, words in rows:
        place = 0
        try:
            for name, kinds in element.columns.items():
                count = 1
                if len(kinds) == 2:
                    count, place = int(words[place]), place + 1
                values = words[place : place + count]
                if len(values) != count:
                    raise ValueError
                place += count
                if name in _FACES:
                    triangles.extend(fan([int(word) for word in values]))
                else:
                    list(map(float, values))
            if place != len(words):
                raise ValueError
        except (IndexError, OverflowError, ValueError):
            raise ValueError(_bad_row(element, number, words)) from None
    return _faces(element, triangles)


def _faces(element: _Element, triangles: array[int]) -> Columns:
    """The column of faces of an element, if it has one."""
    if not {*_FACES} & element.columns.keys():
        return {}
    return {_FACES[0]: np.array(triangles, dtype=np.int64).reshape(-1, 3)}


def _bad_row(element: _Element, number: int, words: list[bytes]) -> str:
    return f"row {number} of {element.name}: {shown(b' '.join(words))}"


def _binary(elements: list[_Element], body: bytes, order: str) -> dict[str, Columns]:
    """Columns of a binary file by element; of lists those of the faces only, as triangles."""
    tables = dict[str, Columns]()
    place = 0
    for element in elements:
        record = _record(element, body, place, order)
        end = place + element.count * record.itemsize
        lists = [name for name, kinds in element.columns.items() if len(kinds) == 2]
        rows = np.frombuffer(body, record, element.count, place) if end <= len(body) else None
        if rows is not None and all(
            np.all(rows[f"{name} length"] == record[name].shape[0]) for name in lists
        ):
            tables[element.name] = {
                name: _triangles(rows[name]) if name in lists else rows[name]
                for name in element.columns
                if name not in lists or name in _FACES
            }
            place = end
        elif lists:
            tables[element.name], place = _rows_apart(element, body, place, order)
        else:
            raise ValueError(f"it ends within {element.name}")
    if place != len(body):
        raise ValueError(f"{len(body) - place} bytes after the last element")
    return tables


def _record(element: _Element, body: bytes, place: int, order: str) -> np.dtype[np.void]:
    """Type of a row at a place of the body, with lists as long as in that row."""
    fields = list[tuple[str, str] | tuple[str, str, tuple[int]]]()
    for name, kinds in element.columns.items():
        if len(kinds) == 1:
            fields.append((name, order + kinds[0]))
            continue
        fields.append((f"{name} length", order + kinds[0]))
        before = np.dtype(fields)
        count = 0
        if element.count:
            if place + before.itemsize > len(body):
                raise ValueError(f"it ends within {element.name}")
            row = np.frombuffer(body, before, 1, place)[0]
            count = int(row[f"{name} length"])
            if not 0 <= count <= len(body):
                raise ValueError(f"a list of {count} in {element.name}")
        fields.append((name, order + kinds[1], (count,)))
    record = np.dtype(fields)
    if element.count and place + record.itemsize > len(body):
        raise ValueError(f"it ends within {element.name}")
    return record


def _rows_apart(element: _Element, body: bytes, place: int, order: str) -> tuple[Columns, int]:
    """Triangles of an element whose lists differ in length, row by row, and the place after it."""
    triangles = array("q")
    for _ in range(element.count):
        record = _record(element, body, place, order)
        row = np.frombuffer(body, record, 1, place)[0]
        for name in _FACES:
            if name in element.columns:
                triangles.extend(_triangles(row[name][None]).ravel().tolist())
        place += record.itemsize
    return _faces(element, triangles), place


def _column(tables: Mapping[str, Columns], element: str, names: tuple[str, ...]) -> NDArray[Any]:
    """The column of a table, by any of some names."""
    for name in names:
        if name in tables.get(element, {}):
            return tables[element][name]
    raise ValueError(f"no {names[0]} of {element}")


def _triangles(polygons: NDArray[Any]) -> IntArray:
    """(k, 3) triangles of polygons (n, m), as fans."""
    if polygons.ndim != 2 or polygons.shape[1] < 3:
        raise ValueError("faces of fewer than three corners")
    corners = polygons.astype(np.int64)
    fans = [corners[:, [0, k, k + 1]] for k in range(1, corners.shape[1] - 1)]
    return np.stack(fans, axis=1).reshape(-1, 3)
