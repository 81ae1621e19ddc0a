"""Tables of drifting spheres in CSV files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ffsr_plan.bodies.track_files import LENGTHS, read_columns
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.text_files import write_text

_SPEEDS = {f"{unit}/s": metres for unit, metres in LENGTHS.items()}
_UNITS: dict[str, dict[str, float]] = {
    **dict.fromkeys(("x", "y", "z", "radius"), LENGTHS),
    **dict.fromkeys(("vx", "vy", "vz"), _SPEEDS),
}


def read_debris(path: str | Path) -> tuple[Array, Array, Array]:
    """Read a comma-separated table of drifting spheres.

    The first line names the columns x, y, z, radius, vx, vy and vz, in any order, with a unit
    unless it is the metre or metres per second: `vx [mm/s]`.

    Args:
        path: the file, in UTF-8.

    Raises:
        InvalidInput: names file, line, column and value.

    Returns:
        (N, 3) centres [m], (N,) radii [m] and (N, 3) velocities [m/s].
    """
    table = read_columns(path, _UNITS)
    return table[:, :3], table[:, 3], table[:, 4:]


def write_debris(path: str | Path, centers: Array, radii: Array, velocities: Array) -> None:
    """Write a table in metres and seconds that `read_debris` reads again bit for bit.

    Args:
        path: the file, replaced if it exists.
        centers: (N, 3) [m].
        radii: (N,) [m].
        velocities: (N, 3) [m/s].

    Raises:
        InvalidInput: a path that cannot be written.
    """
    rows = np.column_stack([centers, radii, velocities]).tolist()
    lines = [",".join(f"{name} [{next(iter(units))}]" for name, units in _UNITS.items())]
    lines += [",".join(map(repr, row)) for row in rows]
    write_text("path", checked_path("path", path), "\n".join(lines) + "\n")
