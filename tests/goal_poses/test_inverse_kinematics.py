"""Inverse kinematics at the end of a motion: the pose is met, or the error says by how much not."""

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.collision.distances import SelfQuery
from ffsr_plan.core.rotations import to_angles
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.motion import Motion
from tests.helpers.frame_poses import angles_of, pose_of, some_goal
from tests.helpers.planar_arm import FORE, SHOULDER, UPPER, planar_arm

seeds = st.integers(0, 100_000)
TIP = "right_link_3"
FOLDED_IN = {"right_1": -1.7, "right_2": 1.3, "right_3": 1.7}  # the arm is in its own base


@pytest.mark.parametrize("mode", list(Mode))
@given(seed=seeds)
@settings(max_examples=12)
def test_the_motion_ends_with_the_frame_at_its_pose(mode, seed):
    robot, start, frame, (position, rotation), base = some_goal(seed, mode)
    angles = angles_of(rotation)
    goal = fp.inverse_kinematics(robot, None, frame, position, angles, start=start, **base)
    places = np.linspace(start[:3], base.get("base_position", start[:3]), 5)
    end = Motion(robot, mode, start, goal, places).configurations()[-1]
    reached, turned = pose_of(robot, end, frame)
    assert reached == pytest.approx(position, abs=1e-7)
    assert np.allclose(turned, rotation, atol=1e-7)
    # and the goal says itself where the base ends
    assert np.allclose(pose_of(robot, goal, frame)[0], position, atol=1e-7)
    values = robot.joint_values(goal)
    assert np.all((values >= robot.lower) & (values <= robot.upper))
    if mode == "attitude-held":
        assert to_angles(goal[3:7]) == pytest.approx(base["base_attitude"], abs=1e-9)
    if mode != "free-floating":
        assert np.array_equal(goal[:3], base["base_position"])


@pytest.mark.parametrize("mode", list(Mode))
def test_a_plan_to_the_goal_arrives_and_verifies(robot, mode):
    start = robot.configuration(joints={"left_1": -0.6, "left_2": -0.9, "right_1": 0.2})
    end = robot.configuration((3.0, 0.5, 0.0), (0.3, 0, 0), {"left_1": 0.5, "left_2": -1.3})
    places = np.array([start[:3], end[:3]])
    end = Motion(robot, mode, start, end, places).configurations()[-1]
    frame = robot.model.frames[-1].name
    position, rotation = pose_of(robot, end, frame)
    base = {} if mode == "free-floating" else {"base_position": (3.0, 0.5, 0.0)}
    if mode == "attitude-held":
        base["base_attitude"] = (0.3, 0.0, 0.0)
    angles = angles_of(rotation)
    goal = fp.inverse_kinematics(
        robot, None, frame, position, angles, start=start, mode=mode, **base
    )
    scene = fp.Scene([[1.5, 2.6, 0.0]], [0.2])
    plan = fp.plan(fp.Problem(robot, scene, start, goal, mode, fp.Lattice(10)))
    reached, turned = pose_of(robot, plan.configurations[-1], frame)
    assert reached == pytest.approx(position, abs=1e-6)
    assert np.allclose(turned, rotation, atol=1e-6)
    report = plan.verify(100)
    assert report.ok, report.problems


@pytest.mark.parametrize(
    ("target", "missed"),
    [
        ((2.0, 1.0, 0.0), np.hypot(2.0 - SHOULDER, 1.0) - (UPPER + FORE)),
        ((SHOULDER + 0.5, 0.9, 0.4), np.hypot(np.hypot(0.5, 0.9), 0.4) - 0.0),
        ((SHOULDER + UPPER + FORE + 1e-3, 0.0, 0.0), 1e-3),
    ],
    ids=["too far", "out of the plane", "by a millimetre"],
)
@pytest.mark.parametrize("mode", list(Mode))
def test_the_pose_error_of_a_planar_arm_is_its_closed_form(mode, target, missed):
    if target[2] != 0.0:  # in the plane it is within reach; what is left is the height
        missed = target[2]
    arm = planar_arm(1e8)  # does not move
    start = arm.configuration(joints={"shoulder": 0.4, "elbow": -0.8})
    with pytest.raises(fp.PoseOutOfReach) as caught:
        fp.inverse_kinematics(arm, None, "tool", target, start=start, mode=mode)
    error = caught.value
    assert error.position_missed == pytest.approx(missed, abs=1e-6)
    assert error.attitude_missed is None
    reached, _ = pose_of(arm, error.configuration, "tool")
    assert np.linalg.norm(reached - target) == pytest.approx(missed, abs=1e-6)
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error)
    assert f"{missed:.4g} m" in str(error)


@pytest.mark.parametrize("mode", ["free-flying", "free-floating"])
def test_the_error_says_what_a_held_base_would_reach(mode):
    arm, angle = planar_arm(3.0), 1.8
    reach = UPPER + FORE - 0.01
    target = (SHOULDER + reach * np.cos(angle), reach * np.sin(angle), 0.0)
    start = arm.neutral()
    held = fp.inverse_kinematics(arm, None, "tool", target, start=start, mode="attitude-held")
    with pytest.raises(fp.PoseOutOfReach) as caught:
        fp.inverse_kinematics(arm, None, "tool", target, start=start, mode=mode)
    found = caught.value.held_base
    assert found.reached
    end = Motion(arm, Mode(mode), start, held, np.zeros((2, 3))).configurations()[-1]
    missed = np.linalg.norm(pose_of(arm, end, "tool")[0] - target)
    assert 0.1 < found.position_missed <= missed + 1e-6
    assert 0.1 < found.rotation < np.pi
    assert "within reach of a held base" in str(caught.value)
    assert "another seed" in str(caught.value)
    far = tuple(3.0 * np.array(target))
    with pytest.raises(fp.PoseOutOfReach) as caught:
        fp.inverse_kinematics(arm, None, "tool", far, start=start, mode=mode)
    assert not caught.value.held_base.reached
    shoulder = np.array([SHOULDER, 0.0, 0.0])
    beyond = np.linalg.norm(far - shoulder) - (UPPER + FORE)
    assert caught.value.held_base.position_missed == pytest.approx(beyond, abs=1e-3)
    assert "seed" not in str(caught.value)


def test_the_error_says_whether_the_position_alone_is_reached():
    arm = planar_arm(1e8)
    position, _ = pose_of(arm, arm.configuration(joints={"shoulder": 0.4, "elbow": -0.8}), "tool")
    with pytest.raises(fp.PoseOutOfReach, match="leave out the attitude") as caught:
        fp.inverse_kinematics(
            arm, None, "tool", position, (0.2, 0.0, 0.3), start=arm.neutral(), mode="attitude-held"
        )
    assert caught.value.without_attitude
    assert caught.value.held_base is None


def test_an_attitude_out_of_the_plane_is_missed_by_its_angle():
    arm = planar_arm(1e8)
    position, _ = pose_of(arm, arm.configuration(joints={"shoulder": 0.4, "elbow": -0.8}), "tool")
    with pytest.raises(fp.PoseOutOfReach) as caught:  # turned by 0.3 about the tool's own x
        fp.inverse_kinematics(arm, None, "tool", position, (0.2, 0.0, 0.3), start=arm.neutral())
    assert caught.value.position_missed == pytest.approx(0.0, abs=1e-6)
    assert caught.value.attitude_missed == pytest.approx(0.3, abs=1e-6)
    assert "17.2 degrees" in str(caught.value)


def test_the_ordinary_jacobian_misses_on_a_light_base():
    """What holds on a held base does not where it floats; the lighter the base, the less."""
    misses = []
    for mass in (5.0, 50.0, 5000.0):
        arm = planar_arm(mass)
        start = arm.configuration(joints={"shoulder": 0.4, "elbow": -0.8})
        held = fp.inverse_kinematics(
            arm, None, "tool", (1.0, 0.6, 0.0), start=start, mode="attitude-held"
        )
        motion = Motion(arm, "free-floating", start, held, np.tile(start[:3], (2, 1)))
        reached, _ = pose_of(arm, motion.configurations()[-1], "tool")
        misses.append(np.linalg.norm(reached - (1.0, 0.6, 0.0)))
        floats = fp.inverse_kinematics(
            arm, None, "tool", (1.0, 0.6, 0.0), start=start, mode="free-floating"
        )
        motion = Motion(arm, "free-floating", start, floats, np.tile(start[:3], (2, 1)))
        reached, _ = pose_of(arm, motion.configurations()[-1], "tool")
        assert reached == pytest.approx((1.0, 0.6, 0.0), abs=1e-7)
    assert misses == sorted(misses, reverse=True)
    assert misses[0] > 0.1
    assert misses[-1] < 1e-2


def test_posture_axes_bring_base_and_tool_to_the_goal():
    problem = fp.load_scenario("gate")
    robot, lattice = problem.robot, fp.Lattice(20, postures=problem.lattice.postures)
    frame = robot.model.frames[-1].name
    ahead = robot.configuration((4, 0, 0), (0.1, 0, 0))
    at_goal, rotation = pose_of(robot, ahead, frame)
    wanted = fp.Problem(robot, fp.Scene(), problem.start, ahead, lattice=lattice)
    wanted = wanted.reaching(frame, at_goal, angles_of(rotation))
    assert wanted.reach_attitude
    plan = fp.plan(wanted, fp.PostureAnnealing(cycles=5))
    reached, turned = pose_of(robot, plan.configurations[-1], frame)
    assert reached == pytest.approx(at_goal, abs=1e-6)
    assert np.allclose(turned, rotation, atol=1e-6)


@pytest.mark.parametrize("mode", list(Mode))
def test_reaching_keeps_the_base_pose_of_the_goal(robot, mode):
    lattice, start = fp.Lattice(4), robot.configuration(joints={"left_1": -0.6, "left_2": -0.9})
    there = robot.configuration((2, 0.5, 0), (0.4, 0, 0), joints={"left_1": 0.2})
    problem = fp.Problem(robot, fp.Scene(), start, there, mode, lattice, delta=0.5)
    frame, wanted = robot.model.frames[-1].name, (2.6, -0.2, 0.0)
    if mode == "free-floating":
        wanted = (0.5, -0.75, 0.0)
    asked = problem.reaching(frame, wanted, seed=1)
    end = fp.LayeredLattice(asked).nominal.configurations()[-1]
    assert pose_of(robot, end, frame)[0] == pytest.approx(wanted, abs=1e-7)
    if mode != "free-floating":
        assert np.array_equal(asked.goal[:3], there[:3])
    if mode == "attitude-held":
        assert asked.goal[3:7] == pytest.approx(there[3:7], abs=1e-12)
    assert (asked.delta, asked.mode, asked.lattice) == (0.5, mode, lattice)
    assert not asked.reach_attitude


def test_the_same_seed_gives_the_same_goal():
    robot = fp.load_robot("satellite_ur5")
    start = robot.configuration(joints=robot.postures["ready"])
    position, rotation = pose_of(robot, start, "arm_tool0")
    wanted = ("arm_tool0", position + np.array([0.1, 0.2, -0.1]), angles_of(rotation))
    first, again = (
        fp.inverse_kinematics(robot, None, *wanted, start=start, mode="free-floating", seed=3)
        for _ in range(2)
    )
    assert np.array_equal(first, again)


def elbow_up_or_down(scene):
    """The planar arm's tool at a place that it reaches with the elbow on either side."""
    arm = planar_arm(1e8)
    start = arm.configuration(joints={"shoulder": 0.4, "elbow": -0.8})
    return fp.inverse_kinematics(arm, scene, "tool", (SHOULDER + 0.8, 0.0, 0.0), start=start), arm


def test_joint_values_in_collision_are_rejected():
    q, arm = elbow_up_or_down(fp.Scene())
    elbow, _ = pose_of(arm, q, "fore")
    assert elbow[1] > 0.0  # the start's side
    blocked = fp.Scene([0.5 * (elbow + pose_of(arm, q, "tool")[0])], [0.1])
    assert fp.clearance(arm, blocked, q) < 0.0
    q, arm = elbow_up_or_down(blocked)
    assert pose_of(arm, q, "fore")[0] == pytest.approx(elbow * (1, -1, 1), abs=1e-6)
    assert fp.clearance(arm, blocked, q) > 0.0


def test_joint_values_in_self_collision_are_rejected(robot):
    inside = robot.configuration(joints=FOLDED_IN)
    apart = SelfQuery(robot)
    assert apart.distance(inside) < 0.0
    given = {"start": inside, "mode": "attitude-held"}
    place, _ = pose_of(robot, inside, TIP)
    assert apart.distance(fp.inverse_kinematics(robot, None, TIP, place, **given)) < 0.0
    goal = fp.inverse_kinematics(robot, fp.Scene(), TIP, place, **given)
    assert apart.distance(goal) > 0.0


def test_a_pose_met_in_collision_only_is_goal_in_collision():
    scene = fp.Scene([[0.0, 3.0, 0.0], [SHOULDER + 0.8, 0.0, 0.0]], [0.1, 0.1])
    with pytest.raises(fp.GoalInCollision) as caught:
        elbow_up_or_down(scene)
    assert caught.value.link == "tool"
    assert caught.value.obstacle == 1
    assert caught.value.depth == pytest.approx(0.1 + 0.02, abs=1e-6)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"frame": "left_hnd"}, r"frame: got 'left_hnd'; allowed: .*left"),
        ({"position": (1, 2)}, r"position \(shape \(2,\)\)"),
        ({"attitude": (0, np.nan, 0)}, r"attitude.*finite"),
        ({"mode": "floating"}, r"mode.*free-flying"),
        ({"mode": "free-floating", "base_position": (0, 0, 0)}, r"base_position.*follows from the"),
        ({"base_attitude": (0, 0, 0)}, r"base_attitude.*None in the mode free-flying"),
        ({"start": (0, 0, 0)}, r"start"),
        ({"seed": -1}, r"seed.*at least 0"),
        ({"scene": []}, r"scene: got \[\]; allowed: a Scene, or None"),
    ],
    ids=lambda value: str(value)[:30],
)
def test_a_wrong_argument_is_named(robot, wrong, message):
    given = {"scene": None, "frame": "left_3", "position": (1, 0, 0), "start": robot.neutral()}
    with pytest.raises(fp.InvalidInput, match=message):
        fp.inverse_kinematics(robot, **(given | wrong))


def test_a_robot_without_joints_has_nothing_to_solve_for(point):
    with pytest.raises(fp.InvalidInput, match="a robot with joints"):
        fp.inverse_kinematics(point, None, "base", (1, 0, 0), start=point.neutral())


@pytest.mark.parametrize(("ahead", "words"), [(2.5, "nearer to"), (SHOULDER, "farther from")])
@pytest.mark.parametrize("mode", ["attitude-held", "free-flying", "free-floating"])
def test_a_pose_that_is_too_far_or_too_close_is_told_apart(mode, ahead, words):
    robot = planar_arm(1e4)
    with pytest.raises(fp.PoseOutOfReach) as raised:
        fp.inverse_kinematics(
            robot, None, "tool", (ahead, 0.0, 0.0), start=robot.neutral(), mode=mode
        )
    what = "another start" if mode == "free-floating" else "another base position of the goal"
    assert raised.value.advice[-1].startswith(f"{what}, {words} the pose")


def test_a_pose_that_no_place_of_the_base_brings_closer_is_not_said_to_be_far():
    """The frame's attitude is out of the arm's plane."""
    robot = planar_arm(1e4)
    with pytest.raises(fp.PoseOutOfReach) as raised:
        fp.inverse_kinematics(
            robot, None, "tool", (1.2, 0.2, 0.0), (0.0, 1.0, 0.0), start=robot.neutral(),
            mode="attitude-held",
        )  # fmt: skip
    assert "the pose" not in raised.value.advice[-1]
