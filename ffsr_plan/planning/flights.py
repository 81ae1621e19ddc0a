"""`TimedPlan` and `SmoothFlight`: plans flown along their path or along their smooth curve."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ffsr_plan.bodies.pace import slip
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.flight_search.straight_flights import straight_flight
from ffsr_plan.planning.flight_pictures import FlightPictures
from ffsr_plan.planning.smooth_data import SmoothPlanData
from ffsr_plan.plans.plan_data import PlanData
from ffsr_plan.problem.problem import Problem
from ffsr_plan.smooth_flight.curve_flight import CurveFlight, curve_flight
from ffsr_plan.trajectory.flight_limits import FlightLimits
from ffsr_plan.trajectory.straight_flight import change_of_place, straight_delta_v
from ffsr_plan.trajectory.timed_motion import TimedMotion, timed

if TYPE_CHECKING:
    from ffsr_plan.meetings.departure import Departure
    from ffsr_plan.meetings.meeting import Meeting
    from ffsr_plan.verification.flights.verify_flight import FlightReport


@dataclass(frozen=True, eq=False, repr=False)
class TimedPlan(FlightPictures, TimedMotion):
    """A plan flown on its path as fast as limits allow; made by `Plan.timed(corners="rest")`.

    It rests at corners of the path, or passes them with pulses of the thrusters, at the highest
    speed at which no pulse changes the velocity of the base by more than allowed. Pulses count
    against the limit on thrust: one of size d takes the time d / thruster_acceleration or longer,
    does not overlap another, and the pace is constant meanwhile.

    Attributes:
        motion: the path of the plan.
        delta_v: velocity change that the thrusters produce in translation: the integral of
            |thrust| / mass, pulses included [m/s].
        rests: (k,) times at which the robot rests on the path, without start and goal [s].
        pulse_times: (p,) times of the corners that pulses pass, in the middle of each pulse [s].
        pulse_durations: (p,) durations of the pulses [s].
        pulses: (p, 3) changes of the base's velocity by them, world axes [m/s]; the acceleration
            during a pulse is constant.
        corner_cut: largest displacement of the robot from its path by pulses [m]: one of size d and
            duration t cuts its corner by d t / 8. It is less than the clearance proven along the
            whole motion.
        problem: robot, obstacles, start and goal.
        limits: those that the flight keeps.
        least_clearance: proven lower bound on the clearance all along the path, from bodies that
            move at the flight's own times, a wait at the start included [m].
    """

    problem: Problem
    limits: FlightLimits
    least_clearance: float

    @property
    def slip(self) -> float:
        """Time by which the whole flight may be early or late and is still free of bodies [s].

        See `Plan.slip`; what pulses cut off corners counts.
        """
        return slip(self.problem.scene.moving, self.least_clearance - self.corner_cut)

    @property
    def straight_delta_v(self) -> float:
        """What the same change of place needs in the same time along a straight line [m/s]."""
        if self.mode.floats:
            return 0.0
        change = change_of_place(self.robot, self.motion.configurations()[[0, -1]])
        return straight_delta_v(change, self.duration, float(self.limits.acceleration[0]))

    @property
    def meeting(self) -> None:
        """None: it ends at rest."""
        return None

    @property
    def departure(self) -> None:
        """None: it begins at rest."""
        return None

    def verify(self) -> FlightReport:
        """Check the flight by other code than the planner's; see `FlightReport`."""
        from ffsr_plan.verification.flights import verify_flight as check

        if self.problem.scene.moves:
            return check.verify_flight(self, self.least_clearance)
        cut, obstacles = self.corner_cut, len(self.problem.scene)
        return check.verify_flight(self, check.clearance_to_confirm(cut, obstacles))


@dataclass(frozen=True, eq=False, repr=False)
class SmoothFlight(FlightPictures, CurveFlight):
    """A plan flown along its smooth curve, at rest at its ends only; made by `Plan.timed`.

    With a meeting it is not at rest at its end, with a departure not at its begin.

    Attributes:
        curve: the curve.
        delta_v: velocity change that the thrusters produce in translation: the integral of
            |thrust| / mass [m/s].
        straight_delta_v: what the same change of place needs in the same time and with the same
            limit on thrust along a straight line, if nothing is in its way: one push, a coast and
            one push against it [m/s]. No flight from rest to rest needs less. With a meeting, two
            pulses that bring the centre of mass to its place and its velocity on arrival, with no
            limit on thrust: no flight that meets needs less.
        smooth_plan: the plan along the curve, with its proof and its kind. A curve of the kind
            `with rests` has them where its path bends.
        limits: those that the flight keeps.
        meeting: what it arrives with; None for a rest.
        departure: the state that it begins in; None for a rest.
    """

    smooth_plan: SmoothPlanData
    limits: FlightLimits
    meeting: Meeting | None = None
    departure: Departure | None = None

    @property
    def problem(self) -> Problem:  # type: ignore[override]  # handed on, not kept twice
        """Robot, obstacles, start and goal."""
        return self.smooth_plan.plan.problem

    @property
    def least_clearance(self) -> float:
        """Proven lower bound on the clearance all along the flight [m]; see `TimedPlan`."""
        return self.smooth_plan.certificate.least_clearance

    @property
    def slip(self) -> float:
        """Time by which the whole flight may be early or late and is still free of bodies [s].

        See `Plan.slip`.
        """
        return self.smooth_plan.slip

    def verify(self) -> FlightReport:
        """Check the flight by other code than the planner's; see `FlightReport`."""
        from ffsr_plan.verification.flights.verify_flight import verify_flight

        return verify_flight(self, self.smooth_plan.certificate.least_clearance)


def timed_plan(plan: PlanData, limits: FlightLimits) -> TimedPlan:
    """A plan flown within limits, with rests or pulses at its corners; see `Plan.timed`."""
    if plan.problem.scene.moves:
        flight, least = straight_flight(plan.problem, plan.motion, limits)
    else:
        least = plan.certificate.least_clearance
        flight = timed(plan.motion, limits, least)
    return TimedPlan(**vars(flight), problem=plan.problem, limits=limits, least_clearance=least)


def smooth_flight(
    smooth: SmoothPlanData, limits: FlightLimits, duration: float | None
) -> SmoothFlight:
    """A smooth plan flown within limits, past scenes at rest; see `Plan.timed`."""
    refuse_pulses(limits)
    flight = curve_flight(smooth.curve, limits, duration)
    return SmoothFlight(**vars(flight), smooth_plan=smooth, limits=limits)


def refuse_pulses(limits: FlightLimits) -> None:
    """Raise `InvalidInput` for pulses along a smooth curve."""
    if limits.velocity_jump > 0.0:
        allowed = "0 along a smooth curve, which has no corners; or corners='rest'"
        raise InvalidInput("velocity_jump", limits.velocity_jump, allowed)
