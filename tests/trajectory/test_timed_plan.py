"""Flights: velocities, forces, momentum and energy along a timed plan."""

from itertools import pairwise

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.dynamics.wheel_momentum import wheel_momentum
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.random_motions import USUAL, bent_motion, flown, inside, straight_motion
from tests.helpers.urdf_builders import box, inertial, joint, link, urdf

SEEDS = (7, 39)  # robots with hinges and slides
seeds = st.integers(0, 10_000)
cases = pytest.mark.parametrize(
    ("seed", "mode", "joints_bend"),
    [(s, m, b) for s in SEEDS for m in list(Mode) for b in (False, True)],
)


def mass(robot):
    return sum(body.mass for body in list(robot.model.inertias)[1:])


def centers(robot, q):
    """(N, 3) centres of mass, world axes [m]."""
    data = robot.model.createData()
    return np.array([pin.centerOfMass(robot.model, data, each) for each in q])


def test_a_straight_flight_takes_twice_its_peak_speed_of_delta_v(point):
    """Closed form: 4 m at 0.01 m/s^2 without and with a limit on the speed."""
    motion = straight_motion(point, [(0, 0, 0), (4, 0, 0)])
    free = flown(motion, thruster_acceleration=0.01)
    assert free.duration == pytest.approx(2.0 * np.sqrt(4.0 / 0.01))
    assert free.delta_v == pytest.approx(2.0 * np.sqrt(4.0 * 0.01), rel=1e-12)
    slow = flown(motion, thruster_acceleration=0.01, base_velocity=0.05)
    assert slow.duration == pytest.approx(4.0 / 0.05 + 0.05 / 0.01)
    assert slow.delta_v == pytest.approx(2.0 * 0.05, rel=1e-12)
    smooth = flown(motion, thruster_acceleration=1e3, thruster_jerk=1e-3)
    assert smooth.duration == pytest.approx(4.0 * np.cbrt(4.0 / 2e-3))
    assert smooth.delta_v == pytest.approx(2.0 * 1e-3 * (smooth.duration / 4.0) ** 2, rel=1e-9)
    assert len(free.rests) == len(free.pulses) == free.corner_cut == 0


@cases
def test_velocities_and_accelerations_are_derivatives(seed, mode, joints_bend):
    motion = bent_motion(seed, mode, joints_bend=joints_bend)
    model, flight = motion.robot.model, flown(motion, **USUAL)
    times, h = inside(flight)
    now, before, after = (flight.at(t) for t in (times, times - h, times + h))
    pairs = zip(before.configurations, after.configurations, strict=True)
    h = 2.0 * h[:, None]
    rates = np.array([pin.difference(model, p, q) for p, q in pairs]) / h
    speeds = (after.configurations - before.configurations)[:, :3] / h
    size = 1e-5 * np.abs(now.velocities).max()
    assert np.allclose(rates, now.velocities, atol=size)
    assert np.allclose(speeds, now.base_velocity, atol=size)
    changes = (after.velocities - before.velocities) / h
    pushes = (after.base_velocity - before.base_velocity) / h
    size = 1e-5 * np.abs(now.accelerations).max()
    assert np.allclose(changes, now.accelerations, atol=size)
    assert np.allclose(pushes, now.base_acceleration, atol=size)


@given(seeds, st.sampled_from(list(Mode)), st.booleans(), st.booleans())
@settings(max_examples=12)
def test_no_limit_is_exceeded_and_some_limit_is_attained(seed, mode, joints_bend, smooth):
    motion = bent_motion(seed, mode, joints_bend=joints_bend)
    given = USUAL | {"joint_velocity": 0.15, "base_velocity": 0.3, "turn_velocity": 0.05}
    if smooth:
        given |= {"joint_jerk": 0.03, "thruster_jerk": 0.02}
    flight = flown(motion, **given)
    states = flight.at(np.linspace(0.0, flight.duration, 10_000))
    norm = np.linalg.norm
    shares = [
        np.abs(states.velocities[:, 6:]).max() / 0.15,
        np.abs(states.accelerations[:, 6:]).max() / 0.05,
    ]
    if mode != "free-floating":
        shares += [norm(states.base_velocity, axis=1).max() / 0.3]
        shares += [norm(states.base_acceleration, axis=1).max() / 0.02]
        shares += [norm(states.thrust, axis=1).max() / mass(motion.robot) / 0.02]
    if mode == "attitude-held":
        shares += [norm(states.velocities[:, 3:6], axis=1).max() / 0.05]
        shares += [norm(states.accelerations[:, 3:6], axis=1).max() / 0.01]
    if smooth:
        jerk = np.diff(states.accelerations[:, 6:], axis=0) * (9_999 / flight.duration)
        shares += [np.abs(jerk).max() / 0.03]  # the acceleration never jumps
        if mode != "free-floating":
            jerk = np.diff(states.base_acceleration, axis=0) * (9_999 / flight.duration)
            shares += [norm(jerk, axis=1).max() / 0.02]
    assert 0.95 < max(shares) < 1.0 + 1e-6


@given(seeds, st.sampled_from(list(Mode)))
@settings(max_examples=10)
def test_half_speed_and_quarter_acceleration_double_the_duration(seed, mode):
    motion = bent_motion(seed, mode)
    fast = flown(
        motion, joint_velocity=0.2, joint_acceleration=0.05, thruster_acceleration=0.02,
        turn_acceleration=0.01, base_velocity=0.2, joint_jerk=0.08,
    )  # fmt: skip
    slow = flown(
        motion, joint_velocity=0.1, joint_acceleration=0.05 / 4, thruster_acceleration=0.02 / 4,
        turn_acceleration=0.01 / 4, base_velocity=0.1, joint_jerk=0.08 / 8,
    )  # fmt: skip
    assert slow.duration == pytest.approx(2.0 * fast.duration, rel=1e-9)
    assert slow.delta_v == pytest.approx(fast.delta_v / 2.0, rel=1e-9, abs=1e-12)
    times, _ = inside(fast)
    one, other = fast.at(times), slow.at(2.0 * times)
    assert np.allclose(one.configurations, other.configurations, atol=1e-9)
    for name in ("thrust", "wheel_torque", "torques"):
        assert np.allclose(getattr(one, name), 4.0 * getattr(other, name), rtol=1e-6, atol=1e-9)


def test_configurations_are_the_plans_and_s_never_decreases(fig2a_plan):
    flight = fig2a_plan.timed(corners="rest", joint_acceleration=0.1, thruster_acceleration=0.01)
    states = flight.at(np.linspace(0.0, flight.duration, 2001))
    assert np.all(np.diff(states.parameters) >= 0.0)
    assert np.allclose(states.configurations, fig2a_plan.at(states.parameters), atol=1e-12)
    assert np.allclose(states.configurations[[0, -1]], fig2a_plan.configurations[[0, -1]])
    assert np.abs(states.velocities[[0, -1]]).max() < 1e-9
    assert len(flight.rests) > 10
    assert np.abs(flight.at(flight.rests).velocities).max() < 1e-9


@cases
def test_momentum_is_what_the_mode_says(seed, mode, joints_bend):
    motion = bent_motion(seed, mode, joints_bend=joints_bend)
    model, data = motion.robot.model, motion.robot.model.createData()
    flight = flown(motion, **USUAL)
    states = flight.at(inside(flight)[0])
    for q, v, stored in zip(
        states.configurations, states.velocities, states.wheel_momentum, strict=True
    ):
        momentum = pin.computeCentroidalMomentum(model, data, q, v)
        wheels = rotations.rotate(q[3:7], stored)
        assert np.allclose(momentum.angular + wheels, 0.0, atol=1e-9)
        if mode == "free-floating":
            assert np.allclose(momentum.linear, 0.0, atol=1e-9)


@cases
def test_thrust_is_mass_times_acceleration_of_the_mass_centre(seed, mode, joints_bend):
    motion = bent_motion(seed, mode, joints_bend=joints_bend)
    flight = flown(motion, **USUAL)
    times, h = inside(flight, share=1e-2)
    q = [flight.at(times + step).configurations for step in (-h, 0.0, h)]
    before, now, after = (centers(motion.robot, each) for each in q)
    pushes = mass(motion.robot) * (before - 2 * now + after) / h[:, None] ** 2
    thrust = flight.at(times).thrust
    assert np.allclose(thrust, pushes, atol=1e-4 * mass(motion.robot) * 0.02)
    assert np.all(thrust == 0.0) == (mode == "free-floating")


@cases
def test_delta_v_is_the_integral_of_thrust_over_mass(seed, mode, joints_bend):
    motion = bent_motion(seed, mode, joints_bend=joints_bend)
    flight = flown(motion, **USUAL)
    edges, total = flight.switch_times, 0.0
    for begin, end in pairwise(edges):
        times = np.linspace(begin, np.nextafter(end, 0.0), 200)
        push = np.linalg.norm(flight.at(times).thrust, axis=1) / mass(motion.robot)
        total += np.sum((push[1:] + push[:-1]) / 2.0 * np.diff(times))
    assert flight.delta_v == pytest.approx(total, rel=1e-4)
    if mode == "free-floating":
        assert flight.delta_v == 0.0


@cases
def test_the_work_of_all_forces_is_the_change_of_kinetic_energy(seed, mode, joints_bend):
    motion = bent_motion(seed, mode, joints_bend=joints_bend)
    robot, flight = motion.robot, flown(motion, **USUAL)
    data = robot.model.createData()

    def energy(times):
        states = flight.at(times)
        return np.array([
            pin.computeKineticEnergy(robot.model, data, q, v)
            for q, v in zip(states.configurations, states.velocities, strict=True)
        ])  # fmt: skip

    times, h = inside(flight)
    states = flight.at(times)
    q, v = states.configurations, states.velocities
    spin = rotations.rotate(q[:, 3:7], v[:, 3:6])
    # thrusters push the base, at the point of it where the centre of mass is
    pushed = states.base_velocity + np.cross(spin, centers(robot, q) - q[:, :3])
    power = (
        np.sum(states.torques * v[:, 6:], axis=1)
        + np.sum(states.thrust * pushed, axis=1)
        + np.sum(states.wheel_torque * v[:, 3:6], axis=1)
    )
    change = (energy(times + h) - energy(times - h)) / (2 * h)
    assert np.allclose(power, change, atol=1e-5 * np.abs(power).max())


@pytest.mark.parametrize("seed", SEEDS)
def test_wheel_torque_is_minus_the_rate_of_wheel_momentum(seed):
    motion = bent_motion(seed, "attitude-held")
    flight = flown(motion, **USUAL)
    times, h = inside(flight)

    def world(t):
        states = flight.at(t)
        return rotations.rotate(states.configurations[:, 3:7], states.wheel_momentum)

    states = flight.at(times)
    torque = rotations.rotate(states.configurations[:, 3:7], states.wheel_torque)
    lost = -(world(times + h) - world(times - h)) / (2 * h[:, None])
    assert np.abs(torque).max() > 1e-4
    assert np.allclose(torque, lost, atol=1e-5 * np.abs(torque).max())


def test_wheel_momentum_per_pace_does_not_depend_on_the_time_law():
    motion = bent_motion(7, "attitude-held")
    flight = flown(motion, **USUAL)
    times, h = inside(flight)
    pace = (flight.at(times + h).parameters - flight.at(times - h).parameters) / (2 * h)
    states = flight.at(times)
    # the quintic law passes u = 1/2 at s = 1/2 only; look for the others
    u = np.linspace(0.0, 1.0, 20_001)
    other = wheel_momentum(motion, 1.0, u)
    rate = 30.0 * (u * (1.0 - u)) ** 2
    for k in range(3):
        per_pace = np.interp(
            states.parameters, other.parameters[1:-1], other.vectors[1:-1, k] / rate[1:-1]
        )
        assert np.allclose(states.wheel_momentum[:, k], per_pace * pace, rtol=1e-3, atol=1e-6)


def arm_only(mode="free-flying"):
    """A base at rest with a rotating arm of a third of its mass."""
    robot = robot_from_urdf(
        urdf(
            link("base", inertial(6.0, (1.0, 1.0, 1.0)), box((1, 1, 1))),
            link("arm", inertial(3.0, (0.01, 0.2, 0.2), (0.9, 0, 0))),
            joint("j", "continuous", "base", "arm", (0, 0, 0)),
        ),
        "made",
    )  # fmt: skip
    start, goal = robot.configuration(), robot.configuration(joints={"j": 3.0})
    return Motion(robot, mode, start, goal, np.zeros((5, 3)))


def test_thrusters_that_hold_the_base_limit_the_speed_of_an_arm():
    motion = arm_only()
    free = flown(motion, joint_acceleration=0.2, thruster_acceleration=1.0)
    for limit in (0.02, 0.002):
        held = flown(motion, joint_acceleration=0.2, thruster_acceleration=limit)
        states = held.at(np.linspace(0.0, held.duration, 10_000))
        peak = np.linalg.norm(states.thrust, axis=1).max() / 9.0
        assert 0.998 * limit < peak < limit
        assert held.duration > free.duration
        assert np.allclose(states.configurations[:, :3], 0.0)
    assert flown(arm_only("free-floating"), joint_acceleration=0.2).delta_v == 0.0


@given(seeds, st.sampled_from(list(Mode)))
@settings(max_examples=10)
def test_joint_torques_stay_within_their_limits_and_meet_one(seed, mode):
    motion = bent_motion(seed, mode)
    free = flown(motion, **USUAL)
    largest = np.abs(free.at(free.clock(2000 / free.duration)).torques).max(axis=0)
    limits = dict(zip(motion.robot.joint_names, (largest / 3.0).tolist(), strict=True))
    flight = flown(motion, **USUAL, joint_torque=limits)
    found = np.abs(flight.at(flight.clock(4000 / flight.duration)).torques).max(axis=0)
    assert 0.95 < np.max(found / (largest / 3.0)) <= 1.0
    assert flight.duration > free.duration


@pytest.mark.parametrize("times", [[], [-0.1], [1e9], [np.nan], 1.0, "now"])
def test_times_that_cannot_be_are_refused(times):
    flight = flown(arm_only(), joint_acceleration=0.2, thruster_acceleration=1.0)
    with pytest.raises(fp.InvalidInput):
        flight.at(times)


def test_states_name_the_base_attitude_and_the_joint_velocities():
    flight = flown(bent_motion(7, "free-flying"), **USUAL)
    states = flight.at(flight.clock(20.0 / flight.duration))
    assert np.array_equal(states.attitudes, states.configurations[:, 3:7])
    assert np.array_equal(states.joint_velocities, states.velocities[:, 6:])
    assert repr(states) == f"States(21 instants, {flight.motion.robot.nd} joints)"
    assert repr(flight).startswith(f"TimedMotion({flight.duration:.4g} s, 3 rests, 0 pulses")


def test_the_base_moves_evenly_where_joints_hardly_move(robot):
    """Joint steps of 1e-11 rad after one of 1 rad: the rounding of their sum moves nothing."""
    joints = np.zeros((5, robot.nd))
    joints[1:, 0] = 1.0 + 1e-11 * np.arange(4)
    way = np.outer(np.arange(5.0), [0.25, 0.0, 0.0])
    ends = [robot.assemble(way[k], rotations.IDENTITY, joints[k]) for k in (0, -1)]
    flight = flown(Motion(robot, "free-flying", *ends, way, joints), **USUAL)
    times, h = inside(flight, count=200)
    before, now, after = (flight.at(times + k * h) for k in (-1, 0, 1))
    moved = after.base_position - before.base_position
    assert np.allclose(moved, 2.0 * h[:, None] * now.base_velocity, atol=1e-10)
