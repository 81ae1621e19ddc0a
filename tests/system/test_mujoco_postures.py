"""MuJoCo flies plans with posture axes, whose joint paths have a corner at every node.

At zero momentum the reaction does not depend on the time law. So each edge is flown from rest to
rest, and the joints keep to their path, corners included.
"""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from tests.helpers.spatial_robot import spatial_problem
from tests.search.postures.test_turning import turning

pytest.importorskip("mujoco", minversion="4")

from tests.helpers import (
    mujoco_flight as engine,
)  # they cannot be imported where there is no MuJoCo
from tests.helpers.mujoco_plans import RECORDED, departures, flown

AGREEMENT = 1e-5  # [rad], [m] and relative; half the step leaves a sixteenth of what is found
FOLLOWED = 1e-6  # [rad], joints


def gate(**changes):
    return replace(fp.load_scenario("gate"), **changes)


def spatial_afloat():
    problem = spatial_problem(20, (1, -1, 1), divisions=24, levels=3, spacing=0.4)
    return replace(problem, mode="free-floating")


TURNING = {
    "through a gate": gate,
    "on the spot": lambda: turning(-30),
    "afloat": lambda: turning(20, mode="free-floating"),
    "afloat in three dimensions": spatial_afloat,
}


def bend(plan):
    """How far [rad] the joint path leaves the straight line between its ends."""
    path = plan.motion.joint_values
    share = np.linspace(0.0, 1.0, len(path))[:, None]
    return np.abs(path - (1.0 - share) * path[0] - share * path[-1]).max()


@pytest.mark.parametrize("name", TURNING)
def test_mujoco_rotates_the_base_to_the_goal_attitude(name):
    plan = fp.plan(TURNING[name](), seed=0)
    flight, _ = flown(plan)
    turned, away, joints = departures(plan, flight)
    assert bend(plan) > 0.5
    assert rotations.angle_between(flight.attitudes[0], flight.attitudes).max() > 0.1
    assert joints < FOLLOWED
    assert turned < AGREEMENT
    assert away < AGREEMENT
    assert rotations.angle_between(flight.attitudes[-1], plan.problem.goal[3:7]) < 1e-3
    if plan.problem.mode == "free-floating":
        assert np.linalg.norm(flight.positions - flight.positions[0], axis=1).max() > 0.05
    assert np.all(flight.impulses == 0.0)


def test_mujocos_wheels_store_the_momentum_that_is_planned():
    goal = gate().robot.configuration((10.0, 0.0, 0.0), (0.4, 0.0, 0.0))
    plan = fp.plan(gate(mode="attitude-held", reach_attitude=False, goal=goal), seed=0)
    flight, (s, rate, _) = flown(plan)
    turned, away, joints = departures(plan, flight)
    assert bend(plan) > 0.5
    assert joints < FOLLOWED
    assert turned < AGREEMENT
    assert away < AGREEMENT
    # stored momentum goes as ds/dt: here in the middle of the edges, there with no halts
    middles = slice(RECORDED // 2, None, RECORDED)
    clock = np.linspace(0.0, 1.0, 100_001)
    clock = np.interp(s[middles], engine.progress(clock, 1.0)[0], clock)
    without = plan.wheel_momentum(1.0, clock).world
    stored = without * (rate[middles] / engine.progress(clock, 1.0)[1])[:, None]
    scale = AGREEMENT * np.linalg.norm(stored, axis=1).max()
    assert np.linalg.norm(stored + flight.impulses[middles], axis=1).max() < scale
    assert np.linalg.norm(stored + flight.momenta[middles], axis=1).max() < scale
