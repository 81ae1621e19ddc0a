"""The error that reports what a search without a path has tried."""

from __future__ import annotations

import numpy as np

from ffsr_plan.collision.contacts import named
from ffsr_plan.collision.distances import Nearest, ObstacleQuery, SelfQuery
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import PathNotFound
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.problem.base_window import plane_of_joints
from ffsr_plan.problem.problem import Problem
from ffsr_plan.tree_search.kernels.flight import fly
from ffsr_plan.tree_search.kernels.search_arrays import JOINTS
from ffsr_plan.tree_search.proven_paths import ProvenPaths
from ffsr_plan.tree_search.restarts import Restarts, far_apart
from ffsr_plan.tree_search.search_space import SearchSpace

_SAME_PLANE = 1e-6  # [rad] of a turn out of a plane
_NEAR = 0.5
"""Trees of an enclosed end stay within this share of the way and of what the others went."""


def path_not_found(
    space: SearchSpace,
    restarts: Restarts,
    proven: ProvenPaths,
    interrupted: bool,
    seconds: float,
    missed: float | None,
) -> PathNotFound:
    """The error.

    Args:
        space: the configuration space.
        restarts: the searches.
        proven: proofs, all of which failed.
        interrupted: whether a time limit ended the search.
        seconds: time that it took [s].
        missed: least angle by which a path missed the attitude that is demanded [rad], if any did.
    """
    state, attitude, other = restarts.nearest()
    near = _in_the_way(space, state, attitude, other)
    tried = restarts.tally()
    contact = named(space.problem.obstacles, near) if np.isfinite(near.distance) else None
    return PathNotFound(
        seconds,
        tried.tries,
        tried.nodes,
        tried.meetings,
        proven.refused,
        far_apart(space, state, other),
        contact,
        _advice(space, interrupted),
        missed,
        enclosed=_enclosed(space, tried.spread),
        spread=tried.spread,
    )


def _enclosed(space: SearchSpace, spread: tuple[float, float]) -> str:
    """`start` or `goal` where only the trees from there stayed near, otherwise nothing."""
    way = min(far_apart(space, space.start, goal) for goal in space.goals)
    for name, own, other in zip(("start", "goal"), spread, spread[::-1], strict=True):
        if 0.0 < own < _NEAR * min(way, other):
            return name
    return ""


def _in_the_way(space: SearchSpace, state: Array, attitude: Array, other: Array) -> Nearest:
    """The nearest pair where the way from one state (D,) to another is not clear any more."""
    arrival = np.zeros(4)
    share = fly(space.arrays, state, attitude, other, arrival, True)
    place = state + share * (other - state)
    robot, position = space.problem.robot, place[:3].copy()
    if space.problem.mode.floats:
        center = centers_of_mass(robot, place[None, JOINTS:])
        anchor = space.arrays.setup[0]["anchor"]
        position = anchor - rotations.rotate(arrival[None], center)[0]
    q = robot.assemble(position, arrival, place[JOINTS:])
    pairs = ObstacleQuery(robot, space.problem.obstacles).nearest(q), SelfQuery(robot).nearest(q)
    return min(pairs, key=lambda pair: pair.distance)


def _advice(space: SearchSpace, interrupted: bool) -> tuple[str, ...]:
    """What may help."""
    problem, advice = space.problem, []
    advice.append("a longer time_limit" if interrupted else "more checks of the TreePlanner")
    advice.append("another seed")
    if problem.mode.has_thrusters:
        low, high = problem.base_window.round(3).tolist()
        advice.append(f"a wider window than {low} to {high}")
    if problem.reach_attitude:
        advice.append("a goal attitude nearer to that of the start")
        advice += _in_the_plane(problem)
    advice.append("another start or goal")
    return tuple(advice)


def _in_the_plane(problem: Problem) -> tuple[str, ...]:
    """Advice for a robot whose joints turn in one plane, and a goal attitude out of it."""
    normal = plane_of_joints(problem.robot, problem.start[3:7])
    turn = rotations.rotate(
        problem.start[3:7], rotations.rotation_vector(problem.start[3:7], problem.goal[3:7])
    )
    if normal is None or np.linalg.norm(np.delete(turn, normal)) <= _SAME_PLANE:
        return ()
    return (f"a goal attitude turned about {'xyz'[normal]} alone, as all joints of the robot are",)
