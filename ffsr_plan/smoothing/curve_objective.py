"""Length L and objective F of a curve, by the definitions for paths."""

from __future__ import annotations

import numpy as np

from ffsr_plan.bodies.pace import Timetable
from ffsr_plan.collision.body_distances import BodyDistances
from ffsr_plan.collision.debris.debris_distances import DebrisDistances
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.core.arrays import Array
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.curves.splines import evaluate
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.problem.objective import objective
from ffsr_plan.problem.problem import Problem

_SAMPLES = 32  # middles of parts of a piece: L is precise to some 1e-6 of it
_STATIONS = 39  # as for plans without a lattice


def curve_lengths(problem: Problem, curve: CurvedMotion) -> Array:
    """Length of the parts of a curve.

    On a lattice the displacement from the nominal motion is perpendicular to it, as in Eq. 6;
    without one L is the Euclidean length in base position, wheels' turn and joint values.

    Args:
        problem: gives the weights.
        curve: the curve, m pieces.

    Returns:
        (m, 32) lengths of equal parts of the pieces' parameters [m].
    """
    m, robot = curve.edges, problem.robot
    piece, time = np.repeat(np.arange(m), _SAMPLES), (np.arange(m * _SAMPLES) % _SAMPLES + 0.5)
    rates = evaluate(curve.pieces.rates, piece, time / _SAMPLES)
    metres, radians = problem.position_weight, problem.rotation_weight
    weights = np.append(np.full(3, metres), np.where(robot.prismatic, metres, radians))
    way, progress = rates[:, :-1], rates[:, -1:]
    if problem.mode.floats:
        way[:, :3] = 0.0
    if problem.lattice is None:
        squares = np.sum((way * weights) ** 2, axis=1)
        squares += np.sum((radians * progress * curve.pieces.turn) ** 2, axis=1)
    else:
        nominal = np.append(problem.base_displacement, problem.joint_displacement)
        squares = np.sum(((way - progress * nominal) * weights) ** 2, axis=1)
        squares += (problem.straight_length * progress[:, 0]) ** 2
    return np.asarray(np.sqrt(squares).reshape(m, _SAMPLES) / _SAMPLES)


def edge_lengths(problem: Problem, motion: Motion) -> Array:
    """(m,) Euclidean lengths of a motion's edges in base position, wheels' turn and joints [m].

    Args:
        problem: gives the weights.
        motion: the motion, m edges.
    """
    metres, radians = problem.position_weight, problem.rotation_weight
    weights = np.where(problem.robot.prismatic, metres, radians)
    steps = [metres * motion.base_steps(), weights * np.diff(motion.joint_values, axis=0)]
    if problem.mode.has_wheels:
        steps.append(radians * motion.turns)
    lengths: Array = np.linalg.norm(np.hstack(steps), axis=1)
    return lengths


def curve_objective(
    problem: Problem,
    curve: CurvedMotion,
    nodes: Array,
    lengths: Array,
    times: Timetable | None = None,
) -> float:
    """F of a curve.

    Args:
        problem: gives the obstacles, delta, the unit of length and the largest clearance.
        curve: the curve.
        nodes: parameters, in pieces, of the inner nodes of a lattice; not used without one.
        lengths: of `curve_lengths` [m].
        times: at which the curve is where; None where no body moves.

    Returns:
        F [length units].
    """
    parameters = nodes if problem.lattice is not None else _stations(lengths)
    piece = np.minimum(parameters.astype(np.int64), curve.edges - 1)
    q, scene, ends = curve.at(piece, parameters - piece), problem.obstacles, np.array([np.inf])
    clearances = ObstacleQuery(problem.robot, scene.at_rest).distances(q)
    if times is not None and scene.moves:
        placed, rows = shape_placements(problem.robot, q), np.arange(len(q))
        instants, still = times.instants(parameters), np.zeros((len(q), 3))
        for body, own in zip(scene.bodies, scene.body_scenes, strict=True):
            query, poses = ObstacleQuery(problem.robot, own), body.poses(instants)
            seen = BodyDistances(problem.robot, query, placed, poses)
            clearances = np.minimum(clearances, seen.distances(rows, still))
        if scene.debris:
            debris = DebrisDistances(problem.robot, scene, float(instants.mean()))
            at_once = np.zeros(len(q))
            clearances = debris.least(placed, rows, still, instants, at_once, clearances)
    return objective(problem, float(lengths.sum()), np.concatenate([ends, clearances, ends]))


def _stations(lengths: Array) -> Array:
    """(39,) parameters, in pieces, at equal steps of length inside a curve."""
    flat = lengths.ravel()
    passed = np.append(0.0, np.cumsum(flat))
    parameters = np.arange(len(passed)) / lengths.shape[1]
    places = passed[-1] * np.arange(1, _STATIONS + 1) / (_STATIONS + 1)
    return np.asarray(np.interp(places, passed, parameters))
