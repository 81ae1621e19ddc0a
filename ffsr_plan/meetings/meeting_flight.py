"""A flight that meets a moving frame, along a curve that is proven free.

Approaches may take a half of the curve, a quarter, an eighth or a sixteenth. Short ones stay close
to the plan, long ones ask for less thrust. Those that can be on time are tried in turn, the one
with the least delta-v first. Of each, curves with more control points, which cut the plan's corners
less, are tried where the proof refuses the first.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.collision.contacts import named
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput, UnprovenCurve
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.meetings.approach import Approach
from ffsr_plan.meetings.arrival import Arrival
from ffsr_plan.meetings.meeting import Meeting
from ffsr_plan.meetings.met_body import touching_links
from ffsr_plan.meetings.timed_approach import earliest, timed_approach
from ffsr_plan.problem.problem import Problem
from ffsr_plan.scene.scene import Scene
from ffsr_plan.smooth_flight.curve_flight import CurveFlight
from ffsr_plan.smoothing.curve_proof import CurveProof, prove_curve
from ffsr_plan.smoothing.proven_curve import ProvenCurve
from ffsr_plan.trajectory.flight_limits import FlightLimits

WINDOWS = 0.25, 0.125, 0.5, 0.0625
"""Shares of a curve that leave the plan; of equals, the first is taken."""
_FACTORS = 1, 2, 4  # of the number of control points


class MeetingFlight(NamedTuple):
    """A flight that meets, and the proof of its curve."""

    flight: CurveFlight
    proven: ProvenCurve


def meeting_flight(
    problem: Problem, motion: Motion, meeting: Meeting, limits: FlightLimits
) -> MeetingFlight:
    """The flight along a motion that ends with a meeting; see `Plan.timed`.

    Args:
        problem: what was planned.
        motion: of the plan.
        meeting: frame, pose, twist and time.
        limits: the limits; jerk cannot be limited.

    Raises:
        InvalidInput: a meeting that cannot be, naming what is allowed.
        UnprovenCurve: a curve that meets on time could not be proven free.
    """
    refuse_jerk(limits, motion, "a meeting")
    arrival, scene = Arrival(motion, meeting, problem.scene), problem.scene
    _check_known(meeting, scene)
    refused: list[CurveProof] = []
    for window in _by_delta_v(arrival, limits):
        for factor in _FACTORS:
            found, flight = timed_approach(arrival, limits, meeting.at, window, factor)
            if found is None or flight is None:
                break
            times = flight.timetable if scene.moves else None
            touching = None
            if times is not None:
                touching = touching_links(meeting, scene, found.curve, times)
            proof = prove_curve(problem, found.curve, problem.tolerance, times, touching)
            if not len(proof.refused):
                nodes = _nodes(arrival, window, proof.curve.edges)
                return MeetingFlight(flight, _proven(proof, nodes, refused))
            refused.append(proof)
    raise unproven(problem, motion, refused, meeting.word)


def _by_delta_v(arrival: Arrival, limits: FlightLimits) -> list[float]:
    """Windows of the approaches that can be on time.

    Raises:
        InvalidInput: none can.
    """
    at = arrival.meeting.at
    tried = {window: timed_approach(arrival, limits, at, window) for window in WINDOWS}
    on_time = {window: each.flight.delta_v for window, each in tried.items() if each.flight}
    if not on_time:
        pose_met = any(each.found is not None for each in tried.values())
        raise _too_early(arrival, limits) if pose_met else _pose_not_met(arrival)
    return sorted(on_time, key=lambda window: on_time[window])


def _nodes(arrival: Arrival, window: float, pieces: int) -> Array:
    """(m + 1,) parameters of the curve that belong to the nodes of the plan."""
    passed = Approach(arrival, pieces, window, 1.0).parameters()[:-1]
    nodes = np.interp(np.arange(arrival.motion.edges + 1.0), passed, np.arange(float(pieces)))
    nodes[-1] = pieces
    return nodes


def _proven(proof: CurveProof, nodes: Array, refused: list[CurveProof]) -> ProvenCurve:
    before = sum(len(each.refused) for each in refused)
    queries = sum(each.prover.queries for each in refused)
    return ProvenCurve("meeting", proof, nodes, before, queries)


def refuse_jerk(limits: FlightLimits, motion: Motion, what: str) -> None:
    """Raise `InvalidInput` for a limit on jerk, of which no law with a speed at its end is made.

    Args:
        limits: the limits.
        motion: of the plan.
        what: what has a speed there.
    """
    names = "thruster_jerk", "", *(f"joint_jerk, joint {j}" for j in motion.robot.joint_names)
    for name, most in zip(names, limits.jerk, strict=True):
        if np.isfinite(most):
            raise InvalidInput(name, float(most), f"no limit on jerk with {what}")


def _check_known(meeting: Meeting, scene: Scene) -> None:
    """Raise `InvalidInput` for a meeting when the motion of a body is not known any more."""
    if meeting.at > (known := scene.known_until):
        allowed = f"at most {known:.6g} s, up to which the motions of all bodies are known"
        raise InvalidInput("meeting.at", meeting.at, allowed)


def _pose_not_met(arrival: Arrival) -> InvalidInput:
    meeting = arrival.meeting
    value = {"frame": meeting.frame, "position": np.round(arrival.pose.translation, 6).tolist()}
    allowed = (
        "a pose of the frame that the joints reach from the plan's goal; plan to the pose first, "
        f"by problem.reaching, or arrive before {meeting.at:.6g} s, as an approach takes a "
        "sixteenth of the flight or longer"
    )
    return InvalidInput("meeting.position, meeting.attitude", value, allowed)


def _too_early(arrival: Arrival, limits: FlightLimits) -> InvalidInput:
    at = arrival.meeting.at
    least = earliest(arrival, limits, at)
    if least is None:
        twist = arrival.twist.tolist()
        allowed = "a twist that the limits on thrust, torques and accelerations allow at some time"
        return InvalidInput("meeting.velocity, meeting.angular_velocity", twist, allowed)
    allowed = f"at least {_rounded_up(least)} s, about the earliest within these limits"
    return InvalidInput("meeting.at", at, allowed)


def _rounded_up(time: float) -> str:
    """Four digits, and no less than the time."""
    unit = 10.0 ** (np.floor(np.log10(time)) - 3)
    return f"{np.ceil(time / unit) * unit:.4g}"


def unproven(
    problem: Problem, motion: Motion, refused: list[CurveProof], what: str
) -> InvalidInput | UnprovenCurve:
    """Why the last curve was refused: a joint beyond its limits, or something too close.

    Args:
        problem: what was planned.
        motion: of the plan.
        refused: proofs of the curves, at least one.
        what: `meeting` or `departure`.
    """
    proof = refused[-1]
    robot, values = motion.robot, proof.curve.pieces.values[:, :, 3:-1]
    low, high = values.min(axis=(0, 1)), values.max(axis=(0, 1))
    beyond = np.maximum(robot.lower - low, high - robot.upper)
    if len(proof.outside) and np.max(beyond) > 0.0:
        k = int(np.argmax(beyond))
        value = float(low[k] if robot.lower[k] - low[k] > 0.0 else high[k])
        allowed = f"from {robot.lower[k]:.6g} to {robot.upper[k]:.6g} all along the curve"
        return InvalidInput(f"{what}, joint {robot.joint_names[k]} on the way", value, allowed)
    piece, still = int(proof.refused[0]), np.zeros(3)
    pairs = (
        proof.prover.nearest(piece, still, still, 0.5),
        proof.prover.links.nearest(piece, 0.5),
    )
    contact = named(problem.obstacles, min(pairs, key=lambda each: each.distance))
    edge = int(np.ceil((piece + 1.0) / proof.curve.edges * motion.edges))
    if proof.refusal is not None:
        return UnprovenCurve(edge, motion.edges, *proof.refusal)
    return UnprovenCurve(edge, motion.edges, contact)
