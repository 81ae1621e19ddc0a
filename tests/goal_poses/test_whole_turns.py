"""Goals by pose take the shorter way of joints whose limits span more than a turn."""

import math

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.frame_poses import angles_of, pose_of
from tests.helpers.urdf_builders import box, inertial, joint, link, urdf

REACH, FORE = 0.9, 0.6
MODES = list(Mode)


def crane(limit, kind="revolute"):
    """A shoulder with wide limits and an elbow, both about z."""
    return robot_from_urdf(
        urdf(
            link("base", inertial(30.0, (3.0, 3.0, 4.0)), box((0.4, 0.4, 0.4))),
            link("boom", inertial(3.0, (0.01, 0.3, 0.3), (REACH / 2, 0, 0))),
            link("fore", inertial(1.0, (0.01, 0.1, 0.1), (FORE / 2, 0, 0))),
            link("hook", inertial(0.1, (0.001,) * 3)),
            joint("shoulder", kind, "base", "boom", (0.3, 0, 0), limit=limit),
            joint("elbow", "revolute", "boom", "fore", (REACH, 0, 0), limit=2.5),
            joint("wrist", "revolute", "fore", "hook", (FORE, 0, 0), limit=2.5),
        ),
        "crane",
    )


@pytest.mark.parametrize("limit", [2.0 * math.pi, 20.0, 1e3, 1e6])
@pytest.mark.parametrize("angle", [2.5, -2.9])
def test_no_joint_goes_a_whole_turn_out_of_its_way(limit, angle):
    robot = crane(limit)
    target = (0.3 + REACH * math.cos(angle), REACH * math.sin(angle), 0.0)
    q = fp.inverse_kinematics(
        robot, None, "fore", target, start=robot.configuration(), mode="attitude-held"
    )
    assert robot.joint_values(q)[0] == pytest.approx(angle, abs=1e-6)


def test_limits_may_make_the_longer_way_the_only_one():
    robot = crane(4.0)
    start = robot.configuration(joints={"shoulder": 3.5})
    target = (0.3 + REACH * math.cos(-1.0), REACH * math.sin(-1.0), 0.0)
    q = fp.inverse_kinematics(robot, None, "fore", target, start=start, mode="attitude-held")
    assert robot.joint_values(q)[0] == pytest.approx(-1.0, abs=1e-6)


@pytest.mark.parametrize("mode", MODES)
def test_a_real_arm_takes_the_shorter_way_in_every_mode(mode):
    robot, rng = fp.load_robot("satellite_ur5"), np.random.default_rng(6)
    for _ in range(8):
        begin = rng.uniform(-1.5, 1.5, robot.nd)
        end = np.clip(begin + rng.uniform(-1.5, 1.5, robot.nd), robot.lower, robot.upper)
        start, there = (
            robot.configuration(joints=dict(zip(robot.joint_names, v.tolist(), strict=True)))
            for v in (begin, end)
        )
        last = Motion(robot, mode, start, there, np.zeros((2, 3))).configurations()[-1]
        position, rotation = pose_of(robot, last, "arm_tool0")
        q = fp.inverse_kinematics(
            robot, None, "arm_tool0", position, angles_of(rotation), start=start, mode=mode
        )
        change = robot.joint_values(q) - begin
        other = begin + change - 2.0 * np.pi * np.sign(change)
        allowed = (other >= robot.lower) & (other <= robot.upper)
        assert not np.any(allowed & (np.abs(change) > np.pi + 1e-6))
        reached = Motion(robot, mode, start, q, np.zeros((2, 3))).configurations()[-1]
        assert np.allclose(pose_of(robot, reached, "arm_tool0")[0], position, atol=1e-7)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("turn", [np.pi, np.pi - 1e-7, 3.0, -3.0])
def test_a_continuous_joint_reaches_up_to_half_a_turn(mode, turn):
    robot = crane(0.0, "continuous")
    start = robot.configuration(joints={"shoulder": 2.5})
    there = robot.configuration(joints={"shoulder": 2.5 + turn})
    last = Motion(robot, mode, start, there, np.zeros((2, 3))).configurations()[-1]
    position, rotation = pose_of(robot, last, "fore")
    q = fp.inverse_kinematics(
        robot, None, "fore", position, angles_of(rotation), start=start, mode=mode
    )
    assert robot.joint_change(start, q)[0] == pytest.approx(turn, abs=1e-6)


def test_joint_values_that_the_user_gives_are_kept():
    robot = crane(2.0 * math.pi)
    ends = [robot.configuration(joints={"shoulder": v}) for v in (-3.0, 3.0)]
    problem = fp.Problem(robot, fp.Scene(), *ends, "attitude-held", fp.Lattice(4))
    assert problem.joint_displacement[0] == 6.0
