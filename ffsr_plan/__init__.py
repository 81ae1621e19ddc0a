"""ffsr-plan: collision-free motions of free-flying space robots, base reaction included.

import ffsr_plan as fp

problem = fp.load_scenario("fig2a")
plan = fp.plan(problem, seed=0)
assert plan.verify().ok
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ffsr_plan import errors, formats
    from ffsr_plan.bodies.body_motion import Drift, Poses, Spin
    from ffsr_plan.bodies.debris.debris_cloud import DebrisCloud
    from ffsr_plan.bodies.moving_body import MovingBody
    from ffsr_plan.bodies.pace import Pace
    from ffsr_plan.bodies.pose_function import PoseFunction
    from ffsr_plan.bodies.track import Track
    from ffsr_plan.bodies.tumble import Tumble
    from ffsr_plan.certification.bus_mass import on_bus
    from ffsr_plan.certification.judgement import certify
    from ffsr_plan.certification.trajectory_report import TrajectoryContact, TrajectoryReport
    from ffsr_plan.collision.clearance import Clearance, clearance
    from ffsr_plan.collision.self_collisions import SelfCollision, SelfCollisions, self_collisions
    from ffsr_plan.core.contacts import Contact
    from ffsr_plan.core.errors import (
        AttitudeOutOfReach,
        FfsrPlanError,
        GoalInCollision,
        GoalPoseIgnored,
        IntegrationError,
        InternalError,
        InvalidInput,
        NearDynamicSingularity,
        NoPath,
        OutOfTime,
        PathNotFound,
        PlanningError,
        PlanNotVerified,
        StartInCollision,
        UncheckedLinks,
        UnprovenCurve,
        UnprovenPath,
        WideTurns,
        WorkerDied,
    )
    from ffsr_plan.curves.curved_motion import CurvedMotion
    from ffsr_plan.curves.smooth_curve import CurvePoints, SmoothCurve
    from ffsr_plan.display.live.live_view import LiveView
    from ffsr_plan.display.web.page_server import PageServer
    from ffsr_plan.dynamics import momentum
    from ffsr_plan.dynamics.actuation_mode import Mode
    from ffsr_plan.dynamics.dynamic_singularity import SlowestPlace, least_singular_value
    from ffsr_plan.dynamics.inverse_dynamics import States
    from ffsr_plan.dynamics.motion import Motion
    from ffsr_plan.dynamics.wheel_momentum import WheelMomentum
    from ffsr_plan.fuel.least_fuel_planner import LeastFuel
    from ffsr_plan.goal_poses.inverse_kinematics import inverse_kinematics
    from ffsr_plan.goal_poses.pose_out_of_reach import (
        ArmReach,
        HeldBase,
        JointBeyond,
        PoseOutOfReach,
    )
    from ffsr_plan.lattice.certificate import Certificate, Counts
    from ffsr_plan.lattice.layered_lattice import LayeredLattice
    from ffsr_plan.lattice.roadmap import Roadmap
    from ffsr_plan.meetings.departure import Departure
    from ffsr_plan.meetings.meeting import Meeting
    from ffsr_plan.planning.certified_plan import Plan
    from ffsr_plan.planning.flights import SmoothFlight, TimedPlan
    from ffsr_plan.planning.plan_and_refine import plan, refine
    from ffsr_plan.planning.smooth_plan import SmoothPlan
    from ffsr_plan.planning.warm_up import warm_up
    from ffsr_plan.portfolio.portfolio_planner import Portfolio
    from ffsr_plan.problem.lattice_settings import Axis, Lattice, Progress
    from ffsr_plan.problem.posture_axes import PostureAxis, PostureTarget
    from ffsr_plan.problem.problem import Problem
    from ffsr_plan.problem_set.bench_problem import BenchProblem
    from ffsr_plan.problem_set.judging.judgement import Judgement, judge
    from ffsr_plan.problem_set.set_index import ProblemSet
    from ffsr_plan.proof.interval_halving import Verdict
    from ffsr_plan.proof.single_edge_proof import EdgeProof, certify_edge
    from ffsr_plan.published_numbers.literature import literature
    from ffsr_plan.published_numbers.recomputed_number import RecomputedNumber
    from ffsr_plan.robots.collision_shapes import Replacement
    from ffsr_plan.robots.kinematics import Components
    from ffsr_plan.robots.loading import load_robot, robot_names
    from ffsr_plan.robots.robot import SpaceRobot
    from ffsr_plan.robots.summary import RobotSummary, robot_summaries
    from ffsr_plan.robots.urdf.inertias import Balanced
    from ffsr_plan.robots.urdf.joints import RateLimits
    from ffsr_plan.satellites.arms import arm_names
    from ffsr_plan.satellites.bus import Bus, Panel
    from ffsr_plan.satellites.composition import Mount, compose
    from ffsr_plan.scenario_files.scenario import Scenario, load_scenario
    from ffsr_plan.scene import generators
    from ffsr_plan.scene.scene import Scene
    from ffsr_plan.scene.shapes.keep_in_zones import HalfSpace
    from ffsr_plan.scene.shapes.mesh_hulls import mesh_hulls
    from ffsr_plan.scene.shapes.obstacle_shapes import Ball, Box, Capsule, Cylinder, Ellipsoid, Hull
    from ffsr_plan.search.ants.ant_system import AntSystem
    from ffsr_plan.search.ants.max_min import MaxMinAntSystem
    from ffsr_plan.search.fuel_figures import FuelFigures
    from ffsr_plan.search.optimum_planner import LatticeOptimum
    from ffsr_plan.search.postures.posture_annealing import PostureAnnealing
    from ffsr_plan.search.records import (
        Branches,
        Cycle,
        History,
        SearchResult,
        Solution,
        Trails,
        TreeCycle,
    )
    from ffsr_plan.studies.running import StudyProgress
    from ffsr_plan.studies.study import Study
    from ffsr_plan.studies.study_result import StudyResult
    from ffsr_plan.timed_proof.unproven_flight import UnprovenFlight
    from ffsr_plan.trajectory.trajectory import Trajectory
    from ffsr_plan.tree_search.tree_planner import TreePlanner
    from ffsr_plan.verification.flights.verify_flight import FlightReport
    from ffsr_plan.verification.verify import Report

__version__ = "0.2.0.dev0"
__all__ = [
    "AntSystem",
    "ArmReach",
    "AttitudeOutOfReach",
    "Axis",
    "Balanced",
    "Ball",
    "BenchProblem",
    "Box",
    "Branches",
    "Bus",
    "Capsule",
    "Certificate",
    "Clearance",
    "Components",
    "Contact",
    "Counts",
    "CurvePoints",
    "CurvedMotion",
    "Cycle",
    "Cylinder",
    "DebrisCloud",
    "Departure",
    "Drift",
    "EdgeProof",
    "Ellipsoid",
    "FfsrPlanError",
    "FlightReport",
    "FuelFigures",
    "GoalInCollision",
    "GoalPoseIgnored",
    "HalfSpace",
    "HeldBase",
    "History",
    "Hull",
    "IntegrationError",
    "InternalError",
    "InvalidInput",
    "JointBeyond",
    "Judgement",
    "Lattice",
    "LatticeOptimum",
    "LayeredLattice",
    "LeastFuel",
    "LiveView",
    "MaxMinAntSystem",
    "Meeting",
    "Mode",
    "Motion",
    "Mount",
    "MovingBody",
    "NearDynamicSingularity",
    "NoPath",
    "OutOfTime",
    "Pace",
    "PageServer",
    "Panel",
    "PathNotFound",
    "Plan",
    "PlanNotVerified",
    "PlanningError",
    "Portfolio",
    "PoseFunction",
    "PoseOutOfReach",
    "Poses",
    "PostureAnnealing",
    "PostureAxis",
    "PostureTarget",
    "Problem",
    "ProblemSet",
    "Progress",
    "RateLimits",
    "RecomputedNumber",
    "Replacement",
    "Report",
    "Roadmap",
    "RobotSummary",
    "Scenario",
    "Scene",
    "SearchResult",
    "SelfCollision",
    "SelfCollisions",
    "SlowestPlace",
    "SmoothCurve",
    "SmoothFlight",
    "SmoothPlan",
    "Solution",
    "SpaceRobot",
    "Spin",
    "StartInCollision",
    "States",
    "Study",
    "StudyProgress",
    "StudyResult",
    "TimedPlan",
    "Track",
    "Trails",
    "Trajectory",
    "TrajectoryContact",
    "TrajectoryReport",
    "TreeCycle",
    "TreePlanner",
    "Tumble",
    "UncheckedLinks",
    "UnprovenCurve",
    "UnprovenFlight",
    "UnprovenPath",
    "Verdict",
    "WheelMomentum",
    "WideTurns",
    "WorkerDied",
    "arm_names",
    "certify",
    "certify_edge",
    "clearance",
    "compose",
    "errors",
    "formats",
    "generators",
    "inverse_kinematics",
    "judge",
    "least_singular_value",
    "literature",
    "load_robot",
    "load_scenario",
    "mesh_hulls",
    "momentum",
    "on_bus",
    "plan",
    "refine",
    "robot_names",
    "robot_summaries",
    "self_collisions",
    "warm_up",
]

_NAMES = {  # by module; each is loaded when one of its names is first used
    "bodies.body_motion": ("Drift", "Poses", "Spin"),
    "bodies.debris.debris_cloud": ("DebrisCloud",),
    "bodies.moving_body": ("MovingBody",),
    "bodies.pace": ("Pace",),
    "bodies.pose_function": ("PoseFunction",),
    "bodies.track": ("Track",),
    "bodies.tumble": ("Tumble",),
    "certification.bus_mass": ("on_bus",),
    "certification.judgement": ("certify",),
    "certification.trajectory_report": ("TrajectoryContact", "TrajectoryReport"),
    "collision.clearance": ("Clearance", "clearance"),
    "collision.self_collisions": ("SelfCollision", "SelfCollisions", "self_collisions"),
    "core.contacts": ("Contact",),
    "core.errors": (
        "AttitudeOutOfReach",
        "FfsrPlanError",
        "GoalInCollision",
        "GoalPoseIgnored",
        "IntegrationError",
        "InternalError",
        "InvalidInput",
        "NearDynamicSingularity",
        "NoPath",
        "OutOfTime",
        "PathNotFound",
        "PlanNotVerified",
        "PlanningError",
        "StartInCollision",
        "UncheckedLinks",
        "UnprovenCurve",
        "UnprovenPath",
        "WideTurns",
        "WorkerDied",
    ),
    "timed_proof.unproven_flight": ("UnprovenFlight",),
    "curves.curved_motion": ("CurvedMotion",),
    "curves.smooth_curve": ("CurvePoints", "SmoothCurve"),
    "display.live.live_view": ("LiveView",),
    "display.web.page_server": ("PageServer",),
    "dynamics.actuation_mode": ("Mode",),
    "dynamics.dynamic_singularity": ("SlowestPlace", "least_singular_value"),
    "dynamics.inverse_dynamics": ("States",),
    "dynamics.motion": ("Motion",),
    "dynamics.wheel_momentum": ("WheelMomentum",),
    "fuel.least_fuel_planner": ("LeastFuel",),
    "goal_poses.inverse_kinematics": ("inverse_kinematics",),
    "goal_poses.pose_out_of_reach": ("ArmReach", "HeldBase", "JointBeyond", "PoseOutOfReach"),
    "lattice.certificate": ("Certificate", "Counts"),
    "lattice.layered_lattice": ("LayeredLattice",),
    "lattice.roadmap": ("Roadmap",),
    "meetings.departure": ("Departure",),
    "meetings.meeting": ("Meeting",),
    "planning.certified_plan": ("Plan",),
    "planning.flights": ("SmoothFlight", "TimedPlan"),
    "planning.plan_and_refine": ("plan", "refine"),
    "planning.smooth_plan": ("SmoothPlan",),
    "planning.warm_up": ("warm_up",),
    "portfolio.portfolio_planner": ("Portfolio",),
    "problem.lattice_settings": ("Axis", "Lattice", "Progress"),
    "problem.posture_axes": ("PostureAxis", "PostureTarget"),
    "problem.problem": ("Problem",),
    "problem_set.bench_problem": ("BenchProblem",),
    "problem_set.judging.judgement": ("Judgement", "judge"),
    "problem_set.set_index": ("ProblemSet",),
    "proof.interval_halving": ("Verdict",),
    "proof.single_edge_proof": ("EdgeProof", "certify_edge"),
    "published_numbers.literature": ("literature",),
    "published_numbers.recomputed_number": ("RecomputedNumber",),
    "robots.collision_shapes": ("Replacement",),
    "robots.kinematics": ("Components",),
    "robots.loading": ("load_robot", "robot_names"),
    "robots.robot": ("SpaceRobot",),
    "robots.summary": ("RobotSummary", "robot_summaries"),
    "robots.urdf.inertias": ("Balanced",),
    "robots.urdf.joints": ("RateLimits",),
    "satellites.arms": ("arm_names",),
    "satellites.bus": ("Bus", "Panel"),
    "satellites.composition": ("Mount", "compose"),
    "scenario_files.scenario": ("Scenario", "load_scenario"),
    "scene.shapes.keep_in_zones": ("HalfSpace",),
    "scene.shapes.mesh_hulls": ("mesh_hulls",),
    "scene.shapes.obstacle_shapes": ("Ball", "Box", "Capsule", "Cylinder", "Ellipsoid", "Hull"),
    "scene.scene": ("Scene",),
    "search.ants.ant_system": ("AntSystem",),
    "search.ants.max_min": ("MaxMinAntSystem",),
    "search.fuel_figures": ("FuelFigures",),
    "search.optimum_planner": ("LatticeOptimum",),
    "search.postures.posture_annealing": ("PostureAnnealing",),
    "search.records": (
        "Branches",
        "Cycle",
        "History",
        "SearchResult",
        "Solution",
        "Trails",
        "TreeCycle",
    ),
    "studies.running": ("StudyProgress",),
    "studies.study": ("Study",),
    "studies.study_result": ("StudyResult",),
    "trajectory.trajectory": ("Trajectory",),
    "tree_search.tree_planner": ("TreePlanner",),
    "verification.flights.verify_flight": ("FlightReport",),
    "verification.verify": ("Report",),
}
_HOME = {name: module for module, names in _NAMES.items() for name in names}
_MODULES = {
    "errors": "errors",
    "formats": "formats",
    "generators": "scene.generators",
    "momentum": "dynamics.momentum",
}


def __getattr__(name: str) -> object:
    if name in _MODULES:
        found: object = import_module(f"ffsr_plan.{_MODULES[name]}")
    elif name in _HOME:
        found = getattr(import_module(f"ffsr_plan.{_HOME[name]}"), name)
    else:
        raise AttributeError(f"module 'ffsr_plan' has no attribute '{name}'")
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
