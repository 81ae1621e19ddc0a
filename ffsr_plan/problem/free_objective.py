"""Length L and objective F of a path without a lattice.

L is the Euclidean length in base position, wheels' turn and joint values with the weights of Eq. 4,
and F = L + delta sum of 1 / d, in units of length. The clearances d are taken at 39 stations at
equal steps of L, as many as the inner nodes of a lattice of 40 divisions: for the straight path F
is that of Eq. 8 on such a lattice, and corners that are added to a path do not change it. Where
bodies move, stations are at equal shares of the edges, which follow one another at the pace given.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.collision.debris.distances_in_time import distances_in_time
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.problem.objective import motion_objective, objective
from ffsr_plan.problem.problem import Problem

STATIONS = 39
"""Points of a path at which F counts the clearance."""
_SAMPLES = 16  # steps of a piece between two stations


def edge_lengths(problem: Problem, motion: Motion) -> Array:
    """Length of each edge of a motion.

    Args:
        problem: gives the weights.
        motion: the motion.

    Returns:
        (m,) lengths [m].
    """
    slide = problem.robot.prismatic
    joints = np.diff(motion.joint_values, axis=0)
    metres = np.hstack([motion.base_steps(), joints[:, slide]]) * problem.position_weight
    radians = joints[:, ~slide] * problem.rotation_weight
    squares = np.sum(metres**2, axis=1) + np.sum(radians**2, axis=1)
    if motion.mode.has_wheels:
        squares += np.sum((motion.turns * problem.rotation_weight) ** 2, axis=1)
    return np.asarray(np.sqrt(squares))


def stations(lengths: Array, count: int = STATIONS) -> tuple[IntArray, Array]:
    """Points at equal steps of length inside a path.

    Args:
        lengths: (m,) length of each edge [m]; where all are zero, edges count alike.
        count: number of points.

    Returns:
        (count,) edges, and (count,) times on them in [0, 1].
    """
    if not np.any(lengths > 0.0):
        lengths = np.ones(len(lengths))
    passed = np.append(0.0, np.cumsum(lengths))
    places = passed[-1] * np.arange(1, count + 1) / (count + 1)
    edge = np.clip(np.searchsorted(passed, places, side="right") - 1, 0, len(lengths) - 1)
    return edge, np.clip((places - passed[edge]) / lengths[edge], 0.0, 1.0)


def free_objective(problem: Problem, length: float, clearances: Array) -> float:
    """F of a path.

    Args:
        problem: gives delta, the unit of length and the largest clearance that counts.
        length: L [m].
        clearances: (STATIONS,) at the stations [m].

    Returns:
        F [length units].
    """
    return objective(problem, length, np.concatenate([[np.inf], clearances, [np.inf]]))


def stations_objective(problem: Problem, motion: Motion) -> tuple[float, float]:
    """L and F of a motion, whether it was planned on a lattice or not.

    Args:
        problem: gives obstacles, weights, delta, the unit of length and the largest clearance that
            counts.
        motion: the motion.

    Returns:
        L [m], and F with the clearances at the stations [length units].
    """
    length = float(edge_lengths(problem, motion).sum())
    return length, free_objective(problem, length, _clearances(problem, motion, STATIONS))


def whole_objective(problem: Problem, motion: Motion, length: float) -> float:
    """F of a whole motion: the sum is over the pieces between the stations.

    Each piece counts with the least clearance of 17 samples.

    Args:
        problem: gives obstacles, delta, the unit of length and the largest clearance that counts.
        motion: the motion.
        length: L [m].

    Returns:
        The value [length units].
    """
    pieces = STATIONS + 1
    if problem.delta == 0.0:
        return motion_objective(problem, length, np.full(pieces, np.inf))
    inner = _clearances(problem, motion, pieces * _SAMPLES - 1)
    places = np.array([0.0, motion.edges])
    ends = _measured(problem, motion.configurations()[[0, -1]], places, motion.edges)
    all_of_them = np.concatenate([ends[:1], inner, ends[1:]])
    least = [np.min(all_of_them[k * _SAMPLES : (k + 1) * _SAMPLES + 1]) for k in range(pieces)]
    return motion_objective(problem, length, np.array(least))


def least_objective(problem: Problem) -> float:
    """A bound below which F of no path falls: the straight way, all obstacles far away."""
    cap = np.inf if problem.clearance_cap is None else problem.clearance_cap
    return free_objective(problem, problem.straight_length, np.full(STATIONS, cap))


def _clearances(problem: Problem, motion: Motion, count: int) -> Array:
    """(count,) clearances at stations inside a motion [m]."""
    if problem.scene.moves:
        places: Array = motion.edges * np.arange(1, count + 1) / (count + 1)
        edge = np.minimum(places.astype(np.int64), motion.edges - 1)
        time = places - edge
    else:
        edge, time = stations(edge_lengths(problem, motion), count)
    return _measured(problem, motion.at(edge, time), edge + time, motion.edges)


def _measured(problem: Problem, q: Array, places: Array, edges: int) -> Array:
    """(n,) clearances of configurations (n, nq) at places (n,) on a path of so many edges [m]."""
    robot, scene, pace = problem.robot, problem.obstacles, problem.pace(edges)
    if not scene.moves or pace is None:
        return ObstacleQuery(robot, scene).distances(q)
    return distances_in_time(robot, scene, q, pace.instants(places))
