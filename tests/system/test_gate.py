"""Gates that only stowed arms pass, with a goal attitude that only the arms can bring about."""

import contextlib
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.scene.generators import gate


@pytest.mark.parametrize("name", ["gate", "double_gate"])
def test_spread_arms_do_not_pass_the_gate_and_that_is_proven(name):
    problem = fp.load_scenario(name)
    bare = replace(problem.lattice, postures=())
    with pytest.raises(fp.NoPath):
        fp.plan(replace(problem, lattice=bare, reach_attitude=False), fp.LatticeOptimum())


@pytest.mark.parametrize("name", ["gate", "double_gate"])
def test_the_colony_passes_the_gate_with_its_arms_stowed(name):
    problem = fp.load_scenario(name)
    plan = fp.plan(problem, seed=0)
    report = plan.verify(300)
    assert report.ok, report.problems
    assert report.momentum_residual <= 1e-9
    assert plan.arrival_attitude_error < 1e-3
    assert np.degrees(plan.arrival_attitude[0]) == pytest.approx(10.0, abs=0.06)
    assert 0.0 < plan.certificate.least_clearance <= report.least_clearance
    stowed = plan.nodes[:, 1]
    assert stowed[0] == stowed[-1] == 0
    for x in sorted(set(problem.scene.centers[:, 0])):
        passing = np.argmin(np.abs(plan.configurations[:, 0] - x))
        assert stowed[passing] >= 4
    assert 0.0 < plan.optimum <= plan.lattice_objective
    assert not plan.optimum_is_exact


def test_the_same_seed_passes_the_gate_in_the_same_way(tmp_path):
    problem = fp.load_scenario("gate")
    first, again, other = (fp.plan(problem, seed=seed) for seed in (3, 3, 4))
    assert first == again
    assert first != other
    first.save(tmp_path / "plan.json")
    assert fp.Plan.load(tmp_path / "plan.json") == first


def test_a_gate_has_the_opening_that_was_asked_for():
    scene = gate(4.0, 0.3, 1.2, 0.7)
    upper, lower = scene.centers[:, 1]
    assert (upper - 0.7) - (lower + 0.7) == pytest.approx(1.2)
    assert 0.5 * (upper + lower) == pytest.approx(0.3)
    assert np.all(scene.centers[:, 0] == 4.0)


def test_planners_that_know_no_attitude_refuse_and_say_why():
    problem = fp.load_scenario("gate")
    for planner in (fp.LatticeOptimum(), fp.AntSystem()):
        with pytest.raises(fp.InvalidInput, match="depends on the path"):
            fp.plan(problem, planner)
    with pytest.raises(fp.InvalidInput, match="no single attitude"):
        fp.Roadmap(problem)


def test_a_page_and_pictures_show_the_way_through_the_gate(tmp_path):
    from ffsr_plan.display.figures import write_figures
    from ffsr_plan.display.plan_page import page

    plan = fp.plan(fp.load_scenario("gate"), seed=0)
    assert len(plan.trails.layer) > 0
    assert "ready" in page(plan)
    assert len(write_figures(plan, tmp_path)) == 3


def test_a_held_attitude_passes_the_gate_too():
    """Wheels hold the base: postures change nothing but themselves."""
    problem = fp.load_scenario("gate")
    goal = problem.robot.configuration((10.0, 0.0, 0.0))
    held = replace(problem, mode="attitude-held", reach_attitude=False, goal=goal)
    plan = fp.plan(held, seed=0)
    report = plan.verify(200)
    assert report.ok, report.problems
    assert np.max(plan.wheel_momentum(duration=600.0).peak) > 0.0


def test_the_colony_can_be_followed_and_cut_short_among_postures():
    problem, seen = fp.load_scenario("gate"), []
    plan = fp.plan(problem, seed=0, on_cycle=seen.append)
    assert [c.number for c in seen] == list(range(1, len(seen) + 1))
    assert all(a.best >= b.best for a, b in pairwise(seen))
    assert seen[0].counts.sum() == seen[0].counts.shape[0] * 30
    assert plan.history.best[-1] <= seen[-1].best
    with contextlib.suppress(fp.PlanningError):  # if nothing that holds was found so soon
        assert fp.plan(problem, seed=0, time_limit=0.05).interrupted
