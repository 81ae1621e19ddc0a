"""Files of spheres: CSV tables of x, y, z, radius, and NumPy arrays.

`numpy.loadtxt` reads the lines of a CSV table that hold plain numbers. It knows no units in a
header and does not name the line and column of a wrong value: the other lines are parsed here.
"""

from __future__ import annotations

import csv
import math
import re
import warnings
import zipfile
from pathlib import Path
from typing import IO, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import FARTHEST, LARGEST_NUMBER, finite_array, unknown_name
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.cost_estimate import check_memory
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import read_text, reason, write_text

COLUMNS = ("x", "y", "z", "radius")
UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "km": 1e3}
"""Metres in each unit that a header may contain."""
BYTES_PER_SPHERE = 800
"""Memory [bytes] that a sphere takes at most while its file is read and its tree is built."""
_LONGEST_LINE = 10_000
_LINES_AT_ONCE = 10_000  # of which one that is no plain number slows down the reading
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_LONGEST_HEADER = 100
_OTHER_DELIMITERS = {";": "semicolons", "\t": "tabs", "|": "bars", " ": "spaces"}
_HEADER = re.compile(r"\s*(\w+)\s*(?:\[\s*(\w+)\s*\])?\s*")


def read_csv(path: str | Path) -> tuple[Array, Array]:
    """Read a comma-separated table of spheres.

    The first line names the columns x, y, z and radius, in any order, each with its unit unless it
    is the metre: `x [mm]`. Blank lines and lines that begin with # are ignored.

    Args:
        path: the file, in UTF-8.

    Returns:
        Centres (N, 3) [m] and radii (N,) [m].

    Raises:
        InvalidInput: names file, line, column and value.
    """
    what = f"CSV file '{path}'"
    lines = read_text("CSV file", checked_path("path", path), "utf-8-sig").splitlines()
    for line, text in enumerate(lines, start=1):
        if len(text) > _LONGEST_LINE:
            allowed = f"at most {_LONGEST_LINE} characters"
            raise InvalidInput(f"{what}, line {line}", f"{len(text)} characters", allowed)
    check_memory(what, {"lines": len(lines)}, BYTES_PER_SPHERE, "fewer spheres")
    cells, used = _first_row(what, lines)
    table = _Table(what, len(cells), *_header(what, cells))
    whole = any('"' in text for text in lines[used:])  # a quoted cell may go on in the next line
    size = max(1, len(lines) if whole else _LINES_AT_ONCE)
    parts = [table.values(lines, k, k + size) for k in range(used, len(lines), size)]
    values = np.concatenate([np.zeros((0, len(COLUMNS))), *parts])
    return values[:, :3], values[:, 3]


def _first_row(what: str, lines: list[str]) -> tuple[list[str], int]:
    """The cells of the first line that is not ignored, and the number of lines up to its end."""
    reader = csv.reader(lines)
    try:
        for row in reader:
            if not _is_ignored(row):
                return row, reader.line_num
    except csv.Error as error:
        raise _broken(what, error) from None
    raise InvalidInput(what, "no line", f"a header that names {', '.join(COLUMNS)}")


class _Table(NamedTuple):
    """How the lines below the header are read."""

    what: str
    width: int
    places: list[int]
    scales: list[float]

    def values(self, lines: list[str], begin: int, end: int) -> Array:
        """(n, 4) x, y, z and radius [m] on the lines `begin` to `end` - 1, counted from 0."""
        block = lines[begin:end]
        numbers = _plain_numbers(block, self.width)
        if numbers is None:
            return self._values_one_by_one(block, begin + 1)
        values = numbers[:, self.places] * self.scales
        near = np.abs(values[:, :3]).max(initial=0.0) <= FARTHEST  # false for NaN
        radii = values[:, 3]
        if near and radii.min(initial=1.0) > 0.0 and radii.max(initial=0.0) <= LARGEST_NUMBER:
            return values
        return self._values_one_by_one(block, begin + 1)

    def _values_one_by_one(self, block: list[str], first: int) -> Array:
        """The same for lines that hold more than plain numbers, or a mistake, which is named."""
        reader, values = csv.reader(block), []
        try:
            for row in reader:
                if not _is_ignored(row):
                    values.append(self._values_of(row, first + reader.line_num - 1))
        except csv.Error as error:
            raise _broken(self.what, error) from None
        return np.array(values, dtype=np.float64).reshape(-1, len(COLUMNS))

    def _values_of(self, row: list[str], line: int) -> list[float]:
        where = f"{self.what}, line {line}"
        if len(row) != self.width:
            raise InvalidInput(where, f"{len(row)} values", f"{self.width}, as in the header")
        return [
            _metres(f"{where}, column {name}", name, row[place].strip(), scale)
            for name, place, scale in zip(COLUMNS, self.places, self.scales, strict=True)
        ]


def _plain_numbers(block: list[str], width: int) -> Array | None:
    """(n, width) the numbers on lines that hold nothing else; None if some do.

    NumPy reads the same decimal numbers as `_NUMBER` and in addition nan and infinity, which the
    caller has to refuse, and skips empty lines likewise.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # such as one of no number at all
            numbers = np.loadtxt(block, delimiter=",", comments=None, ndmin=2)
    except (ValueError, UserWarning):
        return None
    return numbers if numbers.shape[1] == width else None


def _is_ignored(row: list[str]) -> bool:
    """Whether a line is blank or a comment."""
    return not any(cell.strip() for cell in row) or row[0].lstrip().startswith("#")


def _broken(what: str, error: csv.Error) -> InvalidInput:
    return InvalidInput(what, str(error), "a comma-separated table")


def checked_spheres(of: str, centers: ArrayLike, radii: ArrayLike, row: str) -> tuple[Array, Array]:
    """Check spheres.

    Args:
        of: what begins the messages, such as the name of a file.
        centers: (N, 3) [m].
        radii: (N,) [m].
        row: what messages call one of the spheres.

    Returns:
        Read-only copies.

    Raises:
        InvalidInput: names the first sphere that cannot be, and its number that is wrong.
    """
    c = finite_array(f"{of}centers", centers, (-1, 3), FARTHEST, row)
    r = finite_array(f"{of}radii", radii, (-1,), row=row)
    if len(c) != len(r):
        allowed = f"one for each of {len(c)} centers"
        raise InvalidInput(f"{of}radii", f"{len(r)} radii", allowed)
    for i in np.flatnonzero(r <= 0.0)[:1]:
        raise InvalidInput(f"{of}radii, {row} {i}", float(r[i]), "greater than 0 m")
    return c, r


def write_csv(path: str | Path, centers: Array, radii: Array) -> None:
    """Write a table in metres that `read_csv` reads again bit for bit.

    Args:
        path: the file, replaced if it exists.
        centers: (N, 3) [m].
        radii: (N,) [m].

    Raises:
        InvalidInput: a path that cannot be written.
    """
    target = checked_path("path", path)
    rows = np.column_stack([centers, radii]).tolist()
    lines = [",".join(f"{name} [m]" for name in COLUMNS)]
    lines += [",".join(map(repr, row)) for row in rows]
    write_text("path", target, "\n".join(lines) + "\n")


def read_numpy(path: str | Path) -> tuple[Array, Array]:
    """Read spheres from a NumPy file. Pickled objects are not read.

    Args:
        path: a `.npy` file with one array (N, 4) of rows x, y, z, radius [m], or a `.npz` file with
            the arrays `centers` and `radii`.

    Returns:
        Centres (N, 3) [m] and radii (N,) [m].

    Raises:
        InvalidInput: names the file, its content and what is allowed.
    """
    what = f"NumPy file '{path}'"
    file = checked_path("path", path, ".npy", ".npz")
    try:
        if file.suffix == ".npy":
            table = _array(what, file.open("rb"), "spheres")
        else:
            centers, radii = _members(what, file)
    except InvalidInput:
        raise
    except OSError as error:
        raise InvalidInput("NumPy file", str(path), f"a readable file ({reason(error)})") from None
    except Exception as error:  # NumPy raises many types for a file of arbitrary content
        allowed = f"a file of numbers ({reason(error)})"
        raise InvalidInput("NumPy file", str(path), allowed) from None
    if file.suffix == ".npz":
        return checked_spheres(f"{what}, ", centers, radii, "row")
    if table.ndim != 2 or table.shape[1] != len(COLUMNS):
        raise InvalidInput(what, f"shape {table.shape}", "shape (N, 4): x, y, z, radius")
    return checked_spheres(f"{what}, ", table[:, :3], table[:, 3], "row")


def _members(what: str, file: Path) -> tuple[Array, Array]:
    """The arrays centers and radii of an archive; others are not read."""
    with zipfile.ZipFile(file) as archive:
        names = [name.removesuffix(".npy") for name in archive.namelist()]
        for name in ("centers", "radii"):
            if name not in names:
                raise InvalidInput(what, ", ".join(names) or "nothing", "arrays centers and radii")
        centers, radii = (
            _array(f"{what}, {name}", archive.open(f"{name}.npy"), "values")
            for name in ("centers", "radii")
        )
    return centers, radii


def _array(what: str, file: IO[bytes], counted: str) -> Array:
    """An array whose size its header states, before any of it is read."""
    with file:
        version = np.lib.format.read_magic(file)
        read = np.lib.format.read_array_header_1_0
        if version != (1, 0):
            read = np.lib.format.read_array_header_2_0
        shape, in_columns, kind = read(file)
        if kind.kind not in "iuf":
            raise InvalidInput(what, f"numbers of the kind {kind.name}", "real numbers")
        count = math.prod(shape)
        check_memory(what, {counted: count}, BYTES_PER_SPHERE // 4, "fewer spheres")
        content = file.read(count * kind.itemsize)
    array = np.frombuffer(content, kind).reshape(shape, order="F" if in_columns else "C")
    return array.astype(np.float64)


def _header(what: str, cells: list[str]) -> tuple[list[int], list[float]]:
    """Position of each of `COLUMNS` in the table, and the metres in its unit."""
    names, units = [], []
    for cell in cells:
        match = _HEADER.fullmatch(cell) if len(cell) <= _LONGEST_HEADER else None
        name = match.group(1) if match else cell
        if other := _delimiter(cell):
            raise InvalidInput(f"{what}, header", cell, f"commas between columns, not {other}")
        if name not in COLUMNS:
            raise unknown_name(f"{what}, header", cell, COLUMNS)
        if name in names:
            raise InvalidInput(f"{what}, header", name, "each column once")
        unit = (match.group(2) if match else None) or "m"
        if unit not in UNITS:
            raise unknown_name(f"{what}, unit of column {name}", unit, UNITS)
        names.append(name)
        units.append(UNITS[unit])
    for name in COLUMNS:
        if name not in names:
            raise InvalidInput(f"{what}, header", ", ".join(names), f"a column {name} as well")
    places = [names.index(name) for name in COLUMNS]
    return places, [units[k] for k in places]


def _delimiter(cell: str) -> str:
    """What separates the columns of a header that no comma has split; empty if nothing does."""
    for mark, name in _OTHER_DELIMITERS.items():
        if sum(part.split("[")[0].strip() in COLUMNS for part in cell.split(mark)) > 1:
            return name
    return ""


def _metres(what: str, column: str, text: str, unit: float) -> float:
    """A cell in metres; `unit` is that of its column [m]."""
    radius = column == "radius"
    value = float(text) * unit if _NUMBER.fullmatch(text) else math.nan
    if not math.isfinite(value) or (radius and value <= 0.0):
        raise InvalidInput(what, text, "a finite number" + " greater than 0" * radius)
    most = LARGEST_NUMBER if radius else FARTHEST
    if abs(value) > most:
        raise InvalidInput(what, text, f"at most {most:g} m")
    return value
