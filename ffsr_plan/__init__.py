"""ffsr-plan: collision-free motions of free-flying space robots, base reaction included.

import ffsr_plan as fp

problem = fp.load_scenario("fig2a")
plan = fp.plan(problem, seed=0)
assert plan.verify().ok
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ffsr_plan import momentum
from ffsr_plan.arms import arm_names
from ffsr_plan.axes import Axis, Lattice, PostureAxis
from ffsr_plan.bus import Bus, Panel
from ffsr_plan.catalog import RobotSummary, robot_summaries
from ffsr_plan.collision import Clearance, clearance
from ffsr_plan.colony import AntSystem, MaxMinAntSystem
from ffsr_plan.composition import Mount, compose
from ffsr_plan.edge_proof import EdgeProof, certify_edge
from ffsr_plan.end_effector import inverse_kinematics
from ffsr_plan.errors import (
    AttitudeOutOfReach,
    FfsrPlanError,
    GoalInCollision,
    InvalidInput,
    NoPath,
    PlanningError,
    PoseOutOfReach,
    StartInCollision,
    UnprovenPath,
)
from ffsr_plan.lattice import LayeredLattice
from ffsr_plan.optimum import LatticeOptimum
from ffsr_plan.planner import plan
from ffsr_plan.problem import Problem
from ffsr_plan.refinement import refine
from ffsr_plan.result import Plan
from ffsr_plan.roadmap import Roadmap
from ffsr_plan.robot import SpaceRobot, load_robot, robot_names
from ffsr_plan.scene import Scene
from ffsr_plan.timing import TimedPlan
from ffsr_plan.wheels import WheelMomentum

if TYPE_CHECKING:
    from ffsr_plan.live import LiveView
    from ffsr_plan.scenario import Scenario, load_scenario, read_scenario

__version__ = "0.1.0"
__all__ = [
    "AntSystem",
    "AttitudeOutOfReach",
    "Axis",
    "Bus",
    "Clearance",
    "EdgeProof",
    "FfsrPlanError",
    "GoalInCollision",
    "InvalidInput",
    "Lattice",
    "LatticeOptimum",
    "LayeredLattice",
    "LiveView",
    "MaxMinAntSystem",
    "Mount",
    "NoPath",
    "Panel",
    "Plan",
    "PlanningError",
    "PoseOutOfReach",
    "PostureAxis",
    "Problem",
    "Roadmap",
    "RobotSummary",
    "Scenario",
    "Scene",
    "SpaceRobot",
    "StartInCollision",
    "TimedPlan",
    "UnprovenPath",
    "WheelMomentum",
    "arm_names",
    "certify_edge",
    "clearance",
    "compose",
    "inverse_kinematics",
    "load_robot",
    "load_scenario",
    "momentum",
    "plan",
    "read_scenario",
    "refine",
    "robot_names",
    "robot_summaries",
]

_LAZY = {  # these need pydantic, or a web server
    "LiveView": "live",
    "Scenario": "scenario",
    "load_scenario": "scenario",
    "read_scenario": "scenario",
}


def __getattr__(name: str) -> object:
    if name in _LAZY:
        from importlib import import_module

        return getattr(import_module(f"ffsr_plan.{_LAZY[name]}"), name)
    raise AttributeError(f"module 'ffsr_plan' has no attribute '{name}'")
