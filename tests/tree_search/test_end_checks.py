"""A goal is refused only where it touches whatever the way to it; else the search decides."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.collision.contacts import contacts
from ffsr_plan.tree_search.end_checks import check_ends
from tests.tree_search.test_alternative_goals import hand


def reaching_out(robot, mode, attitude=(0.0, 0.0, 0.0), **options):
    """A goal whose hand touches a sphere if the base arrives there at the attitude given."""
    position = (0.0, 0.0, 0.0) if mode == "free-floating" else (1.0, 0.0, 0.0)
    goal = robot.configuration(position, attitude, {"left_1": 0.9, "right_1": -0.9})
    start = robot.configuration(joints={"left_1": 0.2, "right_1": 0.2})
    scene = fp.Scene([hand(robot, goal)], [0.05])
    return fp.Problem(robot, scene, start, goal, mode, **options)


@pytest.mark.parametrize("mode", ["free-flying", "free-floating"])
def test_where_the_attitude_reacts_the_search_decides(robot, mode):
    problem = reaching_out(robot, mode, attitude=(0.3, 0.0, 0.0))
    assert contacts(robot, problem.scene, problem.goal)
    assert check_ends(problem) is problem
    plan = fp.plan(problem, until="first")
    assert plan.verify().ok


def test_where_wheels_hold_the_attitude_the_goal_is_refused(robot):
    with pytest.raises(fp.GoalInCollision):
        check_ends(reaching_out(robot, "attitude-held"))


@pytest.mark.parametrize("mode", ["free-flying", "free-floating"])
def test_at_an_attitude_that_is_demanded_the_goal_is_refused(robot, mode):
    free = reaching_out(robot, mode, attitude=(0.3, 0.0, 0.0), reach_attitude=True)
    place = free.goal[:3]
    if mode == "free-floating":  # the base is where the centre of mass leaves it
        far = fp.Scene([[9.0, 0.0, 0.0]], [0.1])
        plan = fp.plan(
            fp.Problem(robot, far, free.start, free.goal, mode, reach_attitude=True),
            until="first",
        )
        place = plan.configurations[-1, :3]
        assert np.linalg.norm(place) > 0.01
    q = robot.assemble(place, free.goal[3:7], robot.joint_values(free.goal))
    scene = fp.Scene([hand(robot, q)], [0.05])
    problem = fp.Problem(robot, scene, free.start, free.goal, mode, reach_attitude=True)
    with pytest.raises(fp.GoalInCollision) as caught:
        fp.plan(problem)
    for found, expected in zip(caught.value.contacts, contacts(robot, scene, q), strict=True):
        assert found[:2] == expected[:2]
        assert found.depth == pytest.approx(expected.depth, abs=1e-6)


def test_an_obstacle_in_the_middle_of_the_base_is_touched_at_any_attitude(robot):
    goal = robot.configuration((3.0, 0.0, 0.0), joints={"left_1": 0.9})
    start = robot.neutral()
    for radius in (0.1, 0.01):
        scene = fp.Scene([goal[:3] + np.array([0.0, 0.05, 0.0])], [radius])
        with pytest.raises(fp.GoalInCollision):
            check_ends(fp.Problem(robot, scene, start, goal))


def test_a_corner_of_the_base_that_touches_leaves_the_goal_to_the_search(robot):
    """Turned by an eighth of a turn, the base gets past it."""
    goal = robot.configuration((3.0, 0.0, 0.0), joints={"left_1": 0.9})
    corner = next(
        np.array([x, x, 0.0])
        for x in np.linspace(0.05, 0.6, 200)
        if fp.clearance(robot, fp.Scene([goal[:3] + np.array([x, x, 0.0])], [0.01]), goal) > 0.0
    )
    scene = fp.Scene([goal[:3] + corner - 0.02], [0.01])
    problem = fp.Problem(robot, scene, robot.neutral(), goal)
    assert contacts(robot, scene, goal)
    assert check_ends(problem) is problem
