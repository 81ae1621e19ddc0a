"""URDF files that parsers take in silence, or die of: each is refused with file, part and value.

The rows are those of what Pinocchio and yourdfpy were found to do with such files: silence, dropped
links or shapes, matrices that are no rotations, half a robot, a crash.
"""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.urdf_builders import box, inertial, joint, link, urdf

GOOD = inertial(2.0, (0.1, 0.2, 0.25))
SIZE = (0.5, 0.5, 0.5)


def robot_file(own=GOOD, shape=None, hinge=None, tail=""):
    """Two bodies, one hinge; something of it replaced, or added."""
    shape = box(SIZE) if shape is None else shape
    hinge = joint("j", "revolute", "base", "arm", (1, 0, 0)) if hinge is None else hinge
    return urdf(link("base", GOOD, box(SIZE)), link("arm", own, shape), hinge, tail)


def inertia_of(ixx, iyy, izz, ixy=0.0):
    return inertial(2.0, (ixx, iyy, izz)).replace("ixy='0'", f"ixy='{ixy!r}'")


def hinge(change=("", ""), **options):
    return joint("j", "revolute", "base", "arm", (1, 0, 0), **options).replace(*change)


def chain(count):
    parts = [link(f"l{k}", GOOD) for k in range(count)]
    parts += [joint(f"j{k}", "revolute", f"l{k}", f"l{k + 1}", (1, 0, 0)) for k in range(count - 1)]
    return urdf(*parts)


LAUGHS = "<!DOCTYPE robot [<!ENTITY a 'ha'><!ENTITY b '&a;&a;&a;&a;&a;&a;&a;&a;'>]>"
STOLEN = "<!DOCTYPE robot [<!ENTITY a SYSTEM 'file:///etc/hostname'>]>"

ROWS = {
    "no inertial on a moving link": (robot_file(""), r"link 'arm'", "0 kg", "a mass"),
    "mass of zero": (robot_file(inertial(0.0, (1.0, 1.0, 1.0))), "'arm', mass", "0", "greater"),
    "negative mass": (robot_file(inertial(-1.0, (1.0, 1.0, 1.0))), "'arm', mass", "-1", "greater"),
    "indefinite inertia": (
        robot_file(inertia_of(-0.1, 0.2, 0.2)),
        "'arm', inertia",
        "-0.1",
        ">= 0",
    ),
    "product too large": (
        robot_file(inertia_of(0.1, 0.1, 0.15, ixy=0.2)),
        "'arm', inertia",
        "-0.1",
        ">= 0",
    ),
    "triangle inequality": (
        robot_file(inertia_of(0.1, 0.1, 0.5)),
        "'arm', inertia",
        "0.5",
        "less than the third",
    ),
    "mass that is not a number": (
        robot_file(inertial(float("nan"), (1.0, 1.0, 1.0))),
        "'arm', mass",
        "nan",
        "finite",
    ),
    "mass in words": (
        robot_file(GOOD.replace("'2.0'", "'two kilograms'")),
        "'arm', mass",
        "two",
        "finite",
    ),
    "infinite inertia": (
        robot_file(inertial(1.0, (float("inf"), 1.0, 1.0))),
        "'arm', ixx",
        "inf",
        "finite",
    ),
    "missing mesh": (
        robot_file(shape="<collision><geometry><mesh filename='gone.stl'/></geometry></collision>"),
        "'arm', collision mesh",
        "gone.stl",
        "file",
    ),
    "cycle": (
        robot_file(tail=link("c", GOOD) + joint("k", "revolute", "arm", "base", (1, 0, 0))),
        "joints",
        "base",
        "carry each other",
    ),
    "detached cycle": (
        robot_file(
            tail=link("c", GOOD)
            + link("d", GOOD)
            + joint("k", "revolute", "c", "d", (1, 0, 0))
            + joint("l", "revolute", "d", "c", (1, 0, 0))
        ),
        "joints",
        "c",
        "carry each other",
    ),
    "two roots": (robot_file(tail=link("c", GOOD)), "root links", "'c'", "one link"),
    "two links of one name": (robot_file(tail=link("arm", GOOD)), "'arm', name", "arm", "one link"),
    "zero axis": (robot_file(hinge=hinge(axis=(0.0, 0.0, 0.0))), "'j', axis", "0.0", "length 1"),
    "long axis": (robot_file(hinge=hinge(axis=(0.0, 0.0, 2.0))), "'j', axis", "2.0", "length 1"),
    "swapped limits": (
        robot_file(hinge=hinge(("lower='-3.0'", "lower='4.0'"))),
        "'j', limit",
        "4.0",
        "less than",
    ),
    "negative box": (
        robot_file(shape=box((0.5, -0.5, 0.5))),
        "box, size",
        "-0.5",
        "greater than 0",
    ),
    "unknown shape": (
        robot_file(shape="<collision><geometry><cone/></geometry></collision>"),
        "'arm', collision",
        "cone",
        "box",
    ),
    "mimic joint": (
        robot_file(hinge=hinge(("</joint>", "<mimic joint='j'/></joint>"))),
        "'j'",
        "mimic",
        "move",
    ),
    "unknown joint type": (
        robot_file(hinge=hinge(("'revolute'", "'ball'"))),
        "'j', type",
        "ball",
        "revolute",
    ),
    "not XML": ("a robot, honestly", "", "syntax error", "well-formed XML"),
    "empty": ("", "", "no element", "well-formed XML"),
    "truncated": (robot_file()[:-40], "", "line 1", "well-formed XML"),
    "another document": ("<html/>", "", "<html>", "<robot>"),
    "billion laughs": (LAUGHS + robot_file(), "", "DOCTYPE", "plain XML"),
    "external entity": (STOLEN + robot_file(), "", "DOCTYPE", "plain XML"),
    "a chain of 20 000 links": (chain(20_000), "links", "20000", "1 to 1000"),
    "a chain too deep": (chain(700), "links", "699 joints", "at most 500"),
}


@pytest.mark.parametrize("name", ROWS)
def test_a_faulty_urdf_is_refused_with_part_and_value(name, tmp_path):
    text, part, value, allowed = ROWS[name]
    path = tmp_path / "broken_robot.urdf"
    path.write_text(text)
    with pytest.raises(fp.InvalidInput) as caught:
        fp.load_robot(path)
    said = str(caught.value)
    assert "broken_robot" in said
    assert part in said
    assert value in said.split("got", 1)[1]
    assert allowed in said.split("allowed", 1)[1]
    assert ".cpp" not in said
    assert "/include/" not in said


def test_the_urdf_without_faults_is_a_working_robot():
    robot = robot_from_urdf(robot_file(), "made")
    assert robot.joint_names == ("j",)
    assert sum(body.mass for body in robot.model.inertias) == pytest.approx(4.0)
    scene = fp.Scene([[3.0, 0.0, 0.0]], [0.5])
    assert fp.clearance(robot, scene, robot.neutral()) == pytest.approx(1.25)


@pytest.mark.parametrize("moments", [(0.0, 0.2, 0.2), (0.1, 0.2, 0.3)])
def test_flat_and_slender_bodies_are_taken(moments):
    """A plate's principal moments just meet the triangle inequality, a rod has one of zero."""
    robot = robot_from_urdf(robot_file(inertial(2.0, moments)), "made")
    assert np.allclose(np.diag(robot.model.inertias[2].inertia), moments)


def test_bytes_that_are_no_text_are_refused(tmp_path):
    path = tmp_path / "broken_robot.urdf"
    path.write_bytes(b"\xff\xfe\x00<robot")
    with pytest.raises(fp.InvalidInput, match=r"broken_robot.*UTF-8"):
        fp.load_robot(path)
