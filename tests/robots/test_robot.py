"""Robots: Table 1, configurations and their inverse, self-collision pairs."""

import pickle
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.core.bundled_files import folder
from tests.helpers.urdf_builders import random_configuration, random_robot
from tools import make_planar_dual_arm


def test_table_1_the_urdf_and_the_model_agree(robot):
    model = robot.model
    table = {"root_joint": make_planar_dual_arm.BASE} | {
        f"{side}_{k}": body
        for side in ("left", "right")
        for k, body in enumerate(make_planar_dual_arm.ARM, 1)
    }
    assert set(model.names[1:]) == set(table)
    for name, body in table.items():
        inertia = model.inertias[model.getJointId(name)]
        assert inertia.mass == body.mass
        assert inertia.inertia[2, 2] == pytest.approx(body.inertia, rel=1e-12)
    for side in ("left", "right"):
        for k in (2, 3):
            offset = model.jointPlacements[model.getJointId(f"{side}_{k}")].translation
            assert np.allclose(offset, [make_planar_dual_arm.ARM[k - 2].length, 0, 0], atol=1e-12)
    axes = {model.joints[j].shortname() for j in range(2, model.njoints)}
    assert axes == {"JointModelRZ"}


def test_the_misprinted_inertia_is_corrected():
    first = make_planar_dual_arm.ARM[0]
    assert first.inertia == pytest.approx(first.mass * first.length**2 / 12, abs=5e-6)


def test_the_bundled_urdf_is_what_the_table_builds(tmp_path):
    make_planar_dual_arm.write_planar_dual_arm(tmp_path / "made.urdf")
    bundled = folder("urdf") / "planar_dual_arm.urdf"
    assert (tmp_path / "made.urdf").read_text() == bundled.read_text()


def test_the_mass_includes_the_base(robot):
    total = make_planar_dual_arm.BASE.mass + 2 * sum(body.mass for body in make_planar_dual_arm.ARM)
    assert sum(i.mass for i in robot.model.inertias) == pytest.approx(total)


@given(st.integers(0, 200))
def test_components_invert_configuration(seed):
    robot = random_robot(seed)
    q = random_configuration(robot, np.random.default_rng(seed))
    parts = robot.components(q)
    again = robot.configuration(parts.position, parts.attitude, parts.joints)
    assert np.allclose(again, q, atol=1e-12) or np.allclose(again[3:7], -q[3:7], atol=1e-12)
    assert np.allclose(robot.from_paper_vector(robot.paper_vector(q)), again, atol=1e-12)


def test_joints_are_given_by_name_and_the_others_stay_at_zero(robot):
    q = robot.configuration(joints={"right_2": -0.3})
    assert robot.components(q).joints == dict.fromkeys(robot.joint_names, 0.0) | {"right_2": -0.3}


def test_joints_can_be_a_posture_name_or_merged_with_one():
    robot = fp.load_robot("satellite_ur5")
    stowed = robot.configuration(joints="stowed")
    assert np.array_equal(stowed, robot.configuration(joints=robot.postures["stowed"]))
    changed = robot.configuration(joints={**robot.postures["stowed"], "arm_elbow_joint": 0.2})
    assert robot.components(changed).joints["arm_elbow_joint"] == 0.2
    with pytest.raises(fp.InvalidInput, match=r"joints: got 'stoved'.*did you mean 'stowed'"):
        robot.configuration(joints="stoved")


def test_components_of_many_configurations_are_arrays(robot):
    rng = np.random.default_rng(0)
    q = np.array([random_configuration(robot, rng) for _ in range(5)])
    parts = robot.components(q)
    assert parts.position.shape == parts.attitude.shape == (5, 3)
    for k, row in enumerate(q):
        one = robot.components(row)
        assert np.array_equal(parts.position[k], one.position)
        assert np.array_equal(parts.attitude[k], one.attitude)
        assert {name: values[k] for name, values in parts.joints.items()} == one.joints
    assert robot.components(q[:0]).position.shape == (0, 3)
    q[3, 3:7] = 0.0
    with pytest.raises(fp.InvalidInput, match=r"q\[3\] \(base quaternion\)"):
        robot.components(q)


def test_a_robot_is_printed_in_one_line(robot):
    assert repr(robot) == "SpaceRobot('planar_dual_arm': 6 joints, 7.4 kg, 7 links)"
    html = robot._repr_html_()
    assert html.startswith("<table>")
    assert "left_1" in html
    assert "7.4 kg" in html
    assert len(html) < 1000


def test_adjacent_links_are_no_self_collision_pairs(robot):
    shapes = robot.collision_model.geometryObjects
    pairs = {
        frozenset(robot.link_of(shapes[k]) for k in (p.first, p.second))
        for p in robot.collision_model.collisionPairs
    }
    assert frozenset({"base", "left_link_1"}) not in pairs
    assert frozenset({"left_link_1", "left_link_2"}) not in pairs
    assert frozenset({"base", "left_link_2"}) in pairs
    assert frozenset({"left_link_3", "right_link_3"}) in pairs
    assert len(pairs) == 7 * 6 // 2 - 6


def test_a_robot_survives_pickling(robot):
    twin = pickle.loads(pickle.dumps(robot))
    assert twin.joint_names == robot.joint_names
    assert twin.model == robot.model


def test_robots_load_by_name_and_by_path(robot):
    path = folder("urdf") / "planar_dual_arm.urdf"
    assert fp.load_robot(path).model == robot.model == fp.load_robot(str(path)).model
    assert fp.robot_names() == ["planar_dual_arm", "point", "satellite_ur5", "spatial_dual_arm"]


def test_every_bundled_urdf_is_listed():
    assert {p.stem for p in Path(folder("urdf")).glob("*.urdf")} == set(fp.robot_names())


def test_postures_of_a_robot_cannot_be_changed():
    robot = fp.load_robot("satellite_ur5")
    name = next(iter(robot.postures))
    joint = next(iter(robot.postures[name]))
    with pytest.raises(TypeError, match="read-only"):
        robot.postures[name][joint] = 0.5
    with pytest.raises(TypeError, match="read-only"):
        robot.postures.update(other={})
    assert pickle.loads(pickle.dumps(robot.postures)) == robot.postures
    assert robot.postures | {} == dict(robot.postures)
