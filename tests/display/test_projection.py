"""Outlines of robots are the projections of their shapes."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.display.scenes.picture_data import motion_frames
from ffsr_plan.display.scenes.projection import convex_outline, outlines, view_axes, visible_shapes


def area(polygon):
    x, y = polygon.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def test_the_path_runs_from_left_to_right(robot):
    start, goal = robot.configuration(), robot.configuration((3.0, 4.0, 0.0))
    axes = view_axes(fp.Problem(robot, fp.Scene(), start, goal, lattice=fp.Lattice(4)))
    assert np.allclose(axes @ [3.0, 4.0, 0.0], [5.0, 0.0, 0.0])
    assert np.allclose(axes[2], [0.0, 0.0, 1.0])
    assert np.linalg.det(axes) == pytest.approx(1.0)


@pytest.mark.parametrize("angle", [0.0, 0.3, np.pi / 4])
def test_a_box_seen_from_above_is_its_rotated_rectangle(robot, angle):
    q = robot.configuration((1.0, 2.0, 0.0), (angle, 0.0, 0.0))
    shapes = [g for g in robot.collision_model.geometryObjects if robot.link_of(g) == "base"]
    (outline,) = outlines(shapes, motion_frames(robot, q[None]), 0, np.eye(3))
    assert len(outline.polygon) == 4
    assert area(outline.polygon) == pytest.approx(0.25)
    assert np.allclose(outline.polygon.mean(axis=0), [1.0, 2.0])


@pytest.mark.parametrize("name", fp.robot_names())
def test_every_visible_shape_has_an_outline(name):
    robot = fp.load_robot(name)
    shapes = visible_shapes(robot)
    drawn = outlines(shapes, motion_frames(robot, robot.neutral()[None]), 0, np.eye(3))
    assert len(drawn) == len(shapes) > 0
    assert all(area(outline.polygon) > 0.0 for outline in drawn)


def test_points_on_one_line_have_an_outline():
    points = np.outer(np.linspace(0.0, 1.0, 5), [1.0, 2.0])
    outline = convex_outline(points)
    assert np.allclose(outline.min(axis=0), [0.0, 0.0])
    assert np.allclose(outline.max(axis=0), [1.0, 2.0])
