"""Trajectory files of every kind, by the ends of their names."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ffsr_plan.core.checks import one_of, unknown_name
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.formats import csv_trajectories, numpy_trajectories
from ffsr_plan.trajectory.trajectory import INTERPOLATIONS, Trajectory

_READERS: dict[str, Callable[[str | Path, str | None], Trajectory]] = {
    ".csv": csv_trajectories.read_csv,
    ".npz": numpy_trajectories.read_numpy,
}
_WRITERS: dict[str, Callable[[str | Path, Trajectory], None]] = {
    ".csv": csv_trajectories.write_csv,
    ".npz": numpy_trajectories.write_numpy,
}


def read_trajectory(path: str | Path, interpolation: str | None = None) -> Trajectory:
    """Read a trajectory; the end of the file's name tells the format.

    Args:
        path: a file.
        interpolation: `linear` or `cubic`, in place of what the file says.

    Raises:
        InvalidInput: another end, a file that cannot be read, or what is wrong in it.
    """
    target = checked_path("trajectory", path)
    if interpolation is not None:
        one_of("interpolation", interpolation, INTERPOLATIONS)
    reader = _READERS.get(target.suffix.casefold())
    if reader is None:
        raise unknown_name("trajectory", str(path), [f"a file *{end}" for end in _READERS])
    if not target.is_file():
        raise InvalidInput("trajectory", str(path), "a file that exists")
    return reader(target, interpolation)


def write_trajectory(path: str | Path, trajectory: Trajectory) -> None:
    """Write a trajectory; the end of the file's name tells the format.

    Args:
        path: the file, replaced if it exists.
        trajectory: the trajectory.

    Raises:
        InvalidInput: another end, no trajectory, or a file that cannot be written.
    """
    target = checked_path("path", path)
    if not isinstance(trajectory, Trajectory):
        raise InvalidInput("trajectory", trajectory, "a Trajectory")
    writer = _WRITERS.get(target.suffix.casefold())
    if writer is None:
        raise unknown_name("path", str(path), [f"a file *{end}" for end in _WRITERS])
    writer(target, trajectory)
