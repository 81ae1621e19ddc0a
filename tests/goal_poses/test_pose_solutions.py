"""Several joint solutions of one pose: distinct, free of collision, the best ones first."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.goal_poses.pose_solutions import MOST_SOLUTIONS, ROOM
from tests.helpers.frame_poses import pose_of
from tests.helpers.planar_arm import SHOULDER, planar_arm

PLACE = (SHOULDER + 0.8, 0.1, 0.0)


def reaching(scene, start_elbow=-0.8, mode="attitude-held", mass=1e8, **options):
    arm = planar_arm(mass)
    start = arm.configuration(joints={"shoulder": 0.4, "elbow": start_elbow})
    problem = fp.Problem(arm, scene, start, arm.configuration((0.1, 0.0, 0.0)), mode)
    return problem.reaching("tool", PLACE, **options)


def elbows(problem):
    """Sides of the elbow, and sizes of the change of the joints, of all goals."""
    robot = problem.robot
    changes = [robot.joint_change(problem.start, goal) for goal in problem.goals]
    sides = [np.sign(robot.joint_values(goal)[1]) for goal in problem.goals]
    return sides, [float(np.linalg.norm(change)) for change in changes]


def upper_link(problem):
    """(3,) place of the sphere on the upper link, at the goal."""
    ends = [pose_of(problem.robot, problem.goal, frame)[0] for frame in ("upper", "fore")]
    return np.mean(ends, axis=0)


@pytest.mark.parametrize("mode", ["attitude-held", "free-flying", "free-floating"])
def test_all_goals_meet_the_pose_and_differ(mode):
    problem = reaching(fp.Scene(), mode=mode, mass=40.0)
    assert 2 <= len(problem.goals) <= MOST_SOLUTIONS
    assert np.array_equal(problem.goals[0], problem.goal)
    for k, goal in enumerate(problem.goals):
        assert pose_of(problem.robot, goal, "tool")[0] == pytest.approx(PLACE, abs=1e-7)
        assert not len(fp.self_collisions(problem.robot, goal))
        for other in problem.goals[:k]:
            assert np.abs(problem.robot.joint_change(other, goal)).max() > 0.3


@pytest.mark.parametrize("start_elbow", [-0.8, 0.8])
def test_the_nearest_goal_comes_first_where_all_have_room(start_elbow):
    sides, sizes = elbows(reaching(fp.Scene(), start_elbow))
    assert set(sides) == {-1.0, 1.0}
    assert sizes == sorted(sizes)
    assert sides[0] == np.sign(start_elbow)


def test_goals_with_little_room_come_last():
    free = reaching(fp.Scene())
    scene = fp.Scene([upper_link(free) + np.array([0.0, 0.0, 0.1])], [0.05])
    assert 0.0 < fp.clearance(free.robot, scene, free.goal) < ROOM
    crowded = reaching(scene)
    clear = [fp.clearance(free.robot, scene, goal) >= ROOM for goal in crowded.goals]
    assert clear == sorted(clear, reverse=True)
    assert clear[0]
    assert not clear[-1]
    assert elbows(crowded)[0][0] != elbows(free)[0][0]


def test_no_goal_touches_anything_and_the_margin_counts():
    free = reaching(fp.Scene())
    scene = fp.Scene([upper_link(free)], [0.2])
    blocked = reaching(scene)
    assert all(fp.clearance(free.robot, scene, goal) > 0.0 for goal in blocked.goals)
    assert set(elbows(blocked)[0]) == {-elbows(free)[0][0]}
    scene = fp.Scene([upper_link(free) + np.array([0.0, 0.0, 0.1])], [0.05])
    arm, there = free.robot, free.robot.configuration((0.1, 0.0, 0.0))
    kept = fp.Problem(arm, scene, free.start, there, "attitude-held", min_clearance=0.03).reaching(
        "tool", PLACE
    )
    assert all(fp.clearance(arm, scene, goal) > 0.03 for goal in kept.goals)
    assert set(elbows(kept)[0]) == {-elbows(free)[0][0]}


def test_a_seed_gives_the_same_goals_and_more_tries_no_fewer():
    scene = fp.Scene()
    first, again = (reaching(scene, seed=3) for _ in range(2))
    assert first == again
    assert len(reaching(scene, tries=1).goals) == 1
    assert len(reaching(scene, tries=40).goals) >= len(first.goals)
    for wrong in (0, 1.5, "many"):
        with pytest.raises(fp.InvalidInput, match="tries"):
            reaching(scene, tries=wrong)


def test_where_all_joint_values_touch_the_error_names_what_the_clearest_touch():
    arm, free = planar_arm(1e8), reaching(fp.Scene())
    tool = np.array(PLACE)
    scene = fp.Scene([[0.0, 3.0, 0.0], tool], [0.1, 0.1])
    with pytest.raises(fp.GoalInCollision) as caught:
        reaching(scene)
    assert caught.value.link == "tool"
    assert caught.value.obstacle == 1
    assert caught.value.depth == pytest.approx(0.12, abs=1e-6)
    elbow = pose_of(arm, free.goal, "fore")[0]
    scene = fp.Scene([tool + np.array([0.0, 0.0, 0.119]), elbow], [0.1, 0.3])
    with pytest.raises(fp.GoalInCollision) as caught:  # one way only touches with the tool
        reaching(scene)
    assert [contact.link for contact in caught.value.contacts] == ["tool"]


def test_planners_on_a_lattice_take_the_first_goal():
    arm = planar_arm(1e8)
    start = arm.configuration(joints={"shoulder": 0.4, "elbow": -0.8})
    problem = fp.Problem(
        arm, fp.Scene(), start, arm.configuration((0.1, 0, 0)), lattice=fp.Lattice(5)
    )
    assert not len(problem.reaching("tool", PLACE).alternatives)  # found, and no more looked for
    wanted = problem.reaching("tool", PLACE, tries=16)
    assert len(wanted.alternatives)
    plan = fp.plan(wanted)
    assert np.array_equal(plan.problem.goal, wanted.goal)
    assert not len(plan.problem.alternatives)
