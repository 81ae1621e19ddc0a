"""Plans with a time law: what moves when, and what brings it about."""

from itertools import pairwise

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.mode import Mode
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.dynamics.wheel_momentum import wheel_momentum
from ffsr_plan.robots.robot import robot_from_urdf
from tests.helpers.builders import box, inertial, joint, link, urdf
from tests.helpers.random_motions import USUAL, bent_motion, flown, inside

SEEDS = (7, 39)  # robots with hinges and slides
seeds = st.integers(0, 10_000)
cases = pytest.mark.parametrize(
    ("seed", "mode", "joints_bend"),
    [(s, m, b) for s in SEEDS for m in list(Mode) for b in (False, True)],
)


def mass(robot):
    return sum(body.mass for body in list(robot.model.inertias)[1:])


def centers(robot, q):
    """(N, 3) of mass, world [m]."""
    data = robot.model.createData()
    return np.array([pin.centerOfMass(robot.model, data, each) for each in q])


def straight(robot, way, mode="free-flying", **ends):
    q = [robot.configuration(p) for p in (way[0], way[-1])]
    return Motion(robot, mode, *q, np.array(way, dtype=float))


def test_a_straight_flight_takes_twice_its_peak_speed_of_delta_v(point):
    """Closed form: 4 m at 0.01 m/s^2 without and with a limit on the speed."""
    motion = straight(point, [(0, 0, 0), (4, 0, 0)])
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
    flight = fig2a_plan.timed(joint_acceleration=0.1, thruster_acceleration=0.01)
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
    edges, total = flight._law.times, 0.0
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
    """A base that stays where it is and an arm of a third of its mass that turns."""
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


def bend(degrees, **given):
    """Two legs of 10 m with a corner between them."""
    robot = fp.load_robot("point")
    angle = np.radians(degrees)
    way = [(0, 0, 0), (10, 0, 0), (10 + 10 * np.cos(angle), 10 * np.sin(angle), 0)]
    return flown(straight(robot, way), thruster_acceleration=0.02, **given)


def test_a_pulse_passes_a_corner_at_the_largest_possible_speed():
    """Closed form: v' - v of two velocities of equal size v at an angle is 2 v sin(angle / 2)."""
    rest, passed = bend(40.0), bend(40.0, velocity_jump=0.1)
    speed = 0.1 / (2.0 * np.sin(np.radians(20.0)))
    assert len(rest.rests) == 1
    assert len(passed.rests) == len(rest.pulses) == 0
    assert np.linalg.norm(passed.pulses, axis=1) == pytest.approx([0.1])
    (corner,) = passed.pulse_times
    states = passed.at([corner - 1e-9, corner])
    assert np.allclose(np.linalg.norm(states.base_velocity, axis=1), speed, atol=1e-9)
    assert np.allclose(np.diff(states.base_velocity, axis=0), passed.pulses, atol=1e-9)
    peak = np.sqrt(0.02 * 10.0 + speed**2 / 2.0)
    assert passed.duration == pytest.approx(2.0 * (2.0 * peak - speed) / 0.02)
    assert passed.delta_v == pytest.approx(2.0 * (2.0 * peak - speed) + 0.1)
    assert rest.duration == pytest.approx(4.0 * np.sqrt(10.0 / 0.02))


@pytest.mark.parametrize("degrees", [3.0, 40.0, 90.0, 170.0])
def test_a_finite_pulse_cuts_the_corner_by_the_stated_distance(degrees):
    """Evenly over its length: the path's velocity averaged over as long, flown at a steady pace."""
    flight = bend(degrees, velocity_jump=0.05)
    (pulse,), (corner,) = flight.pulses, flight.pulse_times
    (after,) = flight.at([corner]).base_velocity
    lasts = np.linalg.norm(pulse) / 0.02
    t = np.linspace(-lasts, lasts, 4001)
    sharp = np.where(t[:, None] < 0.0, (after - pulse) * t[:, None], after * t[:, None])
    share = np.clip(t / lasts + 0.5, 0.0, 1.0)
    velocity = after - pulse + share[:, None] * pulse
    steps = np.diff(t)[:, None] * (velocity[1:] + velocity[:-1]) / 2.0
    round_ = sharp[0] + np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
    assert np.allclose(round_[-1], sharp[-1], atol=1e-9)
    cut = np.linalg.norm(round_ - sharp, axis=1).max()
    assert flight.corner_cut == pytest.approx(cut, rel=1e-6)


@pytest.mark.parametrize("second", [5.0, -5.0])
def test_pulses_that_overlap_cut_no_deeper_than_stated(second, point):
    """Two corners so near that the first pulse has not ended where the second begins."""
    turns = np.radians([0.0, 5.0, 5.0 + second])
    legs = np.array([10.0, 0.2, 10.0])[:, None] * [(np.cos(a), np.sin(a), 0.0) for a in turns]
    way = np.vstack([np.zeros(3), np.cumsum(legs, axis=0)])
    flight = flown(straight(point, way), thruster_acceleration=0.02, velocity_jump=0.035)
    gap = np.diff(flight.pulse_times)
    lasts = np.linalg.norm(flight.pulses, axis=1) / 0.02
    assert 0.0 < gap < lasts.min() / 2.0
    t = np.linspace(-3.0, 3.0, 6001) + flight.pulse_times.mean()
    share = (t[:, None] - flight.pulse_times) / lasts
    off = np.clip(share + 0.5, 0.0, 1.0) - (share >= 0.0)
    away = np.cumsum(off @ flight.pulses, axis=0) * (t[1] - t[0])
    cut = np.linalg.norm(away, axis=1).max()
    assert np.linalg.norm(away[-1]) < 1e-4
    assert cut <= flight.corner_cut * (1.0 + 1e-3)
    alone = lasts.max() ** 2 * 0.02 / 8.0
    assert flight.corner_cut > 1.05 * alone
    if second > 0.0:  # they add up
        assert cut > 0.95 * flight.corner_cut


def test_arms_keep_their_pace_through_a_pulse(robot):
    start = robot.configuration(joints={"left_1": -0.6})
    goal = robot.configuration((4, 0, 0), joints={"left_1": 0.7, "right_1": 0.5})
    way = np.array([(0, 0, 0), (2, 0.5, 0), (4, 0, 0)], dtype=float)
    motion = Motion(robot, "free-flying", start, goal, way)
    flight = flown(motion, **USUAL, velocity_jump=0.04)
    before, after = flight.at([flight.pulse_times[0] - 1e-9, flight.pulse_times[0]]).velocities
    assert np.abs(after[6:]).max() > 0.01
    assert np.allclose(before[3:], after[3:], atol=1e-9)  # nor does the base's turning change
    assert np.allclose(flight.pulses[0], np.array([0, -0.04, 0]), atol=1e-9)


@pytest.mark.parametrize("mode", ["free-flying", "attitude-held"])
def test_slowing_for_a_torque_keeps_the_pace_through_pulses(mode):
    motion = bent_motion(7, mode)
    given = USUAL | {"velocity_jump": 0.3, "joint_torque": 1e-3}
    flight = flown(motion, **given)
    assert len(flight.pulses) == 3
    just = 1e-9 * flight.duration
    before, after = (flight.at(flight.pulse_times - d) for d in (just, 0.0))
    assert np.abs(after.velocities[:, 6:]).max() > 1e-4
    assert np.allclose(before.velocities[:, 3:], after.velocities[:, 3:], atol=1e-9)
    assert np.allclose(after.base_velocity - before.base_velocity, flight.pulses, atol=1e-8)
    states = flight.at(flight.clock(2000 / flight.duration))
    assert 0.9e-3 < np.abs(states.torques).max() < 1e-3


def test_a_base_rotated_by_wheels_rests_where_its_rate_changes():
    q = bent_motion(7, "attitude-held")
    uneven = np.linspace(0.0, 1.0, 5)[:, None] ** 2
    robot, start = q.robot, q.configurations()[0]
    goal = np.array(start)
    goal[:3] += 1.0
    turned = np.array(goal)
    turned[3:7] = rotations.multiply(goal[3:7], rotations.exp(np.array([0.0, 0.0, 0.5])))
    way = start[:3] + uneven
    assert len(flown(Motion(robot, "attitude-held", start, goal, way), **USUAL).rests) == 0
    assert len(flown(Motion(robot, "attitude-held", start, turned, way), **USUAL).rests) == 3


def test_where_joints_have_a_corner_no_pulse_helps():
    motion = bent_motion(7, "free-flying", joints_bend=True)
    flight = flown(motion, **USUAL, velocity_jump=0.1)
    assert len(flight.rests) == 3
    assert len(flight.pulses) == 0


def test_pulses_that_cut_deeper_than_the_clearance_are_refused(fig2a_plan):
    clear = fig2a_plan.certificate.least_clearance
    most = np.sqrt(8.0 * 0.01 * clear)
    given = {"joint_acceleration": 0.1, "thruster_acceleration": 0.01}
    flight = fig2a_plan.timed(**given, velocity_jump=0.95 * most)
    assert 0.9 * clear < flight.corner_cut < clear
    assert flight.duration < fig2a_plan.timed(**given).duration
    with pytest.raises(fp.InvalidInput, match=r"velocity_jump: got .* proven clear") as refused:
        fig2a_plan.timed(**given, velocity_jump=3.0 * most)
    advised = float(refused.value.allowed.split()[1])
    assert 0.5 * clear < fig2a_plan.timed(**given, velocity_jump=advised).corner_cut < clear


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
        ({"velocity_jump": 0.01, "joint_jerk": 0.1}, "a jump is a jerk without limit"),
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


@pytest.mark.parametrize("times", [[], [-0.1], [1e9], [np.nan], 1.0, "now"])
def test_times_that_cannot_be_are_refused(times):
    with pytest.raises(fp.InvalidInput):
        bend(40.0).at(times)
