"""Ways from start to goal on which progress is counted: the straight one, and any that is proven.

Joints and attitude are functions of progress alone. Where the attitude reacts, going back along the
same path of the joints undoes the turn, so that a place has one configuration, whatever led to it.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray, frozen
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.problem.free_objective import edge_lengths
from ffsr_plan.problem.problem import Problem

_STRAIGHT = 1e-9  # difference of two unit vectors of one direction
_INSIDE = 1e-9  # [m] beyond the window that rounding may bring about


class Way(Protocol):
    """Places from start to goal, and beyond them where there are more.

    Attributes:
        values: (A,) progress of each place, 0 at the start.
        start: number of the place at the start.
        goal: number of the place at the goal.
        most: places that a step goes at most.
    """

    values: IntArray
    start: int
    goal: int
    most: int

    def motion(self, places: IntArray, offsets: Array) -> Motion:
        """The motion through places (k + 1,) with offsets (k + 1, 3) of the base, world [m]."""
        ...

    def lengths(self, places: IntArray) -> Array:
        """(k,) length of each step through places (k + 1,) without offsets [m]."""
        ...

    def holds(self, offsets: Array) -> Flags:
        """(A, n) whether the base may be at offsets (n, 3) from each place [m]."""
        ...


class StraightWay:
    """The straight way of a problem on a lattice with progress; see `Way`."""

    def __init__(self, problem: Problem) -> None:
        """Places at equal steps.

        Args:
            problem: a problem on such a lattice.
        """
        progress = problem.given_lattice.progress
        assert progress is not None
        self._problem, self._steps = problem, progress.steps
        self.most = progress.most
        self.values: IntArray = np.arange(-progress.before, progress.steps + progress.beyond + 1)
        self.start, self.goal = progress.before, progress.before + progress.steps

    def motion(self, places: IntArray, offsets: Array) -> Motion:
        """See `Way`."""
        problem, share = self._problem, self.values[places][:, None] / self._steps
        robot = problem.robot
        positions = problem.start[:3] + share * problem.base_displacement + offsets
        held = np.clip(share, 0.0, 1.0)
        joints = robot.joint_values(problem.start) + held * problem.joint_displacement
        turns = held[:, 0] if problem.mode.has_wheels else None
        return Motion(robot, problem.mode, problem.start, problem.goal, positions, joints, turns)

    def lengths(self, places: IntArray) -> Array:
        """See `Way`; beyond start and goal, where the joints rest, those of the base alone."""
        problem = self._problem
        base = float(np.linalg.norm(problem.base_displacement)) * problem.position_weight
        rest = problem.straight_length**2 - base**2
        share = self.values[places] / self._steps
        along, turned = np.diff(share), np.diff(np.clip(share, 0.0, 1.0))
        return np.sqrt((along * base) ** 2 + turned**2 * max(rest, 0.0))

    def holds(self, offsets: Array) -> Flags:
        """See `Way`: anywhere."""
        return np.full((len(self.values), len(offsets)), True)


class LargestStep(NamedTuple):
    """What a step may change at most.

    Attributes:
        length: in length [m].
        base: of the base's position [m].
        joint: of any joint value [rad or m].
    """

    length: float
    base: float = np.inf
    joint: float = np.inf


class PathWay:
    """A path of a problem without a lattice, its straight pieces cut into equal steps; see `Way`.

    A step goes from one place to the next, so that it follows the path.
    """

    def __init__(self, problem: Problem, path: Motion, largest: LargestStep) -> None:
        """Places along a path.

        Args:
            problem: a problem without a lattice.
            path: from its start to its goal.
            largest: no step is larger.
        """
        self._problem, self.most = problem, 1
        turns = path.turn_shares
        shares = np.zeros(path.edges + 1) if turns is None else np.array(turns)
        corners = np.column_stack([path.positions, shares, path.joint_values])
        if problem.mode.floats:
            corners[:, :3] = problem.start[:3]  # the position reacts
        self._places = _cut(corners[_turning(corners)], problem, largest)
        self._turns = turns is not None
        last = len(self._places) - 1
        self.values: IntArray = np.arange(last + 1)
        self.start, self.goal = 0, last
        self._steps = edge_lengths(problem, self.motion(self.values, np.zeros((last + 1, 3))))

    def motion(self, places: IntArray, offsets: Array) -> Motion:
        """See `Way`."""
        problem, chosen = self._problem, self._places[places]
        return Motion(
            problem.robot, problem.mode, problem.start, problem.goal,
            frozen(chosen[:, :3] + offsets), frozen(chosen[:, 4:].copy()),
            frozen(chosen[:, 3].copy()) if self._turns else None,
        )  # fmt: skip

    def lengths(self, places: IntArray) -> Array:
        """See `Way`."""
        steps, nearer = np.abs(np.diff(places)), np.minimum(places[:-1], places[1:])
        return np.where(steps == 0, 0.0, self._steps[np.minimum(nearer, len(self._steps) - 1)])

    def holds(self, offsets: Array) -> Flags:
        """See `Way`: in the problem's window."""
        if self._problem.mode.floats:
            return np.full((len(self.values), len(offsets)), True)
        low, high = self._problem.base_window
        places = self._places[:, None, :3] + offsets
        return np.asarray(np.all((places >= low - _INSIDE) & (places <= high + _INSIDE), axis=2))


def _turning(corners: Array) -> IntArray:
    """Numbers of the corners at which a path changes its direction, with both ends."""
    steps = np.diff(corners, axis=0)
    sizes = np.linalg.norm(steps, axis=1)
    moved = np.flatnonzero(sizes > 0.0)
    directions = steps[moved] / sizes[moved, None]
    turned = np.linalg.norm(np.diff(directions, axis=0), axis=1) > _STRAIGHT
    return np.concatenate([[0], moved[1:][turned], [len(corners) - 1]])


def _cut(corners: Array, problem: Problem, largest: LargestStep) -> Array:
    """The corners with places between them, no step larger than allowed."""
    steps = np.diff(corners, axis=0)
    path = Motion(
        problem.robot, problem.mode, problem.start, problem.goal, corners[:, :3], corners[:, 4:],
        corners[:, 3] if problem.mode.has_wheels else None,
    )  # fmt: skip
    ratios = np.stack(
        [
            edge_lengths(problem, path) / largest.length,
            np.linalg.norm(steps[:, :3], axis=1) / largest.base,
            np.max(np.abs(steps[:, 4:]), axis=1, initial=0.0) / largest.joint,
        ]
    )
    counts = np.maximum(np.ceil(ratios.max(axis=0) * (1.0 - 1e-12)), 1.0).astype(np.int64)
    parts = [corners[:1]]
    for begin, step, end, count in zip(corners, steps, corners[1:], counts.tolist(), strict=False):
        parts += [begin + np.arange(1, count)[:, None] / count * step, end[None]]
    return np.concatenate(parts)
