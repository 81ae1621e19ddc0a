"""Proof that a curve is free and keeps the limits, piece by piece."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.bodies.pace import Timetable
from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.problem.problem import Problem
from ffsr_plan.proof.interval_halving import Verdict
from ffsr_plan.proof.moving_obstacles import Touching
from ffsr_plan.proof.prover import Prover
from ffsr_plan.timed_proof.flown_proof import Refusal, first_refusal

_ROUNDING = 1e-12  # share by which coefficients may leave a range


class CurveProof(NamedTuple):
    """What is proven of a curve of m pieces.

    Attributes:
        curve: the curve.
        prover: proofs along it.
        clearances: (m + 1,) at the ends of its pieces [m].
        node_queries: Coal queries for these.
        refused: pieces that leave a limit or could not be proven free.
        outside: those of them that leave a joint's limits or the window of the base.
        refusal: past bodies that move, the first piece that could not be proven free, in the words
            of an error; None where there is none.
        times: at which the curve is where; None where no body moves.
        waiting: clearance proven while the robot waits at the start, infinite without a wait [m].
    """

    curve: CurvedMotion
    prover: Prover
    clearances: Array
    node_queries: int
    refused: IntArray
    outside: IntArray
    refusal: Refusal | None = None
    times: Timetable | None = None
    waiting: float = np.inf

    def least_clearance(self) -> float:
        """Proven lower bound on the clearance all along a curve without refused pieces [m]."""
        still = np.zeros((self.curve.edges + 1, 3))
        return min(self.prover.least_clearance(still, self.clearances), self.waiting)

    def at_times(self, problem: Problem, times: Timetable, waiting: float = np.inf) -> CurveProof:
        """The same curve, proven at other times.

        Args:
            problem: gives the obstacles, the limits and the window.
            times: at which the curve is where.
            waiting: clearance proven while the robot waits at the start [m].
        """
        proof = curve_proof(problem, self.curve, self.prover.at_pace(times), times)
        return proof._replace(waiting=waiting)


def prove_curve(
    problem: Problem,
    curve: CurvedMotion,
    tolerance: float,
    times: Timetable | None = None,
    touching: Touching | None = None,
) -> CurveProof:
    """Prove a curve free of obstacles and self-collision, and within the limits.

    Args:
        problem: gives the obstacles, the limits and the window.
        curve: the curve.
        tolerance: clearance below which a piece may be refused [m].
        times: at which the curve is where; None where no body moves.
        touching: shapes that may touch a body that moves; None for none.
    """
    prover = Prover(curve, problem.obstacles, tolerance, pace=times, touching=touching)
    return curve_proof(problem, curve, prover, times)


def curve_proof(
    problem: Problem, curve: CurvedMotion, prover: Prover, times: Timetable | None
) -> CurveProof:
    """The same by a prover that is made already.

    Args:
        problem: gives the obstacles, the limits and the window.
        curve: the curve.
        prover: proofs along the curve at the times.
        times: at which the curve is where; None where no body moves.
    """
    m, still = curve.edges, np.zeros((curve.edges + 1, 3))
    before = prover.queries
    clearances = prover.clearances(np.arange(m + 1), still)
    node_queries = prover.queries - before
    ends = np.column_stack([clearances[:-1], clearances[1:]])
    verdicts = prover.certify_all(np.arange(m), still[1:], still[1:], ends)
    outside = _outside(problem, curve)
    refused = outside | _not_free(verdicts) | _not_free(prover.links.verdicts())
    refusal = None
    if times is not None:
        refusal = first_refusal(problem.obstacles, prover, verdicts, times)
    return CurveProof(
        curve,
        prover,
        clearances,
        node_queries,
        np.flatnonzero(refused),
        np.flatnonzero(outside),
        refusal,
        times,
    )


def joints_are_proven(problem: Problem, curve: CurvedMotion) -> bool:
    """Whether links keep apart and limits hold along a curve, wherever its base is.

    Args:
        problem: gives the limits, and the window, in which the base has to be.
        curve: the curve.
    """
    prover = Prover(curve, problem.obstacles.at_rest, problem.tolerance)
    apart = all(verdict.free for verdict in prover.links.verdicts())
    return apart and not np.any(_outside(problem, curve))


def _not_free(verdicts: list[Verdict]) -> Flags:
    return np.array([not verdict.free for verdict in verdicts])


def _outside(problem: Problem, curve: CurvedMotion) -> Flags:
    """(m,) whether a piece may leave a joint's limits or the window, by its coefficients."""
    values, robot = curve.pieces.values, problem.robot
    lower, upper = robot.lower, robot.upper
    joints = values[:, :, 3:-1]
    if problem.lattice is None and problem.mode.has_thrusters:
        low, high = problem.base_window
        lower, upper = np.concatenate([low, lower]), np.concatenate([high, upper])
        joints = values[:, :, :-1]
    slack = _ROUNDING * (1.0 + np.max(np.abs(joints), initial=0.0))
    left = (joints < lower - slack) | (joints > upper + slack)
    return np.asarray(np.any(left, axis=(1, 2)))
