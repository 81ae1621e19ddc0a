"""The earliest flight along a smooth curve that is proven past bodies that move.

Of each curve the fastest flight within limits is tried, then slower ones and such that wait at the
start first; where all are refused, the next curve along the plan.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import UnprovenCurve
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.curves.smooth_curve import SmoothCurve
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.flight_search.arrival_times import flight_times
from ffsr_plan.flight_search.straight_flights import LEAST_TOLERANCE
from ffsr_plan.problem.problem import Problem
from ffsr_plan.smooth_flight.curve_flight import CurveFlight, flight_at
from ffsr_plan.smooth_flight.pace import Pace
from ffsr_plan.smooth_flight.timed_curve import pace_within
from ffsr_plan.smoothing.curve_proof import CurveProof, prove_curve
from ffsr_plan.smoothing.proven_curve import Kind, ProvenCurve, proven_curve
from ffsr_plan.timed_proof.flown_proof import FlownProof, Refusal, prove_waiting
from ffsr_plan.timed_proof.unproven_flight import UnprovenFlight
from ffsr_plan.trajectory.flight_limits import FlightLimits


class FlownCurve(NamedTuple):
    """A flight past bodies that move, and the proof of its curve at its times."""

    flight: CurveFlight
    proven: ProvenCurve


class _Chosen(Protocol):
    """A smooth plan, as far as it counts here."""

    @property
    def curve(self) -> SmoothCurve:
        """The curve."""

    @property
    def kind(self) -> Kind:
        """What it is."""

    @property
    def nodes(self) -> Array:
        """(m + 1,) its parameters that belong to the nodes of the plan."""


class _Search:
    """Flights along curves, tried one after another; a `Proof` of curves.

    Attributes:
        pace: of the last flight that was tried, which is proven if no piece is refused.
    """

    def __init__(
        self, problem: Problem, motion: Motion, limits: FlightLimits, duration: float | None
    ) -> None:
        self._problem, self._motion = problem, motion
        self._limits, self._given = limits, duration
        self._waits: dict[float, FlownProof] = {}
        self._refusals: list[Refusal] = []
        self._ends: list[float] = []
        self.pace: Pace | None = None

    def __call__(self, curve: CurvedMotion, nodes: Array, tolerance: float) -> CurveProof:
        """The proof of the first flight along a curve that is proven, or of the last one tried."""
        smooth, proof = SmoothCurve(curve), None
        fastest = pace_within(smooth, self._limits)
        for wait, duration in flight_times(self._problem, fastest.duration, self._given):
            waiting = self._waiting(wait, tolerance)
            if waiting.refusal is not None and proof is not None:
                continue
            pace = fastest.slowed(max(duration / fastest.duration, 1.0))
            if wait == 0.0 and duration > fastest.duration:
                pace = pace_within(smooth, self._limits, duration)
            self.pace = pace = pace.after(wait) if wait > 0.0 else pace
            times = pace.timetable(curve.edges)
            if proof is None:
                proof = prove_curve(self._problem, curve, tolerance, times)
            else:
                proof = proof.at_times(self._problem, times, waiting.least_clearance)
            self._ends.append(pace.duration)
            if not len(proof.refused):
                break
            if proof.refusal is None or not self._moves(proof.refusal):
                break  # at no other time either
            self._refusals.append(proof.refusal)
        assert proof is not None  # the first time has no wait
        return proof

    def error(self) -> UnprovenFlight | None:
        """Why no flight was found; None if no body was in the way."""
        if not self._refusals:
            return None
        ends = min(self._ends), max(self._ends)
        return UnprovenFlight(*self._refusals[0], len(self._ends), ends)

    def flown(self, found: ProvenCurve) -> FlownCurve:
        """The flight that was proven last."""
        assert self.pace is not None
        curve = SmoothCurve(found.proof.curve)
        return FlownCurve(flight_at(curve, self._limits, self.pace), found)

    def _waiting(self, wait: float, tolerance: float) -> FlownProof:
        """The proof of a wait at the start; of one that is longer than a refused one, that."""
        for until, known in self._waits.items():
            if known.refusal is not None and until <= wait:
                return known
        if wait not in self._waits:
            scene = self._problem.obstacles
            self._waits[wait] = prove_waiting(scene, self._motion, wait, tolerance)
        return self._waits[wait]

    def _moves(self, refusal: Refusal) -> bool:
        """Whether what was too close is a body that moves."""
        obstacle, scene = refusal.contact.obstacle, self._problem.scene
        return isinstance(obstacle, int) and obstacle >= len(scene.at_rest)


def flight_along(
    problem: Problem, motion: Motion, limits: FlightLimits, duration: float | None
) -> FlownCurve:
    """The earliest flight along any smooth curve of a plan past bodies that move.

    Args:
        problem: what was planned.
        motion: of the plan.
        limits: the limits.
        duration: time of arrival [s]; None for the earliest that is found.

    Raises:
        InvalidInput: limits or a duration that cannot be.
        UnprovenFlight: no flight could be proven because of a body.
        UnprovenCurve: no curve could be proven because of anything else.
    """
    search = _Search(problem, motion, limits, duration)
    try:
        found = proven_curve(problem, motion, search)
    except UnprovenCurve as error:
        raise (search.error() or error) from None
    return search.flown(found)


def flight_on_curve(
    problem: Problem, curve: _Chosen, motion: Motion, limits: FlightLimits, duration: float | None
) -> FlownCurve:
    """The earliest flight along one smooth curve past bodies that move.

    Args:
        problem: what was planned.
        curve: the curve, its kind and nodes.
        motion: of the plan.
        limits: the limits.
        duration: time of arrival [s]; None for the earliest that is found.

    Raises:
        InvalidInput: limits or a duration that cannot be.
        UnprovenFlight: no flight could be proven because of a body.
        UnprovenCurve: none could because of anything else.
    """
    search = _Search(problem, motion, limits, duration)
    proof = search(curve.curve.motion, curve.nodes, LEAST_TOLERANCE)
    if len(proof.refused):
        assert proof.refusal is not None  # limits and links are as they were proven before
        place = int(proof.refused[0]) + 1, curve.curve.pieces
        raise search.error() or UnprovenCurve(*place, *proof.refusal)
    return search.flown(ProvenCurve(curve.kind, proof, curve.nodes, 0, 0))
