"""What is wrong with a URDF is said before Pinocchio sees it, by link or joint and by value."""

from itertools import pairwise

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.robots.urdf import xml_reading
from ffsr_plan.robots.urdf.canonical import read_urdf
from tests.helpers.urdf_builders import (
    box,
    capsule,
    cylinder,
    inertial,
    joint,
    link,
    mesh,
    sphere,
    urdf,
)

MASS = inertial(1.0, (1.0, 1.0, 1.0))
FAR = (0.0, -1000.5, 0.0)


def body(name, *shapes):
    return link(name, MASS, *shapes)


def hinge(name, parent, child, xyz=(1, 0, 0), kind="revolute", **options):
    return joint(name, kind, parent, child, xyz, **options)


def tree(*parts):
    return urdf(body("base"), body("a"), body("b"), *parts)


def chain(count):
    names = [f"link_{k}" for k in range(count)]
    joints = (hinge(f"j_{a}", a, b) for a, b in pairwise(names))
    return urdf(*map(body, names), *joints)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (urdf(body("base", box((1, 1001, 1)))), "link 'base', collision box, size"),
        (urdf(body("base", sphere(1e12))), "link 'base', collision sphere, radius"),
        (urdf(body("base", capsule(0.1, 1e6))), "link 'base', collision capsule, length"),
        (urdf(body("base", cylinder(1e6, 1))), "link 'base', collision cylinder, radius"),
        (urdf(body("base", box((1, 1, 1), FAR))), "link 'base', collision origin, xyz"),
        (urdf(link("base", inertial(1.0, (1.0, 1.0, 1.0), FAR))), "'base', inertial origin, xyz"),
        (tree(hinge("j", "base", "a", FAR), hinge("k", "a", "b")), "joint 'j' origin, xyz"),
        (
            tree(hinge("j", "base", "a", kind="prismatic", limit=1e4), hinge("k", "a", "b")),
            "joint 'j', lower limit",
        ),
    ],
)
def test_lengths_beyond_a_kilometre_are_refused_by_name(text, message):
    with pytest.raises(fp.InvalidInput, match=rf"made, .*{message}: got .*at most 1000 m"):
        robot_from_urdf(text, "made")


def test_lengths_of_a_kilometre_are_taken():
    text = urdf(body("base", box((1000, 1, 1), (-1000, 0, 0))))
    scene = fp.Scene([[500.0, 0.0, 0.0]], [1.0])
    robot = robot_from_urdf(text, "made")
    assert fp.clearance(robot, scene, robot.neutral()) == pytest.approx(999.0, abs=1e-9)


@pytest.mark.parametrize("place", ["inertial", "joint 'j'"])
@pytest.mark.parametrize("key", ["xyz", "rpy"])
def test_an_origin_that_is_not_finite_is_refused(place, key):
    options = {key: (0.0, float("nan"), 0.0)}
    own = options if place == "inertial" else {}
    text = urdf(
        body("base"),
        link("a", inertial(1.0, (1.0, 1.0, 1.0), **own)),
        hinge("j", "base", "a", **({} if own else options)),
    )
    with pytest.raises(fp.InvalidInput, match=rf"{place} origin, {key}.*3 finite numbers"):
        robot_from_urdf(text, "made")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (urdf(), "links: got 0; allowed: 1 to 1000"),
        (urdf("<link/>"), "link number 0, name: got None"),
        (urdf(body("base"), body("base")), "link 'base', name: .*one link only"),
        (tree(hinge("j", "base", "a"), hinge("j", "a", "b")), "joint 'j', name: .*one joint only"),
        (tree(hinge("", "base", "a")), "joint number 0, name: got ''"),
        (tree(hinge("j", "base", "a")), r"root links: got \['base', 'b'\]"),
        (
            tree(hinge("j", "bose", "a"), hinge("k", "a", "b")),
            "joint 'j', parent: got 'bose'.*did you mean 'base'",
        ),
        (tree(hinge("j", "base", "c"), hinge("k", "a", "b")), "joint 'j', child: got 'c'"),
        (
            tree("<joint name='j' type='fixed'><child link='a'/></joint>"),
            "joint 'j', parent: got None",
        ),
        (
            tree(hinge("j", "base", "b"), hinge("k", "a", "b")),
            "joint 'k', child: got 'b'.*no other joint",
        ),
        (
            tree(hinge("j", "a", "b"), hinge("k", "b", "a")),
            r"joints: got \['a', 'b'\].*carry each other",
        ),
        (tree(hinge("j", "base", "a"), hinge("k", "b", "b")), r"joints: got \['b'\]"),
    ],
)
def test_links_that_form_no_tree_are_refused_with_their_names(text, message):
    with pytest.raises(fp.InvalidInput, match=f"made, {message}"):
        robot_from_urdf(text, "made")


@pytest.mark.parametrize("kind", ["revolute", "continuous", "fixed"])
@pytest.mark.parametrize("key", ["effort", "velocity"])
@pytest.mark.parametrize("value", ["", "current='1'", "{}='nan'", "{}='-1'"])
def test_a_limit_without_effort_or_velocity_is_refused_by_joint(kind, key, value):
    text = urdf(body("base"), body("a"), hinge("j", "base", "a", kind=kind))
    wrong = text.replace(f"{key}='1'", value.format(key))
    with pytest.raises(fp.InvalidInput, match=f"made, joint 'j', limit, {key}"):
        robot_from_urdf(wrong, "made")


@pytest.mark.parametrize(
    ("part", "message"),
    [
        ("<axis xyz='foo'/>", "joint 'j', axis: got 'foo'"),
        ("<axis xyz='0 0 nan'/>", "joint 'j', axis: got '0 0 nan'"),
        ("<mimic joint='k' multiplier='x'/>", "joint 'j', mimic multiplier: got 'x'"),
        ("<dynamics damping='x'/>", "joint 'j', dynamics, damping: got 'x'"),
    ],
)
def test_wrong_numbers_of_a_fixed_joint_are_refused_although_they_mean_nothing(part, message):
    joint = f"<joint name='j' type='fixed'><parent link='base'/><child link='a'/>{part}</joint>"
    with pytest.raises(fp.InvalidInput, match=f"made, {message}"):
        robot_from_urdf(urdf(body("base"), body("a"), joint), "made")


@pytest.mark.parametrize("axis", ["0 0 0", "0 0 2", "0 0 1"])
def test_any_axis_of_a_fixed_joint_is_left_out(axis):
    parts = f"<parent link='base'/><child link='a'/><axis xyz='{axis}'/><mimic joint='k'/>"
    text = urdf(body("base"), body("a"), f"<joint name='j' type='fixed'>{parts}</joint>")
    assert robot_from_urdf(text, "made").model.nq == 7


def test_trees_too_deep_or_too_large_for_pinocchio_are_refused():
    with pytest.raises(fp.InvalidInput, match=r"501 joints in a row.*at most 500"):
        read_urdf(chain(502), "made")
    assert len(read_urdf(chain(501), "made").findall("link")) == 501
    with pytest.raises(fp.InvalidInput, match="links: got 1001; allowed: 1 to 1000"):
        read_urdf(chain(1001), "made")


def test_a_text_of_more_than_fifty_million_characters_is_refused(monkeypatch):
    monkeypatch.setattr(xml_reading, "MOST_CHARACTERS", 100)
    with pytest.raises(fp.InvalidInput, match="made: got '101 characters'; allowed: at most 100"):
        read_urdf("x" * 101, "made")


@pytest.mark.parametrize("name", ["universe", "root_joint"])
@pytest.mark.parametrize("kind", ["revolute", "fixed"])
def test_joints_named_like_pinocchios_own_are_refused(name, kind):
    """It would hang the link, or its mass, on the base."""
    text = urdf(body("base"), body("a"), hinge(name, "base", "a", kind=kind))
    with pytest.raises(fp.InvalidInput, match=f"joint '{name}', name: got '{name}'.*Pinocchio"):
        robot_from_urdf(text, "made")


def test_links_may_be_named_like_joints():
    text = urdf(
        body("base"),
        body("universe"),
        body("root_joint", sphere(0.1)),
        hinge("root", "base", "universe", kind="fixed"),
        hinge("base", "universe", "root_joint"),
    )
    robot = robot_from_urdf(text, "made")
    assert robot.joint_names == ("base",)
    assert fp.clearance(robot, fp.Scene([[3, 0, 0]], [0.1]), robot.neutral()) == pytest.approx(0.8)
    assert np.allclose(robot.model.inertias[1].lever, [0.5, 0, 0])


@pytest.mark.parametrize(
    ("scale", "message"),
    [(1e-6, "got 'm of 2e-06 m'.*at least 0.0001 m"), (1e3, "got 'm with 1500 m'.*at most 1000 m")],
)
def test_meshes_too_small_or_too_large_are_refused(scale, message):
    corners = [[0, 0, 0], [1.5, 0, 0], [0, 1, 0], [-0.5, 0, 1]]
    text = urdf(body("base", mesh("m", (scale,) * 3)))
    with pytest.raises(fp.InvalidInput, match=f"made, link 'base', collision mesh: {message}"):
        robot_from_urdf(text, "made", meshes={"m": corners})


FRAMES = ("", inertial(0.0, (0.0, 0.0, 0.0)))


@pytest.mark.parametrize("frame", FRAMES, ids=["no inertial", "zeros"])
def test_massless_frames_fixed_to_bodies_change_nothing(frame):
    """A tool frame, a mount between base and arm, and a mass that a frame carries."""
    parts = (
        body("base"),
        link("mount", frame),
        link("arm", frame),
        body("weight"),
        link("tool", frame),
        hinge("j", "base", "mount", kind="fixed"),
        hinge("k", "mount", "arm"),
        hinge("l", "arm", "weight", kind="fixed"),
        hinge("m", "weight", "tool", kind="fixed"),
    )
    robot = robot_from_urdf(urdf(*parts), "made")
    plain = urdf(
        body("base"),
        link("arm", inertial(1.0, (1.0, 1.0, 1.0), (1, 0, 0))),
        hinge("k", "base", "arm", (2, 0, 0)),
    )
    wanted = robot_from_urdf(plain, "plain").model.inertias
    for mine, other in zip(robot.model.inertias, wanted, strict=True):
        assert mine.isApprox(other)


@pytest.mark.parametrize("frame", FRAMES, ids=["no inertial", "zeros"])
def test_a_moving_body_without_mass_is_refused_by_name(frame):
    for tip in ("", link("tip", frame) + hinge("m", "b", "tip", kind="fixed")):
        text = urdf(
            body("base"),
            body("a"),
            link("b", frame),
            hinge("j", "base", "a"),
            hinge("k", "a", "b"),
            tip,
        )
        with pytest.raises(fp.InvalidInput, match="made, link 'b': got '0 kg'; allowed: a mass"):
            robot_from_urdf(text, "made")


@pytest.mark.parametrize(("mass", "moments"), [(0.0, (1.0, 1.0, 1.0)), (-1.0, (0.0, 0.0, 0.0))])
def test_inertia_without_mass_and_negative_mass_are_refused(mass, moments):
    text = urdf(
        body("base"),
        link("a", inertial(mass, moments)),
        hinge("j", "base", "a", kind="fixed"),
    )
    with pytest.raises(fp.InvalidInput, match=r"made, link 'a', mass: got .*greater than 0 kg, or"):
        robot_from_urdf(text, "made")
