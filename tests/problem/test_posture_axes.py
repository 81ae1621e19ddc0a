"""Posture axes: the displacement of the joints, and the factor at each index."""

from dataclasses import asdict

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.problem.posture_axes import PostureTarget
from ffsr_plan.robots.loading import robot_from_urdf


def test_both_kinds_are_posture_axes():
    assert isinstance(fp.PostureAxis({"left_1": 1.0}, half_count=8, spacing=0.2), fp.PostureAxis)
    assert isinstance(fp.PostureAxis.towards("stowed", levels=6), fp.PostureAxis)
    assert fp.PostureAxis.towards("stowed", 6) == PostureTarget("stowed", 6)


def test_a_direction_displaces_by_index_times_spacing(robot):
    axis = fp.PostureAxis({"left_1": 1.0, "right_2": -0.5}, 2, 0.1)
    nominal = np.full((3, robot.nd), 0.3)
    displacement = axis.displacement(robot, nominal)
    assert displacement.shape == nominal.shape
    assert np.array_equal(displacement[1], [1.0, 0, 0, 0, -0.5, 0])
    assert list(axis.indices) == [-2, -1, 0, 1, 2]
    assert axis.factors(np.array(axis.indices)) == pytest.approx([-0.2, -0.1, 0, 0.1, 0.2])


def test_a_target_leads_from_the_nominal_joints_to_the_posture(robot):
    axis, nominal = fp.PostureAxis.towards("stowed", 4), np.full((3, robot.nd), 0.3)
    displacement = axis.displacement(robot, nominal)
    for name, value in robot.postures["stowed"].items():
        k = robot.joint_names.index(name)
        assert nominal[:, k] + displacement[:, k] == pytest.approx(value)
    assert list(axis.indices) == [0, 1, 2, 3, 4]
    assert axis.factors(np.array(axis.indices)) == pytest.approx([0, 0.25, 0.5, 0.75, 1])


def test_their_keys_tell_them_apart():
    axes = (fp.PostureAxis({"left_1": 1.0}, 2, 0.1), fp.PostureAxis.towards("stowed", 4))
    stored = asdict(fp.Lattice(4, postures=axes))
    assert [set(axis) for axis in stored["postures"]] == [
        {"joints", "half_count", "spacing"},
        {"towards", "levels"},
    ]
    assert fp.Lattice(**stored).postures == axes


def test_a_joint_that_is_named_twice_is_refused():
    with pytest.raises(fp.InvalidInput, match="joints: got 'a more than once'"):
        fp.PostureAxis([("a", 1.0), ("b", 1.0), ("a", 2.0)], 2, 0.1)
    assert fp.PostureAxis([("a", 1.0), ("b", 2.0)], 2, 0.1).joints == (("a", 1.0), ("b", 2.0))


def test_a_wrong_posture_is_found_when_the_problem_is_made(robot):
    lattice = fp.Lattice(4, postures=[fp.PostureAxis.towards("stoved", 3)])
    for goal in (robot.configuration((1, 0, 0)), robot.neutral()):  # also where nothing moves
        with pytest.raises(fp.InvalidInput, match="did you mean 'stowed'"):
            fp.Problem(robot, fp.Scene(), robot.neutral(), goal, lattice=lattice)


def test_a_robot_without_postures_or_joints_is_said_to_have_none(robot, point):
    robot = robot_from_urdf(robot.urdf, "made")
    goal = robot.configuration((1, 0, 0))
    towards = fp.Lattice(4, postures=[fp.PostureAxis.towards("stowed", 2)])
    moving = fp.Lattice(4, postures=[fp.PostureAxis({"left_1": 1.0}, 2, 0.1)])
    assert not robot.postures
    assert not point.joint_names
    cases = {
        "no posture, as no <group_state>": lambda: fp.Problem(
            robot, fp.Scene(), robot.neutral(), goal, lattice=towards
        ),
        "no posture, as": lambda: robot.configuration(joints="stowed"),
        "no joint, as none": lambda: fp.Problem(
            point, fp.Scene(), point.neutral(), point.configuration((1, 0, 0)), lattice=moving
        ),
        "no joint, as": lambda: point.configuration(joints={"left_1": 0.0}),
    }
    for allowed, case in cases.items():
        with pytest.raises(fp.InvalidInput, match=f"got '(stowed|left_1)'; allowed: {allowed}"):
            case()
