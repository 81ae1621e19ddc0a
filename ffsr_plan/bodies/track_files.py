"""Tables of numbers with units in CSV files, such as of time, position and attitude."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.checks import unknown_name
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import read_text

LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "km": 1e3}
"""Metres in each unit of length that a header may contain, the metre first."""
_UNITS: dict[str, dict[str, float]] = {
    "t": {"s": 1.0, "min": 60.0},
    **dict.fromkeys("xyz", LENGTHS),
    **{axis: {} for axis in ("qx", "qy", "qz", "qw")},
}
_HEADER = re.compile(r"\s*(\w{1,20})\s*(?:\[\s*(\w{1,20}(?:/s)?)\s*\])?\s*")
_LARGEST_FILE = 50_000_000  # [bytes]


def read_track(path: str | Path) -> tuple[Array, Array, Array]:
    """Read a comma-separated table of poses.

    The first line names the columns t, x, y, z, qx, qy, qz and qw, in any order, with a unit unless
    it is the second or the metre: `x [mm]`. Blank lines and lines that begin with # are ignored.

    Args:
        path: the file, in UTF-8.

    Raises:
        InvalidInput: names file, line, column and value.

    Returns:
        (n,) times [s], (n, 3) positions [m] and (n, 4) quaternions (x, y, z, w).
    """
    table = read_columns(path, _UNITS)
    return table[:, 0], table[:, 1:4], table[:, 4:]


def read_columns(path: str | Path, columns: Mapping[str, Mapping[str, float]]) -> Array:
    """Read a comma-separated table whose first line names its columns.

    Args:
        path: the file, in UTF-8.
        columns: all columns, with what a unit counts by each unit that a header may contain.

    Raises:
        InvalidInput: names file, line, column and value.

    Returns:
        (n, columns) in the order of `columns`.
    """
    what = f"CSV file '{path}'"
    text = read_text("CSV file", checked_path("path", path), "utf-8-sig", _LARGEST_FILE)
    reader, rows = csv.reader(text.splitlines()), list[list[float]]()
    scales: dict[str, float] = {}
    try:
        for row in reader:
            if not any(cell.strip() for cell in row) or row[0].lstrip().startswith("#"):
                continue
            if scales:
                rows.append(_numbers(f"{what}, line {reader.line_num}", row, scales, columns))
            else:
                scales = _header(what, row, columns)
    except csv.Error as error:
        raise InvalidInput(what, str(error), "a comma-separated table") from None
    if not scales:
        raise InvalidInput(what, "no line", f"a header that names {', '.join(columns)}")
    return np.array(rows, dtype=np.float64).reshape(-1, len(columns))


def _header(
    what: str, cells: list[str], columns: Mapping[str, Mapping[str, float]]
) -> dict[str, float]:
    """The columns in their order, with what the unit of each counts."""
    found: dict[str, float] = {}
    for cell in cells:
        match = _HEADER.fullmatch(cell)
        name, unit = match.groups() if match else (cell, None)
        if name not in columns:
            raise unknown_name(f"{what}, header", cell, columns)
        if name in found:
            raise InvalidInput(f"{what}, header", name, "each column once")
        units = columns[name]
        if unit is not None and unit not in units:
            raise unknown_name(f"{what}, unit of column {name}", unit, units or ["none"])
        found[name] = units[unit] if unit else 1.0
    for name in columns:
        if name not in found:
            raise InvalidInput(f"{what}, header", ", ".join(found), f"a column {name} as well")
    return found


def _numbers(
    where: str, row: list[str], scales: dict[str, float], columns: Iterable[str]
) -> list[float]:
    """The numbers of a line, in the order of `columns`."""
    if len(row) != len(scales):
        raise InvalidInput(where, f"{len(row)} values", f"{len(scales)}, as in the header")
    values = {}
    for (name, scale), cell in zip(scales.items(), row, strict=True):
        try:
            values[name] = float(cell) * scale
        except ValueError:
            raise InvalidInput(f"{where}, column {name}", cell, "a number") from None
        if not math.isfinite(values[name]):
            raise InvalidInput(f"{where}, column {name}", cell, "a finite number")
    return [values[name] for name in columns]
