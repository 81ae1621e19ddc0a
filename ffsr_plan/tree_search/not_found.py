"""The error that reports what a search without a path has tried."""

from __future__ import annotations

import numpy as np

from ffsr_plan.collision.contacts import named
from ffsr_plan.collision.distances import Nearest, ObstacleQuery, SelfQuery
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import PathNotFound
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.tree_search.kernels.flight import fly
from ffsr_plan.tree_search.kernels.search_arrays import JOINTS
from ffsr_plan.tree_search.proven_paths import ProvenPaths
from ffsr_plan.tree_search.restarts import Restarts, far_apart
from ffsr_plan.tree_search.search_space import SearchSpace


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
    tried = restarts.meetings
    nodes = tried.nodes + int(restarts.trees.counts[:2].sum())
    meetings = tried.meetings + int(restarts.trees.counts[3])
    contact = named(space.problem.obstacles, near) if np.isfinite(near.distance) else None
    return PathNotFound(
        seconds,
        tried.tries,
        nodes,
        meetings,
        proven.refused,
        far_apart(space, state, other),
        contact,
        _advice(space, interrupted),
        missed,
    )


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
    advice.append("another start or goal")
    return tuple(advice)
