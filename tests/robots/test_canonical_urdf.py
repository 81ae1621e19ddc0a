"""One canonical text: what is read, what is refused with its cause, and what is left out."""

from xml.etree import ElementTree

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.urdf_builders import box, capsule, inertial, joint, link, urdf

MASS = inertial(2.0, (0.1, 0.2, 0.25))
ALONG = capsule(0.05, 0.8, (0.4, 0.0, 0.0), (0.0, np.pi / 2, 0.0))
HINGE = joint("j", "revolute", "base", "arm", (0.5, 0.1, 0.2), (0.1, 0.2, 0.3))
TEXT = urdf(
    link("base", inertial(20.0, (2.0, 2.0, 2.0)), box((0.8, 0.8, 0.8))),
    link("arm", inertial(2.0, (0.01, 0.2, 0.2), (0.4, 0, 0)), ALONG),
    HINGE,
)
HALF = repr(float(np.sqrt(0.5)))


def changed(*pairs, text=TEXT):
    for old, new in pairs:
        assert old in text, old
        text = text.replace(old, new)
    return text


def read(text):
    return robot_from_urdf(text, "made")


def tip_clearance(text):
    """Clearance of a small ball a little beyond the arm's tip."""
    robot = read(text)
    end = robot.model.frames[robot.model.getFrameId("arm")]
    assert end.name == "arm"
    place = robot.model.jointPlacements[2]
    ball = place.act(np.array([0.9, 0.0, 0.0]))
    return float(fp.clearance(robot, fp.Scene([ball], [0.01]), robot.neutral()))


@pytest.mark.parametrize("spelling", ["0.2 ", " 0.2", "0.2&#9;", "&#10;0.2", "+0.2", ".2", "2e-1"])
def test_blanks_and_other_spellings_of_a_number_mean_the_number(spelling):
    text = changed(("izz='0.2'", f"izz='{spelling}'"))
    assert read(text).model.inertias[2].isApprox(read(TEXT).model.inertias[2])


@pytest.mark.parametrize(
    "spelling",
    ["0.2_0", "0.2&#160;", "0.\uff12", "\u0660.2", "0x1", "2d-1", "0.2f", "nan", "infinity", "0,2"],
)
def test_numbers_that_readers_disagree_about_are_refused(spelling):
    text = changed(("izz='0.2'", f"izz='{spelling}'"))
    with pytest.raises(fp.InvalidInput, match=r"made, link 'arm', izz: .*plain digits \(line 1"):
        read(text)


@pytest.mark.parametrize("version", ["", "version='1.0'", "version='1.1'", "version=' 1.2 '"])
def test_a_quaternion_is_read_like_the_same_angles(version):
    turned = changed(
        ("name='made'", f"name='made' {version}"),
        ("rpy='0.0 1.5707963267948966 0.0'", f"quat_xyzw='0 {HALF} 0 {HALF}'"),
    )
    assert tip_clearance(turned) == pytest.approx(tip_clearance(TEXT), abs=1e-12)
    assert "quat" not in read(turned).urdf


def test_quaternions_of_joints_and_inertials_reach_verification_and_compose(tmp_path):
    q = f"quat_xyzw='0 0 {HALF} {HALF}'"
    lying = inertial(2.0, (0.01, 0.2, 0.2), (0.4, 0, 0))
    text = changed(("rpy='0.1 0.2 0.3'", q), (lying, lying.replace("rpy='0.0 0.0 0.0'", q)))
    (tmp_path / "arm.urdf").write_text(text)
    robot = fp.load_robot(tmp_path / "arm.urdf")
    both = [robot, fp.compose(fp.Bus((1, 1, 1), 100.0), [fp.Mount(tmp_path / "arm.urdf")])]
    for each in both:
        assert np.allclose(each.model.jointPlacements[2].rotation[:, 0], [0, 1, 0], atol=1e-12)
        assert np.allclose(np.diag(each.model.inertias[2].inertia), [0.2, 0.01, 0.2])
    start, goal = (robot.configuration((x, 0, 0), joints={"j": x}) for x in (0.0, 1.0))
    scene = fp.Scene([[0.5, 3.0, 0.0]], [0.2])
    plan = fp.plan(fp.Problem(robot, scene, start, goal, lattice=fp.Lattice(5, fp.Axis(2, 0.2))))
    assert plan.verify(samples=20).problems == ()


@pytest.mark.parametrize(
    ("pairs", "message"),
    [
        ([("rpy='0.1", "rpyy='0.1")], "joint 'j' origin, attribute: got 'rpyy'.*mean 'rpy'"),
        ([("rpy='0.1", "RPY='0.1")], "joint 'j' origin, attribute: got 'RPY'"),
        ([("xyz='0.5", "XYZ='0.5")], "joint 'j' origin, attribute: got 'XYZ'"),
        ([("xyz='0.5", "position='0.5")], "joint 'j' origin, attribute: got 'position'"),
        ([("upper=", "uper=")], "joint 'j', limit, attribute: got 'uper'.*mean 'upper'"),
        ([("<mass value='2.0'", "<mass Value='2.0'")], "'arm', mass, attribute: got 'Value'"),
        ([("radius=", "radios=")], "'arm', collision capsule, attribute: got 'radios'.*'radius'"),
        ([("rpy='0.1 0.2 0.3'", "rpy='0 0 0' quat_xyzw='0 0 0 1'")], "rpy and quat_xyzw.*one of"),
        ([("rpy='0.1 0.2 0.3'", "quat_xyzw='0 0 0 2'")], "origin, quat_xyzw: .*length 1"),
        ([("<axis", "<Axis")], "joint 'j': got 'Axis'.*mean 'axis'"),
        ([("<axis", "<box size='1 1 1'/><axis")], "joint 'j': got '<box>'.*no such element"),
        ([("<collision>", "<p:collision>"), ("</collision>", "</p:collision>")], "out a prefix"),
        ([("='arm'><inertial>", "='arm'><origin xyz='1 0 0'/><inertial>")], "got '<origin>'"),
        ([("name='made'", "name=''")], "robot name: got ''; allowed: a name"),
        ([("name='made'", "name='made' version='2.0'")], "robot version: got '2.0'.*1.0, 1.1, 1.2"),
        ([("<axis", "<dynamics damping='a'/><axis")], "joint 'j', dynamics, damping: got 'a'"),
        ([("velocity='1'", "velocity='1&#160;'")], "joint 'j', limit, velocity"),
        ([("'revolute'", "'floating'")], "joint 'j', type: got .*an empty root link"),
        ([("'revolute'", "'planar'")], "joint 'j', type: got 'planar'"),
        ([("upper='3.0'", "upper='3.0' acceleration='0'")], "acceleration: got 0.0.*greater than"),
        ([("<box size='0.8 0.8 0.8'/>", "<box size='0.8 0.8'/>")], "collision box, size.*3 finite"),
    ],
)  # fmt: skip
def test_faults_are_refused_with_part_cause_and_line(pairs, message, capfd):
    text = changed(*pairs)
    with pytest.raises(fp.InvalidInput, match=f"^made, .*{message}.*line 1, column"):
        read(text)
    assert capfd.readouterr() == ("", "")


OTHER = "xmlns:m='http://www.ros.org/wiki/xacro'"
XACRO = "xmlns:xacro='http://www.ros.org/wiki/xacro'"


@pytest.mark.parametrize(
    ("pairs", "found"),
    [
        ([("</robot>", "<xacro:include filename='a'/></robot>")], "<xacro:include>"),
        ([("</link>", "<gazebo><a><xacro:arm/></a></gazebo></link>")], "<xacro:arm>"),
        ([("name='made'", f"name='made' {OTHER}"), ("</robot>", "<m:if/></robot>")], "<m:if>"),
        ([("<link name='arm'>", "<link name='arm' xacro:x='1'>")], "<link xacro:x>"),
        ([("value='2.0'", "value='${m}'")], r"\$\{m\}"),
        ([("'j' type", "'$(arg j)' type")], r"\$\(arg j\)"),
    ],
)  # fmt: skip
def test_xacro_that_was_not_expanded_is_refused_at_any_depth(pairs, found):
    with pytest.raises(fp.InvalidInput, match=f"made.*{found}.*xacro in.xacro > out.urdf"):
        read(changed(*pairs))


def test_elements_of_other_tools_and_a_declared_xacro_are_left_out():
    text = changed(
        ("name='made'", f"name='made' {XACRO}"),
        ("</robot>", "<gazebo><plugin file='$(find a)'/></gazebo><drake:x y='1'/></robot>"),
        ("</link>", "<contact><stiffness value='1'/></contact></link>"),
        ("</joint>", "<calibration rising='x'/><dynamics/></joint>"),
    )
    robot = read(text)
    assert robot.model == read(TEXT).model
    tags = {element.tag for element in ElementTree.fromstring(robot.urdf).iter()}
    assert not tags & {"gazebo", "drake:x", "contact", "calibration", "dynamics"}


@pytest.mark.parametrize("name", ["planar_dual_arm", "satellite_ur5", "point"])
def test_reading_the_canonical_text_gives_the_same_text(name):
    text = fp.load_robot(name).urdf
    assert robot_from_urdf(text, name, collision="ignore").urdf == text


def test_a_world_that_carries_the_base_is_removed():
    world = (
        "<link name='world'/><joint name='free' type='floating'><parent link='world'/>"
        "<child link='base'/></joint></robot>"
    )
    robot = read(changed(("</robot>", world)))
    assert robot.model == read(TEXT).model
    assert robot.joint_names == ("j",)
    heavy = world.replace("<link name='world'/>", f"<link name='world'>{MASS}</link>")
    with pytest.raises(fp.InvalidInput, match="joint 'free', type: got \"link 'world' with an in"):
        read(changed(("</robot>", heavy)))
    twice = world.replace(
        "</robot>", link("w2") + joint("f2", "floating", "w2", "world", (0, 0, 0))
    )
    with pytest.raises(fp.InvalidInput, match=r"joint 'free', type: got 'floating'.*once"):
        read(changed(("</robot>", twice + "</robot>")))


def test_limits_of_urdf_1_2_are_on_the_robot_and_in_its_file(tmp_path):
    wheel = link("c", MASS, box((0.1, 0.1, 0.1)))
    wheel += joint("k", "continuous", "arm", "c", (2, 0, 0))
    text = changed(
        ("upper='3.0'", "upper='3.0' acceleration='4' deceleration='2.5' jerk='90'"),
        ("</robot>", wheel + "</robot>"),
    )
    read(text).save(tmp_path / "made.urdf")
    for robot in (read(text), fp.load_robot(tmp_path / "made.urdf")):
        order = [robot.joint_names.index(name) for name in ("j", "k")]
        assert robot.acceleration[order].tolist() == [2.5, np.inf]
        assert robot.jerk[order].tolist() == [90.0, np.inf]
        assert robot.rate_limits["j"] == fp.RateLimits(2.5, 90.0)


def test_an_axis_of_nearly_unit_length_is_normalised_for_all():
    robot = read(changed(("axis xyz='0.0 0.0 1.0'", "axis xyz='0.0 0.6 0.8003'")))
    (axis,) = ElementTree.fromstring(robot.urdf).iter("axis")
    values = np.array(axis.get("xyz").split(), dtype=float)
    assert np.linalg.norm(values) == pytest.approx(1.0, abs=1e-15)


def test_a_byte_order_mark_is_skipped_and_an_lfs_pointer_named(tmp_path):
    path = tmp_path / "made.urdf"
    path.write_bytes(b"\xef\xbb\xbf" + TEXT.encode())
    assert fp.load_robot(path).nd == 1
    assert read("\ufeff" + TEXT).nd == 1
    path.write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n")
    with pytest.raises(fp.InvalidInput, match=r"made.urdf.*git lfs pull"):
        fp.load_robot(path)


def test_well_formed_xml_is_asked_for_with_line_and_column():
    with pytest.raises(fp.InvalidInput, match="made: got 'mismatched tag: line 2, column"):
        read(TEXT.replace("</robot>", "\n</robots>"))
    with pytest.raises(fp.InvalidInput, match="at most 100 elements inside one another"):
        read(TEXT.replace("</robot>", "<a>" * 150 + "</a>" * 150 + "</robot>"))
