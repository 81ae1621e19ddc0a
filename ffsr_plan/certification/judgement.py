"""`certify`: is a trajectory free when the base reacts, and if not, what touches first."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.certification.end_effector import checked_frame
from ffsr_plan.certification.first_contact import first_contact
from ffsr_plan.certification.given_times import GivenTimes
from ffsr_plan.certification.sampled_trajectory import SAMPLES, configurations_at, samples_of
from ffsr_plan.certification.spans import RobotTrajectory, Span
from ffsr_plan.certification.trajectory_report import TrajectoryContact, TrajectoryReport
from ffsr_plan.collision.contacts import named
from ffsr_plan.collision.distances import Nearest, ObstacleQuery, SelfQuery
from ffsr_plan.core.checks import FARTHEST, finite_array, number
from ffsr_plan.core.contacts import obstacle_name
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.rotations import angle_between, from_angles
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.formats.plan_trajectories import trajectory_of
from ffsr_plan.formats.trajectory_files import read_trajectory
from ffsr_plan.planning.smooth_data import SmoothPlanData
from ffsr_plan.plans.plan_data import PlanData
from ffsr_plan.proof.prover import Prover
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene
from ffsr_plan.trajectory.flight import Flight
from ffsr_plan.trajectory.trajectory import Trajectory

_RESOLUTION = 1e-6  # [s] of the time of a contact


Given = Trajectory | PlanData | SmoothPlanData | Flight | str | Path
"""What can be judged; a text or path is that of a file."""


class _Found(NamedTuple):
    """What was found on a span: least proven clearance [m], or times [s] and the nearest pair.

    `near` is the time until which all is proven free, None where the whole span is.
    """

    queries: int
    clearance: float
    near: float | None
    contact: float | None
    pair: Nearest | None


def certify(
    robot: SpaceRobot,
    scene: Scene,
    trajectory: Given,
    mode: Mode | str = Mode.FREE_FLOATING,
    *,
    base_position: ArrayLike = (0.0, 0.0, 0.0),
    base_attitude: ArrayLike = (0.0, 0.0, 0.0),
    frame: str | None = None,
    tolerance: float = 1e-4,
) -> TrajectoryReport:
    """Prove that a trajectory touches nothing, or find what it touches first.

    The interpolated motion is what is judged, all of it, by interval halving (docs/proof.md), not
    at samples. Obstacles that move are where they are at each time. Limits of the joints are held
    by the values at the given times.

    Args:
        robot: the robot.
        scene: the obstacles.
        trajectory: a `Trajectory`, the path of a file that `formats.read_trajectory` reads, or a
            plan, smooth plan or flight, which `formats.trajectory_of` makes one of.
        mode: what the base does. `free-floating`: position and attitude follow from the joints by
            conservation of momentum, whatever the trajectory says of the base after the first time.
            `free-flying`: thrusters move its origin as the trajectory says, or hold it; its
            attitude follows from the joints. `attitude-held`: both are as the trajectory says, or
            held.
        base_position: (3,) base origin at the start where the trajectory has none, world [m].
        base_attitude: (3,) ZYX angles of the base at the start where the trajectory has none [rad].
        frame: the end effector whose drift is told, a frame of the model; by default the link with
            the most joints before it.
        tolerance: clearance below which a trajectory may be refused, at least 1e-7 [m].

    Returns:
        The report; its `free` is the answer.

    Raises:
        InvalidInput: naming the field, its value and what is allowed: joints that only robot or
            trajectory have, values beyond a limit (as of angles in degrees), a file that cannot be
            read, or an argument of another kind.
        IntegrationError: the reaction cannot be integrated, as the joints go too far in one piece.
    """
    if not isinstance(robot, SpaceRobot):
        raise InvalidInput("robot", robot, "a SpaceRobot")
    if not isinstance(scene, Scene):
        raise InvalidInput("scene", scene, "a Scene")
    trajectory = _given(trajectory)
    mode, frame = Mode.parse("mode", mode), checked_frame(robot, frame)
    allowed = number("tolerance", tolerance, at_least=1e-7)
    position = finite_array("base_position", base_position, (3,), FARTHEST)
    attitude = from_angles(finite_array("base_attitude", base_attitude, (3,)))
    run = RobotTrajectory(robot, mode, trajectory, position, attitude)
    return _judged(run, scene, frame, allowed)


def _judged(run: RobotTrajectory, scene: Scene, frame: str, tolerance: float) -> TrajectoryReport:
    """The report on a trajectory of a robot."""
    robot, spans, found = run.robot, list(run.spans()), list[_Found]()
    for span in spans:
        found.append(_proven(span, scene, tolerance))
        if found[-1].contact is not None:
            break
    times = [each.near for each in found if each.near is not None]
    free, last, contact = not times and found[-1].contact is None, found[-1], None
    if last.contact is not None and last.pair is not None:
        contact = _contact(robot, scene, spans, last.contact, last.pair)
    return TrajectoryReport(
        robot, scene, run.trajectory, run.mode, free,
        min(each.clearance for each in found) if free else 0.0, contact,
        times[0] if times else float(run.trajectory.times[-1]), frame,
        samples_of(robot, spans, frame), sum(each.queries for each in found), spans,
    )  # fmt: skip


def _given(trajectory: object) -> Trajectory:
    """The trajectory that is meant."""
    if isinstance(trajectory, Trajectory):
        return trajectory
    if isinstance(trajectory, (str, Path)):
        return read_trajectory(trajectory)
    if isinstance(trajectory, (PlanData, SmoothPlanData, Flight)):
        return trajectory_of(trajectory)
    allowed = "a Trajectory, the path of a file, a plan or a flight"
    raise InvalidInput("trajectory", trajectory, allowed)


def _proven(span: Span, scene: Scene, tolerance: float) -> _Found:
    """What is found on a span."""
    motion, still = span.motion, np.zeros((span.motion.edges + 1, 3))
    prover = Prover(motion, scene, tolerance, pace=GivenTimes.at(span.times))
    corners, edges = np.arange(motion.edges + 1), np.arange(motion.edges)
    clearances = prover.clearances(corners, still)
    ends = np.column_stack([clearances[:-1], clearances[1:]])
    verdicts = prover.certify_all(edges, still[1:], still[1:], ends)
    links = prover.links.verdicts()
    near = None
    for edge in edges.tolist():
        if verdicts[edge].free and links[edge].free:
            continue
        begin, length = float(span.times[edge]), float(np.diff(span.times)[edge])
        until, close = 2.0, None
        for each in prover.edges_at(edge):
            found = first_contact(each, tolerance, _RESOLUTION / length, min(until, 1.0))
            until = until if found.contact is None else min(until, found.contact)
            if found.near is not None:
                close = found.near if close is None else min(close, found.near)
        if until <= 1.0:
            pair = _pair(prover, edge, until)
            if near is None and close is not None:
                near = begin + close * length
            return _Found(prover.queries, 0.0, near, begin + until * length, pair)
        if close is not None and near is None:
            near = begin + close * length
    if near is not None:
        return _Found(prover.queries, 0.0, near, None, None)
    least = prover.least_clearance(still, clearances)
    return _Found(prover.queries, least, None, None, None)


def _pair(prover: Prover, edge: int, time: float) -> Nearest:
    """What touches at a time on an edge."""
    still = np.zeros(3)
    pairs = prover.nearest(edge, still, still, time), prover.links.nearest(edge, time)
    return min(pairs, key=lambda pair: pair.distance)


def _contact(
    robot: SpaceRobot, scene: Scene, spans: Sequence[Span], time: float, pair: Nearest
) -> TrajectoryContact:
    """The contact at a time [s], and the deepest one from then on."""
    end = float(spans[-1].times[-1])
    times = np.append(time, np.linspace(time, end, SAMPLES))
    q = configurations_at(spans, times)
    links, fixed = SelfQuery(robot), ObstacleQuery(robot, scene) if not scene.moves else None
    deepest, when = named(scene, pair), time
    for each, at in zip(q, times.tolist(), strict=True):
        placed = scene.at(at)
        query = fixed or ObstacleQuery(robot, placed)
        for found in (query.nearest(each), links.nearest(each)):
            if -found.distance > deepest.depth:
                deepest, when = named(placed, found), at
    first, met = configurations_at(spans, spans[0].times[:1])[0], named(scene, pair)
    turn = float(angle_between(first[3:7], q[0, 3:7]))
    name = obstacle_name(met.obstacle, met.source)
    return TrajectoryContact(time, met.link, met.obstacle, name, turn, when, deepest)
