"""Pulses of the thrusters at corners of the base's path."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.motion import Motion
from tests.helpers.random_motions import USUAL, bent_motion, flown, straight_motion

POINT = fp.load_robot("point")


def bend(degrees, **limits):
    """Two legs of 10 m with a corner between them."""
    angle = np.radians(degrees)
    way = [(0, 0, 0), (10, 0, 0), (10 + 10 * np.cos(angle), 10 * np.sin(angle), 0)]
    return flown(straight_motion(POINT, way), thruster_acceleration=0.02, **limits)


def test_a_pulse_passes_a_corner_at_the_largest_possible_speed():
    """Closed form: v' - v of two velocities of equal size v at an angle is 2 v sin(angle / 2)."""
    rest, passed = bend(40.0), bend(40.0, velocity_jump=0.1)
    speed = 0.1 / (2.0 * np.sin(np.radians(20.0)))
    lasts = 0.1 / 0.02
    assert len(rest.rests) == 1
    assert len(passed.rests) == len(rest.pulses) == 0
    assert np.linalg.norm(passed.pulses, axis=1) == pytest.approx([0.1])
    (corner,) = passed.pulse_times
    states = passed.at([corner - 1e-9, corner])
    assert passed.pulse_durations == pytest.approx([lasts])
    assert np.allclose(np.linalg.norm(states.base_velocity, axis=1), speed, atol=1e-9)
    assert np.allclose(np.diff(states.base_velocity, axis=0), passed.pulses, atol=1e-9)
    peak = np.sqrt(0.02 * (10.0 - speed * lasts / 2.0) + speed**2 / 2.0)
    assert passed.duration == pytest.approx(2.0 * (2.0 * peak - speed) / 0.02 + lasts)
    assert passed.delta_v == pytest.approx(2.0 * (2.0 * peak - speed) + 0.1)
    assert rest.duration == pytest.approx(4.0 * np.sqrt(10.0 / 0.02))


@pytest.mark.parametrize("degrees", [3.0, 40.0, 90.0, 170.0])
def test_a_finite_pulse_cuts_the_corner_by_the_stated_distance(degrees):
    """A uniform pulse averages the path's velocity over its duration, at a constant pace."""
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


def drawn_out(flight, count):
    """Equal steps of each piece of constant acceleration, about `count` in all.

    Returns the lengths (N,) of the steps [s], the states at their middles, and the acceleration
    (N, 3) of the base by pulses there [m/s^2].
    """
    halves = flight.pulse_durations / 2.0
    ends = [flight.switch_times, flight.pulse_times - halves, flight.pulse_times + halves]
    ends = np.unique(np.concatenate(ends))
    lengths = np.diff(ends)
    begins, lengths = ends[:-1][lengths > 1e-12 * ends[-1]], lengths[lengths > 1e-12 * ends[-1]]
    each = max(count // len(lengths), 8)
    middles = begins[:, None] + lengths[:, None] * (np.arange(each) + 0.5) / each
    during = np.abs(middles.ravel()[:, None] - flight.pulse_times) < halves
    assert np.all(during.sum(axis=1) <= 1)  # pulses do not overlap
    pulses = during @ (flight.pulses / flight.pulse_durations[:, None])
    return np.repeat(lengths / each, each), flight.at(middles.ravel()), pulses


def assert_drawn_out_within(flight, limit, count=400):
    """Thrust within its limit; from rest to rest on the path, but for the corner cut."""
    steps, states, pulses = drawn_out(flight, count)
    mass = sum(body.mass for body in list(flight.motion.robot.model.inertias)[1:])
    thrust = np.linalg.norm(states.thrust / mass + pulses, axis=1)
    assert thrust.max() <= limit * (1.0 + 1e-9)
    assert flight.delta_v == pytest.approx(thrust @ steps, rel=1e-4)
    assert flight.delta_v <= limit * flight.duration * (1.0 + 1e-9)
    changes = (states.base_acceleration + pulses) * steps[:, None]  # exact, as it is constant
    velocity = np.cumsum(changes, axis=0)
    size = np.linalg.norm(velocity, axis=1).max()
    assert np.linalg.norm(velocity[-1]) < 1e-9 * size
    moved = np.cumsum((velocity - changes / 2.0) * steps[:, None], axis=0)
    times = np.minimum(np.cumsum(steps), flight.duration)
    path = flight.at(times).configurations[:, :3] - flight.at([0.0]).configurations[:, :3]
    away = np.linalg.norm(moved - path, axis=1).max()
    assert away == pytest.approx(flight.corner_cut, rel=1e-6, abs=1e-8 * size * flight.duration)
    return thrust.max()


@given(st.integers(0, 10_000), st.floats(0.003, 0.3), st.booleans())
@settings(max_examples=25)
def test_pulses_drawn_out_keep_the_thrust_limit_on_any_polyline(seed, jump, closes):
    """Corners of all angles, reversals too, and runs of any length."""
    rng = np.random.default_rng(seed)
    legs = rng.normal(size=(int(rng.integers(2, 8)), 3)) * 10.0 ** rng.uniform(-2, 1, size=(1, 1))
    legs[1:] += rng.choice([-1.0, 0.0, 1.0]) * legs[:-1]
    if closes:
        legs[1] = -0.7 * legs[0] + 1e-3 * legs[1]
    way = np.vstack([np.zeros(3), np.cumsum(legs, axis=0)])
    motion = straight_motion(POINT, way)
    flight = flown(motion, thruster_acceleration=0.02, velocity_jump=jump)
    assert len(flight.pulses) == len(way) - 2
    assert assert_drawn_out_within(flight, 0.02) > 0.0199
    assert np.linalg.norm(flight.pulses, axis=1).max() <= jump * (1.0 + 1e-9)
    slower = flown(motion, thruster_acceleration=0.02, velocity_jump=0.7 * jump)
    rest = flown(motion, thruster_acceleration=0.02)
    assert flight.duration <= slower.duration * (1.0 + 1e-9) <= rest.duration * (1.0 + 2e-9)


@pytest.mark.parametrize("mode", ["free-flying", "attitude-held"])
@pytest.mark.parametrize("seed", [7, 39, 112])
def test_pulses_drawn_out_add_to_the_thrust_of_moving_arms(seed, mode):
    motion = bent_motion(seed, mode, edges=6)
    flight = flown(motion, **USUAL, velocity_jump=0.1)
    assert len(flight.pulses) == 5
    assert_drawn_out_within(flight, USUAL["thruster_acceleration"], count=10_000)


@pytest.mark.parametrize(("aside", "largest"), [(0.2, 0.02), (-0.2, 0.0177)])
def test_fast_arms_leave_less_thrust_for_a_pulse(robot, aside, largest):
    """An arm swings while the base passes a corner: against the pulse, and along with it."""
    start = robot.configuration(joints={"left_1": -1.5, "left_2": 0.3})
    goal = robot.configuration((1.0, 0, 0), joints={"left_1": 1.5, "left_2": 0.9})
    motion = Motion(
        robot, "free-flying", start, goal, np.array([(0, 0, 0), (0.5, aside, 0), (1, 0, 0)])
    )
    fast = {"joint_acceleration": 1.0, "joint_velocity": 2.0, "thruster_acceleration": 0.02}
    flight = flown(motion, **fast, velocity_jump=0.1)
    assert len(flight.pulses) == 1
    assert assert_drawn_out_within(flight, 0.02, count=4_000) > 0.99 * largest


def test_torques_keep_their_limit_during_a_pulse():
    """The joints have to carry their links along while the base is pushed."""
    motion = bent_motion(7, "attitude-held")
    free = flown(motion, **USUAL, velocity_jump=0.3)
    limit = 0.5 * drawn_out_torque(free)
    flight = flown(motion, **USUAL, velocity_jump=0.3, joint_torque=limit)
    assert 0.9 * limit < drawn_out_torque(flight) <= limit
    assert len(flight.pulses) == len(free.pulses)


def drawn_out_torque(flight):
    """Largest joint torque or force with pulses drawn out."""
    _, states, pulses = drawn_out(flight, count=2_000)
    model = flight.motion.robot.model.copy()
    model.gravity = pin.Motion.Zero()
    data, largest = model.createData(), 0.0
    for k, q in enumerate(states.configurations):
        a = states.accelerations[k].copy()
        a[:3] += rotations.matrix(q[3:7]).T @ pulses[k]
        torques = pin.rnea(model, data, q, states.velocities[k], a)[6:]
        largest = max(largest, np.abs(torques).max())
    return largest


def test_a_longer_pulse_than_two_short_runs_hold_is_made_smaller(point):
    """Two corners 0.2 m apart: each pulse gets half of the run between them."""
    turns = np.radians([0.0, 20.0, 40.0])
    legs = np.array([10.0, 0.2, 10.0])[:, None] * [(np.cos(a), np.sin(a), 0.0) for a in turns]
    way = np.vstack([np.zeros(3), np.cumsum(legs, axis=0)])
    flight = flown(straight_motion(point, way), thruster_acceleration=0.02, velocity_jump=1.0)
    size = 2.0 * np.sin(np.radians(10.0))
    speed = np.sqrt(0.02 * 0.2 / size)
    assert np.allclose(np.linalg.norm(flight.pulses, axis=1), speed * size, rtol=1e-9)
    assert np.allclose(np.diff(flight.pulse_times), flight.pulse_durations, rtol=1e-9)


def test_arms_keep_their_pace_through_a_pulse(robot):
    start = robot.configuration(joints={"left_1": -0.6})
    goal = robot.configuration((4, 0, 0), joints={"left_1": 0.7, "right_1": 0.5})
    way = np.array([(0, 0, 0), (2, 0.5, 0), (4, 0, 0)], dtype=float)
    motion = Motion(robot, "free-flying", start, goal, way)
    flight = flown(motion, **USUAL, velocity_jump=0.04)
    before, after = flight.at([flight.pulse_times[0] - 1e-9, flight.pulse_times[0]]).velocities
    assert np.abs(after[6:]).max() > 0.01
    assert np.allclose(before[3:], after[3:], atol=1e-9)  # nor does the base's turning change
    assert np.allclose(flight.pulses[0], np.array([0, -0.04, 0]), rtol=2e-3)


@pytest.mark.parametrize("mode", ["free-flying", "attitude-held"])
def test_slowing_for_a_torque_keeps_the_pace_through_pulses(mode):
    motion = bent_motion(7, mode)
    flight = flown(motion, **USUAL, velocity_jump=0.3, joint_torque=1e-3)
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


def test_pulses_that_cut_deeper_than_the_clearance_are_refused():
    """The cut is d^2 / 8a."""
    with pytest.raises(fp.InvalidInput, match=r"velocity_jump: got .* proven clear") as refused:
        bend(40.0, velocity_jump=0.1, clearance=0.05)
    advised = float(refused.value.allowed.split()[1])
    assert advised == pytest.approx(np.sqrt(8 * 0.02 * 0.05), rel=0.05)
    assert 0.04 < bend(40.0, velocity_jump=advised, clearance=0.05).corner_cut < 0.05
    with pytest.raises(fp.InvalidInput, match="velocity_jump"):
        bend(40.0, velocity_jump=0.01, clearance=0.0)


def test_a_plan_is_flown_faster_with_pulses(fig2a_plan):
    limits = {"joint_acceleration": 0.1, "thruster_acceleration": 0.01, "corners": "rest"}
    rest = fig2a_plan.timed(**limits)
    flight = fig2a_plan.timed(**limits, velocity_jump=0.02)
    assert flight.corner_cut < fig2a_plan.certificate.least_clearance
    assert flight.duration < 0.7 * rest.duration
    assert assert_drawn_out_within(flight, 0.01, count=10_000) > 0.0099
