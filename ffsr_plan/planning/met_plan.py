"""A plan flown to a meeting with a moving frame."""

from __future__ import annotations

from ffsr_plan.core.checks import one_of
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.meetings.meeting import Meeting
from ffsr_plan.meetings.meeting_flight import meeting_flight
from ffsr_plan.planning.flights import SmoothFlight
from ffsr_plan.planning.smooth_plan import smooth_plan
from ffsr_plan.plans.plan_data import PlanData
from ffsr_plan.trajectory.flight_limits import FlightLimits


def met_plan(
    plan: PlanData, limits: FlightLimits, corners: str, duration: float | None, meeting: Meeting
) -> SmoothFlight:
    """A plan flown to a meeting; see `Plan.timed`."""
    if not isinstance(meeting, Meeting):
        raise InvalidInput("meeting", meeting, "a Meeting or None")
    if one_of("corners", corners, ("smooth", "rest")) != "smooth":
        raise InvalidInput("corners", corners, "'smooth' with a meeting")
    if duration is not None:
        raise InvalidInput("duration", duration, "None with a meeting, whose `at` gives it")
    if limits.velocity_jump > 0.0:
        raise InvalidInput("velocity_jump", limits.velocity_jump, "0 with a meeting")
    flight, proven = meeting_flight(plan.problem, plan.motion, meeting, limits)
    return SmoothFlight(
        **vars(flight),
        smooth_plan=smooth_plan(plan, proven),
        limits=limits,
        meeting=meeting,
    )
