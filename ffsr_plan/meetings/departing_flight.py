"""A flight that begins in motion, along a curve that is proven free.

The curve begins with the configuration and the rates of the departure and joins the plan's path in
a window at its begin. As for meetings, windows are tried in turn, and curves with more control
points where the proof refuses one.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import IntegrationError, InvalidInput
from ffsr_plan.curves.control_points import ControlPoints, control_points_on
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.curves.smooth_curve import SmoothCurve
from ffsr_plan.dynamics.momentum import connection
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.meetings.approach import braking, with_end
from ffsr_plan.meetings.departure import Departure
from ffsr_plan.meetings.meeting_flight import WINDOWS, MeetingFlight, refuse_jerk, unproven
from ffsr_plan.meetings.met_body import touching_links
from ffsr_plan.meetings.timed_approach import SPEED, first_possible, pieces_for
from ffsr_plan.problem.problem import Problem
from ffsr_plan.smooth_flight.curve_flight import CurveFlight, curve_flight
from ffsr_plan.smooth_flight.pace_search import EndSpeeds
from ffsr_plan.smoothing.curve_proof import CurveProof, prove_curve
from ffsr_plan.smoothing.proven_curve import ProvenCurve
from ffsr_plan.trajectory.flight_limits import FlightLimits

_FACTORS = 1, 2, 4  # of the number of control points
_BALANCED = 1e-8  # [rad/s or m/s] by which the base may move otherwise than momentum lets it


class _Begin(NamedTuple):
    """The state in which a flight begins.

    Attributes:
        configuration: (nq,).
        joint_values: (nd,) on the branch of the plan's [rad or m].
        joint_rates: (nd,) [rad/s or m/s].
        base_velocity: (3,) of the base origin, world axes [m/s].
    """

    configuration: Array
    joint_values: Array
    joint_rates: Array
    base_velocity: Array


def departing_flight(
    problem: Problem, motion: Motion, departure: Departure, limits: FlightLimits, duration: float
) -> MeetingFlight:
    """The flight along a motion that begins with a departure; see `Plan.timed`.

    Args:
        problem: what was planned.
        motion: of the plan.
        departure: the state at the begin.
        limits: the limits; jerk cannot be limited.
        duration: of the flight [s].

    Raises:
        InvalidInput: a departure that cannot be, naming what is allowed.
        UnprovenCurve: no curve could be proven free.
    """
    refuse_jerk(limits, motion, "a departure")
    begin, scene = _begin(motion, departure, limits), problem.scene
    if duration > (known := scene.known_until):
        allowed = f"at most {known:.6g} s, up to which the motions of all bodies are known"
        raise InvalidInput("duration", duration, allowed)
    refused: list[CurveProof] = []
    for window in _by_delta_v(motion, begin, limits, duration):
        for factor in _FACTORS:
            flight = _flight(motion, begin, limits, duration, window, factor)
            if flight is None:
                break
            curve, touching = flight.curve.motion, None  # type: ignore[attr-defined]
            times = flight.timetable if scene.moves else None
            if times is not None:
                touching = touching_links(departure, scene, curve, times, leaves=True)
            proof = prove_curve(problem, curve, problem.tolerance, times, touching)
            if not len(proof.refused):
                nodes = _nodes(motion, window, curve.edges)
                before = sum(len(each.refused) for each in refused)
                queries = sum(each.prover.queries for each in refused)
                return MeetingFlight(
                    flight, ProvenCurve("departure", proof, nodes, before, queries)
                )
            refused.append(proof)
    raise unproven(problem, motion, refused, "departure")


def _begin(motion: Motion, departure: Departure, limits: FlightLimits) -> _Begin:
    """The state of a departure, checked.

    Raises:
        InvalidInput: a state that the robot does not have, whose base does not move as momentum
            lets it, or that is too fast.
    """
    robot, mode = motion.robot, motion.mode
    q = robot.check_configuration("departure.configuration", departure.configuration)
    velocity = departure.velocity
    if len(velocity) != robot.model.nv:
        raise InvalidInput("departure.velocity", velocity.tolist(), f"{robot.model.nv} numbers")
    first, rates = motion.joint_values[0], velocity[6:]
    values = robot.joint_values(q)
    endless = np.isinf(robot.upper)
    values[endless] += 2.0 * np.pi * np.round((first - values)[endless] / (2.0 * np.pi))
    _check_momentum(motion, q, velocity)
    base = rotations.matrix(q[3:7]) @ velocity[:3]
    speeds = np.concatenate([[np.linalg.norm(base)], np.abs(rates)])
    for name, speed, most in zip(
        ("the base", *robot.joint_names), speeds, limits.velocity[[0, *range(2, 2 + robot.nd)]],
        strict=True,
    ):  # fmt: skip
        if speed > most and not (mode.floats and name == "the base"):
            allowed = f"at most {most:.4g} m/s or rad/s of {name}, not {speed:.4g}"
            raise InvalidInput("departure.velocity", velocity.tolist(), allowed)
    return _Begin(q, values, rates, base)


def _check_momentum(motion: Motion, q: Array, velocity: Array) -> None:
    """Raise `InvalidInput` for a base that does not move as momentum lets it."""
    robot, mode, rates = motion.robot, motion.mode, velocity[6:]
    wanted = connection(robot, q) @ rates if mode.attitude_reacts else np.zeros(3)
    largest = float(np.max(np.abs(rates), initial=1.0))
    if np.max(np.abs(velocity[3:6] - wanted)) > _BALANCED * largest:
        why = "which conserve angular momentum" if mode.attitude_reacts else "as wheels hold it"
        allowed = f"{np.round(wanted, 9).tolist()} for the rotation of the base, {why}"
        raise InvalidInput("departure.velocity", velocity.tolist(), allowed)
    data = robot.model.createData()
    pin.centerOfMass(robot.model, data, q, velocity)
    if mode.floats and np.max(np.abs(data.vcom[0])) > _BALANCED:
        allowed = "a centre of mass at rest, as nothing moves the base"
        raise InvalidInput("departure.velocity", velocity.tolist(), allowed)


def _by_delta_v(
    motion: Motion, begin: _Begin, limits: FlightLimits, duration: float
) -> Iterator[float]:
    """Windows in which the flight can take the duration, that with the least delta-v first.

    Raises:
        InvalidInput: there is none.
    """

    def flown(window: float, time: float) -> CurveFlight | None:
        return _flight(motion, begin, limits, time, window)

    tried = {window: flown(window, duration) for window in WINDOWS}
    possible = {window: flight.delta_v for window, flight in tried.items() if flight}
    if not possible:
        least = first_possible(lambda time: any(flown(each, time) for each in WINDOWS), duration)
        if least is None:
            allowed = "a state from which the limits allow a flight that ends at rest"
            raise InvalidInput("departure.velocity", begin.joint_rates.tolist(), allowed)
        allowed = f"at least {least:.4g} s, about the shortest within these limits"
        raise InvalidInput("duration", duration, allowed)
    return iter(sorted(possible, key=lambda window: possible[window]))


def _flight(
    motion: Motion,
    begin: _Begin,
    limits: FlightLimits,
    duration: float,
    window: float,
    factor: int = 1,
) -> CurveFlight | None:
    """A curve of one window, flown in a time; None if the limits forbid that."""
    pieces = pieces_for(motion.edges, window, factor)
    speed = SPEED * pieces / duration
    try:
        control = _control(motion, begin, pieces, window, speed)
        curve = CurvedMotion(motion, control, joints_bend=True, start=begin.configuration[3:7])
        return curve_flight(SmoothCurve(curve), limits, duration, EndSpeeds(speed, 0.0))
    except IntegrationError:  # joints that turn many times over, for a very long flight
        return None
    except InvalidInput as error:
        if error.what not in ("duration", "begin_speed"):
            raise
        return None


def _control(
    motion: Motion, begin: _Begin, pieces: int, window: float, speed: float
) -> ControlPoints:
    """Control points whose curve begins with the state and ends with the motion."""
    control = control_points_on(motion, _parameters(motion, pieces, window))
    if motion.mode.floats:
        data = motion.robot.model.createData()
        center = pin.centerOfMass(motion.robot.model, data, begin.configuration)
        positions = np.tile(np.array(center), (pieces + 1, 1))
    else:
        origin, rate = begin.configuration[:3], begin.base_velocity / speed
        positions = with_end(control.positions[::-1], window, origin, -rate)[::-1]
    joints, rates = begin.joint_values, begin.joint_rates / speed
    values = with_end(control.joint_values[::-1], window, joints, -rates)[::-1]
    return ControlPoints(positions, values, control.shares)


def _parameters(motion: Motion, pieces: int, window: float) -> Array:
    """(n + 1,) of the control points on the motion; the first two are its start."""
    return np.asarray((1.0 - braking(pieces, window)[::-1]) * motion.edges)


def _nodes(motion: Motion, window: float, pieces: int) -> Array:
    """(m + 1,) parameters of the curve that belong to the nodes of the plan."""
    passed = _parameters(motion, pieces, window)[1:]
    nodes = np.interp(np.arange(motion.edges + 1.0), passed, np.arange(1.0, pieces + 1.0))
    nodes[0] = 0.0
    return nodes
