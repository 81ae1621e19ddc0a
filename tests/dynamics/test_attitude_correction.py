"""Gauss-Newton correction of the attitude at the end of a joint path."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ffsr_plan.core import rotations
from ffsr_plan.dynamics.attitude_correction import attitude_slopes, corrected
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.search.postures.posture_lattice import displacements
from tests.search.postures.test_turning import quick, spatial


def test_the_correction_closes_the_error_and_keeps_the_ends():
    motion = quick().motion
    robot, path = motion.robot, motion.joint_values
    directions = displacements(quick().problem, np.tile(path[0], (len(path), 1)))
    start, goal = rotations.IDENTITY, rotations.from_angles((math.radians(20.7), 0.0, 0.0))
    bent = corrected(robot, start, goal, path, directions)
    reached = Reaction.along(robot, bent).attitudes(start)[-1]
    assert rotations.angle_between(reached, goal) < 1e-6
    assert np.array_equal(bent[[0, -1]], path[[0, -1]])


def test_the_correction_keeps_limits_and_held_corners():
    motion = quick().motion
    robot, path = motion.robot, motion.joint_values
    directions = displacements(quick().problem, np.tile(path[0], (len(path), 1)))
    start, goal = rotations.IDENTITY, rotations.from_angles((math.radians(20.7), 0.0, 0.0))
    free = corrected(robot, start, goal, path, directions)
    assert np.any((free > path.max(axis=0) + 1e-4) | (free < path.min(axis=0) - 1e-4))
    tight = replace(robot)
    object.__setattr__(tight, "upper", path.max(axis=0))
    object.__setattr__(tight, "lower", path.min(axis=0))
    held = np.arange(len(path)) < len(path) // 2
    for bent in (
        corrected(tight, start, goal, path, directions),
        corrected(tight, start, goal, path, directions, held),
    ):
        reached = Reaction.along(robot, bent).attitudes(start)[-1]
        assert rotations.angle_between(reached, goal) < 1e-6
        assert np.all((bent <= tight.upper) & (bent >= tight.lower))
    assert np.array_equal(bent[held], path[held])
    assert corrected(tight, start, goal, path, directions, np.ones_like(held)) is None


def test_slopes_of_the_correction_equal_finite_differences():
    plan = spatial(30, (0, 0, 1))
    robot, path, h = plan.problem.robot, plan.motion.joint_values, 1e-4
    directions = displacements(plan.problem, np.tile(path[0], (len(path), 1)))
    slopes = attitude_slopes(robot, path, directions, Reaction.along(robot, path).increments)
    axes = directions.shape[1]
    for column in range(0, slopes.shape[1], 11):
        corner, axis = 1 + column // axes, column % axes
        ends = []
        for sign in (1.0, -1.0):
            moved = np.array(path)
            moved[corner] += sign * h * directions[corner, axis]
            ends.append(Reaction.along(robot, moved).attitudes(rotations.IDENTITY)[-1])
        turned = rotations.log(rotations.multiply(rotations.inverse(ends[1]), ends[0])) / (2.0 * h)
        assert slopes[:, column] == pytest.approx(turned, abs=1e-5)
