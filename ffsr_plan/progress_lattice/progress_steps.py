"""Steps of progress along the way from start to goal, and the motion that makes all of them.

Joints and attitude are functions of progress alone: joints follow one straight line, and where the
attitude reacts, going back along it undoes the turn. So a node (progress, offset) has one
configuration, whatever the path that leads to it.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.problem.problem import Problem
from ffsr_plan.proof.edge_travel import EdgeTravel


class ProgressSteps:
    """All steps of a lattice with progress.

    Attributes:
        values: (A,) progress of each place, 0 at the start and `steps` at the goal.
        start: number of the place at the start.
        goal: number of the place at the goal.
        motion: a motion without offsets that makes every step, and ends at the goal.
        corners: (A,) a corner of that motion at each place.
        edges: (A, D) edge of that motion that makes a step of -most .. most from each place; -1
            where there is none.
        lengths: (E,) length of each edge of the motion along the way [m].
        most: places that a step goes at most.
    """

    def __init__(self, problem: Problem) -> None:
        """List the steps.

        Args:
            problem: a problem on a lattice with progress.
        """
        progress = problem.given_lattice.progress
        assert progress is not None
        self.most = progress.most
        self.values: IntArray = np.arange(-progress.before, progress.steps + progress.beyond + 1)
        self.start, self.goal = progress.before, progress.before + progress.steps
        walk, edges = self._walk()
        self.edges: IntArray = edges
        self.corners: IntArray = np.array([walk.index(place) for place in range(len(self.values))])
        places = self.values[walk]
        self.motion = motion_at(problem, places, np.zeros((len(walk), 3)))
        self.lengths = frozen(edge_lengths(problem, places))

    @cached_property
    def travel(self) -> EdgeTravel:
        """Travel bounds along the edges of the motion."""
        return EdgeTravel(self.motion)

    @cached_property
    def between(self) -> Array:
        """(A, A) bound on the travel of any point of the robot from place to place [m]."""
        along = np.linalg.norm(self.motion.base_steps(), axis=1)
        travel = along + self.travel.speeds + self.travel.attitude_error
        way = np.concatenate([[0.0], np.cumsum(travel[self.edges[:-1, self.most + 1]])])
        return np.abs(way[:, None] - way[None])

    def _walk(self) -> tuple[list[int], IntArray]:
        """Places in an order that makes every step and ends at the goal, and the edges."""
        last, most = len(self.values) - 1, self.most
        edges = np.full((last + 1, 2 * most + 1), -1, dtype=np.int64)
        walk = [0]

        def go(place: int) -> None:
            edges[walk[-1], place - walk[-1] + most] = len(walk) - 1
            walk.append(place)

        for place in range(last + 1):  # a wait and a single step forwards at each
            go(place)
            if place < last:
                go(place + 1)
        for size in range(1, most + 1):
            for first in range(size):
                while walk[-1] != first:
                    go(walk[-1] + (1 if first > walk[-1] else -1))
                for place in range(first + size, last + 1, size):
                    go(place)
                for place in range(walk[-1] - size, -1, -size):
                    go(place)
        while walk[-1] != self.goal:
            go(walk[-1] + 1)
        return walk, edges


def motion_at(problem: Problem, progress: IntArray, offsets: Array) -> Motion:
    """The motion through places of progress with offsets.

    Args:
        problem: a problem on a lattice with progress.
        progress: (k + 1,) progress at each corner.
        offsets: (k + 1, 3) of the base from the straight way, world axes [m].
    """
    settings = problem.given_lattice.progress
    assert settings is not None
    robot, share = problem.robot, progress[:, None] / settings.steps
    positions = problem.start[:3] + share * problem.base_displacement + offsets
    held = np.clip(share, 0.0, 1.0)
    joints = robot.joint_values(problem.start) + held * problem.joint_displacement
    turns = held[:, 0] if problem.mode.has_wheels else None
    return Motion(robot, problem.mode, problem.start, problem.goal, positions, joints, turns)


def edge_lengths(problem: Problem, progress: IntArray) -> Array:
    """Length of each step along the way (Eq. 4).

    Args:
        problem: a problem on a lattice with progress.
        progress: (k + 1,) progress at each corner.

    Returns:
        (k,) lengths [m]: beyond start and goal, where the joints rest, those of the base alone.
    """
    settings = problem.given_lattice.progress
    assert settings is not None
    base = float(np.linalg.norm(problem.base_displacement)) * problem.position_weight
    rest = problem.straight_length**2 - base**2
    share = progress / settings.steps
    along, turned = np.diff(share), np.diff(np.clip(share, 0.0, 1.0))
    return np.sqrt((along * base) ** 2 + turned**2 * max(rest, 0.0))
