"""Pulses of the thrusters at corners of the base's path."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.motion import Motion
from tests.helpers.random_motions import USUAL, bent_motion, flown, straight_motion


def bend(degrees, **given):
    """Two legs of 10 m with a corner between them."""
    robot = fp.load_robot("point")
    angle = np.radians(degrees)
    way = [(0, 0, 0), (10, 0, 0), (10 + 10 * np.cos(angle), 10 * np.sin(angle), 0)]
    return flown(straight_motion(robot, way), thruster_acceleration=0.02, **given)


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


@pytest.mark.parametrize("second", [5.0, -5.0])
def test_pulses_that_overlap_cut_no_deeper_than_stated(second, point):
    """Two corners so close that the second pulse begins before the first one ends."""
    turns = np.radians([0.0, 5.0, 5.0 + second])
    legs = np.array([10.0, 0.2, 10.0])[:, None] * [(np.cos(a), np.sin(a), 0.0) for a in turns]
    way = np.vstack([np.zeros(3), np.cumsum(legs, axis=0)])
    flight = flown(straight_motion(point, way), thruster_acceleration=0.02, velocity_jump=0.035)
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
