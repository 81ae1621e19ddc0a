"""Trajectories of plans and flights made here."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.curves.splines import evaluate
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.planning.smooth_data import SmoothPlanData
from ffsr_plan.plans.plan_data import PlanData
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.trajectory.flight import Flight
from ffsr_plan.trajectory.trajectory import Trajectory

_SECONDS = 1.0  # that a path takes which has no duration
_PARTS = 8  # of an edge over which the pace is not even
_RATE = 50.0  # [1/s] of the rows of a flight
_LARGEST = 1e9  # [s, 1/s]


def trajectory_of(
    source: PlanData | SmoothPlanData | Flight,
    *,
    duration: float | None = None,
    rate: float = _RATE,
) -> Trajectory:
    """The trajectory of a plan, of a smooth plan or of a flight, base pose included.

    A plan's joints and base are linear between its nodes, a smooth plan's are cubic pieces: both
    are taken as they are. A flight is sampled, with velocities, as cubic pieces between the rows.
    Attitudes are given at the times of the trajectory.

    Args:
        source: a `Plan`, a `SmoothPlan`, a `TimedPlan` or a `SmoothFlight`.
        duration: of a plan or smooth plan [s]; without, that of its problem, or 1 s. A flight has
            its own.
        rate: rows per second of a flight [1/s].

    Raises:
        InvalidInput: something else, or a duration or rate that is not allowed.
    """
    if duration is not None:
        duration = number("duration", duration, above=0.0, at_most=_LARGEST)
    rate = number("rate", rate, above=0.0, at_most=_LARGEST)
    if isinstance(source, Flight):
        return _of_flight(source, rate)
    if isinstance(source, SmoothPlanData):
        return _of_curve(source, duration or source.problem.duration or _SECONDS)
    if isinstance(source, PlanData):
        return _of_plan(source, duration)
    allowed = "a Plan, a SmoothPlan, a TimedPlan or a SmoothFlight"
    raise InvalidInput("source", source, allowed)


def _of_plan(plan: PlanData, duration: float | None) -> Trajectory:
    motion: Motion = plan.motion
    pace = plan.problem.pace(motion.edges)
    parts = 1 if pace is None or pace.ramp == 0.0 else _PARTS
    places = np.arange(parts * motion.edges + 1) / parts
    times = places / motion.edges if pace is None else pace.instants(places) / pace.duration
    times = times * (duration or plan.problem.duration or _SECONDS)
    edge = np.minimum(places.astype(np.int64), motion.edges - 1)
    q, joints = motion.at(edge, places - edge), motion.joints_at(edge, places - edge)
    return Trajectory(
        times,
        _named(motion.robot, joints),
        base_positions=q[:, :3],
        base_attitudes=q[:, 3:7],
        source=f"plan of {motion.robot.name}",
    )


def _of_curve(smooth: SmoothPlanData, duration: float) -> Trajectory:
    motion = smooth.curve.motion
    step = duration / motion.edges
    last = np.append(np.arange(motion.edges), motion.edges - 1)
    ends = np.append(np.zeros(motion.edges), 1.0)
    rates = evaluate(motion.pieces.rates, last, ends)[:, :-1] / step
    q, moved = motion.at(last, ends), motion.mode.has_thrusters
    return Trajectory(
        np.arange(motion.edges + 1) * step,
        _named(motion.robot, motion.joints_at(last, ends)),
        velocities=_named(motion.robot, rates[:, 3:]),
        base_positions=q[:, :3],
        base_velocities=rates[:, :3] if moved else None,
        base_attitudes=q[:, 3:7],
        interpolation="cubic",
        source=f"smooth plan of {motion.robot.name}",
    )


def _of_flight(flight: Flight, rate: float) -> Trajectory:
    times = flight.clock(rate)
    states = flight.at(times)
    return Trajectory(
        times,
        _named(flight.robot, states.joints),
        velocities=_named(flight.robot, states.joint_velocities),
        base_positions=states.base_position,
        base_velocities=states.base_velocity,
        base_attitudes=states.attitudes,
        interpolation="cubic",
        source=f"flight of {flight.robot.name}",
    )


def _named(robot: SpaceRobot, values: Array) -> dict[str, Array]:
    """Columns (N,) of values (N, nd) by the names of the joints."""
    return {name: values[:, k] for k, name in enumerate(robot.joint_names)}
