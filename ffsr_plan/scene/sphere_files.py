"""Files of spheres: CSV tables of x, y, z, radius, and NumPy arrays.

CSV is parsed here rather than by `numpy.loadtxt`, because that function knows no units in a header
and does not name the line and column of a wrong value.
"""

from __future__ import annotations

import csv
import math
import re
import zipfile
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import FARTHEST, LARGEST_NUMBER, finite_array
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.cost_estimate import check_memory
from ffsr_plan.core.errors import InvalidInput, unknown_name
from ffsr_plan.core.text_files import read_text, reason, write_text

COLUMNS = ("x", "y", "z", "radius")
UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "km": 1e3}
"""Metres in each unit that a header may contain."""
BYTES_PER_SPHERE = 800
"""Memory [bytes] that a sphere takes at most while its file is read and its tree is built."""
_LONGEST_LINE = 10_000
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
    try:
        numbered = list(enumerate(csv.reader(lines), start=1))
    except csv.Error as error:
        raise InvalidInput(what, str(error), "a comma-separated table") from None
    rows = [(line, row) for line, row in numbered if row and not row[0].lstrip().startswith("#")]
    rows = [(line, row) for line, row in rows if any(cell.strip() for cell in row)]
    if not rows:
        raise InvalidInput(what, "no line", f"a header that names {', '.join(COLUMNS)}")
    places, scales = _header(what, rows[0][1])
    values = np.empty((len(rows) - 1, len(COLUMNS)))
    for k, (line, row) in enumerate(rows[1:]):
        if len(row) != len(rows[0][1]):
            raise InvalidInput(
                f"{what}, line {line}", f"{len(row)} values", f"{len(rows[0][1])}, as in the header"
            )
        for c, name in enumerate(COLUMNS):
            given = row[places[c]].strip()
            about = f"{what}, line {line}, column {name}"
            values[k, c] = _metres(about, name, given, scales[c])
    return values[:, :3], values[:, 3]


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
