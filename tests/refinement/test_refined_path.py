"""Beyond the lattice: F of the whole motion never rises, and what is returned is certified."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.proof.prover import Prover
from tests.search.ants.test_max_min import random_problem


@given(st.integers(0, 10_000), st.sampled_from([0.0, 0.02, 0.1, 2.0]))
@settings(max_examples=25)
def test_refinement_lowers_f_of_the_motion_and_its_plans_verify(seed, delta):
    try:
        plan = fp.plan(random_problem(seed, delta), fp.LatticeOptimum(), refine=False)
    except fp.PlanningError:
        return
    better = fp.refine(plan)
    assert better.motion_objective <= plan.motion_objective
    if delta == 0.0:
        assert better.objective == better.motion_objective < plan.objective
    assert better.lattice_objective == plan.lattice_objective
    assert better.optimum == plan.optimum
    assert np.array_equal(better.nodes, plan.nodes)
    report = better.verify(100)
    assert report.ok, report.problems
    assert report.least_clearance >= better.certificate.least_clearance > 0.0


def test_refinement_helps_a_path_of_any_planner():
    problem = fp.load_scenario("fig2a")
    for planner in (fp.AntSystem(cycles=5), fp.MaxMinAntSystem(cycles=20), fp.LatticeOptimum()):
        rough = fp.plan(problem, planner, 0, refine=False)
        better = fp.plan(problem, planner, 0)
        assert better.motion_objective < rough.motion_objective
        again = fp.refine(rough)
        assert again.objective == better.objective
        assert np.array_equal(again.configurations, better.configurations)


def test_a_path_does_not_hide_between_two_layers():
    """A gate of 10 cm half-way between two layers, which F at the nodes does not see."""
    robot = fp.load_robot("point")
    radius = float(-fp.clearance(robot, fp.Scene([[0, 0, 0]], [1e-9]), robot.configuration()))
    gate = fp.Scene([[1.5, s * (0.45 + radius), 0.0] for s in (-1, 1)], [0.4, 0.4])
    ends = robot.configuration(), robot.configuration((4.0, 0.0, 0.0))
    lattice = fp.Lattice(4, fp.Axis(10, 0.3))
    problem = fp.Problem(robot, gate, *ends, delta=0.2, lattice=lattice)
    hidden = fp.plan(problem, refine=False)
    refined = fp.plan(problem)
    assert hidden.certificate.least_clearance < 0.051
    assert refined.certificate.least_clearance > 4.0 * hidden.certificate.least_clearance
    assert refined.objective > hidden.objective
    assert refined.motion_objective < hidden.motion_objective


def test_more_weight_gives_more_clearance_and_takes_none():
    planner, clearances = fp.LatticeOptimum(), []
    for delta in (0.02, 0.2):
        plans = [fp.plan(random_problem(s, delta), planner) for s in (1, 2, 3, 4, 5, 6, 7, 9, 10)]
        clearances.append(np.array([plan.certificate.least_clearance for plan in plans]))
    some, much = clearances
    assert 0.1 < np.median(some) < np.median(much)
    assert np.all(much > 0.9 * some)


def test_f_of_the_motion_contains_the_least_clearance_on_each_edge(fig2a_plan):
    problem, motion = fig2a_plan.problem, fig2a_plan.motion
    prover = Prover(motion, problem.scene, problem.tolerance)
    times, still = np.linspace(0.0, 1.0, 129).tolist(), np.zeros(3)
    edges = [prover.obstacle_edge(i, still, still) for i in range(motion.edges)]
    dense = np.array([min(edge.clearance(t) for t in times) for edge in edges])
    near = problem.delta * problem.length_unit / dense
    length = fig2a_plan.length / problem.length_unit
    assert length + near.sum() / 2.0 < fig2a_plan.motion_objective <= length + near.sum() + 1e-9
    assert fig2a_plan.motion_objective == pytest.approx(length + near.sum(), rel=0.02)
    assert fig2a_plan.motion_objective > fig2a_plan.objective


def test_refinement_stays_within_the_window_and_in_sixteenths():
    """In metres, delta = 6 drives the path to the rim of the window."""
    plan = fp.plan(random_problem(1, 6.0), fp.LatticeOptimum())
    lateral = plan.configurations[:, 1]
    assert np.abs(plan.nodes).max() == 20
    assert np.abs(lateral).max() == pytest.approx(20 * 0.15)
    assert np.allclose(lateral / (0.15 / 16), np.rint(lateral / (0.15 / 16)), atol=1e-9)
    assert lateral[0] == lateral[-1] == 0.0


def test_refinement_in_space_uses_both_axes():
    given_ = fp.load_scenario("fig2a")
    problem = fp.Problem(
        given_.robot, given_.scene, given_.start, given_.goal, delta=2.0, length_unit=0.1,
        lattice=fp.Lattice(20, fp.Axis(6, 0.4), fp.Axis(4, 0.4)),
    )  # fmt: skip
    plan = fp.plan(problem, fp.LatticeOptimum())
    rough = fp.plan(problem, fp.LatticeOptimum(), refine=False)
    assert plan.motion_objective < rough.motion_objective
    assert plan.verify(100).ok


def test_a_refined_plan_can_be_refined_again_and_gets_no_worse():
    plan = fp.plan(fp.load_scenario("fig2b"), fp.AntSystem(cycles=5))
    assert fp.refine(plan).motion_objective <= plan.motion_objective


def test_there_is_nothing_to_refine_without_an_axis(robot):
    goal = robot.configuration(joints={"left_1": 1.0})
    problem = fp.Problem(robot, fp.Scene(), robot.neutral(), goal, lattice=fp.Lattice(4))
    plan = fp.plan(problem, refine=False)
    assert fp.refine(plan) == plan


def test_what_is_no_plan_cannot_be_refined():
    with pytest.raises(fp.InvalidInput, match="a Plan"):
        fp.refine("plan.json")


def test_a_refined_plan_saves_and_loads(tmp_path):
    plan = fp.plan(fp.load_scenario("fig2b"), seed=4)
    plan.save(tmp_path / "plan.json")
    assert fp.Plan.load(tmp_path / "plan.json") == plan
    assert plan.gap >= 0.0
