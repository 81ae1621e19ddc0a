"""The collision shapes of a URDF as obstacles."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.scene.shapes.obstacle_shapes import Box, Cylinder
from tests.helpers.single_link_robots import MASS, one_link
from tests.helpers.urdf_builders import box, cylinder, link, urdf


def test_clearances_from_a_robot_as_an_obstacle_are_those_between_the_two():
    """Of two robots, each is as far from the other as the other from it."""
    one, other = fp.load_robot("planar_dual_arm"), fp.load_robot("satellite_ur5")
    rng = np.random.default_rng(0)
    for _ in range(10):
        pose = rng.uniform(-2.0, 2.0, 3), rng.uniform(-3.0, 3.0, 3)
        joints = {"arm_shoulder_pan_joint": 0.4, "arm_elbow_joint": -0.7}
        far = rng.uniform(-4.0, 4.0, 3), rng.uniform(-3.0, 3.0, 3)
        there = fp.clearance(one, fp.Scene.from_urdf(other, *pose, joints), one.configuration(*far))
        back = fp.clearance(
            other, fp.Scene.from_urdf(one, *far), other.configuration(*pose, joints)
        )
        assert there == pytest.approx(back, abs=1e-8)
    assert there.link in one.link_names


def test_a_cylinder_of_a_urdf_stays_one():
    target = one_link(cylinder(0.4, 2.0, (0.1, 0.2, 0.3), (0.3, 0.2, 0.1)))
    (shape,) = fp.Scene.from_urdf(target, (1.0, 0.0, 0.0), name="client").shapes
    assert isinstance(shape, Cylinder)
    assert (shape.radius, shape.length, shape.name) == (0.4, 2.0, "client, base")
    assert shape.position == pytest.approx([1.1, 0.2, 0.3])


def test_shapes_have_the_pose_of_their_link():
    parts = box((2.0, 1.0, 0.5)), box((0.1, 0.1, 0.1), (3.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    target = robot_from_urdf(urdf(link("base", MASS, *parts)), "target")
    body, far = fp.Scene.from_urdf(target, (1.0, 2.0, 3.0), (np.pi / 2, 0.0, 0.0)).shapes
    assert isinstance(body, Box)
    assert body.position == pytest.approx([1.0, 2.0, 3.0])
    assert body.size == pytest.approx([2.0, 1.0, 0.5])
    assert far.position == pytest.approx([1.0, 5.0, 3.0])
    turn = np.pi / 2 + 1.0
    assert far.attitude == pytest.approx([0.0, 0.0, np.sin(turn / 2), np.cos(turn / 2)])


def test_a_wrong_name_is_refused():
    with pytest.raises(fp.InvalidInput, match="name"):
        fp.Scene.from_urdf("planar_dual_arm", name=3)


def test_options_of_loading_are_refused_beside_a_loaded_robot():
    robot = fp.load_robot("planar_dual_arm")
    with pytest.raises(fp.InvalidInput, match=r"package_dirs.*loaded already"):
        fp.Scene.from_urdf(robot, package_dirs=[])
