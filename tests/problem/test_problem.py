"""A problem keeps what it was made from, and says itself in one line."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from tests.helpers.urdf_builders import box, inertial, link, urdf


@pytest.fixture
def problem(robot):
    goal = robot.configuration((3, 0, 0), joints={"left_1": 0.5})
    lattice = fp.Lattice(6, fp.Axis(2, 0.1), postures=[fp.PostureAxis.towards("stowed", 3)])
    return fp.Problem(robot, fp.Scene([[1, 2, 0]], [0.3]), robot.neutral(), goal, lattice=lattice)


def test_arguments_keep_their_positional_order(robot):
    goal = robot.configuration((3, 0, 0), (0.1, 0, 0))
    lattice = fp.Lattice(4)
    made = fp.Problem(
        robot, fp.Scene(), robot.neutral(), goal, "attitude-held", lattice,
        0.5, 0.1, 2.0, 3.0, 4.0, 1e-3, False,
    )  # fmt: skip
    assert (made.mode, made.lattice, made.delta, made.length_unit) == (
        "attitude-held", lattice, 0.5, 0.1,
    )  # fmt: skip
    assert (made.clearance_cap, made.position_weight, made.rotation_weight) == (2.0, 3.0, 4.0)
    assert (made.tolerance, made.reach_attitude) == (1e-3, False)


def test_start_and_goal_are_read_only_copies(robot):
    start = robot.neutral()
    made = fp.Problem(robot, fp.Scene(), start, robot.configuration((1, 0, 0)))
    start[0] = 9.0
    assert made.start[0] == 0.0
    for array in (made.start, made.goal, made.base_displacement, made.joint_displacement):
        assert not array.flags.writeable


def test_without_a_lattice_there_is_none(robot):
    goal = robot.configuration((1, 0, 0))
    for given in ({}, {"lattice": None}):
        made = fp.Problem(robot, fp.Scene(), robot.neutral(), goal, **given)
        assert made.lattice is None
        assert "lattice=none" in repr(made)
        with pytest.raises(fp.InvalidInput, match="a problem with a lattice"):
            made.delta_d
        assert made.straight_length == pytest.approx(1.0)


def test_problems_are_equal_by_content(problem):
    assert problem == replace(problem, scene=fp.Scene(problem.scene.centers, problem.scene.radii))
    assert hash(problem) == hash(replace(problem))
    assert problem != replace(problem, delta=2.0)
    assert problem != replace(problem, scene=fp.Scene())
    assert problem != "problem"


@pytest.mark.parametrize("name", ["delta", "length_unit", "clearance_cap", "rotation_weight"])
def test_weights_whose_products_overflow_are_refused_by_name(problem, name):
    with pytest.raises(fp.InvalidInput, match=rf"^{name}: got 1e\+308; .*at most 1e\+09"):
        replace(problem, **{name: 1e308})


def test_a_joint_that_travels_over_many_turns_is_refused(problem):
    axis = fp.PostureAxis({"left_1": 1e6}, 1, 0.1)
    with pytest.raises(fp.InvalidInput, match=r"postures\.0, displacement.*at most 500 rad"):
        replace(problem, lattice=fp.Lattice(4, postures=[axis]))


def test_replace_checks_again(problem):
    assert replace(problem, delta=2.0).delta == 2.0
    with pytest.raises(fp.InvalidInput, match=r"delta.*at least 0"):
        replace(problem, delta=-2.0)


@pytest.mark.parametrize("wrong", [{"robot": "planar_dual_arm"}, {"scene": None}, {"scene": {}}])
def test_robot_and_scene_have_to_be_objects(problem, wrong):
    name = next(iter(wrong))
    with pytest.raises(fp.InvalidInput, match=f"{name}: got .*; allowed: a S"):
        replace(problem, **wrong)


@pytest.mark.parametrize(
    ("axis", "message"),
    [
        (fp.PostureAxis({"left_9": 1.0}, 2, 0.1), r"joints: got 'left_9'.*did you mean 'left_\d'"),
        (fp.PostureAxis.towards("stowd", 2), "towards: got 'stowd'.*did you mean 'stowed'"),
    ],
)
def test_axes_that_the_robot_does_not_have_are_refused(problem, axis, message):
    lattice = replace(problem.lattice, postures=[axis])
    with pytest.raises(fp.InvalidInput, match=message):
        replace(problem, lattice=lattice)


def test_it_is_shown_in_one_line_and_in_a_small_table(problem):
    text, table = repr(problem), problem._repr_html_()
    assert text.startswith("Problem(robot=planar_dual_arm, mode=free-flying, obstacles=1 sphere, ")
    assert "\n" not in text
    assert len(text) < 250
    assert len(table) < 1000
    assert "<td>free-flying</td>" in table


def test_displacements_lead_from_start_to_goal(robot):
    goal = robot.configuration((3, 1, 0), (0.2, 0, 0), {"left_1": 0.5})
    made = fp.Problem(robot, fp.Scene(), robot.neutral(), goal, "attitude-held")
    assert made.base_displacement == pytest.approx((3, 1, 0))
    assert made.joint_displacement == pytest.approx((0.5, 0, 0, 0, 0, 0))
    assert made.held_rotation == pytest.approx(0.2)
    floating = fp.Problem(robot, fp.Scene(), robot.neutral(), goal, "free-floating")
    assert np.array_equal(floating.base_displacement, np.zeros(3))
    assert floating.held_rotation == 0.0


def test_a_goal_that_only_an_attitude_tells_from_the_start_needs_it_demanded(robot):
    scene, start = fp.Scene(), robot.configuration()
    goal = robot.configuration(attitude=(0.5, 0.0, 0.0))
    with pytest.raises(fp.InvalidInput, match="reach_attitude=True"):
        fp.Problem(robot, scene, start, goal)
    with pytest.raises(fp.InvalidInput, match=r"in what the mode moves$"):
        fp.Problem(robot, scene, start, start)
    assert fp.Problem(robot, scene, start, goal, reach_attitude=True).reach_attitude


def test_without_joints_no_attitude_can_be_demanded(tmp_path):
    path = tmp_path / "bus.urdf"
    path.write_text(urdf(link("bus", inertial(5.0, (1.0, 1.0, 1.0)), box((1.0, 1.0, 1.0)))))
    bus = fp.load_robot(path)
    start = bus.configuration()
    goal = bus.configuration((1.0, 0.0, 0.0), attitude=(0.5, 0.0, 0.0))
    with pytest.raises(fp.InvalidInput, match="robot without joints"):
        fp.Problem(bus, fp.Scene(), start, goal, reach_attitude=True)
