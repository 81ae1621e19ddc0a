"""The bundled scenarios in three dimensions: a ring, a turn by the arms alone, a truss."""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations


def test_the_ring_has_no_path_for_spread_arms():
    problem = fp.load_scenario("ring")
    bare = replace(problem, lattice=replace(problem.lattice, postures=()))
    with pytest.raises(fp.NoPath):
        fp.plan(bare, fp.LatticeOptimum())


def test_stowed_arms_pass_the_ring_and_are_spread_again():
    problem = fp.load_scenario("ring")
    plan = fp.plan(problem, seed=0)
    report = plan.verify(100)
    assert report.ok, report.problems
    assert report.momentum_residual <= 1e-9
    stowed = plan.nodes[:, 2]
    assert stowed[0] == stowed[-1] == 0
    passing = np.argmin(np.abs(plan.configurations[:, 0] - 5.0))
    assert stowed[passing] > 0
    centers = problem.scene.centers[:, 1:] - plan.configurations[passing, 1:3]
    angles = np.sort(np.arctan2(centers[:, 1], centers[:, 0]))
    assert np.max(np.diff(angles, append=angles[0] + 2 * np.pi)) < np.pi  # inside, not around it


def test_arms_rotate_a_floating_satellite_about_any_axis():
    problem = fp.load_scenario("spatial_turn")
    plan = fp.plan(problem, seed=0)
    report = plan.verify(50)
    assert report.ok, report.problems
    assert report.momentum_residual <= 1e-9
    assert report.center_drift <= 1e-6
    begin, end = plan.configurations[[0, -1]]
    assert rotations.angle_between(end[3:7], problem.goal[3:7]) < 1e-3
    assert np.degrees(rotations.angle_between(begin[3:7], end[3:7])) == pytest.approx(20.0, abs=2)
    assert end[7:] == pytest.approx(begin[7:], abs=1e-9)


def test_the_satellites_tool_arrives_along_the_truss():
    problem = fp.load_scenario("inspection")
    plan = fp.plan(problem, seed=0)
    report = plan.verify(100)
    assert report.ok, report.problems
    assert report.momentum_residual <= 1e-9
    assert plan.optimum_is_exact
    assert plan.gap < 1e-3
    model = problem.robot.model
    data = model.createData()
    pin.framesForwardKinematics(model, data, plan.configurations[-1])
    tool = data.oMf[model.getFrameId("arm_tool0")].translation
    assert tool == pytest.approx([10.6, 0.3, 1.6], abs=1e-6)
    turned = rotations.angle_between(plan.configurations[0, 3:7], plan.configurations[-1, 3:7])
    assert turned > 0.02  # the base reacts, and the goal was solved for with that
