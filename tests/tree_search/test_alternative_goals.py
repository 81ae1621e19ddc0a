"""Searches with several goals: any may be reached, and the plan has the one that was."""

from itertools import product

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.tree_search.kernels.search_arrays import JOINTS
from ffsr_plan.tree_search.search_space import SearchSpace
from tests.helpers.free_scenes import beside_a_box, scattered

QUICK = fp.TreePlanner(checks=60_000)


def two_goals(robot, scene, **options):
    """Ahead; the arm goes to one side or the other."""
    near, far = (
        robot.configuration((2.5, 0.0, 0.0), joints={"left_1": value}) for value in (0.5, -0.9)
    )
    return fp.Problem(robot, scene, robot.neutral(), near, alternatives=[far], **options), far


def hand(robot, q):
    import pinocchio as pin

    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return data.oMf[robot.model.getFrameId("left_link_3")].translation.copy()


def test_the_nearest_goal_is_reached_where_the_way_to_it_is_free(robot):
    problem, far = two_goals(robot, fp.Scene())
    plan = fp.plan(problem, QUICK)
    assert np.array_equal(plan.problem.goal, problem.goal)
    assert not len(plan.problem.alternatives)
    assert plan.gap == 0.0
    swapped = fp.Problem(robot, fp.Scene(), problem.start, far, alternatives=[problem.goal])
    assert np.array_equal(fp.plan(swapped, QUICK).problem.goal, problem.goal)


def test_a_goal_that_is_not_the_first_is_reached_where_that_touches(robot, tmp_path):
    mode = "attitude-held"
    free, far = two_goals(robot, fp.Scene(), mode=mode)
    scene = fp.Scene([hand(robot, free.goal)], [0.1])
    problem, _ = two_goals(robot, scene, mode=mode)
    plan = fp.plan(problem, QUICK)
    assert np.array_equal(plan.problem.goal, far)
    assert plan.verify().ok
    plan.save(tmp_path / "plan.json")
    assert fp.Plan.load(tmp_path / "plan.json") == plan
    assert plan == fp.plan(problem, QUICK)


def test_each_goal_has_its_own_attitude_to_arrive_at(robot):
    """The nearest one demands an attitude that takes many loops, the other where arms lead."""
    start = robot.neutral()
    near = robot.configuration((2.5, 0.0, 0.0), (1.5, 0.0, 0.0), {"left_1": 0.3})
    bent = robot.configuration((2.5, 0.0, 0.0), joints={"left_1": -0.9})
    ends = np.array([[0.0, 0.0, 0.0], [2.5, 0.0, 0.0]])
    other = fp.Motion(robot, "free-flying", start, bent, ends).configurations()[-1]
    problem = fp.Problem(robot, fp.Scene(), start, near, reach_attitude=True, alternatives=[other])
    plan = fp.plan(problem, fp.TreePlanner(checks=100_000), until="first")
    assert np.array_equal(plan.problem.goal, other)
    assert plan.arrival_attitude_error < 1e-8
    assert plan.length == pytest.approx(np.hypot(2.5, 0.9))
    assert plan.verify().ok


def test_a_straight_way_to_a_goal_farther_off_does_not_end_the_search(robot):
    ends = [robot.configuration((2.5, 0, 0), joints={"left_1": value}) for value in (0.5, -1.7)]
    middle = robot.configuration((1.25, 0, 0), joints={"left_1": 0.25})
    scene = fp.Scene([hand(robot, middle) + np.array([0.0, 0.08, 0.0])], [0.03])
    problem = fp.Problem(
        robot, scene, robot.neutral(), ends[0], "attitude-held", alternatives=[ends[1]]
    )
    assert fp.clearance(robot, scene, middle) < 0.0
    plan = fp.plan(problem, QUICK)
    assert np.array_equal(plan.problem.goal, ends[0])
    assert plan.length < np.hypot(2.5, 1.7)


def test_more_goals_do_not_make_plans_longer():
    robot = fp.load_robot("satellite_ur5")
    for seed in range(2):
        single = beside_a_box(robot, seed)
        values = robot.joint_values(single.goal).copy()
        values[-1] += 0.3
        other = robot.assemble(single.goal[:3], single.goal[3:7], values)
        several = fp.Problem(
            robot, single.scene, single.start, single.goal, single.mode, alternatives=[other]
        )
        planner = fp.TreePlanner(checks=300_000)
        alone, both = fp.plan(single, planner), fp.plan(several, planner)
        assert both.verify().ok
        assert both.length < 1.1 * alone.length


def test_a_space_has_a_state_for_each_goal_the_nearest_first(robot):
    values = np.linspace(-0.9, 0.9, 12)
    goals = [robot.configuration((1.0, 0, 0), joints={"left_1": v}) for v in values]
    problem = fp.Problem(robot, fp.Scene(), robot.neutral(), goals[0], alternatives=goals[1:])
    space = SearchSpace(problem, 1e-3)
    assert len(space.goals) == len(space.problems) == 12
    sizes = np.linalg.norm((space.goals - space.start)[:, 4:], axis=1)
    assert np.all(np.diff(sizes) >= 0.0)
    for k, (state, each) in enumerate(zip(space.goals, space.problems, strict=True)):
        assert space.goal_at(state) == k
        assert state[4:] == pytest.approx(robot.joint_values(each.goal))


def test_goals_that_touch_are_left_out_and_if_all_do_that_is_reported(robot):
    problem, far = two_goals(robot, fp.Scene())
    both = fp.Scene([hand(robot, problem.goal), hand(robot, far)], [0.1, 0.1])
    blocked, _ = two_goals(robot, both, mode="attitude-held")
    with pytest.raises(fp.GoalInCollision) as caught:
        fp.plan(blocked)
    assert {contact.obstacle for contact in caught.value.contacts} == {0}


def test_a_problem_with_one_goal_is_planned_as_before(robot):
    problem = scattered(robot, 0)
    assert SearchSpace(problem, 1e-3).problems == (problem,)
    assert fp.plan(problem, QUICK).problem is problem


def test_a_joint_with_limits_of_more_than_a_turn_takes_the_side_that_works():
    """The same pose of a UR5 at two values of its first joint: the nearer one, if it is free."""
    robot = fp.load_robot("satellite_ur5")
    pan = robot.joint_names[0]
    assert robot.upper[0] - robot.lower[0] > 2.0 * np.pi
    start = robot.configuration(joints={pan: 3.0, robot.joint_names[1]: -1.5})
    far = robot.configuration(joints={pan: -3.0, robot.joint_names[1]: -1.5})
    problem = fp.Problem(robot, fp.Scene(), start, far, "free-floating")
    plan = fp.plan(problem, until="first")
    reached = robot.joint_values(plan.configurations[-1])
    assert reached[0] == pytest.approx(2.0 * np.pi - 3.0)
    assert np.allclose(reached[1:], robot.joint_values(far)[1:])
    assert robot.joint_values(plan.problem.goal)[0] == pytest.approx(reached[0])
    assert plan.length == pytest.approx(2.0 * np.pi - 6.0)
    assert plan.verify().ok


def test_whole_turns_keep_within_limits_and_sort_by_length():
    robot = fp.load_robot("satellite_ur5")
    rng = np.random.default_rng(4)
    ends = [rng.uniform(robot.lower, robot.upper) for _ in range(2)]
    start, goal = (
        robot.configuration(joints=dict(zip(robot.joint_names, each, strict=True))) for each in ends
    )
    space = SearchSpace(fp.Problem(robot, fp.Scene(), start, goal, "free-floating"), 1e-3)
    values = space.goals[:, JOINTS:]
    turns = (values - ends[1]) / (2.0 * np.pi)
    assert np.allclose(turns, np.round(turns))
    assert np.all((robot.lower <= values) & (values <= robot.upper))
    lengths = np.linalg.norm(values - ends[0], axis=1)
    assert np.all(np.diff(lengths) >= 0.0)
    whole = [
        np.array(each)
        for each in product(*([v + k * 2 * np.pi for k in (-1, 0, 1)] for v in ends[1]))
    ]
    inside = [v for v in whole if np.all((robot.lower <= v) & (v <= robot.upper))]
    best = sorted(np.linalg.norm(v - ends[0]) for v in inside)[: len(lengths)]
    assert np.allclose(lengths, best)
