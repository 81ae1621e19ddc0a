"""Why reaction belongs inside the planner: what is free with the attitude held, collides in flight.

Distances are the scalar and vector closed forms of `closed_forms`, not Coal's.
"""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.dynamics.motion import Motion
from tests.helpers.closed_forms import clearances

SAMPLES = 101


@pytest.fixture(scope="module", params=["paper/06", "paper/24"])
def problem(request):
    """A problem of the set, for the shortest path, which hugs its obstacles."""
    return replace(fp.ProblemSet()[request.param].problem, delta=0.0, length_unit=1.0)


def least_clearance(motion, scene):
    times = np.linspace(0.0, 1.0, SAMPLES)
    q = motion.at(np.repeat(np.arange(motion.edges), SAMPLES), np.tile(times, motion.edges))
    return clearances(motion.robot, scene, q).min()


def certified(motion, scene):
    """Edge by edge, each from the attitude that the one before arrives at."""
    corners = motion.configurations()
    return [
        fp.certify_edge(motion.robot, scene, begin, end, mode=motion.mode).free
        for begin, end in pairwise(corners)
    ]


def test_a_plan_for_a_held_base_collides_when_it_reacts(problem):
    held = fp.plan(replace(problem, mode="attitude-held"), fp.LatticeOptimum())
    assert held.verify(samples=SAMPLES).ok
    assert least_clearance(held.motion, problem.scene) > 0.0
    path = held.configurations[:, :3]
    flight = Motion(problem.robot, "free-flying", problem.start, problem.goal, path)
    np.testing.assert_array_equal(flight.joint_values, held.motion.joint_values)
    assert least_clearance(flight, problem.scene) < -0.1
    assert not all(certified(flight, problem.scene))


def test_a_plan_with_reaction_does_not_collide(problem):
    plan = fp.plan(problem, fp.LatticeOptimum())
    assert plan.verify(samples=SAMPLES).ok
    assert least_clearance(plan.motion, problem.scene) > 0.0
    assert all(certified(plan.motion, problem.scene))
