"""Links and joints of one name, and joints that cannot be at zero."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.robots.kinematics import frame_index
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.urdf_builders import box, capsule, inertial, joint, link, urdf

MASS = inertial(5.0, (1.0, 1.0, 1.0))


def arm(**names):
    """A boom of 1.2 m with a tip; `names` are those of its two joints."""
    return urdf(
        link("bus", MASS, box((0.4, 0.4, 0.4))),
        link("boom", MASS, capsule(0.05, 0.8, (0.6, 0, 0), (0, np.pi / 2, 0))),
        link("tip"),
        joint(names.get("hinge", "hinge"), "revolute", "bus", "boom", (0.4, 0, 0), limit=2),
        joint(names.get("bolt", "bolt"), "fixed", "boom", "tip", (1.2, 0, 0)),
    )


@pytest.mark.parametrize(
    "names",
    [{}, {"bolt": "tip"}, {"hinge": "tip"}, {"hinge": "bus", "bolt": "boom"}, {"bolt": "bus"}],
)
def test_a_frame_is_the_link_of_its_name(tmp_path, names):
    """The hinge at 0.3 rad brings the tip to (0.4 + 1.2 cos 0.3, 1.2 sin 0.3)."""
    robot = robot_from_urdf(arm(**names), "arm")
    place = (0.4 + 1.2 * np.cos(0.3), 1.2 * np.sin(0.3), 0.0)
    wanted = {"start": robot.neutral(), "mode": "attitude-held"}
    q = fp.inverse_kinematics(robot, None, "tip", place, **wanted)
    assert robot.joint_values(q) == pytest.approx([0.3], abs=1e-7)
    plain = robot_from_urdf(arm(), "arm")
    for frame in ("tip", "boom", "bus"):
        found, expected = (
            fp.momentum.generalized_jacobian(each, each.neutral(), frame) for each in (robot, plain)
        )
        np.testing.assert_allclose(found, expected, atol=1e-12)
    (tmp_path / "arm.urdf").write_text(arm(**names))
    (tmp_path / "one.toml").write_text(
        '[robot]\nurdf = "arm.urdf"\nmode = "attitude-held"\n[goal]\n'
        f'end_effector = {{ frame = "tip", position = {[float(x) for x in place]} }}\n'
        "[lattice]\ndivisions = 4\n"
    )
    problem = fp.load_scenario(tmp_path / "one.toml")
    assert robot.joint_values(problem.goal) == pytest.approx([0.3], abs=1e-7)
    mirrored = problem.reaching("tip", (place[0], -place[1], 0.0))
    assert robot.joint_values(mirrored.goal) == pytest.approx([-0.3], abs=1e-7)


def test_joints_are_frames_too_and_others_are_refused():
    robot = robot_from_urdf(arm(), "arm")
    assert robot.model.frames[frame_index(robot.model, "hinge")].name == "hinge"
    for wrong in ("tipp", None, np.zeros(2)):
        with pytest.raises(fp.InvalidInput, match=r"frame: got .*allowed: .*tip"):
            frame_index(robot.model, wrong)


def test_neutral_is_valid_where_limits_exclude_zero():
    text = arm().replace("lower='-2' upper='2'", "lower='0.3' upper='2'")
    low = robot_from_urdf(text, "arm")
    high = robot_from_urdf(text.replace("'0.3' upper='2'", "'-2' upper='-0.5'"), "arm")
    for robot, value in ((low, 0.3), (high, -0.5), (robot_from_urdf(arm(), "arm"), 0.0)):
        assert robot.joint_values(robot.neutral()).tolist() == [value]
        robot.check_configuration("q", robot.neutral())
        assert robot.joint_values(robot.configuration((1, 0, 0))).tolist() == [value]
    with pytest.raises(fp.InvalidInput, match=r"joint hinge.*got 0\.0; allowed: 0\.3 to 2"):
        low.configuration(joints={"hinge": 0.0})
