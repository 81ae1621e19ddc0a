"""Trajectory files of every kind, by the ends of their names."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ffsr_plan.core.checks import one_of, unknown_name
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.formats import (
    csv_trajectories,
    mcap_trajectories,
    mujoco_models,
    numpy_trajectories,
    ros_messages,
)
from ffsr_plan.formats.plan_trajectories import trajectory_of
from ffsr_plan.formats.values.data_files import read_data
from ffsr_plan.plans.plan_file import read as read_plan
from ffsr_plan.trajectory.trajectory import INTERPOLATIONS, Trajectory


def _read_json(path: str | Path, interpolation: str | None) -> Trajectory:
    """A plan that `Plan.save` wrote, or a message."""
    data = read_data("trajectory", path)
    if isinstance(data, dict) and {"format", "problem", "motion"} <= data.keys():
        return trajectory_of(read_plan(Path(path)))
    return ros_messages.trajectory_from(f"file '{path}'", data, interpolation)


_READERS: dict[str, Callable[[str | Path, str | None], Trajectory]] = {
    ".csv": csv_trajectories.read_csv,
    ".npz": numpy_trajectories.read_numpy,
    ".json": _read_json,
    ".yaml": ros_messages.read_ros,
    ".yml": ros_messages.read_ros,
    ".mcap": mcap_trajectories.read_mcap,
    ".xml": mujoco_models.read_mjcf,
}
_WRITERS: dict[str, Callable[[str | Path, Trajectory], None]] = {
    ".csv": csv_trajectories.write_csv,
    ".npz": numpy_trajectories.write_numpy,
    ".json": ros_messages.write_ros,
    ".yaml": ros_messages.write_ros,
    ".yml": ros_messages.write_ros,
    ".mcap": mcap_trajectories.write_mcap,
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
