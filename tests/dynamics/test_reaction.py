"""The reaction of joint segments: closed forms and laws."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ffsr_plan.core import rotations
from ffsr_plan.dynamics.momentum import connections
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.urdf_builders import box, inertial, joint, link, random_robot, urdf

seeds = st.integers(0, 10_000)
IDENTITY = rotations.IDENTITY


def total(robot, corners):
    return Reaction.along(robot, np.array(corners)).attitudes(IDENTITY)[-1]


def by_many_small_steps(robot, begin, end, steps):
    """The same rotation by the midpoint rule on the group: second order, other code."""
    theta = begin + (np.arange(steps)[:, None] + 0.5) / steps * (end - begin)
    rotation = IDENTITY
    for rate in connections(robot, theta) @ (end - begin):
        rotation = rotations.multiply(rotation, rotations.exp(rate / steps))
    return rotation


def path(robot, seed, corners=2, spread=1.5):
    return np.random.default_rng(seed).uniform(-spread, spread, (corners, robot.nd))


def test_the_dual_arm_rotates_its_base_as_in_closed_form():
    """13.3 kg base, two arms of two links; yaw from an independent closed form."""
    arm = []
    for side, y, yaw in (("left", 0.2, np.pi / 2), ("right", -0.2, -np.pi / 2)):
        for k, com in ((1, 0.1926), (2, 0.1635)):
            name = f"{side}_link_{k}"
            arm.append(link(name, inertial(2.9, (0.1, 0.1, 0.1245), (com, 0, 0))))
        arm.append(joint(f"{side}_1", "revolute", "base", f"{side}_link_1", (0, y, 0), (0, 0, yaw)))
        arm.append(
            joint(f"{side}_2", "revolute", f"{side}_link_1", f"{side}_link_2", (0.3852, 0, 0))
        )
    base = link("base", inertial(13.3, (0.285, 0.285, 0.285)), box((0.3, 0.3, 0.3)))
    robot = robot_from_urdf(urdf(base, *arm), "manisat")
    start = {"left_1": 0.2, "left_2": -0.5, "right_1": 0.1, "right_2": 0.4}
    change = {"left_1": 1.2, "left_2": -1.0, "right_1": -0.6, "right_2": 1.4}
    begin = np.array([start[name] for name in robot.joint_names])
    end = begin + np.array([change[name] for name in robot.joint_names])
    alpha, beta, gamma = rotations.to_angles(total(robot, [begin, end]))
    assert alpha == pytest.approx(-0.206117, abs=1e-6)
    assert abs(beta) < 1e-12
    assert abs(gamma) < 1e-12


@given(seeds)
@settings(max_examples=25)
def test_the_integrator_converges_to_many_small_steps(seed):
    robot = random_robot(seed)
    begin, end = path(robot, seed)
    reference = by_many_small_steps(robot, begin, end, 200)
    finer = by_many_small_steps(robot, begin, end, 400)
    error = rotations.angle_between(finer, reference)  # of second order: the finer has a third left
    assert rotations.angle_between(total(robot, [begin, end]), finer) <= 0.4 * error + 1e-10


@given(seeds)
@settings(max_examples=25)
def test_its_error_stays_below_1e_9_rad(seed):
    """One long segment is compared with a hundred short ones, and with its own bound."""
    robot = random_robot(seed)
    begin, end = path(robot, seed)
    whole = Reaction.along(robot, np.array([begin, end]))
    pieces = total(robot, np.linspace(begin, end, 101))
    assert rotations.angle_between(whole.increments[0], pieces) < 1e-9
    assert whole.errors[0] < 1e-10


@given(seeds)
@settings(max_examples=25)
def test_forward_then_backward_is_the_identity(seed):
    robot = random_robot(seed)
    corners = path(robot, seed, corners=4)
    there_and_back = np.concatenate([corners, corners[-2::-1]])
    assert rotations.angle_between(total(robot, there_and_back), IDENTITY) < 1e-9


@given(seeds)
@settings(max_examples=25)
def test_the_rotation_does_not_depend_on_the_timing(seed):
    robot = random_robot(seed)
    begin, end = path(robot, seed)
    uneven = np.sort(np.append(np.random.default_rng(seed).random(7), [0.0, 1.0]))
    resampled = begin + uneven[:, None] * (end - begin)
    difference = rotations.angle_between(total(robot, [begin, end]), total(robot, resampled))
    assert difference < 1e-9


def test_a_closed_joint_loop_turns_the_base(robot):
    """Holonomy: closed loops of the arms rotate a satellite."""
    a, b = np.zeros(6), np.zeros(6)
    a[0], b[1] = 1.2, 1.2
    turned = total(robot, [0 * a, a, a + b, b, 0 * a])
    assert rotations.angle_between(turned, IDENTITY) > 0.01


@given(seeds)
@settings(max_examples=25)
def test_a_mirror_symmetric_motion_does_not_turn_the_base(seed):
    from ffsr_plan import load_robot

    robot = load_robot("planar_dual_arm")
    left = np.random.default_rng(seed).uniform(-1, 1, (5, 3))
    mirrored = np.hstack([left, -left])  # both arms turn about +z
    assert rotations.angle_between(total(robot, mirrored), IDENTITY) < 1e-12
    lopsided = np.hstack([left, -0.5 * left])
    assert rotations.angle_between(total(robot, lopsided), IDENTITY) > 1e-6


def test_the_rotation_within_an_edge_leads_to_its_end(robot):
    corners = path(robot, 3, corners=3)
    reaction = Reaction.along(robot, corners)
    edges = np.array([0, 0, 1, 1])
    times = np.array([0.0, 1.0, 0.0, 1.0])
    got = reaction.rotation(edges, times)
    expected = [IDENTITY, reaction.increments[0], IDENTITY, reaction.increments[1]]
    assert np.allclose(got, expected, atol=1e-14)


def test_no_motion_of_the_arms_is_no_rotation(point, robot):
    still = np.zeros((3, 6))
    assert np.allclose(Reaction.along(robot, still).increments, IDENTITY)
    assert np.allclose(Reaction.along(point, np.zeros((3, 0))).increments, IDENTITY)
