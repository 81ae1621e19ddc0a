"""Momentum conservation: the connection, Eq. 1 and the generalized Jacobian."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.dynamics import momentum
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.urdf_builders import (
    box,
    inertial,
    joint,
    link,
    random_configuration,
    random_robot,
    urdf,
)

seeds = st.integers(0, 10_000)


def floating_velocity(robot, q, rate):
    """Base and joint velocity (nv,) at zero linear and angular momentum."""
    data = robot.model.createData()
    pin.computeCentroidalMap(robot.model, data, q)
    a = np.array(data.Ag)
    return np.concatenate([-np.linalg.solve(a[:, :6], a[:, 6:] @ rate), rate])


@given(seeds)
def test_the_connection_does_not_depend_on_the_base_pose(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    q = random_configuration(robot, rng)
    elsewhere = np.array(q)
    elsewhere[:7] = random_configuration(robot, rng)[:7]
    a, b = momentum.connection(robot, q), momentum.connection(robot, elsewhere)
    assert np.allclose(a, b, rtol=1e-10, atol=1e-12)


@given(seeds)
def test_angular_momentum_vanishes_whatever_the_thrusters_do(seed):
    """The base moves at any linear velocity; the sum runs over bodies, not over the matrix."""
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    q = random_configuration(robot, rng)
    rate = rng.normal(size=robot.nd)
    v = np.concatenate([rng.normal(size=3), momentum.connection(robot, q) @ rate, rate])
    total, scale = angular_momentum(robot, q, v)
    assert np.linalg.norm(total) <= 1e-12 * scale


def angular_momentum(robot, q, v):
    """Angular momentum about the centre of mass by bodies, and the sum of its terms' sizes."""
    model, data = robot.model, robot.model.createData()
    pin.forwardKinematics(model, data, q, v)
    com = pin.centerOfMass(model, data, q, v)
    drift = data.vcom[0].copy()
    total, scale = np.zeros(3), 0.0
    for j in range(1, model.njoints):
        body, pose, twist = model.inertias[j], data.oMi[j], data.v[j]
        turn = pose.rotation @ twist.angular
        arm = pose.act(body.lever) - com
        speed = pose.rotation @ (twist.linear + np.cross(twist.angular, body.lever)) - drift
        orbital = body.mass * np.cross(arm, speed)
        spin = pose.rotation @ body.inertia @ pose.rotation.T @ turn
        total += orbital + spin
        scale += body.mass * np.linalg.norm(arm) * np.linalg.norm(speed) + np.linalg.norm(spin)
    return total, max(scale, 1e-12)


@given(seeds)
@settings(max_examples=30)
def test_equation_1_matches_differences_of_integrated_angles(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    q = random_configuration(robot, rng)
    rate = rng.uniform(-1, 1, robot.nd)
    h = 1e-4
    theta = robot.joint_values(q)
    ways = [Reaction.along(robot, np.array([theta, theta + s * h * rate])) for s in (1, -1)]
    ahead, behind = (
        rotations.to_angles(rotations.multiply(q[3:7], way.increments[0])) for way in ways
    )
    measured = (np.mod(ahead - behind + np.pi, 2 * np.pi) - np.pi) / (2 * h)
    expected = momentum.attitude_rate_map(robot, q) @ rate
    assert np.allclose(expected, measured, rtol=1e-5, atol=1e-6)


def test_equation_1_says_that_it_is_singular_at_beta_90_degrees(robot):
    q = robot.configuration(attitude=(0.1, np.pi / 2, 0.2))
    with pytest.raises(fp.InvalidInput, match=r"beta.*singular"):
        momentum.attitude_rate_map(robot, q)


@given(seeds)
@settings(max_examples=30)
def test_the_generalized_jacobian_matches_finite_differences(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    model = robot.model
    q = random_configuration(robot, rng)
    rate = rng.uniform(-1, 1, robot.nd)
    frame = model.frames[-1].name
    h = 1e-5
    poses = []
    for s in (-1.0, 1.0):
        first = pin.integrate(model, q, 0.5 * s * h * floating_velocity(robot, q, rate))
        moved = pin.integrate(model, q, s * h * floating_velocity(robot, first, rate))  # midpoint
        data = model.createData()
        pin.framesForwardKinematics(model, data, moved)
        poses.append(data.oMf[model.getFrameId(frame)].copy())
    linear = (poses[1].translation - poses[0].translation) / (2 * h)
    angular = pin.log3(poses[1].rotation @ poses[0].rotation.T) / (2 * h)
    expected = momentum.generalized_jacobian(robot, q, frame) @ rate
    assert np.allclose(expected, np.concatenate([linear, angular]), atol=1e-6)


def test_a_ten_times_heavier_base_reacts_ten_times_less():
    def arm_on(mass):
        return robot_from_urdf(
            urdf(
                link("base", inertial(mass, (mass / 6,) * 3), box((0.4, 0.4, 0.4))),
                link("arm", inertial(1.0, (0.01, 0.05, 0.05), (0.3, 0, 0)), box((0.6, 0.1, 0.1))),
                joint("j", "revolute", "base", "arm", (0.3, 0.1, 0)),
            ),
            "made",
        )

    differences = []
    for mass in (1e4, 1e5, 1e6):
        robot = arm_on(mass)
        q = robot.configuration(joints={"j": 0.7})
        data = robot.model.createData()
        fixed = pin.computeFrameJacobian(
            robot.model, data, q, robot.model.getFrameId("arm"), pin.LOCAL_WORLD_ALIGNED
        )[:, 6:]
        differences.append(np.linalg.norm(momentum.generalized_jacobian(robot, q, "arm") - fixed))
    assert differences[0] / differences[1] == pytest.approx(10, rel=1e-3)
    assert differences[1] / differences[2] == pytest.approx(10, rel=1e-3)


def test_an_unknown_frame_is_named_with_the_nearest_one(robot):
    with pytest.raises(fp.InvalidInput, match="did you mean 'left_link_3'"):
        momentum.generalized_jacobian(robot, robot.neutral(), "left_link3")


def test_a_robot_without_arms_has_an_empty_connection(point):
    assert momentum.connection(point, point.neutral()).shape == (3, 0)
