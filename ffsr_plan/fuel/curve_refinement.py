"""A smooth curve along any proven path whose base is moved so that it needs little fuel.

Control points lie on the path at equal steps of its length. The joints, and with them the attitude
of the base, stay as they are along the curve; what changes is the position of the base, so that
the velocity of the robot's centre of mass changes little. Displacements have three directions: the
base may also hurry or wait while the arms move. A curve that jumps across an obstacle is refused by
the proof, and the place becomes a station.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ffsr_plan.collision.near_pairs import NearPairs
from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.rotations import rotate
from ffsr_plan.curves.control_points import ControlPoints, control_points_on
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.fuel.descent import Descent
from ffsr_plan.fuel.least_change_programme import Programme, vectors_of
from ffsr_plan.fuel.refinement import GROWTH, PROOFS, SPARE
from ffsr_plan.fuel.stations import Stations, curve_stations, on_curve
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.fuel_figures import velocity_change
from ffsr_plan.smoothing.curve_objective import edge_lengths
from ffsr_plan.smoothing.curve_proof import joints_are_proven, prove_curve
from ffsr_plan.smoothing.proven_curve import curve_along

_POINTS = (40, 80)  # edges of the control polygon, tried in turn
_IN_A_PIECE = 16  # samples for the change of velocity: precise to some 1e-3
_FAR = 1e6  # [m] bound on displacements without a window
_WITHIN_REFUSED = np.array([0.0, 0.25, 0.5, 0.75])  # times on a refused piece that become stations
_LEAST_STEP = 1e-3  # [m] of trust where the base hardly moves


class RefinedCurve(NamedTuple):
    """A curve that is proven to keep a margin.

    Attributes:
        curve: the curve.
        nodes: (n + 1,) parameters of the curve that belong to the path's nodes.
        refused: pieces of other curves that were refused before.
        queries: Coal queries of their proofs.
    """

    curve: CurvedMotion
    nodes: Array
    refused: int
    queries: int


def curve_change(curve: CurvedMotion) -> float:
    """Change of velocity of the centre of mass for a flight of unit duration at constant pace [m].

    Divided by a duration it is a delta-v [m/s].
    """
    count = curve.edges * _IN_A_PIECE
    at = np.arange(count + 1) / _IN_A_PIECE
    edge = np.minimum(at.astype(np.int64), curve.edges - 1)
    return velocity_change(_centers(curve, edge, at - edge))


def refined_curve(
    problem: Problem, motion: Motion, directions: Array, margin: float
) -> RefinedCurve | None:
    """The curve along a proven motion, its base displaced to a small change of velocity.

    Args:
        problem: what was planned; its base is moved by thrusters.
        motion: the motion of the plan.
        directions: (axes, 3) orthonormal directions in which the base may be displaced, 1 to 3;
            world axes without a lattice.
        margin: clearance to keep [m].

    Returns:
        The curve; None if none was proven.

    Raises:
        InvalidInput: a margin that start or goal lack.
        IntegrationError: the reaction along a curve cannot be integrated.
    """
    wider = replace(problem, min_clearance=problem.min_clearance + margin)
    refused = queries = 0
    for count in _POINTS:
        parameters = _equal_steps(problem, motion, count)
        base = curve_along(problem, motion, control_points_on(motion, parameters))
        if base is None or not joints_are_proven(problem, base):
            continue
        refinement = _Refinement(wider, motion, base, directions)
        found = refinement.refined()
        refused, queries = refused + refinement.refused, queries + refinement.queries
        if found is not None:
            nodes = np.interp(np.arange(motion.edges + 1.0), parameters, np.arange(count + 1.0))
            return RefinedCurve(found, nodes, refused, queries)
    return None


class _Refinement:
    """Descents of one control polygon, each ended by a proof."""

    def __init__(
        self, wider: Problem, motion: Motion, base: CurvedMotion, directions: Array
    ) -> None:
        self.refused = self.queries = 0
        self._problem, self._motion, self._base = wider, motion, base
        self._directions = directions
        control, m = base.control, base.edges
        ends = np.append(np.arange(m), m - 1), np.append(np.zeros(m), 1.0)
        swing = _centers(base, *ends) - base.configurations()[:, :3]
        centers = control.positions + swing
        low, high = np.full((2, m + 1, len(directions)), [[[-_FAR]], [[_FAR]]])
        if wider.lattice is None:
            room = wider.base_window[:, None] - control.positions
            low, high = np.sort(room @ directions.T, axis=0)  # directions are along world axes
        vectors = vectors_of(centers)
        nominal = vectors @ directions.T
        across = np.linalg.norm(vectors - nominal @ directions, axis=1)
        self._programme = Programme(nominal, across, low, high)
        step = float(np.mean(np.linalg.norm(np.diff(centers, axis=0), axis=1)))
        pairs = NearPairs(wider.robot, wider.obstacles)
        self._descent = Descent(self._programme, pairs, directions, max(step, _LEAST_STEP))

    def refined(self) -> CurvedMotion | None:
        """The curve at the end of the descents; None if none was proven."""
        m = self._base.edges
        stations, spare = curve_stations(m), SPARE * self._problem.tolerance
        offsets = np.zeros((m + 1, len(self._directions)))
        for _ in range(PROOFS):
            placed = shape_placements(
                self._problem.robot, self._base.at(stations.edges, stations.times)
            )
            offsets = self._descent.descended(placed, stations, offsets, spare)
            curve = CurvedMotion(
                self._motion, _displaced(self._base.control, offsets @ self._directions)
            )
            proof = prove_curve(self._problem, curve, self._problem.tolerance)
            if not len(proof.refused):
                return curve
            self.refused += len(proof.refused)
            self.queries += proof.prover.queries
            stations = stations.with_others(_beside(m, proof.refused))
            spare *= GROWTH
        return None


def _beside(divisions: int, refused: IntArray) -> Stations:
    edges = np.repeat(refused, len(_WITHIN_REFUSED))
    return on_curve(divisions, edges, np.tile(_WITHIN_REFUSED, len(refused)))


def _displaced(control: ControlPoints, offsets: Array) -> ControlPoints:
    return control._replace(positions=control.positions + offsets)


def _centers(curve: CurvedMotion, edge: IntArray, time: Array) -> Array:
    """(N, 3) centre of mass of the robot along a curve, world axes [m]."""
    q = curve.at(edge, time)
    centers = centers_of_mass(curve.robot, curve.robot.joint_values(q))
    return np.asarray(q[:, :3] + rotate(q[:, 3:7], centers))


def _equal_steps(problem: Problem, motion: Motion, count: int) -> Array:
    """(count + 1,) parameters on a motion, from 0 to its edges, at equal steps of length."""
    passed = np.append(0.0, np.cumsum(edge_lengths(problem, motion)))
    places = np.linspace(0.0, passed[-1], count + 1)
    found: Array = np.interp(places, passed, np.arange(motion.edges + 1.0))
    return found
