"""A plan flown to a meeting with a moving frame, or from a departure in motion."""

from __future__ import annotations

from ffsr_plan.core.checks import one_of
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.meetings.departing_flight import departing_flight
from ffsr_plan.meetings.departure import Departure
from ffsr_plan.meetings.meeting import Meeting
from ffsr_plan.meetings.meeting_flight import meeting_flight
from ffsr_plan.planning.flights import SmoothFlight
from ffsr_plan.planning.smooth_plan import smooth_plan
from ffsr_plan.plans.plan_data import PlanData
from ffsr_plan.trajectory.flight_limits import FlightLimits


def flown_in_motion(
    plan: PlanData,
    limits: FlightLimits,
    corners: str,
    duration: float | None,
    ends: Meeting | Departure,
) -> SmoothFlight:
    """A plan flown to a meeting, or from a departure; see `Plan.timed`.

    Args:
        plan: the plan.
        limits: the limits.
        corners: `smooth`.
        duration: of a departing flight [s]; None for that of the problem, and with a meeting.
        ends: the meeting, or the departure.

    Raises:
        InvalidInput: arguments that do not go together, or a meeting or departure that cannot be.
        UnprovenCurve: no curve could be proven free.
    """
    if not isinstance(ends, (Meeting, Departure)):
        raise InvalidInput("meeting, departure", ends, "a Meeting, a Departure or None")
    if one_of("corners", corners, ("smooth", "rest")) != "smooth":
        raise InvalidInput("corners", corners, f"'smooth' with a {ends.word}")
    if limits.velocity_jump > 0.0:
        raise InvalidInput("velocity_jump", limits.velocity_jump, f"0 with a {ends.word}")
    problem, motion = plan.problem, plan.motion
    if isinstance(ends, Meeting):
        if duration is not None:
            raise InvalidInput("duration", duration, "None with a meeting, whose `at` gives it")
        flight, proven = meeting_flight(problem, motion, ends, limits)
    else:
        time = problem.duration if duration is None else duration
        if time is None:
            raise InvalidInput("duration", None, "a time [s] with a departure")
        flight, proven = departing_flight(problem, motion, ends, limits, time)
    return SmoothFlight(
        **vars(flight),
        smooth_plan=smooth_plan(plan, proven),
        limits=limits,
        meeting=ends if isinstance(ends, Meeting) else None,
        departure=ends if isinstance(ends, Departure) else None,
    )
