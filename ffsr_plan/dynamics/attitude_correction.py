"""Gauss-Newton correction of the final base attitude.

The attitude at the end is the product of the base rotations over all joint steps. Its derivative by
every inner corner, along every posture axis, comes from differences of the two steps beside the
corner; of all displacements that close the error to first order the least one is taken. Where the
full step does not reduce the error, a part of it is taken.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, Flags
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.time_limit.deadline import Deadline

_DIFFERENCE = 1e-5  # of the finite differences, in units of the displacement
_ITERATIONS = 20
_LEAST_STEP = 1.0 / 32.0  # of the full step
_TOLERANCE = 1e-9  # [rad]


def corrected(
    robot: SpaceRobot,
    start: Array,
    goal: Array,
    joint_values: Array,
    directions: Array,
    held: Flags | None = None,
    deadline: Deadline | None = None,
) -> Array | None:
    """Joint values (m + 1, nd) whose reaction ends at the goal attitude; None without convergence.

    Args:
        robot: the robot; its joint limits are kept.
        start: (4,) attitude at the beginning (xyzw).
        goal: (4,) attitude to end with.
        joint_values: (m + 1, nd) corners of a path whose reaction ends close to it.
        directions: (m + 1, axes, nd) along which each corner may be displaced.
        held: (m + 1,) corners that are to stay where they are; the first and the last do anyway.
        deadline: after which `OutOfTime` is raised.
    """
    deadline = deadline or Deadline()
    path = np.array(joint_values)
    free = np.ones(directions[1:-1].shape[:2], dtype=np.bool_)
    if held is not None:
        free[held[1:-1]] = False
    reaction, missed = _reaction_and_error(robot, path, start, goal)
    for _ in range(_ITERATIONS):
        if np.linalg.norm(missed) < _TOLERANCE:
            return path
        deadline.check()
        slope = attitude_slopes(robot, path, directions, reaction.increments)
        share = 1.0
        while share >= _LEAST_STEP:
            deadline.check()
            inner = within_limits(robot, path[1:-1], directions[1:-1], slope, share * missed, free)
            if inner is None:
                return None
            trial = np.vstack([path[:1], inner, path[-1:]])
            reaction, rest = _reaction_and_error(robot, trial, start, goal)
            if np.linalg.norm(rest) < np.linalg.norm(missed):
                path, missed = trial, rest
                break
            share *= 0.5
        else:
            return None
    return None


def _reaction_and_error(
    robot: SpaceRobot, path: Array, start: Array, goal: Array
) -> tuple[Reaction, Array]:
    """The reaction along a path, and the rotation vector (3,) from its end to the goal [rad]."""
    reaction = Reaction.along(robot, path)
    reached = reaction.attitudes(start)[-1]
    return reaction, rotations.log(rotations.multiply(rotations.inverse(reached), goal))


def within_limits(
    robot: SpaceRobot, corners: Array, directions: Array, slope: Array, missed: Array, free: Flags
) -> Array | None:
    """The corners after the least displacement that keeps every joint's limits.

    A corner that would exceed a limit along an axis is kept at its place along that axis; the other
    corners take over its part.

    Args:
        robot: the robot.
        corners: (m - 1, nd) inner corners of a path [rad or m].
        directions: (m - 1, axes, nd) along which each may be displaced.
        slope: (3, (m - 1) axes) of `attitude_slopes`.
        missed: (3,) rotation that is missing at the end, in its own axes [rad].
        free: (m - 1, axes) whether they may be.

    Returns:
        (m - 1, nd), or None where nothing may be displaced.
    """
    free = free.copy()
    while free.any():
        change = np.linalg.lstsq(slope * free.ravel(), missed, rcond=None)[0].reshape(free.shape)
        moves = change[..., None] * directions
        moved = corners + np.sum(moves, axis=1)
        above = moved > np.maximum(robot.upper, corners)
        below = moved < np.minimum(robot.lower, corners)
        if not np.any(above | below):
            return np.asarray(moved)
        blocked = (above[:, None] & (moves > 0.0)) | (below[:, None] & (moves < 0.0))
        free &= ~np.any(blocked, axis=2)
    return None


def attitude_slopes(robot: SpaceRobot, path: Array, directions: Array, increments: Array) -> Array:
    """(3, (m - 1) axes) rotation at the end, in its own axes, for each unit of displacement."""
    m, axes = len(path) - 1, directions.shape[1]
    corners = np.repeat(np.arange(1, m), axes)
    moved = path[1:-1, None] + _DIFFERENCE * directions[1:-1]
    moved = moved.reshape(-1, path.shape[1])
    before = Reaction(robot, path[corners - 1], moved - path[corners - 1], inside=False).increments
    behind = Reaction(robot, moved, path[corners + 1] - moved, inside=False).increments
    rest = [rotations.IDENTITY]  # from corner k + 1 to the end, backwards
    for increment in increments[:0:-1]:
        rest.append(rotations.multiply(increment, rest[-1]))
    after = np.array(rest[::-1])[corners]
    old = rotations.multiply(increments[corners - 1], increments[corners])
    turned = rotations.multiply(rotations.inverse(old), rotations.multiply(before, behind))
    turned = rotations.multiply(rotations.inverse(after), rotations.multiply(turned, after))
    return rotations.log(turned).T / _DIFFERENCE
