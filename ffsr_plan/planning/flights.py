"""`TimedPlan`: a timed motion with the problem that it solves, from which pictures are made."""

from __future__ import annotations

from dataclasses import dataclass, fields

from ffsr_plan.planning.flight_pictures import FlightPictures
from ffsr_plan.plans.plan_data import PlanData
from ffsr_plan.problem.problem import Problem
from ffsr_plan.trajectory.flight_limits import FlightLimits
from ffsr_plan.trajectory.timed_plan import TimedPlan as TimedMotion
from ffsr_plan.trajectory.timed_plan import timed


@dataclass(frozen=True, eq=False, repr=False)
class TimedPlan(FlightPictures, TimedMotion):
    """A plan flown from rest to rest as fast as the limits allow; made by `Plan.timed`.

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
    """

    problem: Problem
    limits: FlightLimits


def timed_plan(plan: PlanData, limits: FlightLimits) -> TimedPlan:
    """A plan flown within limits, with rests or pulses at its corners; see `Plan.timed`."""
    flight = timed(plan.motion, limits, plan.certificate.least_clearance)
    own = {field.name: getattr(flight, field.name) for field in fields(TimedMotion)}
    return TimedPlan(**own, problem=plan.problem, limits=limits)
