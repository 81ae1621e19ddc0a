"""Limits of a flight: their defaults, their checks, and the limits on x along each run."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.trajectory.flight_limits import read_limits
from ffsr_plan.trajectory.straight_runs import straight_runs
from tests.helpers.random_motions import USUAL, bent_motion, flown, read


def test_limits_of_x_are_the_tightest_along_each_run():
    motion, rng = bent_motion(3, "attitude-held"), np.random.default_rng(3)
    runs, robot = straight_runs(motion), motion.robot
    names = np.array([
        ["base_velocity", "turn_velocity", "joint_velocity"],
        ["thruster_acceleration", "turn_acceleration", "joint_acceleration"],
        ["thruster_jerk", "none", "joint_jerk"],
    ])  # fmt: skip
    binding = set()
    for _ in range(30):
        values = 10.0 ** rng.uniform(-2.0, 2.0, (3, 3))
        values[2, 1] = np.inf
        given = dict(zip(names.ravel().tolist(), values.ravel().tolist(), strict=True))
        given.pop("none")
        found = read(robot, **given).along(runs)
        for k in range(len(runs.first)):
            rates = np.array([
                np.linalg.norm(runs.base[k]), np.linalg.norm(runs.turn[k]),
                np.abs(runs.joints[k]).max(),
            ])  # fmt: skip
            due = values / rates
            assert np.allclose([each[k] for each in found], due.min(axis=1), rtol=1e-12)
            binding |= set(names[np.arange(3), due.argmin(axis=1)].tolist())
    assert len(binding) == 8


def test_limits_by_name_are_those_of_their_joints():
    robot = bent_motion(3, "free-floating").robot
    numbers = {name: 0.1 + k for k, name in enumerate(robot.joint_names)}
    found = read(robot, joint_acceleration=numbers, joint_jerk=numbers, joint_torque=numbers)
    values = list(numbers.values())
    assert np.array_equal(found.acceleration[2:], values)
    assert np.array_equal(found.jerk[2:], values)
    assert np.array_equal(found.torque, values)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"thruster_acceleration": 0.01}, "joint_acceleration, joint left_1: got None"),
        ({"joint_acceleration": 0.1}, "thruster_acceleration: got None"),
        ({"joint_acceleration": 0.1, "thruster_acceleration": 0.0}, "greater than 0"),
        ({"joint_acceleration": -0.1, "thruster_acceleration": 0.1}, "greater than 0"),
        ({"joint_acceleration": {"left_9": 0.1}}, "did you mean 'left_1'|left_1"),
        ({"joint_acceleration": {"left_1": "fast"}}, r"joint_acceleration\.left_1"),
        ({"joint_velocity": np.nan}, "joint_velocity"),
        ({"velocity_jump": -0.1}, "at least 0"),
        ({"velocity_jump": 0.01, "joint_jerk": 0.1}, "a jump has an infinite jerk"),
        ({"base_velocity": True}, "base_velocity"),
    ],
)
def test_limits_that_are_missing_or_cannot_be_are_named(fig2a_plan, given, message):
    with pytest.raises(fp.InvalidInput, match=message):
        fig2a_plan.timed(**given)


def test_a_base_that_wheels_turn_needs_a_limit_for_it():
    motion = bent_motion(7, "attitude-held")
    with pytest.raises(fp.InvalidInput, match="turn_acceleration"):
        flown(motion, joint_acceleration=0.1, thruster_acceleration=0.1)


def test_joints_keep_the_urdfs_velocities_by_default(robot):
    start = robot.configuration()
    goal = robot.configuration(joints={"left_1": 1.6, "right_1": 0.8})
    motion = Motion(robot, "free-floating", start, goal, np.zeros((4, 3)))
    own = flown(motion, joint_acceleration=1.0)
    assert own.duration == pytest.approx(1.6 / 0.5 + 0.5 / 1.0)  # the URDF allows 0.5 rad/s
    told = flown(motion, joint_acceleration=1.0, joint_velocity={"right_1": 0.1})
    assert told.duration == pytest.approx(0.8 / 0.1 + 0.1 / 0.5)  # it is half as fast as left_1


def test_joints_keep_the_urdfs_accelerations_and_jerks_by_default(robot):
    text = robot.urdf.replace('velocity="0.5"', 'velocity="0.5" acceleration="0.2"')
    urged = robot_from_urdf(text, "limited")
    start, goal = urged.configuration(), urged.configuration(joints={"left_1": 1.6})
    motion = Motion(urged, "free-floating", start, goal, np.zeros((4, 3)))
    assert flown(motion).duration == pytest.approx(1.6 / 0.5 + 0.5 / 0.2)
    told = flown(motion, joint_acceleration=1.0)
    assert told.duration == pytest.approx(1.6 / 0.5 + 0.5 / 1.0)
    smooth = robot_from_urdf(text.replace('velocity="0.5"', 'velocity="0.5" jerk="0.4"'), "jerk")
    motion = Motion(smooth, "free-floating", start, goal, np.zeros((4, 3)))
    assert flown(motion).duration == pytest.approx(1.6 / 0.5 + 0.5 / 0.2 + 0.2 / 0.4)
    way = np.array([(0, 0, 0), (1, 1, 0), (2, 0, 0)], dtype=float)
    motion = Motion(
        smooth, "free-flying", start, smooth.configuration((2, 0, 0), joints={"left_1": 1}), way
    )
    with pytest.raises(fp.InvalidInput, match=r"velocity_jump: .* URDF .* jerk of joint left_1"):
        flown(motion, thruster_acceleration=0.1, velocity_jump=0.1)


def test_a_velocity_of_zero_in_the_urdf_is_not_taken_for_a_limit(robot):
    still = robot_from_urdf(robot.urdf.replace('velocity="0.5"', 'velocity="0"'), "still")
    start, goal = still.configuration(), still.configuration(joints={"left_1": 1.0})
    motion = Motion(still, "free-floating", start, goal, np.zeros((4, 3)))
    with pytest.raises(fp.InvalidInput, match="joint_velocity, joint left_1: got 0"):
        flown(motion, joint_acceleration=1.0)
    assert flown(motion, joint_acceleration=1.0, joint_velocity=1.0).duration > 0.0


def test_a_plan_that_leads_nowhere_has_no_time_law(robot):
    q = robot.configuration()
    with pytest.raises(fp.InvalidInput, match="nothing moves"):
        flown(Motion(robot, "free-flying", q, q, np.zeros((4, 3))), **USUAL)


LIMITS = (
    "base_velocity",
    "thruster_acceleration",
    "thruster_jerk",
    "velocity_jump",
    "turn_velocity",
    "turn_acceleration",
)
LACKING = {
    "free-flying": ("turn_velocity", "turn_acceleration"),
    "attitude-held": (),
    "free-floating": LIMITS,
}


@pytest.mark.parametrize("mode", LACKING)
def test_a_limit_of_what_a_mode_does_not_have_is_refused(robot, mode):
    read_limits(robot, Mode(mode))
    for name in LIMITS:
        given = {"thruster_acceleration": 1.0} if name == "velocity_jump" else {}
        given[name] = 0.1
        if name in LACKING[mode]:
            with pytest.raises(InvalidInput, match=r"allowed: none in the mode"):
                read_limits(robot, Mode(mode), **given)
        else:
            read_limits(robot, Mode(mode), **given)
