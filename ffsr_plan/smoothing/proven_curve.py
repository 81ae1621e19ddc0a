"""The smoothest curve along a path that is proven free.

Tried in turn, each only where the one before was refused:

spline          the B-spline whose control points are the path's nodes, without those that are too
                close together, at which it would nearly rest: it cuts corners a little
refined spline  with more control points, in the middles of edges of the path: first beside what was
                refused, then beside every bend, as joints that cut corners turn the base otherwise
through         the spline that passes through the nodes and swings outwards between them
with rests      the path itself, at rest wherever it bends

A refined spline changes its velocity by less in all than one through the nodes, which on unequal
edges also bends sharply: `benchmarks.studies.planners.smooth_curves` compares them.
"""

from __future__ import annotations

from functools import partial
from typing import Literal, NamedTuple, Protocol

import numpy as np

from ffsr_plan.collision.contacts import named
from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.core.errors import UnprovenCurve
from ffsr_plan.curves.control_points import ControlPoints, control_points_on
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.problem.problem import Problem
from ffsr_plan.smoothing.curve_objective import edge_lengths
from ffsr_plan.smoothing.curve_proof import CurveProof, prove_curve
from ffsr_plan.smoothing.goal_attitude import curve_to_attitude
from ffsr_plan.trajectory.timetables import NodeTimes

Kind = Literal[
    "spline", "refined spline", "through", "with rests", "least fuel", "meeting", "departure"
]
"""What a smooth curve is: see `proven_curve`, `fuel.curve_refinement`, and `meetings`."""
_BESIDE_REFUSED, _ROUNDS = 3, 7  # rounds of refinement beside what was refused, and in all
_LEAST_SHARE = 0.1  # of the mean edge, by which nodes that are control points are apart
_NO_BEND = 1e-9  # second difference of control points [m or rad] that counts as none
_LEAST_TOLERANCE = 1e-7  # [m] of the path itself, which may be closer than the problem's


class ProvenCurve(NamedTuple):
    """A curve that is proven free, and how it was found.

    Attributes:
        kind: what it is.
        proof: the curve and its proof; no piece is refused.
        nodes: (n + 1,) parameters, in pieces, that belong to the nodes of the path.
        refused: pieces of other curves that were refused before.
        queries: Coal queries of their proofs.
    """

    kind: Kind
    proof: CurveProof
    nodes: Array
    refused: int
    queries: int


class _Candidate(NamedTuple):
    """A curve to try: its control points, and the parameters that belong to the path's nodes."""

    kind: Kind
    control: ControlPoints
    nodes: Array


class Proof(Protocol):
    """How a curve is proven."""

    def __call__(self, curve: CurvedMotion, nodes: Array, tolerance: float) -> CurveProof:
        """The proof of a curve, some of whose pieces may be refused.

        Args:
            curve: the curve.
            nodes: (n + 1,) its parameters, in pieces, that belong to the nodes of the path.
            tolerance: clearance below which a piece may be refused [m].
        """


def proven_curve(problem: Problem, motion: Motion, prove: Proof | None = None) -> ProvenCurve:
    """A smooth curve along the proven motion of a plan.

    Args:
        problem: what was planned.
        motion: the motion of the plan.
        prove: how curves are proven; by default at the pace of the plan.

    Raises:
        UnprovenCurve: not even the path itself could be proven.
        IntegrationError: the reaction along a curve cannot be integrated.
    """
    tried: list[CurveProof | None] = []
    chosen: Proof = prove or partial(_at_own_pace, problem)
    whole = np.arange(motion.edges + 1.0)
    parameters = _apart(edge_lengths(problem, motion))
    for attempt in range(1 + _ROUNDS):
        nodes = np.interp(whole, parameters, np.arange(float(len(parameters))))
        control = control_points_on(motion, parameters)
        spline = _Candidate("refined spline" if attempt else "spline", control, nodes)
        found = _attempt(problem, motion, spline, tried, chosen)
        if found is not None:
            return found
        beside = _beside_bends(control)
        proof = tried[-1]
        if proof is not None and attempt < _BESIDE_REFUSED:
            beside = (proof.refused[:, None] + np.array([-1, 0, 1])).ravel()
        parameters = _halved(parameters, beside)
    control = control_points_on(motion, whole)
    through = _Candidate("through", control.through(), whole)
    for candidate in (through, _with_rests(control)):
        found = _attempt(problem, motion, candidate, tried, chosen)
        if found is not None:
            return found
    raise _unproven(problem, motion, candidate.nodes, tried[-1])


def _at_own_pace(
    problem: Problem, curve: CurvedMotion, nodes: Array, tolerance: float
) -> CurveProof:
    """The proof at the pace at which the path was planned, where it has one."""
    pace = problem.pace(len(nodes) - 1)
    times = None if pace is None else NodeTimes(nodes, pace)
    return prove_curve(problem, curve, tolerance, times)


def _attempt(
    problem: Problem,
    motion: Motion,
    candidate: _Candidate,
    tried: list[CurveProof | None],
    prove: Proof,
) -> ProvenCurve | None:
    """The candidate if it is proven free; otherwise it is added to those that were tried.

    It is added as None where it does not arrive at the attitude that is demanded.
    """
    at_rest = candidate.kind == "with rests"
    if at_rest:
        curve: CurvedMotion | None = CurvedMotion(motion, candidate.control)
    else:
        curve = curve_along(problem, motion, candidate.control)
    if curve is None:
        tried.append(None)
        return None
    tolerance = _LEAST_TOLERANCE if at_rest else problem.tolerance
    proof = prove(curve, candidate.nodes, tolerance)
    if len(proof.refused):
        tried.append(proof)
        return None
    before = [each for each in tried if each is not None]
    return ProvenCurve(
        candidate.kind,
        proof,
        candidate.nodes,
        sum(len(each.refused) for each in before),
        sum(each.prover.queries for each in before),
    )


def curve_along(problem: Problem, motion: Motion, control: ControlPoints) -> CurvedMotion | None:
    """The curve with control points, these moved a little where an attitude is to be reached.

    Args:
        problem: what was planned.
        motion: the motion of the plan.
        control: control points on its path or near it.

    Returns:
        The curve; None where it does not come to arrive at the attitude that is demanded.
    """
    if problem.reach_attitude and not motion.joints_are_straight:
        return curve_to_attitude(motion, control, problem.goal[3:7])
    return CurvedMotion(motion, control)


def _apart(lengths: Array) -> Array:
    """(k + 1,) numbers of nodes of a path, its ends included, that are not too close together.

    Args:
        lengths: (m,) of its edges [m].
    """
    passed = np.append(0.0, np.cumsum(lengths))
    least, kept = _LEAST_SHARE * passed[-1] / len(lengths), [0]
    for node in range(1, len(lengths)):
        if min(passed[node] - passed[kept[-1]], passed[-1] - passed[node]) >= least:
            kept.append(node)
    return np.array([*kept, len(lengths)], dtype=np.float64)


def _bends(control: ControlPoints) -> Flags:
    """(m + 1,) whether the polygon bends at each control point, or its steps change there."""
    bend = np.zeros(len(control.shares), dtype=np.bool_)
    bend[1:-1] = np.any(np.abs(np.diff(control.table, 2, axis=0)) > _NO_BEND, axis=1)
    return bend


def _beside_bends(control: ControlPoints) -> IntArray:
    """Edges of the polygon beside its bends."""
    bends = np.flatnonzero(_bends(control))
    return np.concatenate([bends - 1, bends])


def _halved(parameters: Array, edges: IntArray) -> Array:
    """Parameters of control points with the middles of some edges; those that are none count not.

    Args:
        parameters: (k + 1,) on the path.
        edges: numbers of edges.
    """
    among = np.unique(edges[(edges >= 0) & (edges < len(parameters) - 1)])
    return np.sort(np.append(parameters, 0.5 * (parameters[among] + parameters[among + 1])))


def _with_rests(control: ControlPoints) -> _Candidate:
    """The path itself: each control point at a bend thrice."""
    counts = np.where(_bends(control), 3, 1)
    nodes = np.cumsum(counts) - 1.0 - (counts == 3)
    return _Candidate("with rests", control.repeated(counts), nodes)


def _unproven(
    problem: Problem, motion: Motion, nodes: Array, proof: CurveProof | None
) -> UnprovenCurve:
    """The error that names the first edge of the path that was refused."""
    assert proof is not None  # the path itself arrives where the plan does
    piece = int(proof.refused[0])
    edge = int(np.clip(np.searchsorted(nodes, piece, side="right") - 1, 0, motion.edges - 1))
    still = np.zeros(3)
    pairs = (
        proof.prover.nearest(piece, still, still, 0.5),
        proof.prover.links.nearest(piece, 0.5),
    )
    contact, time = named(problem.obstacles, min(pairs, key=lambda each: each.distance)), None
    if proof.refusal is not None and problem.scene.moves:
        contact, time = proof.refusal
    return UnprovenCurve(edge + 1, motion.edges, contact, time)
