"""Begin and end of a flight: at rest at start and goal, or in the states that were asked for."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import Array
from ffsr_plan.dynamics.inverse_dynamics import States
from ffsr_plan.meetings.departure import Departure
from ffsr_plan.meetings.meeting import Meeting
from ffsr_plan.verification.flights.flown import Flown
from ffsr_plan.verification.flights.met_target import target_axes
from ffsr_plan.verification.verify import other_ends

ARRIVAL_LIMIT = 1e-9
"""Allowed error of pose and twist of a frame that is met [m, rad, m/s, rad/s]."""


def flight_ends(flight: Flown, velocities: Array, still: float) -> list[str]:
    """Where a flight begins or ends otherwise than it has to.

    Args:
        flight: the flight.
        velocities: (N, nv) on its way.
        still: velocity that counts as rest, as a share of the largest one.
    """
    problem, states = flight.problem, flight.at([0.0, flight.duration])
    slow = still * float(np.max(np.abs(velocities)))
    begins, ends = np.max(np.abs(states.velocities), axis=1) <= slow
    if flight.departure is not None:
        problems = _departed(flight, flight.departure, states)
        return problems if ends else [*problems, "it does not end at rest"]
    if flight.meeting is None:
        problems = other_ends(problem, *states.configurations)
        return problems if begins and ends else [*problems, "it does not rest at both of its ends"]
    problems = _missed(flight, flight.meeting, states)
    if np.max(np.abs(states.configurations[0] - problem.start)) > ARRIVAL_LIMIT:
        problems.append("the motion does not begin at the start")
    if flight.duration != flight.meeting.at:
        problems.append(
            f"it arrives at {flight.duration:.12g} s, not at {flight.meeting.at:.12g} s"
        )
    return problems if begins else [*problems, "it does not begin at rest"]


def _departed(flight: Flown, departure: Departure, states: States) -> list[str]:
    """A begin that is not the state of the departure, and an end that is not the goal."""
    problem, problems = flight.problem, []
    for what, found, wanted in (
        ("configuration", states.configurations[0], departure.configuration),
        ("velocity", states.velocities[0], departure.velocity),
    ):
        error = float(np.max(np.abs(found - wanted)))
        if not error <= ARRIVAL_LIMIT:
            problems.append(f"its first {what} misses the departure's by {error:.3g}")
    missed = states.configurations[1, 7:] - problem.goal[7:]
    if problem.mode.has_thrusters:
        missed = np.append(missed, states.configurations[1, :3] - problem.goal[:3])
    if np.max(np.abs(missed), initial=0.0) > ARRIVAL_LIMIT:
        problems.append("it does not end at the goal")
    return problems


def _missed(flight: Flown, meeting: Meeting, states: States) -> list[str]:
    """Pose and twist of the frame that are not those of the meeting, by Pinocchio's kinematics."""
    model, axes = flight.problem.robot.model, target_axes(flight, meeting)
    data, frame = model.createData(), model.getFrameId(meeting.frame)
    pin.forwardKinematics(model, data, states.configurations[1], states.velocities[1])
    pin.updateFramePlacement(model, data, frame)
    pose, twist = data.oMf[frame], pin.getFrameVelocity(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
    apart = np.array(pose.translation) - axes.place
    carried = axes.velocity + np.cross(axes.angular_velocity, apart)
    own = axes.turn.T
    errors = {
        "velocity": own @ (np.array(twist.linear) - carried) - meeting.velocity,
        "angular velocity": own @ (np.array(twist.angular) - axes.angular_velocity)
        - meeting.angular_velocity,
    }
    if meeting.position is not None:
        errors["position"] = own @ apart - meeting.position
    if meeting.attitude is not None:
        gamma_to_alpha = pin.rpy.rpyToMatrix(np.asarray(meeting.attitude)[::-1])
        errors["attitude"] = pin.log3(gamma_to_alpha.T @ own @ pose.rotation)
    limit = ARRIVAL_LIMIT + axes.error * (1.0 + float(np.linalg.norm(apart)))
    return [
        f"the frame's {what} misses the meeting's by {np.max(np.abs(error)):.3g}"
        for what, error in errors.items()
        if not np.max(np.abs(error)) <= limit
    ]
