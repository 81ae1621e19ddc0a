"""Curves of least fuel beside any path: their bound, their margin, their joints and their end."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.core.rotations import rotate
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.fuel.curve_refinement import curve_change, refined_curve
from ffsr_plan.fuel.least_change_programme import Programme, vectors_of
from ffsr_plan.search.fuel_figures import velocity_change
from tests.fuel.test_least_change_programme import NO_CUTS

BALL = fp.Scene([[2.0, 0.1, 0.0]], [0.5])


WINDOW = (-3.0, -4.0, -1.0), (7.0, 4.0, 1.0)


def free_problem(scene, window=WINDOW):
    robot = fp.load_robot("planar_dual_arm")
    start = robot.configuration()
    goal = robot.configuration((4.0, 0.0, 0.0), joints={"left_1": 1.5, "right_2": -1.0})
    return fp.Problem(robot, scene, start, goal, window=window)


def bent_motion(problem):
    """Past the ball in a wide bow; the arms move on the first half of the way only."""
    robot = problem.robot
    positions = np.array([[0, 0, 0], [1.0, -1.6, 0], [2.0, -2.0, 0], [3.0, -1.5, 0.1], [4, 0, 0]])
    ends = robot.joint_values(np.array([problem.start, problem.goal]))
    shares = np.array([0.0, 0.5, 1.0, 1.0, 1.0])[:, None]
    joints = ends[0] + shares * (ends[1] - ends[0])
    return Motion(robot, problem.mode, problem.start, problem.goal, positions, joints)


def centers(curve, per_piece):
    count = curve.edges * per_piece
    at = np.arange(count + 1) / per_piece
    edge = np.minimum(at.astype(int), curve.edges - 1)
    q = curve.at(edge, at - edge)
    return q[:, :3] + rotate(q[:, 3:7], centers_of_mass(curve.robot, curve.robot.joint_values(q)))


def straight(curve):
    ends = centers(curve, 1)[[0, -1]]
    return 2.0 * float(np.linalg.norm(ends[1] - ends[0]))


@pytest.fixture(scope="module")
def past_the_ball():
    problem = free_problem(BALL)
    motion = bent_motion(problem)
    return problem, motion, refined_curve(problem, motion, np.eye(3), 0.1).curve


def test_with_nothing_in_the_way_the_centre_of_mass_moves_on_a_line_at_even_speed():
    problem = free_problem(fp.Scene([], []))
    found = refined_curve(problem, bent_motion(problem), np.eye(3), 0.0).curve
    assert straight(found) <= curve_change(found) * (1.0 + 1e-9)
    assert curve_change(found) < 1.02 * straight(found)
    speeds = np.linalg.norm(np.diff(centers(found, 8), axis=0), axis=1)
    assert np.ptp(speeds) < 0.05 * speeds.mean()


def test_the_change_is_that_of_the_centre_of_mass(past_the_ball):
    *_, curve = past_the_ball
    assert curve_change(curve) == pytest.approx(velocity_change(centers(curve, 100)), rel=2e-3)


def test_the_margin_is_kept_between_all_samples(past_the_ball):
    problem, motion, curve = past_the_ball
    query = ObstacleQuery(problem.robot, problem.scene)
    edges = np.repeat(np.arange(curve.edges), 50)
    times = np.tile(np.arange(50) / 49.0, curve.edges)
    least = query.distances(curve.at(edges, times)).min()
    assert 0.1 <= least < 0.11  # and no more than is needed
    assert curve_change(curve) < 0.6 * velocity_change(motion.positions)


def test_joints_and_attitudes_are_those_of_the_path(past_the_ball):
    problem, motion, curve = past_the_ball
    ends = curve.configurations()[[0, -1]]
    assert ends[0] == pytest.approx(problem.start, abs=1e-12)
    assert ends[1][:3] == pytest.approx(problem.goal[:3], abs=1e-12)
    assert curve.joint_values[-1] == pytest.approx(motion.joint_values[-1], abs=1e-12)
    low, high = motion.joint_values.min(axis=0), motion.joint_values.max(axis=0)
    assert np.all((curve.joint_values >= low - 1e-12) & (curve.joint_values <= high + 1e-12))


def test_displacements_keep_to_their_directions(past_the_ball):
    problem, motion, _ = past_the_ball
    flat = np.eye(3)[:2]
    curve = refined_curve(problem, motion, flat, 0.1).curve
    heights = centers(curve, 1)[:, 2]
    assert heights.max() > 0.02  # of the path itself, at its last corner but one
    assert curve_change(curve) >= curve_change(past_the_ball[2]) * (1.0 - 1e-3)


def test_the_window_of_the_base_is_kept():
    low, high = (-0.5, -0.9, -0.2), (4.5, 0.005, 0.2)
    problem = free_problem(fp.Scene([], []), window=(low, high))
    robot = problem.robot
    goal, positions = problem.goal, np.array([[0, 0, 0], [2.0, -0.89, 0.1], [4.0, 0, 0]])
    ends = robot.joint_values(np.array([problem.start, goal]))
    joints = ends[[0, 1, 1]]
    motion = Motion(robot, problem.mode, problem.start, goal, positions, joints)
    curve = refined_curve(problem, motion, np.eye(3), 0.0).curve
    at = curve.control.positions
    assert np.all((at >= np.array(low) - 1e-9) & (at <= np.array(high) + 1e-9))


@pytest.mark.parametrize("seed", range(3))
def test_without_clearances_a_polygon_in_space_becomes_straight_and_even(seed):
    corners = np.cumsum(np.random.default_rng(seed).normal(size=(9, 3)), axis=0)
    far = np.full((9, 3), 1e3)
    programme = Programme(vectors_of(corners), np.zeros(9), -far, far)
    offsets = np.zeros((9, 3))
    for _ in range(6):
        offsets = programme.best(offsets, NO_CUTS, 100.0)
    least = 2.0 * np.linalg.norm(corners[-1] - corners[0])
    assert 8 * programme.change(offsets) == pytest.approx(least, rel=5e-3)
    assert velocity_change(corners + offsets) == pytest.approx(8 * programme.change(offsets))


def test_a_plan_on_a_lattice_needs_less_and_stays_on_its_plane(fig2a_plan):
    plain, curve = fig2a_plan.smooth(), fig2a_plan.least_fuel(margin=0.02)
    assert curve.kind == "least fuel"
    assert 20.0 <= curve.change < 0.5 * plain.change
    assert curve.delta_v(200.0) == curve.change / 200.0
    assert curve.certificate.least_clearance >= 0.02
    heights = curve.at(np.linspace(0.0, 1.0, 101))[:, 2]
    assert heights == pytest.approx(0.0, abs=1e-12)


def test_a_goal_attitude_is_reached_by_the_curve_of_least_fuel():
    plan = fp.plan(fp.load_scenario("gate"), seed=0)
    curve = plan.least_fuel(margin=0.01)
    assert curve.kind == "least fuel"
    assert curve.arrival_attitude_error < 1e-6
    assert curve.change < plan.smooth().change


def test_margins_that_cannot_be_kept_and_modes_without_thrusters_are_refused(fig2a_plan):
    with pytest.raises(fp.InvalidInput, match=r"margin.*clearance of the start"):
        fig2a_plan.least_fuel(margin=3.0)
    with pytest.raises(fp.InvalidInput, match="duration"):
        fig2a_plan.least_fuel().delta_v(0.0)
    floating = fp.plan(fp.load_scenario("spatial_turn"), seed=0)
    with pytest.raises(fp.InvalidInput, match=r"mode.*no fuel is burnt"):
        floating.least_fuel()
