"""The earliest flight along a plan's own path that is proven past bodies that move."""

from __future__ import annotations

import numpy as np

from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.flight_search.arrival_times import flight_times
from ffsr_plan.problem.problem import Problem
from ffsr_plan.proof.prover import Prover
from ffsr_plan.timed_proof.flown_proof import Refusal, prove_flown, prove_waiting
from ffsr_plan.timed_proof.unproven_flight import UnprovenFlight
from ffsr_plan.trajectory.flight_limits import FlightLimits
from ffsr_plan.trajectory.timed_motion import TimedMotion, check_corner_cut, timed

LEAST_TOLERANCE = 1e-7
"""Clearance below which a flight on a plan's path may be refused [m]."""


def straight_flight(
    problem: Problem, motion: Motion, limits: FlightLimits
) -> tuple[TimedMotion, float]:
    """The earliest flight within limits, and the clearance proven all along its path [m].

    Args:
        problem: what was planned, past bodies that move.
        motion: of the plan.
        limits: the limits.

    Raises:
        InvalidInput: limits that cannot be, or pulses that cut corners by more than the clearance.
        UnprovenFlight: no flight could be proven.
    """
    scene = problem.obstacles
    fastest = timed(motion, limits, np.inf)
    prover: Prover | None = None
    refusals: list[Refusal] = []
    ends, clear = [], 0.0
    for wait, duration in flight_times(problem, fastest.duration, None):
        ends.append(wait + duration)
        flight = fastest.slowed(duration / fastest.duration).after(wait)
        waiting = prove_waiting(scene, motion, wait, LEAST_TOLERANCE)
        proof, times = waiting, flight.timetable
        if waiting.refusal is None:
            if prover is None:
                prover = Prover(motion, scene, LEAST_TOLERANCE, pace=times)
            prover = prover.at_pace(times)
            proof = prove_flown(scene, prover, motion.edges, times)
        if proof.refusal is not None:
            refusals.append(proof.refusal)
            continue
        least = min(proof.least_clearance, waiting.least_clearance)
        if flight.corner_cut < least or flight.corner_cut == 0.0:
            return flight, least
        clear = max(clear, least)
    if clear > 0.0:
        check_corner_cut(fastest.corner_cut, limits, clear)
    raise UnprovenFlight(*refusals[0], len(ends), (min(ends), max(ends)))
