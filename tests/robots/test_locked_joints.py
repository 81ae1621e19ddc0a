"""Joints that are fixed by name, and all that mimic them."""

import numpy as np
import pinocchio as pin
import pytest

import ffsr_plan as fp
from ffsr_plan.robots.kinematics import frame_index
from tests.helpers.urdf_builders import box, inertial, joint, link, urdf

HEAVY = inertial(1.0, (0.1, 0.1, 0.1))


def hand(mimic="joint='left' multiplier='-2' offset='0.05'", third=""):
    """A palm on a hinge, with a finger, one that follows it, and one that follows that."""

    def finger(name, side, followed):
        text = joint(name, "prismatic", "palm", f"{name}_tip", (0, side, 0), axis=(0, 1, 0))
        text = text.replace("'3.0'", "'0.4'").replace("'-3.0'", "'-0.4'")
        return text.replace("</joint>", f"<mimic {followed}/></joint>" if followed else "</joint>")

    return urdf(
        link("base", HEAVY, box((0.2, 0.2, 0.2))),
        *(link(name, HEAVY) for name in ("palm", "left_tip", "right_tip", "thumb_tip")),
        joint("wrist", "continuous", "base", "palm", (0.3, 0.1, 0)),
        finger("left", 0.1, ""),
        finger("right", -0.1, mimic),
        finger("thumb", 0.0, third),
    )


def load(tmp_path, text, **options):
    (tmp_path / "hand.urdf").write_text(text)
    return fp.load_robot(tmp_path / "hand.urdf", **options)


THIRD = "joint='right' multiplier='0.5' offset='0'"


@pytest.mark.parametrize("named", [{"left": -0.1}, {"right": 0.25}, {"thumb": 0.125}])
def test_any_joint_of_a_chain_of_followers_fixes_all(tmp_path, named):
    """left = -0.1, so right = -2 (-0.1) + 0.05 = 0.25, and thumb = 0.125."""
    robot = load(tmp_path, hand(third=THIRD), locked=named)
    assert robot.joint_names == ("wrist",)
    free = load(tmp_path, hand(mimic=""))
    values = {"left": -0.1, "right": 0.25, "thumb": 0.125}
    data = free.model.createData()
    pin.framesForwardKinematics(free.model, data, free.configuration(joints=values))
    for name in ("palm", "left_tip", "right_tip", "thumb_tip"):
        place = data.oMi[1].actInv(data.oMf[frame_index(free.model, name)])
        own = robot.model.createData()
        pin.framesForwardKinematics(robot.model, own, robot.neutral())
        np.testing.assert_allclose(
            own.oMf[frame_index(robot.model, name)].homogeneous, place.homogeneous, atol=1e-12
        )


@pytest.mark.parametrize(
    ("locked", "message"),
    [
        (None, r"joint 'right', mimic: got 'left'; allowed: .*locked={'left': ...}"),
        ({"lefd": 0.1}, "locked: got 'lefd'; .*did you mean 'left'"),
        ({"left": 0.5}, "locked 'left': got 0.5; .*at most 0.4"),
        ({"left": 0.3}, r"joint 'right', which follows from 'left': got -0\.5.*at least -0\.4"),
        ({"left": 0.1, "right": 0.2}, r"got 0.2; allowed: the -0.15 .*follows 'left'"),
        ({"wrist": "up"}, "locked 'wrist': got 'up'"),
        ([("left", 0.1)], r"locked: got \[\('left'"),
        ({"left": float("nan")}, "locked 'left': got nan"),
    ],
)
def test_what_cannot_be_locked_is_named(tmp_path, locked, message):
    with pytest.raises(fp.InvalidInput, match=message):
        load(tmp_path, hand(), locked=locked)


def test_both_of_a_pair_may_be_named_if_they_agree(tmp_path):
    robot = load(tmp_path, hand(), locked={"left": 0.1, "right": -0.15, "wrist": 9.0})
    assert robot.joint_names == ("thumb",)
    assert load(tmp_path, hand("joint='left' multiplier='0' offset='0.1'")).joint_names == (
        "wrist",
        "left",
        "thumb",
    )
    with pytest.raises(fp.InvalidInput, match=r"got 0\.2; allowed: the 0\.1"):
        load(tmp_path, hand("joint='left' multiplier='0' offset='0.1'"), locked={"right": 0.2})


def test_locked_joints_stay_locked_in_plans_and_scenarios(tmp_path):
    srdf = """<robot name='hand'>
      <group_state name='open' group='g'><joint name='left' value='0.4'/></group_state>
      <group_state name='raised' group='g'>
        <joint name='wrist' value='1'/><joint name='left' value='0.4'/>
      </group_state></robot>"""
    (tmp_path / "hand.srdf").write_text(srdf)
    (tmp_path / "hand.urdf").write_text(hand())
    (tmp_path / "one.toml").write_text(
        '[robot]\nurdf = "hand.urdf"\nsrdf = "hand.srdf"\nlocked = { right = -0.15, thumb = 0.0 }\n'
        '[goal]\nposition = [1, 0, 0]\nposture = "raised"\n[lattice]\ndivisions = 4\n'
    )
    problem = fp.load_scenario(tmp_path / "one.toml")
    assert problem.robot.joint_names == ("wrist",)
    assert problem.robot.postures == {"raised": {"wrist": 1.0}}
    plan = fp.plan(problem)
    plan.save(tmp_path / "plan.json")
    assert fp.Plan.load(tmp_path / "plan.json").problem.robot.urdf == problem.robot.urdf
    assert plan.verify(20).ok


def test_without_mimics_or_locks_the_text_stays(tmp_path):
    free = load(tmp_path, hand(mimic=""))
    assert load(tmp_path, hand(mimic=""), locked={}).urdf == free.urdf
    assert free.urdf.count("fixed") == hand(mimic="").count("fixed")


def test_the_locks_of_a_mount_cannot_be_changed():
    mount = fp.Mount("z1", locked={"jointGripper": -0.5})
    with pytest.raises(TypeError, match="read-only"):
        mount.locked["joint1"] = 0.0
