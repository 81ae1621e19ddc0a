"""`SmoothPlan`: a plan along a smooth curve, proven free like the plan."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.checks import number, one_of
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.curves.smooth_curve import SmoothCurve
from ffsr_plan.flight_search.curve_flights import FlownCurve, flight_along, flight_on_curve
from ffsr_plan.fuel.curve_refinement import refined_curve
from ffsr_plan.lattice.certificate import Certificate
from ffsr_plan.planning.smooth_data import SmoothPlanData
from ffsr_plan.planning.timing import Timing
from ffsr_plan.plans.plan_data import PlanData
from ffsr_plan.smoothing.curve_objective import curve_lengths, curve_objective
from ffsr_plan.smoothing.curve_proof import prove_curve
from ffsr_plan.smoothing.proven_curve import ProvenCurve, proven_curve

if TYPE_CHECKING:
    from ffsr_plan.meetings.departure import Departure
    from ffsr_plan.meetings.meeting import Meeting
    from ffsr_plan.planning.flights import SmoothFlight, TimedPlan
    from ffsr_plan.trajectory.flight_limits import FlightLimits


@dataclass(frozen=True, eq=False, repr=False)
class SmoothPlan(Timing, SmoothPlanData):
    """A whole-body motion without corners, proven free of collisions, the base's reaction included.

    Velocity and acceleration are continuous in the curve's parameter. Start and goal are those of
    the plan; a goal attitude that is demanded is reached again. That of a meeting ends with it,
    that of a departure begins with it.

    Attributes:
        plan: the plan that was smoothed.
        curve: the curve. Its parameter runs from 0 to the number of its pieces.
        kind: what the curve is: a `spline` whose control points are the plan's nodes, a `refined
            spline` with more of them, the spline `through` the nodes, the plan's path `with rests`
            at its bends, one of `least fuel` beside it, or a spline that ends with a `meeting` or
            begins with a `departure`.
        nodes: (m + 1,) parameters of the curve that belong to the plan's nodes.
        length: L by its definition for paths [m]; shorter than the plan's but for `through`.
        objective: F by its definition for paths [length units]. It may be a little larger than the
            plan's, as a spline cuts corners, and these are at obstacles.
        clearances: (n + 1,) least distances to obstacles at the ends of the curve's n pieces [m].
        certificate: pieces proven and refused, Coal queries spent, and the proven clearance all
            along the curve.
    """

    def _flown(
        self,
        limits: FlightLimits,
        corners: str,
        duration: float | None,
        ends: Meeting | Departure | None,
    ) -> SmoothFlight | TimedPlan:
        from ffsr_plan.planning.flights import refuse_pulses, smooth_flight

        if ends is not None:
            raise InvalidInput(ends.word, ends, "None along a smooth plan; see Plan.timed")
        if one_of("corners", corners, ("smooth", "rest")) == "rest":
            raise InvalidInput("corners", corners, "smooth: a smooth plan has none to rest at")
        if self.problem.scene.moves:
            refuse_pulses(limits)
            found = flight_on_curve(self.problem, self, self.plan.motion, limits, duration)
            return _flight(self.plan, found, limits)
        return smooth_flight(self, limits, duration)


def smoothed(plan: PlanData) -> SmoothPlan:
    """The plan along a smooth curve; see `Plan.smooth`.

    Args:
        plan: the plan.

    Raises:
        UnprovenCurve: nothing could be proven, not even the plan's path with rests.
    """
    return smooth_plan(plan, proven_curve(plan.problem, plan.motion))


def least_fuel(plan: PlanData, margin: float) -> SmoothPlan:
    """The plan along a smooth curve that needs little fuel; see `Plan.least_fuel`.

    Args:
        plan: the plan.
        margin: clearance to keep [m].

    Raises:
        InvalidInput: a plan without thrusters, or a margin that cannot be kept.
        UnprovenCurve: see `smoothed`.
    """
    problem, motion = plan.problem, plan.motion
    margin = number("margin", margin, at_least=0.0)
    if problem.mode.floats:
        allowed = "free-flying or attitude-held: without thrusters no fuel is burnt"
        raise InvalidInput("mode", str(problem.mode), allowed)
    for end, clearance in zip(("start", "goal"), plan.clearances[[0, -1]].tolist(), strict=True):
        if clearance <= margin:
            allowed = f"less than {clearance:.6g} m, the clearance of the {end}"
            raise InvalidInput("margin", margin, allowed)
    plain, found = smoothed(plan), refined_curve(problem, motion, _directions(plan), margin)
    keeps = plain.certificate.least_clearance >= margin
    if found is not None:
        proof = prove_curve(problem, found.curve, problem.tolerance)
        curve = ProvenCurve("least fuel", proof, found.nodes, found.refused, found.queries)
        refined = smooth_plan(plan, curve, margin)
        if not keeps or refined.change < plain.change:
            return refined
    if not keeps:
        most = plain.certificate.least_clearance
        raise InvalidInput("margin", margin, f"at most {most:.6g} m; no curve with more was found")
    return plain


def flown_past_bodies(plan: PlanData, limits: FlightLimits, duration: float | None) -> SmoothFlight:
    """The plan flown along a smooth curve past bodies that move; see `Plan.timed`."""
    from ffsr_plan.planning.flights import refuse_pulses

    refuse_pulses(limits)
    return _flight(plan, flight_along(plan.problem, plan.motion, limits, duration), limits)


def _flight(plan: PlanData, found: FlownCurve, limits: FlightLimits) -> SmoothFlight:
    from ffsr_plan.planning.flights import SmoothFlight

    smooth = smooth_plan(plan, found.proven)
    return SmoothFlight(**vars(found.flight), smooth_plan=smooth, limits=limits)


def _directions(plan: PlanData) -> Array:
    """(axes, 3) directions of displacements: along the way and those of a lattice, or all."""
    way = plan.problem.base_displacement
    length = float(np.linalg.norm(way))
    if plan.lattice is None or length == 0.0:
        return np.eye(3)
    return np.vstack([way / length, plan.lattice.directions])


def smooth_plan(plan: PlanData, found: ProvenCurve, margin: float = 0.0) -> SmoothPlan:
    """A plan along a curve that is proven.

    Args:
        plan: the plan.
        found: the curve and its proof.
        margin: clearance that it is known to keep [m].
    """
    problem, curve = plan.problem, found.proof.curve
    lengths = curve_lengths(problem, curve)
    return SmoothPlan(
        plan=plan,
        curve=SmoothCurve(curve),
        kind=found.kind,
        nodes=frozen(found.nodes),
        length=float(lengths.sum()),
        objective=curve_objective(problem, curve, found.nodes[1:-1], lengths, found.proof.times),
        clearances=frozen(found.proof.clearances),
        certificate=_certificate(problem.robot.unchecked_links, found, margin),
    )


def _certificate(unchecked: tuple[str, ...], found: ProvenCurve, margin: float) -> Certificate:
    proof = found.proof
    least, nodes = max(proof.least_clearance(), margin), proof.node_queries
    queries = found.queries + proof.prover.queries - nodes
    return Certificate(proof.curve.edges, found.refused, nodes, queries, least, unchecked)
