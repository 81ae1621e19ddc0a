"""Alternative goals of a problem: what they may be, and which one a motion has reached."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp


def problem(robot, mode="free-flying", **options):
    goal = robot.configuration((3.0, 0.0, 0.0), joints={"left_1": 0.5})
    if mode == "free-floating":
        goal = robot.configuration(joints={"left_1": 0.5})
    return fp.Problem(robot, fp.Scene(), robot.neutral(), goal, mode, **options)


def bent(robot, value, position=(3.0, 0.0, 0.0), attitude=(0.0, 0.0, 0.0)):
    return robot.configuration(position, attitude, {"left_1": value})


def test_goals_are_the_goal_and_its_alternatives(robot):
    assert problem(robot).alternatives.shape == (0, robot.model.nq)
    others = [bent(robot, 0.1), bent(robot, -0.6)]
    made = problem(robot, alternatives=others)
    assert np.array_equal(made.goals[0], made.goal)
    assert np.array_equal(made.goals[1:], others)
    assert not made.alternatives.flags.writeable
    assert made != problem(robot)
    assert made == problem(robot, alternatives=others)


def test_a_motion_ends_at_the_goal_nearest_to_its_end(robot):
    others = [bent(robot, 0.1), bent(robot, -0.6)]
    made = problem(robot, alternatives=others)
    for q, goal in ((bent(robot, -0.59), others[1]), (others[0], others[0]), (made.goal,) * 2):
        reached = made.ending_at(q)
        assert np.array_equal(reached.goal, goal)
        assert not len(reached.alternatives)
        assert replace(reached, goal=made.goal, alternatives=others) == made
    single = problem(robot)
    assert single.ending_at(others[0]) is single


def test_of_goals_with_equal_joints_the_attitude_that_is_demanded_decides(robot):
    turned = bent(robot, 0.5, attitude=(0.7, 0.0, 0.0))
    made = problem(robot, reach_attitude=True, alternatives=[turned])
    assert np.array_equal(made.ending_at(turned).goal, turned)


@pytest.mark.parametrize(
    ("mode", "alternative", "message"),
    [
        ("free-flying", {"position": (3.1, 0.0, 0.0)}, r"alternatives.0, base position"),
        ("attitude-held", {"attitude": (0.1, 0.0, 0.0)}, r"alternatives.0, base attitude"),
    ],
)
def test_alternatives_prescribe_no_other_base_pose(robot, mode, alternative, message):
    with pytest.raises(fp.InvalidInput, match=message):
        problem(robot, mode, alternatives=[bent(robot, 0.2, **alternative)])
    other = [bent(robot, 0.2, **alternative)]
    assert len(problem(robot, "free-floating", alternatives=other).alternatives) == 1


@pytest.mark.parametrize(
    ("alternatives", "message"),
    [
        (3.0, "alternatives"),
        ([[1.0, 2.0]], "alternatives"),
        ("two", "alternatives"),
        (np.zeros((1, 13)), r"alternatives.0"),
    ],
)
def test_what_is_no_configuration_is_named(robot, alternatives, message):
    with pytest.raises(fp.InvalidInput, match=message):
        problem(robot, alternatives=alternatives)


def test_too_many_alternatives_are_refused(robot):
    with pytest.raises(fp.InvalidInput, match="at most 100 configurations"):
        problem(robot, alternatives=[bent(robot, 0.1)] * 101)
