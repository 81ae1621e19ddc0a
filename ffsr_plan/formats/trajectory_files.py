"""Trajectory files of every kind, by the ends of their names."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ffsr_plan.core.checks import one_of, unknown_name
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.formats.csv_trajectories import read_csv, write_csv
from ffsr_plan.formats.mcap_trajectories import read_mcap, write_mcap
from ffsr_plan.formats.mujoco_models import read_mjcf
from ffsr_plan.formats.numpy_trajectories import read_numpy, write_numpy
from ffsr_plan.formats.plan_trajectories import trajectory_of
from ffsr_plan.formats.ros_messages import read_ros, trajectory_from, write_ros
from ffsr_plan.formats.values.data_files import read_data
from ffsr_plan.plans.plan_file import read as read_plan
from ffsr_plan.trajectory.trajectory import INTERPOLATIONS, Trajectory


def _read_json(path: str | Path, interpolation: str | None) -> Trajectory:
    """A plan that `Plan.save` wrote, or a message."""
    data = read_data("trajectory", path)
    if isinstance(data, dict) and {"format", "problem", "motion"} <= data.keys():
        return trajectory_of(read_plan(Path(path)))
    return trajectory_from(f"file '{path}'", data, interpolation)


_READERS: dict[str, Callable[[str | Path, str | None], Trajectory]] = {
    ".csv": read_csv,
    ".npz": read_numpy,
    ".json": _read_json,
    ".yaml": read_ros,
    ".yml": read_ros,
    ".mcap": read_mcap,
    ".xml": read_mjcf,
}
_WRITERS: dict[str, Callable[[str | Path, Trajectory], None]] = {
    ".csv": write_csv,
    ".npz": write_numpy,
    ".json": write_ros,
    ".yaml": write_ros,
    ".yml": write_ros,
    ".mcap": write_mcap,
}


def read_trajectory(
    path: str | Path, interpolation: str | None = None, topic: str | None = None
) -> Trajectory:
    """Read a trajectory; the end of the file's name tells the format.

    Args:
        path: a file.
        interpolation: `linear` or `cubic`, in place of what the file says.
        topic: of a bag `*.mcap`, the only one that is read; `read_mcap` also takes a number.

    Raises:
        InvalidInput: another end, a topic of what is no bag, a file that cannot be read, or what is
            wrong in it.
    """
    target = checked_path("trajectory", path)
    if interpolation is not None:
        one_of("interpolation", interpolation, INTERPOLATIONS)
    reader = _READERS.get(target.suffix.casefold())
    if reader is None:
        raise unknown_name("trajectory", str(path), [f"a file *{end}" for end in _READERS])
    if not target.is_file():
        raise InvalidInput("trajectory", str(path), "a file that exists")
    if topic is None:
        return reader(target, interpolation)
    if target.suffix.casefold() != ".mcap":
        raise InvalidInput("topic", topic, f"None for '{target.name}', which is no bag")
    return read_mcap(target, interpolation, topic=topic)


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
