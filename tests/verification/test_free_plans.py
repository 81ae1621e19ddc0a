"""Forged plans without a lattice are found out."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from tests.helpers.free_scenes import scattered


@pytest.fixture(scope="module")
def plan():
    robot = fp.load_robot("planar_dual_arm")
    problem = scattered(robot, 0, delta=0.01, clearance_cap=1.0)
    return fp.plan(problem, fp.TreePlanner(checks=60_000))


def problems_of(plan):
    return " ".join(plan.verify(20).problems)


def test_an_honest_plan_has_no_problems(plan):
    report = plan.verify()
    assert report.ok, report.problems
    assert report.objective_error < 1e-9
    assert report.clearance_error < 1e-9
    assert "that the lower bound on F holds" in report.not_checked


def test_other_figures_are_found_out(plan):
    assert "the length is" in problems_of(replace(plan, length=plan.length + 1e-6))
    other = plan.objective + 1e-6
    assert "F is" in problems_of(replace(plan, objective=other, lattice_objective=other))
    assert "F is stated as" in problems_of(replace(plan, lattice_objective=other))
    clearances = plan.clearances.copy()
    clearances[3] += 1e-6
    assert "node clearances differ" in problems_of(replace(plan, clearances=clearances))


def test_an_impossible_lower_bound_is_found_out(plan):
    assert "above F" in problems_of(replace(plan, optimum=1.1 * plan.objective))
    assert "below F of any path" in problems_of(replace(plan, optimum=0.9 * plan.optimum))


def test_a_base_outside_its_window_is_found_out(plan):
    low, high = plan.motion.positions.min(axis=0), plan.motion.positions.max(axis=0)
    exact = replace(plan.problem, window=(low, high))
    optimum = plan.optimum
    assert problems_of(replace(plan, problem=exact, optimum=optimum)) == ""
    low = low + np.array([0.0, 1e-6, 0.0])
    if low[1] > plan.problem.start[1]:
        low, high = plan.motion.positions.min(axis=0), high - np.array([0.0, 1e-6, 0.0])
    narrow = replace(plan.problem, window=(low, high))
    assert "the base leaves the window" in problems_of(replace(plan, problem=narrow))
