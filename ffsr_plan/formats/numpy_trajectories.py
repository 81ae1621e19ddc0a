"""Trajectories as NumPy files: one array for each part."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.checks import unknown_name
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import reason, write_files
from ffsr_plan.trajectory.trajectory import Trajectory

_NEEDED = ("times", "positions", "joint_names")
_MORE = ("velocities", "base_positions", "base_velocities", "base_attitudes", "interpolation")


def read_numpy(path: str | Path, interpolation: str | None = None) -> Trajectory:
    """Read a `.npz` file.

    It holds `times` (N,) [s], `positions` (N, n) [rad or m] and `joint_names` (n,), and may hold
    `velocities` (N, n), `base_positions` (N, 3) [m], `base_velocities` (N, 3) [m/s],
    `base_attitudes` (N, 4) (x, y, z, w) and `interpolation`, a text.

    Args:
        path: the file.
        interpolation: `linear` or `cubic`, in place of what the file says; without either, linear.

    Raises:
        InvalidInput: names the file, the array and what is allowed.
    """
    target, what = checked_path("path", path, ".npz"), f"NumPy file '{path}'"
    try:
        with np.load(target, allow_pickle=False) as file:
            arrays: dict[str, Any] = {name: file[name] for name in file.files}
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        allowed = f"a .npz file of arrays of numbers and texts ({reason(error)})"
        raise InvalidInput("NumPy file", str(path), allowed) from None
    for name in arrays:
        if name not in _NEEDED + _MORE:
            raise unknown_name(f"{what}, arrays", name, _NEEDED + _MORE)
    for name in _NEEDED:
        if name not in arrays:
            allowed = f"an array {name} as well"
            raise InvalidInput(f"{what}, arrays", ", ".join(arrays) or "none", allowed)
    said = arrays.pop("interpolation", np.array("linear"))
    return Trajectory.of_array(
        arrays.pop("times"),
        arrays.pop("positions"),
        arrays.pop("joint_names").tolist(),
        **arrays,
        interpolation=interpolation or str(said),
        source=what,
    )


def write_numpy(path: str | Path, trajectory: Trajectory) -> None:
    """Write a `.npz` file that `read_numpy` reads again bit for bit.

    Args:
        path: the file, replaced if it exists; it ends in `.npz`.
        trajectory: the trajectory.

    Raises:
        InvalidInput: no trajectory, or a file that cannot be written.
    """
    target = checked_path("path", path, ".npz")
    if not isinstance(trajectory, Trajectory):
        raise InvalidInput("trajectory", trajectory, "a Trajectory")
    names = list(trajectory.joints)
    arrays: dict[str, Any] = {
        "times": trajectory.times,
        "positions": trajectory.joint_array(names),
        "joint_names": np.array(names, dtype=np.str_),
        "interpolation": np.array(trajectory.interpolation),
    }
    if trajectory.velocities:
        arrays["velocities"] = trajectory.joint_array(names, velocities=True)
    for name in ("base_positions", "base_velocities", "base_attitudes"):
        if getattr(trajectory, name) is not None:
            arrays[name] = getattr(trajectory, name)
    content = io.BytesIO()
    np.savez(content, **arrays)
    write_files("path", {target: content.getvalue()})
