"""Trajectories as comma-separated tables: a column of times, one of each joint, and the base's.

The header names the columns, each with its unit unless it is the second, the radian or the metre:
`t [s]`, `elbow [deg]`, `wrist (deg)`, `elbow velocity [rad/s]`, `base_x [m]`, `base_qx`. The tables
that plans and flights write are read as well: what is no time, joint or base pose there is skipped.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.checks import unknown_name
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import read_text, write_text
from ffsr_plan.trajectory.trajectory import INTERPOLATIONS, Trajectory

_TIME = ("t", "time", "timestamp", "time_from_start", "s")
_TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "1": 1.0}
_VALUES = {"rad": 1.0, "deg": math.pi / 180.0, "m": 1.0, "cm": 1e-2, "mm": 1e-3, "1": 1.0}
_RATES = {f"{unit}/s": scale for unit, scale in _VALUES.items()}
_LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "km": 1e3}
_UNITS = {
    "time": _TIMES,
    "position": _VALUES,
    "velocity": _RATES,
    "base": _LENGTHS,
    "quat": {"1": 1.0},
    "base_v": {f"{unit}/s": scale for unit, scale in _LENGTHS.items()},
}
_SKIPPED = re.compile(r"base_(a|w|dw)[xyz]|alpha|beta|gamma|(thrust|wheel_\w+)_[xyz]")
_HEADER = re.compile(
    r"\s*([^\[\]()]*?)\s*(position|velocity|acceleration|torque|force|effort)?\s*"
    r"(?:\(([^)]*)\))?\s*(?:\[\s*([^\]\s][^\]]*?)\s*\])?\s*"
)
_COMMENT = re.compile(r"#\s*interpolation\s*[:=]\s*(\w+)\s*")
_LONGEST_CLOCK = (
    1e6  # [s] beyond which times count from the first one: they are those of a calendar
)
_Columns = dict[tuple[str, str], tuple[int, float]]
"""Place and scale of each column that is read, by what it is and its name."""


def read_csv(path: str | Path, interpolation: str | None = None) -> Trajectory:
    """Read a comma-separated table.

    Blank lines and lines that begin with # are ignored, but for `# interpolation: cubic`. Times
    beyond 1e6 s, such as those since 1970, are counted from the first one. Where there is no column
    of times, the path parameter `s` counts as the time.

    Args:
        path: the file, in UTF-8.
        interpolation: `linear` or `cubic`, in place of what the file says; without either, linear.

    Raises:
        InvalidInput: names file, line, column and value.
    """
    what = f"CSV file '{path}'"
    lines = read_text("CSV file", checked_path("path", path), "utf-8-sig").splitlines()
    said = [found.group(1) for found in map(_COMMENT.fullmatch, lines) if found]
    columns: _Columns = {}
    rows = list[list[float]]()
    width = 0
    for number, cells in _lines(what, lines):
        if not columns:
            columns, width = _header(what, cells), len(cells)
        else:
            rows.append(_numbers(f"{what}, line {number}", cells, width, columns))
    if not columns:
        raise InvalidInput(what, "no line", "a header that names time and joints")
    table = np.array(rows, dtype=np.float64).reshape(-1, len(columns))
    named = dict(zip(columns, table.T, strict=True))
    return _trajectory(what, named, interpolation or (said[0] if said else INTERPOLATIONS[0]))


def write_csv(path: str | Path, trajectory: Trajectory) -> None:
    """Write a table that `read_csv` reads again bit for bit.

    Args:
        path: the file, replaced if it exists.
        trajectory: the trajectory.

    Raises:
        InvalidInput: no trajectory, or a file that cannot be written.
    """
    target = checked_path("path", path)
    if not isinstance(trajectory, Trajectory):
        raise InvalidInput("trajectory", trajectory, "a Trajectory")
    table = {"t [s]": trajectory.times}
    for values, header in (
        (trajectory.base_positions, "base_{} [m]"),
        (trajectory.base_attitudes, "base_q{} [1]"),
        (trajectory.base_velocities, "base_v{} [m/s]"),
    ):
        if values is not None:
            axes = zip("xyzw", values.T, strict=False)
            table |= {header.format(axis): column for axis, column in axes}
    table |= {f"{name} position": numbers for name, numbers in trajectory.joints.items()}
    table |= {f"{name} velocity": numbers for name, numbers in trajectory.velocities.items()}
    text = io.StringIO(newline="")
    text.write(f"# interpolation: {trajectory.interpolation}\n")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(table)
    writer.writerows(np.column_stack(list(table.values())).tolist())
    write_text("path", target, text.getvalue())


def _lines(what: str, lines: list[str]) -> Iterator[tuple[int, list[str]]]:
    """Numbers and cells of the lines that are not ignored."""
    reader = csv.reader(lines)
    try:
        for cells in reader:
            if any(cell.strip() for cell in cells) and not cells[0].lstrip().startswith("#"):
                yield reader.line_num, cells
    except csv.Error as error:
        raise InvalidInput(what, str(error), "a comma-separated table") from None


def _header(what: str, cells: list[str]) -> _Columns:
    """The columns that are read, in their order."""
    found: _Columns = {}
    for place, cell in enumerate(cells):
        match = _HEADER.fullmatch(cell)
        name, quantity, note, unit = match.groups() if match else (cell, None, None, None)
        kind = _kind(str(name), quantity)
        if kind is None:
            continue
        if unit is None and note is not None:  # where both are given, the first is a remark
            unit = note.strip()
        if not name:
            raise InvalidInput(f"{what}, header", cell, "a name in each column")
        units = _UNITS[kind]
        if unit is not None and unit not in units:
            raise unknown_name(f"{what}, unit of column '{name}'", unit, units)
        key = (kind, str(name))
        if key in found:
            raise InvalidInput(f"{what}, header", name, "each column once")
        found[key] = place, units[unit] if unit else 1.0
    if not any(kind == "time" for kind, _ in found):
        shown = ", ".join(cell.strip() for cell in cells)
        allowed = "columns parted by commas" if len(cells) == 1 else "a column t [s] of times"
        raise InvalidInput(f"{what}, header", shown, allowed)
    return found


def _kind(name: str, quantity: str | None) -> str | None:
    """What a column holds; None for one that is skipped."""
    if quantity is None and name.casefold() in _TIME:
        return "time"
    if quantity not in (None, "position", "velocity") or _SKIPPED.fullmatch(name):
        return None
    for kind, pattern in (
        ("base", "base_[xyz]"),
        ("quat", "base_q[xyzw]"),
        ("base_v", "base_v[xyz]"),
    ):
        if re.fullmatch(pattern, name):
            return kind
    return quantity or "position"


def _numbers(where: str, cells: list[str], width: int, columns: _Columns) -> list[float]:
    """The numbers of a line, in the order of the columns, in seconds, radians and metres."""
    if len(cells) != width:
        raise InvalidInput(where, f"{len(cells)} values", f"{width}, as in the header")
    numbers = []
    for (_, name), (place, scale) in columns.items():
        try:
            value = float(cells[place])
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise InvalidInput(f"{where}, column '{name}'", cells[place], "a finite number")
        numbers.append(value if scale == 1.0 else value * scale)
    return numbers


def _trajectory(what: str, table: dict[tuple[str, str], Array], interpolation: str) -> Trajectory:
    """The trajectory of the columns of a table."""
    clocks = {name: column for (kind, name), column in table.items() if kind == "time"}
    if len(clocks) > 1:
        clocks.pop("s", None)
    if len(clocks) > 1:
        raise InvalidInput(f"{what}, header", ", ".join(clocks), "one column of times")
    times = next(iter(clocks.values()))
    if len(times) and abs(times[0]) > _LONGEST_CLOCK:
        times = times - times[0]
    return Trajectory(
        times,
        {name: column for (kind, name), column in table.items() if kind == "position"},
        velocities={name: column for (kind, name), column in table.items() if kind == "velocity"},
        base_positions=_base(what, table, "base", "xyz"),
        base_velocities=_base(what, table, "base_v", "xyz"),
        base_attitudes=_base(what, table, "quat", "xyzw"),
        interpolation=interpolation,
        source=what,
    )


def _base(what: str, table: dict[tuple[str, str], Array], kind: str, axes: str) -> Array | None:
    """(N, n) columns of the base, all of them or none."""
    head = {"base": "base_", "base_v": "base_v", "quat": "base_q"}[kind]
    names = [f"{head}{axis}" for axis in axes]
    present = [name for name in names if (kind, name) in table]
    if not present:
        return None
    if len(present) < len(names):
        raise InvalidInput(f"{what}, header", ", ".join(present), f"all of {', '.join(names)}")
    rows: Array = np.column_stack([table[kind, name] for name in names])
    return rows
