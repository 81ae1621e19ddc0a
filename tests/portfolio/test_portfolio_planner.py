"""A portfolio returns the better of two plans, by one measure, and loses neither."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.portfolio.lattice_left_out import without_lattice
from ffsr_plan.problem.free_objective import stations_objective
from ffsr_plan.search.records import SearchRequest
from ffsr_plan.tree_search.kernels.random_numbers import random_state
from ffsr_plan.tree_search.path_improvement import ImprovedPath
from ffsr_plan.tree_search.search_space import SearchSpace
from tests.helpers.free_scenes import wall

QUICK = fp.TreePlanner(checks=60_000)
NEXT_TO_NOTHING = fp.TreePlanner(checks=1)
ACROSS = fp.Lattice(16, fp.Axis(8, 0.25))


@pytest.fixture(scope="module")
def passable(robot):
    """A sphere that the lattice gets around."""
    scene = fp.Scene([[2.5, 0.6, 0.0]], [0.4])
    start = robot.configuration(joints={"left_1": 0.2})
    goal = robot.configuration((5.0, 0.0, 0.0), joints={"right_1": -0.3})
    return fp.Problem(robot, scene, start, goal, lattice=ACROSS, delta=0.1)


def walled(robot, *, closed):
    """A wall across the whole lattice, with a gap far aside or with none."""
    centers, radii = wall(2.5, -9.0 if closed else -2.3, 9.0, 0.25)
    ends = robot.configuration(), robot.configuration((5.0, 0.0, 0.0))
    return fp.Problem(robot, fp.Scene(centers, radii), *ends, lattice=ACROSS)


def test_the_plan_is_no_worse_than_either_by_the_measure_of_stations(passable):
    free = without_lattice(passable)
    both = fp.plan(passable, fp.Portfolio(trees=QUICK))
    value = stations_objective(free, both.motion)[1]
    assert value < stations_objective(free, fp.plan(passable).motion)[1]
    assert value <= fp.plan(free, QUICK).objective * 1.02
    assert both.verify().ok
    assert both == fp.plan(passable, fp.Portfolio(trees=QUICK))


def test_a_path_of_the_lattice_that_trees_do_not_better_is_kept_with_its_exact_optimum(passable):
    both = fp.plan(passable, fp.Portfolio(trees=NEXT_TO_NOTHING))
    alone = fp.plan(passable)
    assert both.problem == passable
    assert both.optimum_is_exact
    assert replace(both, planner=alone.planner) == alone


def test_where_the_lattice_has_no_path_that_of_the_trees_is_taken(robot):
    problem = walled(robot, closed=False)
    with pytest.raises(fp.NoPath):
        fp.plan(problem)
    plan = fp.plan(problem, fp.Portfolio(trees=QUICK))
    assert (plan.lattice, plan.problem.lattice) == (None, None)
    assert plan.problem == without_lattice(problem)
    assert plan.verify().ok
    alone = fp.plan(without_lattice(problem), QUICK)
    assert replace(plan, planner=QUICK) == alone  # the same random numbers


def test_the_trees_draw_the_numbers_that_they_draw_alone_whatever_the_lattice_drew(robot):
    folding = fp.PostureAxis({"left_2": 1.0}, 1, 0.2)
    problem = walled(robot, closed=False)
    problem = replace(problem, lattice=fp.Lattice(6, fp.Axis(2, 0.5), postures=[folding]))
    ants = fp.PostureAnnealing(ants=2, cycles=2, annealing_shifts=20)
    with pytest.raises(fp.UnprovenPath):
        fp.plan(problem, ants)
    plan = fp.plan(problem, fp.Portfolio(ants, QUICK))
    assert replace(plan, planner=QUICK) == fp.plan(without_lattice(problem), QUICK)


def test_where_neither_finds_a_path_the_error_says_what_both_tried(robot):
    problem = walled(robot, closed=True)
    with pytest.raises(
        fp.PathNotFound, match=r"searches.*On the lattice: no path on this"
    ) as caught:
        fp.plan(problem, fp.Portfolio(trees=fp.TreePlanner(checks=20_000)))
    assert "layer" in caught.value.on_lattice


def test_a_start_that_touches_something_is_said_at_once(robot):
    scene = fp.Scene([[0.1, 0.0, 0.0]], [0.2])
    ends = robot.configuration(), robot.configuration((5.0, 0.0, 0.0))
    with pytest.raises(fp.StartInCollision):
        fp.plan(fp.Problem(robot, scene, *ends, lattice=ACROSS), fp.Portfolio())


def test_without_a_lattice_a_portfolio_is_the_search_by_trees(passable):
    free = replace(passable, lattice=None)
    plan = fp.plan(free, fp.Portfolio(trees=QUICK), 4)
    assert replace(plan, planner=QUICK) == fp.plan(free, QUICK, 4)


def test_trees_begin_with_the_path_of_the_lattice():
    """With too little work to find a path they still improve one."""
    problem = fp.load_scenario("gate")
    known = fp.plan(problem, fp.PostureAnnealing(ants=6, cycles=5))
    free, few = without_lattice(problem), fp.TreePlanner(checks=600)
    rng = np.random.default_rng
    with pytest.raises(fp.PathNotFound):
        few.solve(free, rng(0), SearchRequest())
    found = few.solve(free, rng(0), SearchRequest(incumbent=known.motion))
    assert found.objective < stations_objective(free, known.motion)[1]


@pytest.mark.parametrize("mode", ["free-flying", "attitude-held", "free-floating"])
def test_states_along_a_motion_of_the_lattice_are_flown_as_the_motion_is(robot, mode):
    start = robot.configuration(joints={"left_1": 0.2})
    goal = robot.configuration((3.0, 0.0, 0.0), (0.3, 0.0, 0.0), {"right_1": -0.6, "left_2": 0.8})
    across = None if mode == "free-floating" else fp.Axis(3, 0.2)
    lattice = fp.Lattice(10, across)
    scene = fp.Scene([[1.5, 1.2, 0.0]], [0.3])
    problem = fp.Problem(robot, scene, start, goal, mode, lattice=lattice)
    motion = fp.plan(problem).motion
    space = SearchSpace(without_lattice(problem), 1e-3)
    path = ImprovedPath(space, space.states_along(motion), motion.attitudes)
    assert path.repair(random_state(np.random.default_rng(0)), 1)  # clear as it is
    assert path.cost == pytest.approx(stations_objective(problem, motion)[0])


def test_all_nodes_of_the_lattice_lie_in_the_window(robot, passable):
    wide = replace(passable, lattice=fp.Lattice(6, fp.Axis(40, 0.5), fp.Axis(1, 0.1)))
    for problem in (passable, wide):
        low, high = without_lattice(problem).window
        own = replace(problem, lattice=None).base_window
        lattice = fp.LayeredLattice(problem)
        nodes = (lattice.nominal.positions[:, None] + lattice.offsets).reshape(-1, 3)
        assert np.all(low <= np.minimum(nodes.min(axis=0), own[0]) + 1e-9)
        assert np.all(high >= np.maximum(nodes.max(axis=0), own[1]) - 1e-9)
    assert without_lattice(passable).window[:, 2] == pytest.approx([0.0, 0.0], abs=0.0)
    assert np.ptp(without_lattice(wide).window[:, 2]) == pytest.approx(0.2)


def test_where_the_robot_floats_there_is_no_window(robot):
    goal = robot.configuration(joints={"left_1": 0.5})
    problem = fp.Problem(
        robot, fp.Scene(), robot.neutral(), goal, "free-floating", lattice=fp.Lattice(4)
    )
    assert without_lattice(problem) == replace(problem, lattice=None)


def test_callbacks_receive_cycles_of_ants_then_rounds_of_trees(passable):
    seen = []
    colony = fp.MaxMinAntSystem(cycles=4)
    fp.plan(passable, fp.Portfolio(lattice=colony, trees=QUICK), on_cycle=seen.append)
    kinds = [type(cycle) for cycle in seen]
    assert kinds == [fp.Cycle] * kinds.count(fp.Cycle) + [fp.TreeCycle] * kinds.count(fp.TreeCycle)
    assert {*kinds} == {fp.Cycle, fp.TreeCycle}


def test_a_time_limit_covers_both(passable):
    fp.plan(passable, fp.Portfolio(trees=QUICK))  # ready to run
    plan = fp.plan(passable, fp.Portfolio(), time_limit=0.8)
    assert plan.interrupted
    assert plan.seconds < 0.95
    assert plan.verify().ok


def test_several_goals_are_for_the_trees(robot):
    problem = walled(robot, closed=False)
    other = robot.configuration((5.0, 0.0, 0.0), joints={"left_1": 0.1})
    both = replace(problem, alternatives=[other])
    plan = fp.plan(both, fp.Portfolio(trees=QUICK))
    assert plan.problem.lattice is None
    assert not len(plan.problem.alternatives)
    assert replace(plan, planner=QUICK) == fp.plan(without_lattice(both), QUICK)


@pytest.mark.parametrize(
    "planner",
    [
        fp.Portfolio(trees=NEXT_TO_NOTHING),
        fp.Portfolio(fp.AntSystem(ants=5, cycles=3), NEXT_TO_NOTHING, 0.3),
        fp.Portfolio(fp.LatticeOptimum(), QUICK),
    ],
    ids=["default", "ant-system", "optimum"],
)
def test_plans_are_kept_with_the_settings_of_both(passable, tmp_path, planner):
    plan = fp.plan(passable, planner)
    plan.save(tmp_path / "plan.json")
    assert fp.Plan.load(tmp_path / "plan.json") == plan
    assert fp.Plan.load(tmp_path / "plan.json").planner == planner


def test_wrong_requests_are_refused_by_name(passable):
    with pytest.raises(fp.InvalidInput, match="colonies"):
        fp.plan(passable, fp.Portfolio(lattice=fp.LatticeOptimum()), colonies=2)
    with pytest.raises(fp.InvalidInput, match="until"):
        fp.plan(passable, fp.Portfolio(), until="first")
    with pytest.raises(fp.InvalidInput, match="posture-annealing"):
        fp.plan(fp.load_scenario("gate"), fp.Portfolio(lattice=fp.MaxMinAntSystem()))
    with pytest.raises(fp.InvalidInput, match="lattice"):
        fp.Portfolio(lattice=QUICK)
    with pytest.raises(fp.InvalidInput, match="lattice_share"):
        fp.Portfolio(lattice_share=1.0)
