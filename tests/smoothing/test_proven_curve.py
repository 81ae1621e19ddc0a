"""The ladder from the spline of the nodes to the path with rests."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.curves.control_points import control_points_on
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.smoothing import proven_curve as ladder
from ffsr_plan.smoothing.curve_proof import prove_curve

STEPS = 400


def corner(room, small=0.5):
    """A sphere inside a right-angled bend, a little away from the path of a point."""
    robot = fp.load_robot("point")
    start, goal = robot.configuration((0, 0, 0)), robot.configuration((2, 2, 0))
    way = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [2, 2, 0.0]])
    center = np.array([2.0, 0.0, 0.0]) + (0.5 + room) * np.array([-1.0, 1.0, 0.0])
    scene = fp.Scene([center], [small])
    problem = fp.Problem(robot, scene, start, goal, window=((-1, -1, 0), (3, 3, 0)))
    return problem, fp.Motion(robot, "free-flying", start, goal, way)


def test_a_path_with_room_becomes_the_spline_of_its_nodes():
    problem, motion = corner(0.4)
    found = ladder.proven_curve(problem, motion)
    assert found.kind == "spline"
    assert found.proof.curve.edges == motion.edges
    assert np.array_equal(found.nodes, np.arange(5.0))
    assert found.refused == found.queries == 0


@pytest.mark.parametrize("room", [0.01, 0.003, 0.001])
def test_a_tight_corner_takes_more_control_points(room):
    problem, motion = corner(room)
    found = ladder.proven_curve(problem, motion)
    assert found.kind == "refined spline"
    assert found.proof.curve.edges > motion.edges
    assert found.refused > 0
    assert found.nodes[[0, -1]].tolist() == [0.0, found.proof.curve.edges]
    s = np.linspace(0.0, 1.0, STEPS)
    scaled = s * found.proof.curve.edges
    edge = np.minimum(scaled.astype(int), found.proof.curve.edges - 1)
    path = found.proof.curve.at(edge, scaled - edge)
    gaps = [float(fp.clearance(problem.robot, problem.scene, q)) for q in path]
    assert 0.0 < found.proof.least_clearance() <= min(gaps) + 1e-12


def test_min_clearance_is_kept_along_the_curve():
    problem, motion = corner(0.01, small=0.42)
    kept = replace(problem, min_clearance=0.08)
    found = ladder.proven_curve(kept, motion)
    edge = np.repeat(np.arange(found.proof.curve.edges), 50)
    time = np.tile(np.linspace(0, 1, 50), found.proof.curve.edges)
    path = found.proof.curve.at(edge, time)
    gaps = [float(fp.clearance(problem.robot, problem.scene, q)) for q in path]
    assert min(gaps) >= 0.08 + found.proof.least_clearance() - 1e-9


def test_the_spline_through_the_nodes_and_the_path_with_rests_are_the_last(monkeypatch):
    problem, motion = corner(0.002)
    monkeypatch.setattr(ladder, "_ROUNDS", 0)
    through = ladder.proven_curve(problem, motion)
    assert through.kind == "through"
    knots = through.proof.curve.configurations()
    assert knots == pytest.approx(motion.configurations(), abs=1e-12)
    monkeypatch.setattr(ladder.ControlPoints, "through", lambda control: control)
    rests = ladder.proven_curve(problem, motion)
    assert rests.kind == "with rests"
    curve = rests.proof.curve
    at_nodes = curve.at(rests.nodes[:-1].astype(int), np.zeros(motion.edges))
    assert at_nodes == pytest.approx(motion.configurations()[:-1], abs=1e-12)
    assert np.allclose(curve.pieces.rates[int(rests.nodes[2]), 0, :3], 0.0, atol=1e-14)


def test_where_nothing_can_be_proven_the_edge_and_the_obstacle_are_named():
    problem, motion = corner(-0.3)
    with pytest.raises(fp.UnprovenCurve) as caught:
        ladder.proven_curve(problem, motion)
    assert caught.value.edge in (2, 3)
    assert caught.value.edges == 4
    assert caught.value.contact.obstacle == 0
    assert f"on edge {caught.value.edge} of 4, link '" in str(caught.value)


def test_joints_that_cut_corners_far_away_are_refined_too(robot):
    """An obstacle beside a straight part of the path, where the base is turned otherwise."""
    joints = np.zeros((9, robot.nd))
    joints[:, 0], joints[:, 1] = (
        [0, 0.5, 1, 1, 0.5, 0, 0, 0, 0],
        [0, 0, 0, -0.8, -0.8, -0.8, 0, 0, 0],
    )
    positions = np.zeros((9, 3))
    positions[:, 0] = [0, 0, 0, 0, 0, 0, 0, 1, 2]
    start, goal = robot.assemble(positions[[0, -1]], np.eye(4)[[3, 3]], joints[[0, -1]])
    motion = fp.Motion(robot, "free-flying", start, goal, positions, joints)
    control = control_points_on(motion, np.arange(9.0))
    smooth = CurvedMotion(motion, control)
    straight = motion.attitudes[-1]
    apart = 2.0 * np.arccos(min(1.0, abs(smooth.attitudes[-1] @ straight)))
    assert apart > 1e-3
    problem = fp.Problem(robot, fp.Scene(), start, goal)
    q = motion.at(np.repeat(np.arange(8), 200), np.tile(np.linspace(0, 1, 200), 8))
    smooth_q = smooth.at(np.full(200, 7), np.linspace(0, 1, 200))
    center = touching_sphere(robot, q, smooth_q)
    scene = fp.Scene([center[:3]], [center[3]])
    problem = replace(problem, scene=scene)
    first = prove_curve(problem, smooth, 1e-4)
    assert len(first.refused)
    found = ladder.proven_curve(problem, motion)
    assert found.kind == "refined spline"


def touching_sphere(robot, path, other):
    """A sphere that a path misses and another one hits."""

    def gaps(reach, angle):
        center = [1.5 + reach * np.cos(angle), reach * np.sin(angle), 0.0]
        scene = fp.Scene([center], [0.05])
        query = ObstacleQuery(robot, scene)
        both = [query.distances(each).min() for each in (path, other)]
        return both, np.append(center, 0.05)

    for angle in np.linspace(0.0, 2.0 * np.pi, 36, endpoint=False):
        near, far = 0.0, 6.0
        while far - near > 1e-4:  # the other one just touches
            middle = 0.5 * (near + far)
            near, far = (middle, far) if gaps(middle, angle)[0][1] < -3e-4 else (near, middle)
        found, sphere = gaps(near, angle)
        if found[0] > 3e-4:
            return sphere
    raise AssertionError("no sphere tells the two apart")


def test_nodes_that_are_hardly_apart_do_not_stop_the_flight():
    """A node just beside another one, or upon it, is none of the control points."""
    problem, motion = corner(0.4)
    beside = np.insert(
        motion.positions, [3, 4, 4], [[2, 1e-6, 0], [2, 1, 0], [2, 1.001, 0]], axis=0
    )
    crowded = fp.Motion(problem.robot, "free-flying", problem.start, problem.goal, beside)
    plain, found = (ladder.proven_curve(problem, each) for each in (motion, crowded))
    control = found.proof.curve.control.positions
    assert np.linalg.norm(np.diff(control, axis=0), axis=1).min() > 0.05
    assert len(control) == len(plain.proof.curve.control.positions)
    assert np.all(np.diff(found.nodes) >= 0.0)
    assert found.nodes[[0, -1]].tolist() == [0.0, found.proof.curve.edges]
    assert len(found.nodes) == len(beside)
