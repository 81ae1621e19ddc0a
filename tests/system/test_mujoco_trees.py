"""MuJoCo flies plans without a lattice: in all modes, and the base is where it was planned."""

import numpy as np
import pytest

import ffsr_plan as fp
from benchmarks.studies.general.families import drawn, loaded
from ffsr_plan.core import rotations
from tests.helpers.dense_flight import least_gap
from tests.helpers.free_scenes import gap, held_turn, scattered

pytest.importorskip("mujoco", minversion="4")

from tests.helpers import mujoco_plans as engine  # it cannot be imported where there is no MuJoCo

AGREEMENT = 1e-5  # [rad] and [m]; half the step leaves a sixteenth of what is found
FOLLOWED = 1e-6  # [rad], joints

REACTING = {
    "among spheres": lambda: scattered(loaded("planar_dual_arm"), 11),
    "through a gap": lambda: gap(loaded("planar_dual_arm"), 10),
    "afloat beside a box": lambda: drawn(4, 0),
    "past spheres": lambda: drawn(5, 100),
}


def agrees(plan, step=engine.STEP):
    """Fly it, and return the flight."""
    flight, _ = engine.flown(plan, step)
    turned, away, joints = engine.departures(plan, flight)
    assert joints < FOLLOWED
    assert turned < AGREEMENT
    assert away < AGREEMENT
    least, touching = least_gap(plan, engine.configurations(plan, flight))
    assert not touching
    assert least > plan.certificate.least_clearance - AGREEMENT
    return flight


@pytest.mark.parametrize("name", REACTING)
def test_mujoco_turns_the_base_as_planned(name):
    plan = fp.plan(REACTING[name](), seed=0, until="first")
    flight = agrees(plan)
    assert rotations.angle_between(flight.attitudes[0], flight.attitudes).max() > 0.02
    assert np.all(flight.impulses == 0.0)
    if plan.problem.mode == "free-floating":
        assert np.linalg.norm(flight.positions - flight.positions[0], axis=1).max() > 0.01


def test_mujoco_brings_the_base_to_the_attitude_that_is_demanded():
    plan = fp.plan(drawn(6, 1), seed=0, until="first")
    flight = agrees(plan, step=0.5 * engine.STEP)
    assert rotations.angle_between(plan.problem.start[3:7], plan.problem.goal[3:7]) > 0.1
    assert rotations.angle_between(flight.attitudes[-1], plan.problem.goal[3:7]) < 2.0 * AGREEMENT


def test_mujocos_wheels_turn_the_base_unevenly_as_planned():
    problem = held_turn(scattered(loaded("planar_dual_arm"), 21, "attitude-held"), 0.5)
    plan = fp.plan(problem, fp.TreePlanner(checks=200_000), seed=1)
    assert np.ptp(np.diff(plan.motion.turn_shares)) > 0.01
    flight = agrees(plan)
    assert np.linalg.norm(flight.impulses, axis=1).max() > 0.0
