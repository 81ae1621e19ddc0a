"""Mutated URDFs: each is read as a second reader reads it, or refused in one sentence."""

import re
import warnings
from collections import Counter
from xml.etree import ElementTree

import coal
import numpy as np
import pinocchio as pin
import pytest

import ffsr_plan as fp
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.urdf_by_hand import ByHand

BASE = """<robot name="mutant" version="1.1">
  <material name="gold"><color rgba="0.8 0.6 0.2 1"/></material>
  <link name="bus">
    <inertial><origin xyz="0.01 -0.02 0.03" rpy="0.1 0.2 0.3"/><mass value="50.5"/>
      <inertia ixx="3.1" ixy="0.1" ixz="-0.05" iyy="3.3" iyz="0.02" izz="3.6"/></inertial>
    <visual><geometry><box size="0.8 0.8 0.8"/></geometry><material name="gold"/></visual>
    <collision><origin xyz="0 0 0.05" rpy="0 0 0.4"/><geometry><box size="0.8 0.7 0.9"/></geometry>
    </collision>
  </link>
  <link name="panel">
    <inertial><mass value="4.25"/>
      <inertia ixx="0.52" ixy="0" ixz="0" iyy="0.06" iyz="0" izz="0.58"/></inertial>
    <collision><geometry><box size="0.4 1.2 0.02"/></geometry></collision>
  </link>
  <link name="arm">
    <inertial><origin xyz="0.5 0.01 0" rpy="0 0.3 0"/><mass value="6"/>
      <inertia ixx="0.05" ixy="0.01" ixz="0" iyy="0.61" iyz="0" izz="0.62"/></inertial>
    <collision><origin xyz="0.5 0 0" rpy="0 1.5707963267948966 0"/>
      <geometry><capsule radius="0.06" length="0.9"/></geometry></collision>
    <collision><origin xyz="0.1 0 0"/><geometry><sphere radius="0.09"/></geometry></collision>
  </link>
  <link name="hand">
    <inertial><mass value="1.5"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.011" iyz="0" izz="0.012"/></inertial>
    <collision><origin rpy="0.3 0 0"/><geometry><cylinder radius="0.1" length="0.2"/></geometry>
    </collision>
  </link>
  <link name="wheel">
    <inertial><mass value="0.75"/>
      <inertia ixx="0.003" ixy="0" ixz="0" iyy="0.003" iyz="0" izz="0.005"/></inertial>
    <collision><geometry><sphere radius="0.08"/></geometry></collision>
  </link>
  <joint name="mount" type="fixed"><parent link="bus"/><child link="panel"/>
    <origin xyz="0 1.1 0" rpy="0 0.7 0"/></joint>
  <joint name="shoulder" type="revolute"><parent link="bus"/><child link="arm"/>
    <origin xyz="0.45 0.1 -0.1" rpy="0.2 -0.4 1.1"/><axis xyz="0 0.6 0.8"/>
    <limit lower="-2" upper="2.5" velocity="0.5" effort="20"/><dynamics damping="0.1"/></joint>
  <joint name="slide" type="prismatic"><parent link="arm"/><child link="hand"/>
    <origin xyz="1.05 0 0"/><axis xyz="1 0 0"/>
    <limit lower="-0.1" upper="0.3" velocity="0.2" effort="15"/></joint>
  <joint name="spin" type="continuous"><parent link="panel"/><child link="wheel"/>
    <origin xyz="0 0.8 0" rpy="1.2 0 0"/><limit velocity="3" effort="1"/></joint>
</robot>
"""
NUMBERS = (
    "{} ", " {}", "{}&#10;", "&#9;{}", "{}_0", "{}&#160;", "&#8201;{}", "{}\uff17", "\u0667{}",
    "+{}", "0x{}", "{}e400", "{}e-3", "{}E2", "{}f", "{}d0", "nan", "inf", "-infinity", "", "{} {}",
    "{},5", "\u2212{}", "1e", ".", "{}.", "{}e+0", "${{m}}", "$(arg m)", "0",
    "-{}", "1e-30", "1e30",
    "1e-400", "one", "{}-{}", "{};",
)  # fmt: skip
WORDS = (
    "XYZ",
    "rpyy",
    "position",
    "Value",
    "uper",
    "quat_xyzw",
    "x:rpy",
    "radius",
    "ixxx",
    "lenght",
)
TAGS = ("Origin", "colision", "x:collision", "xacro:if", "gazebo", "inertia", "limits", "frame")


def number_text(rng, root):
    """One number of an attribute in another spelling."""
    holders = [
        (e, k) for e in root.iter() for k, v in e.attrib.items()
        if v[:1] in "0123456789-." and k != "version" and v
    ]  # fmt: skip
    element, key = holders[rng.integers(len(holders))]
    words = element.get(key).split()
    k = int(rng.integers(len(words)))
    words[k] = NUMBERS[rng.integers(len(NUMBERS))].format(words[k], words[k])
    element.set(key, " ".join(words))


def attribute(rng, root):
    """An attribute renamed, doubled under another name, or dropped."""
    holders = [(e, k) for e in root.iter() for k in e.attrib]
    element, key = holders[rng.integers(len(holders))]
    value = element.attrib[key]
    if rng.random() < 0.7:
        changed = [key.upper(), key + key[-1], key[:-1], key[::-1], f" {key}".strip(), *WORDS]
        element.set(changed[rng.integers(len(changed))], value)
    if rng.random() < 0.8:
        del element.attrib[key]


def quaternion(rng, root):
    """An orientation as a quaternion: right, not of length one, beside `rpy`, or not of four."""
    origins = list(root.iter("origin"))
    origin = origins[rng.integers(len(origins))]
    q = rng.normal(size=4)
    q /= np.linalg.norm(q)
    fault = rng.integers(6)
    q = {0: 2.0 * q, 1: 0.0 * q, 2: q[:3]}.get(int(fault), q)
    origin.set("quat_xyzw", " ".join(map(repr, q.tolist())))
    if fault != 3:
        origin.attrib.pop("rpy", None)
    root.set("version", ("1.0", "1.1", "1.2", "1.3", "2")[rng.integers(5)])


def element(rng, root):
    """An element dropped, doubled, moved, renamed, or wrapped in another one."""
    parents = {child: parent for parent in root.iter() for child in parent}
    chosen = list(parents)[rng.integers(len(parents))]
    parent, what = parents[chosen], rng.integers(5)
    if what == 0:
        parent.remove(chosen)
    elif what == 1:
        parent.append(chosen)
    elif what == 2:
        parent.remove(chosen)
        places = [e for e in root.iter() if e not in set(chosen.iter())]
        places[rng.integers(len(places))].append(chosen)
    elif what == 3:
        chosen.tag = TAGS[rng.integers(len(TAGS))]
    else:
        wrapper = ElementTree.Element(TAGS[rng.integers(len(TAGS))])
        parent.remove(chosen)
        wrapper.append(chosen)
        parent.append(wrapper)


def kind(rng, root):
    """Another type of a joint, other ends, or a world that carries the bus."""
    joints = list(root.iter("joint"))
    joint = joints[rng.integers(len(joints))]
    if rng.random() < 0.5:
        types = ("fixed", "revolute", "continuous", "prismatic", "floating", "planar", "Revolute")
        joint.set("type", types[rng.integers(len(types))])
    elif rng.random() < 0.5:
        link = ("bus", "arm", "", "bus ", "hand")[rng.integers(5)]
        joint.find(("parent", "child")[rng.integers(2)]).set("link", link)
    else:
        ElementTree.SubElement(root, "link", name="world")
        free = ElementTree.SubElement(root, "joint", name="free", type="floating")
        ElementTree.SubElement(free, "parent", link="world")
        ElementTree.SubElement(free, "child", link=("bus", "arm")[rng.integers(2)])


KINDS = (number_text, attribute, quaternion, element, kind)


def mutants(count, seed):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        root = ElementTree.fromstring(BASE.replace("x:", "x-"))
        for _ in range(1 if rng.random() < 0.8 else 2):
            KINDS[rng.integers(len(KINDS))](rng, root)
        text = ElementTree.tostring(root, encoding="unicode").replace("&amp;#", "&#")
        yield text.replace("<x-", "<x:").replace("</x-", "</x:").replace(" x-", " x:")


def agrees(robot, text, rng):
    """Assert that the robot is what the second reader finds in the text."""
    hand = ByHand(re.sub(r"\bx:", "x-", text))  # a prefix need not be declared
    moving = [n for n, j in hand.joints.items() if j.get("type") != "fixed"]
    assert sorted(moving) == sorted(robot.joint_names)
    for k, name in enumerate(robot.joint_names):
        lower, upper, velocity, effort = hand.limits(name)
        assert (robot.lower[k], robot.upper[k]) == (lower, upper)
        j = robot.model.joints[robot.model.getJointId(name)].idx_v
        assert robot.model.upperVelocityLimit[j] == velocity
        assert robot.model.upperEffortLimit[j] == effort
    joints = rng.uniform(-1, 1, robot.nd)
    values = dict(zip(robot.joint_names, joints.tolist(), strict=True))
    q = robot.assemble(np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), joints)
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, q)
    poses = hand.poses(values)
    assert sorted(poses) == sorted(robot.link_names)
    for k, frame in enumerate(model.frames):
        if frame.type == pin.FrameType.BODY:
            assert np.allclose(data.oMf[k].homogeneous, poses[frame.name], atol=1e-9)
    mass, center, tensor = hand.whole(values)
    pin.ccrba(model, data, q, np.zeros(model.nv))
    assert data.Ig.mass == pytest.approx(mass, rel=1e-12)
    assert np.allclose(data.com[0], center, rtol=0, atol=1e-9)
    assert np.allclose(data.Ig.inertia, tensor, rtol=0, atol=1e-9 * np.abs(tensor).max())
    shapes = {shape.name: shape for shape in robot.collision_model.geometryObjects}
    pin.updateGeometryPlacements(model, data, robot.collision_model, placed := pin.GeometryData(
        robot.collision_model))  # fmt: skip
    found = list(hand.shapes())
    assert len(found) == len(shapes)
    for link, k, tag, sizes, at in found:
        shape = shapes[f"{link}_{k}"]
        index = robot.collision_model.getGeometryId(shape.name)
        assert np.allclose(placed.oMg[index].homogeneous[:3, 3], (poses[link] @ at)[:3, 3])
        own = shape.geometry
        if tag == "box":
            assert np.allclose(2.0 * own.halfSide, sizes)
        elif tag == "sphere":
            assert own.radius == sizes[0]
        elif tag == "capsule":
            assert np.allclose([own.radius, 2.0 * own.halfLength], sizes)
        else:
            assert isinstance(own, coal.ConvexBase)


def test_mutated_urdfs_are_read_as_by_hand_or_refused(capfd):
    rng, outcomes, reasons = np.random.default_rng(0), Counter(), Counter()
    for number, text in enumerate(mutants(600, 20261126)):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                robot = robot_from_urdf(text, f"mutant {number}")
            except fp.InvalidInput as error:
                said = str(error)
                assert said.startswith(f"mutant {number}"), said
                assert "\n" not in said
                assert any(word in said for word in ("link", "joint", "robot", "material", "<")), (
                    said
                )
                outcomes["refused"] += 1
                reasons[said.split(": got")[0].split(", ", 1)[-1][:30]] += 1
                continue
        outcomes["read"] += 1
        try:
            agrees(robot, text, rng)
        except Exception as error:
            raise AssertionError(f"mutant {number} is read otherwise:\n{text}") from error
        again = robot_from_urdf(robot.urdf, "again")
        assert again.urdf == robot.urdf
    assert outcomes["read"] >= 100, outcomes
    assert outcomes["refused"] >= 150, outcomes
    assert len(reasons) >= 40, reasons
    written = capfd.readouterr()
    assert written.out == ""
    assert written.err == ""


def test_the_robot_that_is_mutated_is_read_as_by_hand():
    agrees(robot_from_urdf(BASE, "made"), BASE, np.random.default_rng(1))
