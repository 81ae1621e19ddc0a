"""A trajectory for a problem of the set, judged: accepted with its figures, or refused and why."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ffsr_plan.certification.judgement import certify
from ffsr_plan.certification.trajectory_report import TrajectoryReport
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import FfsrPlanError, InvalidInput
from ffsr_plan.core.rotations import angle_between, to_angles
from ffsr_plan.problem.problem import Problem
from ffsr_plan.problem_set.bench_problem import BenchProblem
from ffsr_plan.problem_set.judging.figures import Figures, figures_of
from ffsr_plan.trajectory.trajectory import Trajectory

AT_START, AT_GOAL = 1e-6, 1e-3
"""Allowed differences from start and goal, in metres and radians alike."""
OF_BASE = 1e-3
"""Allowed difference of stated base poses from those that momentum leads to [m, rad]."""


@dataclass(frozen=True)
class Judgement:
    """What came of a trajectory.

    Attributes:
        problem: name of the problem.
        accepted: whether it solves the problem.
        reason: why not; empty where it does.
        length: L [m]; None where it is refused.
        objective: F of the whole motion [length units]; None where it is refused.
        delta_v: change of velocity [m/s]; None where it is refused.
        clearance: least distance from obstacles, sampled [m]; None where it is refused or there
            are none.
        proven_clearance: lower bound of it, proven; None likewise.
    """

    problem: str
    accepted: bool
    reason: str = ""
    length: float | None = None
    objective: float | None = None
    delta_v: float | None = None
    clearance: float | None = None
    proven_clearance: float | None = None


def judge(given: BenchProblem, trajectory: Trajectory) -> Judgement:
    """Judge a trajectory for a problem of the set, by `certify`; nothing it says is trusted.

    It has to begin at the start and end at the goal (within 1e-3 m and rad), stay within joint
    limits and window, take the problem's time where bodies move, and be proven free all along with
    the base reacting. Base poses that it states where the base reacts have to be those that
    conservation of momentum leads to.

    Args:
        given: the problem.
        trajectory: what a planner found.

    Raises:
        InvalidInput: no problem of the set, or no trajectory.
    """
    if not isinstance(given, BenchProblem):
        raise InvalidInput("given", given, "a BenchProblem, such as ProblemSet()['traps/07']")
    if not isinstance(trajectory, Trajectory):
        raise InvalidInput("trajectory", trajectory, "a Trajectory")
    return judged(given.name, given.problem, trajectory)


def judged(name: str, problem: Problem, trajectory: Trajectory) -> Judgement:
    """Judge a trajectory by `certify`; nothing that it says of itself is trusted.

    It has to begin at the start and end at the goal, stay within joint limits and window, take the
    problem's time where bodies move, obey the mode's physics as far as it states base poses, and be
    proven free all along.

    Args:
        name: of the problem.
        problem: the problem.
        trajectory: joint values over time; where thrusters move the base, its positions; where
            wheels hold it, its attitudes.
    """
    try:
        refused, report = _looked_at(problem, trajectory)
    except FfsrPlanError as error:
        return Judgement(name, False, str(error))
    if refused or report is None:
        return Judgement(name, False, refused)
    found: Figures = figures_of(problem, report)
    return Judgement(
        name,
        True,
        "",
        found.length,
        found.objective,
        found.delta_v,
        _finite(found.clearance),
        _finite(report.proven_clearance),
    )


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _looked_at(problem: Problem, given: Trajectory) -> tuple[str, TrajectoryReport | None]:
    """Why it is refused, or an empty text; and the report."""
    late = _wrong_time(problem, given)
    if late:
        return late, None
    report = certify(
        problem.robot,
        problem.obstacles,
        given,
        problem.mode,
        base_position=problem.start[:3],
        base_attitude=to_angles(problem.start[3:7]),
        tolerance=1e-6,
    )
    q = report.at(given.times)
    for wrong in (
        _wrong_start(problem, q[0]),
        "" if report.free else report.verdict(),
        _wrong_goal(problem, q[-1]),
        _outside(problem, report),
        _wrong_base(problem, given, q),
    ):
        if wrong:
            return wrong, None
    return "", report


def _wrong_time(problem: Problem, given: Trajectory) -> str:
    if problem.duration is None:
        return ""
    begin, end = float(given.times[0]), float(given.times[-1])
    if abs(begin) > AT_START or abs(end - problem.duration) > AT_START:
        asked = f"0 to {problem.duration:g} s is asked, as bodies move"
        return f"from {begin:g} to {end:g} s, where {asked}"
    return ""


def _wrong_start(problem: Problem, first: Array) -> str:
    robot = problem.robot
    away = {
        "base origin [m]": float(np.linalg.norm(first[:3] - problem.start[:3])),
        "base attitude [rad]": float(angle_between(first[3:7], problem.start[3:7])),
        "joints": float(np.max(np.abs(robot.joint_change(problem.start, first)), initial=0.0)),
    }
    return _farther("start", away, AT_START)


def _wrong_goal(problem: Problem, last: Array) -> str:
    robot, goal, mode = problem.robot, problem.goal, problem.mode
    apart = robot.joint_change(goal, last)
    turns = np.where(robot.prismatic, 0.0, 2.0 * np.pi * np.round(apart / (2.0 * np.pi)))
    away = {"joints": float(np.max(np.abs(apart - turns), initial=0.0))}  # a turn more is no other
    if mode.has_thrusters:
        away["base origin [m]"] = float(np.linalg.norm(last[:3] - goal[:3]))
    if mode.has_wheels or problem.reach_attitude:
        away["base attitude [rad]"] = float(angle_between(last[3:7], goal[3:7]))
    return _farther("goal", away, AT_GOAL)


def _farther(end: str, away: dict[str, float], allowed: float) -> str:
    for what, distance in away.items():
        if not distance <= allowed:
            return f"{what} {distance:.3g} away from the {end}, where {allowed:g} is allowed"
    return ""


def _outside(problem: Problem, report: TrajectoryReport) -> str:
    """Whether the base leaves the window, at the trajectory's own times and 401 others."""
    if problem.window is None:
        return ""
    times = report.trajectory.times
    q = report.at(np.union1d(times, np.linspace(times[0], times[-1], 401)))
    beyond = np.maximum(problem.window[0] - q[:, :3], q[:, :3] - problem.window[1]).max()
    if beyond > AT_START:
        return f"the base leaves its window by {beyond:.3g} m"
    return ""


def _wrong_base(problem: Problem, given: Trajectory, q: Array) -> str:
    """Whether base poses are stated that conservation of momentum does not allow."""
    mode = problem.mode
    if mode.floats and given.base_positions is not None:
        apart = float(np.linalg.norm(given.base_positions - q[:, :3], axis=1).max())
        if apart > OF_BASE:
            return f"the base is stated {apart:.3g} m from where momentum takes it ({mode})"
    if mode.attitude_reacts and given.base_attitudes is not None:
        turned = float(angle_between(given.base_attitudes, q[:, 3:7]).max())
        if turned > OF_BASE:
            return f"the base is stated {turned:.3g} rad from where its arms turn it ({mode})"
    return ""
