"""A least clearance is kept all along the motion, by every planner, and verified."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.collision.distances import ObstacleQuery
from tests.helpers.free_scenes import gap

KEPT = 0.05
CASES = {
    "max-min-ant-system": ("fig2a", fp.MaxMinAntSystem(cycles=12), 12),
    "lattice-optimum": ("fig2a", fp.LatticeOptimum(), 12),
    "ant-system": ("fig2a", fp.AntSystem(cycles=4, ants=5), 12),
    "posture-annealing": ("gate", fp.PostureAnnealing(ants=4, cycles=6), None),
    "tree-planner": (None, fp.TreePlanner(checks=200_000), None),
}


def problem_of(name, divisions):
    if name is None:
        return gap(fp.load_robot("planar_dual_arm"), 0)
    problem = replace(fp.load_scenario(name), reach_attitude=False)
    if divisions is None:
        return problem
    return replace(problem, lattice=fp.Lattice(divisions, fp.Axis(8, 0.3)))


@pytest.mark.parametrize("name", CASES)
def test_a_least_clearance_is_kept_all_along_the_motion(name, tmp_path):
    scenario, planner, divisions = CASES[name]
    problem = replace(problem_of(scenario, divisions), min_clearance=KEPT)
    plan = fp.plan(problem, planner)
    sampled = ObstacleQuery(problem.robot, problem.scene).distances(plan.at(np.linspace(0, 1, 801)))
    assert sampled.min() > KEPT
    assert plan.clearances.min() >= 0.0
    assert plan.certificate.least_clearance <= sampled.min() - KEPT + 1e-9
    assert plan.verify(10).ok
    plan.save(tmp_path / "plan.json")
    assert fp.Plan.load(tmp_path / "plan.json") == plan


def test_a_plan_that_does_not_keep_it_does_not_verify():
    plan = fp.plan(problem_of("fig2a", 12), fp.LatticeOptimum())
    assert plan.verify(10).ok
    near = replace(plan, problem=replace(plan.problem, min_clearance=0.5))
    report = near.verify(10)
    assert not report.ok
    assert report.least_clearance == pytest.approx(plan.verify(10).least_clearance - 0.5, abs=0.01)


def test_ends_that_do_not_keep_it_are_reported_with_the_distance_they_lack(point):
    scene = fp.Scene([[0.0, 1.0, 0.0]], [0.5])
    goal = point.configuration((4.0, 0.0, 0.0))
    problem = fp.Problem(point, scene, point.configuration(), goal, min_clearance=1.0)
    with pytest.raises(fp.StartInCollision, match="grown by 1 m") as error:
        fp.plan(problem)
    clearance = fp.clearance(point, scene, problem.start)
    assert error.value.depth == pytest.approx(1.0 - clearance)


@pytest.mark.parametrize("value", [-0.1, np.inf, "0.1"])
def test_a_least_clearance_is_a_length(point, value):
    goal = point.configuration((4.0, 0.0, 0.0))
    with pytest.raises(fp.InvalidInput, match="min_clearance"):
        fp.Problem(point, fp.Scene(), point.configuration(), goal, min_clearance=value)
