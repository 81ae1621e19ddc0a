"""Compiled dynamics of paths against Pinocchio, and the laws of momentum."""

import numpy as np
import pinocchio as pin
import pytest

from ffsr_plan.core import rotations
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.inverse_dynamics import states_along
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.dynamics.path_dynamics import Prescribed, path_dynamics
from tests.helpers.urdf_builders import random_configuration, random_robot

SEEDS = range(12)


def random_points(robot, seed, count=20):
    """Points of a path at any attitudes, with any derivatives."""
    rng = np.random.default_rng(seed)
    q = np.array([random_configuration(robot, rng) for _ in range(count)])
    joints = np.array([robot.joint_values(each) for each in q])
    base, turn = rng.normal(size=(2, count, 2, 3))
    return Prescribed(q, joints, base, turn, rng.normal(size=(count, 2, robot.nd)))


def flown(seed, mode):
    """A random robot at random points of a path, its dynamics, and states at a random pace."""
    robot, mode = random_robot(seed, depth=3), Mode(mode)
    path = random_points(robot, seed)
    dynamics = path_dynamics(robot, mode, path)
    rng = np.random.default_rng(seed + 100)
    pace, acceleration = rng.uniform(0.1, 2.0, len(path.joints)), rng.normal(size=len(path.joints))
    return robot, path, dynamics, states_along(path, dynamics, pace, pace, acceleration)


def pinocchio_forces(robot, states):
    """(N, nv) forces without gravity and (N, 6) centroidal momentum and its rate, world axes."""
    model, data = robot.model.copy(), robot.model.createData()
    model.gravity = pin.Motion.Zero()
    forces, momentum, rate = [], [], []
    for q, v, a in zip(states.configurations, states.velocities, states.accelerations, strict=True):
        forces.append(pin.rnea(model, data, q, v, a).copy())
        pin.computeCentroidalMomentumTimeVariation(model, data, q, v, a)
        momentum.append(data.hg.vector.copy())
        rate.append(data.dhg.vector.copy())
    return np.array(forces), np.array(momentum), np.array(rate)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("mode", list(Mode))
def test_forces_are_those_of_the_newton_euler_algorithm(seed, mode):
    robot, path, _, states = flown(seed, mode)
    forces, _, _ = pinocchio_forces(robot, states)
    size = np.abs(forces).max()
    assert np.allclose(states.torques, forces[:, 6:], rtol=0.0, atol=1e-10 * size)
    quats = states.configurations[:, 3:7]
    assert np.allclose(
        rotations.rotate(rotations.inverse(quats), states.thrust),
        forces[:, :3],
        rtol=0.0,
        atol=1e-10 * size,
    )
    moment = forces[:, 3:6] - np.cross(centers_of_mass(robot, path.joints), forces[:, :3])
    assert np.allclose(states.wheel_torque, moment, rtol=0.0, atol=1e-10 * size)


@pytest.mark.parametrize("seed", SEEDS)
def test_momentum_and_its_rate_are_zero_where_the_base_reacts(seed):
    for mode in ("free-flying", "free-floating"):
        robot, _, _, states = flown(seed, mode)
        rows = slice(0 if mode == "free-floating" else 3, 6)
        _, momentum, rate = pinocchio_forces(robot, states)
        size = np.abs(states.torques).max() + robot.mass
        assert np.abs(momentum[:, rows]).max() < 1e-10 * size
        assert np.abs(rate[:, rows]).max() < 1e-10 * size


@pytest.mark.parametrize("seed", SEEDS)
def test_wheels_hold_the_momentum_of_base_and_arms(seed):
    robot, _, _, states = flown(seed, "attitude-held")
    _, momentum, _ = pinocchio_forces(robot, states)
    stored = rotations.rotate(states.attitudes, states.wheel_momentum)
    assert np.allclose(stored, -momentum[:, 3:], rtol=0.0, atol=1e-10 * np.abs(momentum).max())


@pytest.mark.parametrize("mode", list(Mode))
def test_prescribed_derivatives_are_met(mode):
    _, path, dynamics, _ = flown(3, mode)
    assert np.array_equal(dynamics.velocities[:, :, 6:], path.rates)
    still = np.zeros(len(path.joints))
    states = states_along(path, dynamics, still, still + 1.0, still)
    if mode != "free-floating":
        assert np.allclose(states.base_velocity, path.base[:, 0], atol=1e-12)
        assert np.allclose(states.base_acceleration, path.base[:, 1], atol=1e-12)
    if mode == "attitude-held":
        assert np.array_equal(states.angular_velocity, path.turn[:, 0])
        assert np.array_equal(states.accelerations[:, 3:6], path.turn[:, 1])


@pytest.mark.parametrize("mode", list(Mode))
def test_forces_are_quadratic_in_the_pace(mode):
    """The same path flown k times as slowly needs 1 / k^2 of every force."""
    _, path, dynamics, _ = flown(5, mode)
    rng = np.random.default_rng(0)
    pace, acceleration = rng.uniform(0.1, 2.0, 20), rng.normal(size=20)
    fast = states_along(path, dynamics, pace, pace, acceleration)
    slow = states_along(path, dynamics, pace, pace / 3.0, acceleration / 9.0)
    for name in ("accelerations", "thrust", "wheel_torque", "torques"):
        assert np.allclose(getattr(fast, name), 9.0 * getattr(slow, name), rtol=1e-12, atol=1e-12)
    for name in ("velocities", "wheel_momentum"):
        assert np.allclose(getattr(fast, name), 3.0 * getattr(slow, name), rtol=1e-12, atol=1e-12)


def test_states_have_names_for_what_scripts_ask_for():
    _, path, _, states = flown(1, "free-flying")
    assert np.array_equal(states.attitude, path.configurations[:, 3:7])
    assert np.array_equal(states.base_position, path.configurations[:, :3])
    assert np.array_equal(states.joint_positions, path.joints)
    assert np.array_equal(states.joint_velocities, states.velocities[:, 6:])
    assert np.array_equal(states.joint_accelerations, states.accelerations[:, 6:])
