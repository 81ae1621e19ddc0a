"""Path frame, layers and nodes: Eqs. 3 to 6."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.lattice.layered_lattice import LayeredLattice, path_frame
from tests.helpers.urdf_builders import random_robot

directions = st.tuples(*[st.floats(-5, 5)] * 3).map(np.array).filter(lambda v: np.any(abs(v) > 0.1))


@given(directions)
def test_the_path_frame_is_a_right_handed_frame_along_the_travel(travel):
    frame = path_frame(travel)
    assert np.allclose(frame.T @ frame, np.eye(3), atol=1e-12)
    assert np.linalg.det(frame) == pytest.approx(1.0)
    assert np.allclose(frame[:, 2], travel / np.linalg.norm(travel))
    assert abs(frame[2, 0]) < 1e-8  # x' lies in the world's xy-plane


def test_a_planar_travel_has_its_normal_along_z():
    frame = path_frame(np.array([3.0, 4.0, 0.0]))
    assert np.allclose(frame[:, 1], [0, 0, 1])
    assert np.allclose(frame[:, 0], [-0.8, 0.6, 0])


def problem(robot, **changes):
    start = robot.configuration((1, 2, 0), (0.3, 0.0, 0.0), {"left_1": -0.9, "right_2": 0.4})
    goal = robot.configuration((4, 6, 0), joints={"left_1": 0.4, "right_2": -0.6})
    settings = {"lattice": fp.Lattice(divisions=10, lateral=fp.Axis(3, 0.2))} | changes
    return fp.Problem(robot, fp.Scene([[50, 0, 0]], [1]), start, goal, **settings)


def test_nodes_lie_on_the_cuts_between_start_and_goal(robot):
    lattice = LayeredLattice(problem(robot))
    for i in range(11):
        q = lattice.layer(i)
        along = (q[:, :3] - [1, 2, 0]) @ [0.6, 0.8, 0.0]
        across = (q[:, :3] - [1, 2, 0]) @ [-0.8, 0.6, 0.0]
        assert np.allclose(along, 5.0 * i / 10)
        assert np.allclose(across, 0.2 * np.arange(-3, 4))
        assert np.allclose(q[:, 7:], q[0, 7:])
    assert np.allclose(lattice.layer(0)[lattice.origin], lattice.problem.start)
    last = lattice.layer(10)[lattice.origin]
    assert np.allclose(np.delete(last, range(3, 7)), np.delete(lattice.problem.goal, range(3, 7)))


def test_two_axes_make_every_pair_of_offsets_once(robot):
    lattice = LayeredLattice(
        problem(robot, lattice=fp.Lattice(5, fp.Axis(2, 0.3), fp.Axis(1, 0.5)))
    )
    assert lattice.size == 15
    assert len(np.unique(lattice.indices, axis=0)) == 15
    assert np.all(lattice.indices[lattice.origin] == 0)
    frame = path_frame(np.array([3.0, 4.0, 0.0]))
    expected = (
        0.3 * lattice.indices[:, :1] * frame[:, 0] + 0.5 * lattice.indices[:, 1:] * frame[:, 1]
    )
    assert np.allclose(lattice.offsets, expected)


def test_equation_4_weighs_metres_and_radians(robot):
    joints = np.hypot(1.3, 1.0)
    assert problem(robot).delta_d == pytest.approx(np.hypot(5.0, joints) / 10)
    weighed = problem(robot, position_weight=2.0, rotation_weight=3.0)
    assert weighed.delta_d == pytest.approx(np.hypot(10.0, 3 * joints) / 10)
    held = problem(robot, mode="attitude-held")
    assert held.delta_d == pytest.approx(np.sqrt(25 + joints**2 + 0.3**2) / 10)


def test_an_edge_is_as_long_as_equation_6_says(robot):
    lattice = LayeredLattice(problem(robot))
    step = lattice.problem.delta_d
    assert lattice.steps[1, 4] == pytest.approx(np.hypot(step, 0.6))
    assert np.allclose(np.diag(lattice.steps), step)
    assert lattice.base_travel[3, 5] == pytest.approx(np.hypot(0.5, 0.4))


def test_the_attitude_reacts_or_is_held_as_the_mode_says(robot):
    reacting = LayeredLattice(problem(robot)).nominal.attitudes
    held = LayeredLattice(problem(robot, mode="attitude-held")).nominal.attitudes
    assert np.allclose(held[-1], [0, 0, 0, 1])
    assert np.linalg.norm(reacting[-1] - held[-1]) > 0.01
    assert np.allclose(reacting[0], held[0])


def test_a_turn_on_the_spot_has_one_node_a_layer(robot):
    start = robot.neutral()
    goal = robot.configuration(joints={"left_1": 1.0})
    spot = fp.Problem(robot, fp.Scene(), start, goal, lattice=fp.Lattice(4))
    plan = fp.plan(spot)
    assert plan.length == pytest.approx(1.0)
    assert plan.verify(50).ok
    assert abs(plan.arrival_attitude[0]) > 0.1


def test_a_continuous_joint_goes_the_shorter_way_round():
    robot = random_robot(1, kinds=("continuous",), arms=1, depth=1)
    (name,) = robot.joint_names
    start = robot.configuration(joints={name: 3.0})
    goal = robot.configuration((5.0, 0.0, 0.0), joints={name: -3.0})
    turning = fp.Problem(robot, fp.Scene(), start, goal, lattice=fp.Lattice(4))
    assert turning.joint_displacement == pytest.approx([2 * np.pi - 6.0])
    plan = fp.plan(turning)
    assert plan.length == pytest.approx(np.hypot(5.0, 2 * np.pi - 6.0))
    assert np.allclose(plan.configurations[-1][7:], goal[7:], atol=1e-12)
    assert plan.verify(50).ok
