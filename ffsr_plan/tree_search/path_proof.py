"""Proof of a path through the configuration space, as the motion that is returned."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ffsr_plan.collision.distances import Nearest
from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.dynamics.attitude_correction import corrected
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.problem.problem import Problem
from ffsr_plan.proof.prover import Prover
from ffsr_plan.time_limit.deadline import Deadline
from ffsr_plan.tree_search.kernels.search_arrays import JOINTS, TURN
from ffsr_plan.tree_search.search_space import SearchSpace

_LONGEST = 0.4  # edge of the motion: many short ones are proven at once sooner than few long ones


class Refusal(NamedTuple):
    """An edge that could not be proven free.

    Attributes:
        edge: its number.
        near: the nearest pair there.
    """

    edge: int
    near: Nearest


class PathProof(NamedTuple):
    """A motion, and what is proven of it.

    Attributes:
        states: (m + 1, D) at the ends of its edges.
        motion: the motion.
        prover: proofs along it.
        clearances: (m + 1,) at the ends of its edges [m].
        refusals: edges that could not be proven free.
        missed: angle by which the attitude that is demanded is missed [rad], or 0.
    """

    states: Array
    motion: Motion
    prover: Prover
    clearances: Array
    refusals: list[Refusal]
    missed: float


def prove(space: SearchSpace, corners: Array, deadline: Deadline) -> PathProof:
    """Prove the motion along a path free of collisions, edge by edge.

    Args:
        space: the configuration space.
        corners: (k, D) states.
        deadline: of the proof.

    Raises:
        OutOfTime: by the deadline.
    """
    states = cut(space, corners)
    problem = space.problems[space.goal_at(states[-1])]
    if problem.reach_attitude:
        states = _turned(problem, states, deadline)
    turns = None
    if space.goals[0, TURN] > 0.0:
        turns = states[:, TURN] / space.goals[0, TURN]
    motion = Motion(
        problem.robot, problem.mode, problem.start, problem.goal, frozen(states[:, :3].copy()),
        frozen(states[:, JOINTS:].copy()), turns,
    )  # fmt: skip
    m, still = motion.edges, np.zeros((motion.edges + 1, 3))
    prover = Prover(motion, problem.obstacles, problem.tolerance, deadline)
    clearances, refusals = prover.clearances(np.arange(m + 1), still), []
    ends = np.column_stack([clearances[:-1], clearances[1:]])
    verdicts = prover.certify_all(np.arange(m), still[1:], still[1:], ends)
    for edge, (verdict, links) in enumerate(zip(verdicts, prover.links.verdicts(), strict=True)):
        if not verdict.free:
            refusals.append(Refusal(edge, prover.nearest(edge, still[0], still[0], verdict.time)))
        elif not links.free:
            refusals.append(Refusal(edge, prover.links.nearest(edge, links.time)))
    missed = 0.0
    if problem.reach_attitude:
        missed = float(angle_between(motion.attitudes[-1], problem.goal[3:7]))
    return PathProof(states, motion, prover, frozen(clearances), refusals, missed)


def _turned(problem: Problem, states: Array, deadline: Deadline) -> Array:
    """(m + 1, D) the states with joints that bring the base to the attitude demanded.

    They hardly differ; where the correction does not converge, they are the same.
    """
    joints = states[:, JOINTS:]
    directions = np.broadcast_to(np.eye(joints.shape[1]), (*joints.shape, joints.shape[1]))
    found = corrected(
        problem.robot, problem.start[3:7], problem.goal[3:7], joints, directions, None, deadline
    )
    return states if found is None else np.hstack([states[:, :JOINTS], found])


def cut(space: SearchSpace, corners: Array) -> Array:
    """(m + 1, D) the corners (k, D) with further states on edges that are long."""
    weights = space.arrays.weights[0]
    parts = [corners[:1]]
    for begin, end in pairwise(corners):
        length = float(np.linalg.norm((end - begin) * weights))
        count = max(1, int(np.ceil(length / _LONGEST)))
        shares = np.arange(1, count)[:, None] / count
        parts += [begin + shares * (end - begin), end[None]]
    return np.concatenate(parts)
