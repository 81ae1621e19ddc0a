"""Trajectories and scenes in the formats of other tools, each with its reader and its writer."""

from __future__ import annotations

from ffsr_plan.formats.csv_trajectories import read_csv, write_csv
from ffsr_plan.formats.numpy_trajectories import read_numpy, write_numpy
from ffsr_plan.formats.plan_trajectories import trajectory_of
from ffsr_plan.formats.scene_files import read_scene
from ffsr_plan.formats.trajectory_files import read_trajectory, write_trajectory

__all__ = [
    "read_csv",
    "read_numpy",
    "read_scene",
    "read_trajectory",
    "trajectory_of",
    "write_csv",
    "write_numpy",
    "write_trajectory",
]
