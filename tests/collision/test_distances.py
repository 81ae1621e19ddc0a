"""Clearance by Coal against closed forms and against the laws of distance."""

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.collision.distances import ObstacleQuery, SelfQuery
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.closed_forms import clearance as closed_form
from tests.helpers.urdf_builders import (
    box,
    inertial,
    link,
    random_configuration,
    random_robot,
    random_scene,
    urdf,
)

seeds = st.integers(0, 10_000)


@given(seeds)
def test_clearance_equals_the_closed_form_for_spheres_and_boxes(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    scene = random_scene(rng, low=-2, high=2)
    q = random_configuration(robot, rng)
    assert fp.clearance(robot, scene, q) == pytest.approx(closed_form(robot, scene, q), abs=1e-12)


@given(seeds)
def test_clearance_changes_by_at_most_the_obstacles_motion(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    scene = random_scene(rng, count=1, low=-2, high=2)
    q = random_configuration(robot, rng)
    shift = rng.normal(size=3) * rng.uniform(0, 0.5)
    moved = fp.Scene(scene.centers + shift, scene.radii)
    change = fp.clearance(robot, moved, q) - fp.clearance(robot, scene, q)
    assert abs(change) <= np.linalg.norm(shift) + 1e-9


@given(seeds)
def test_a_distance_depends_on_none_that_was_measured_before(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    scene = random_scene(rng, low=-2, high=2)
    many = np.array([random_configuration(robot, rng) for _ in range(8)])
    at_once = ObstacleQuery(robot, scene).distances(many)
    assert at_once.tolist() == [fp.clearance(robot, scene, q) for q in many]


def test_the_distance_of_a_hull_depends_on_no_penetration_measured_before():
    points = np.random.default_rng(0).normal(size=(60, 3))
    mesh = "<collision><geometry><mesh filename='hull.stl'/></geometry></collision>"
    robot = robot_from_urdf(
        urdf(link("base", inertial(1.0, (1.0, 1.0, 1.0)), mesh)),
        "made",
        meshes={"hull.stl": points},
    )
    scene = fp.Scene([[0.0, 0.0, 0.0], [9.0, 0.0, 0.0]], [0.5, 0.2])
    many = np.array([robot.configuration((x, 0.3, 0.1)) for x in (0.0, 5.0, 0.5, 9.0, 4.0)])
    at_once = ObstacleQuery(robot, scene).distances(many)
    assert at_once.min() < 0.0 < at_once.max()
    assert at_once.tolist() == [fp.clearance(robot, scene, q) for q in many]


@given(seeds)
def test_clearance_is_the_least_over_obstacles(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    scene = random_scene(rng, low=-2, high=2)
    q = random_configuration(robot, rng)
    each = [
        fp.clearance(robot, fp.Scene([c], [r]), q)
        for c, r in zip(scene.centers, scene.radii, strict=True)
    ]
    assert fp.clearance(robot, scene, q) == min(each)
    near = ObstacleQuery(robot, scene).nearest(q)
    assert near.obstacle == int(np.argmin(each))


@given(seeds)
def test_clearance_is_invariant_under_translation(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    scene = random_scene(rng, low=-2, high=2)
    q = random_configuration(robot, rng)
    shift = rng.normal(size=3)
    elsewhere = np.array(q)
    elsewhere[:3] += shift
    moved = fp.Scene(scene.centers + shift, scene.radii)
    assert fp.clearance(robot, moved, elsewhere) == pytest.approx(
        fp.clearance(robot, scene, q), abs=1e-9
    )


def test_touching_is_zero_and_penetration_is_negative():
    robot = robot_from_urdf(
        urdf(link("base", inertial(1.0, (1.0, 1.0, 1.0)), box((2.0, 2.0, 2.0)))), "cube"
    )
    q = robot.neutral()
    assert fp.clearance(robot, fp.Scene([[1.5, 0, 0]], [0.5]), q) == pytest.approx(0, abs=1e-12)
    assert fp.clearance(robot, fp.Scene([[1.2, 0, 0]], [0.5]), q) == pytest.approx(-0.3)


def test_an_empty_scene_is_infinitely_far(robot):
    assert fp.clearance(robot, fp.Scene([], []), robot.neutral()) == np.inf


def test_self_distance_depends_on_the_joints_alone(robot):
    query = SelfQuery(robot)
    joints = {"left_1": -0.8, "right_1": 0.9, "left_2": 0.3}
    a = robot.configuration(joints=joints)
    b = robot.configuration((3, -2, 1), (0.4, 0.5, 0.6), joints)
    assert query.distance(a) == pytest.approx(query.distance(b), abs=1e-12)


def test_the_nearest_link_is_named(robot):
    q = robot.neutral()  # arms stretched to the sides
    near = ObstacleQuery(robot, fp.Scene([[0.12, 1.6, 0.0]], [0.2])).nearest(q)
    assert near.link == "left_link_3"
    assert near.obstacle == 0


def test_a_clearance_is_a_float_that_shows_its_pair(robot):
    scene = fp.Scene([[0.12, 1.6, 0.0]], [0.2])
    near = fp.clearance(robot, scene, robot.neutral())
    assert repr(near) == f"Clearance({float(near)} m, link 'left_link_3', obstacle 0)"
    assert f"{near} {near:.1f}" == f"{float(near)} {float(near):.1f}"
    assert type(near + 0.0) is float
    again = pickle.loads(pickle.dumps(near))
    assert (again, again.link, again.obstacle) == (near, "left_link_3", 0)
    assert repr(fp.clearance(robot, fp.Scene(), robot.neutral())) == "Clearance(inf m, empty scene)"
