"""Trajectories and scenes in the formats of other tools, each with its reader and its writer."""

from __future__ import annotations

from ffsr_plan.formats.ccsds_messages import Frames, read_aem, read_oem, write_aem, write_oem
from ffsr_plan.formats.csv_trajectories import read_csv, write_csv
from ffsr_plan.formats.mcap_trajectories import read_mcap, write_mcap
from ffsr_plan.formats.mujoco_models import read_mjcf, read_mjcf_scene, write_mjcf
from ffsr_plan.formats.numpy_trajectories import read_numpy, write_numpy
from ffsr_plan.formats.plan_trajectories import trajectory_of
from ffsr_plan.formats.ros_messages import messages_of, read_ros, write_ros
from ffsr_plan.formats.scenes.moveit_scenes import read_moveit_scene, write_moveit_scene
from ffsr_plan.formats.scenes.primitive_scenes import read_primitives, write_primitives
from ffsr_plan.formats.scenes.scene_files import read_scene
from ffsr_plan.formats.trajectory_files import read_trajectory, write_trajectory

__all__ = [
    "Frames",
    "messages_of",
    "read_aem",
    "read_csv",
    "read_mcap",
    "read_mjcf",
    "read_mjcf_scene",
    "read_moveit_scene",
    "read_numpy",
    "read_oem",
    "read_primitives",
    "read_ros",
    "read_scene",
    "read_trajectory",
    "trajectory_of",
    "write_aem",
    "write_csv",
    "write_mcap",
    "write_mjcf",
    "write_moveit_scene",
    "write_numpy",
    "write_oem",
    "write_primitives",
    "write_ros",
    "write_trajectory",
]
