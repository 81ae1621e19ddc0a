"""Laws that are known in closed form: along a straight line, and scaled."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.smooth_flight.curve_flight import curve_flight
from ffsr_plan.smooth_flight.pace_search import EndSpeeds
from ffsr_plan.smooth_flight.timed_curve import pace_within
from tests.helpers.random_motions import bent_motion, straight_motion
from tests.helpers.smooth_flights import (
    BY_MODE,
    curve_of,
    flown,
    instants,
    limits_of,
    shares_in_use,
)

LENGTH, PUSH = 3.0, 0.02


@pytest.fixture(scope="module")
def line(point):
    return straight_motion(point, [[0.0, 0.0, 0.0], [LENGTH, 0.0, 0.0]])


def test_a_straight_line_is_pushed_half_way_and_braked_half_way(line):
    flight = flown(line, thruster_acceleration=PUSH)
    assert flight.duration == pytest.approx(2.0 * np.sqrt(LENGTH / PUSH), rel=1e-9)
    assert flight.delta_v == pytest.approx(2.0 * np.sqrt(LENGTH * PUSH), rel=1e-9)
    assert flight.delta_v == pytest.approx(flight.straight_delta_v, rel=1e-6)


def test_with_a_limit_on_velocity_it_coasts_in_between(line):
    speed = 0.1
    flight = flown(line, thruster_acceleration=PUSH, base_velocity=speed)
    assert flight.duration == pytest.approx(LENGTH / speed + speed / PUSH, rel=1e-4)
    assert flight.delta_v == pytest.approx(2.0 * speed, rel=1e-4)


@pytest.mark.parametrize("factor", [1.0, 1.01, 1.5, 20.0])
def test_a_given_duration_is_met_and_nothing_needs_less_along_a_line(line, factor):
    """A coast between two pushes is the best there is."""
    duration = factor * flown(line, thruster_acceleration=PUSH).duration
    flight = flown(line, duration, thruster_acceleration=PUSH)
    assert flight.duration == pytest.approx(duration, rel=1e-12)
    assert flight.delta_v == pytest.approx(flight.straight_delta_v, rel=1e-2)
    assert flight.delta_v >= flight.straight_delta_v * (1.0 - 1e-6)


def test_a_duration_shorter_than_the_fastest_is_refused_with_that_one(line):
    fastest = flown(line, thruster_acceleration=PUSH).duration
    with pytest.raises(InvalidInput, match=f"duration.*{fastest:.6g} s"):
        flown(line, 0.99 * fastest, thruster_acceleration=PUSH)
    with pytest.raises(InvalidInput, match="duration"):
        flown(line, -1.0, thruster_acceleration=PUSH)


def test_end_speeds_are_met_and_save_time(line):
    """From 0.1 m/s to 0.2 m/s, up and down again at constant acceleration."""
    curve = curve_of(line)
    ends = EndSpeeds(0.1 / LENGTH, 0.2 / LENGTH)
    pace = pace_within(curve, limits_of(curve, thruster_acceleration=PUSH), ends=ends)
    top = np.sqrt(PUSH * LENGTH + (0.1**2 + 0.2**2) / 2.0)
    assert pace.duration == pytest.approx((2.0 * top - 0.3) / PUSH, rel=1e-4)
    assert pace.begin[0, 1] == pytest.approx(ends.begin, rel=1e-12)
    last = pace.on(np.array([len(pace.begin) - 1]), pace.times[-1:])
    assert last[1] == pytest.approx(ends.end, rel=1e-9)


@pytest.mark.parametrize("ends", [EndSpeeds(1.0, 0.0), EndSpeeds(0.0, 1.0)])
def test_end_speeds_that_cannot_be_are_refused(line, ends):
    curve = curve_of(line)
    with pytest.raises(InvalidInput, match=r"_speed.*at most"):
        pace_within(curve, limits_of(curve, thruster_acceleration=PUSH), ends=ends)
    jerky = limits_of(curve, thruster_acceleration=PUSH, thruster_jerk=PUSH)
    with pytest.raises(InvalidInput, match="zero with a limit on jerk"):
        pace_within(curve, jerky, ends=ends)


def test_end_speeds_on_a_bent_curve_keep_the_limits():
    motion = bent_motion(1, "free-flying", joints_bend=True)
    curve = curve_of(motion)
    given = limits_of(curve, **BY_MODE["free-flying"])
    slow = pace_within(curve, given)
    speed = 0.5 * float(np.median(slow.begin[:, 1]))
    pace = pace_within(curve, given, ends=EndSpeeds(0.0, 0.1 * speed))
    last = pace.on(np.array([len(pace.begin) - 1]), pace.times[-1:])
    assert last[1] == pytest.approx(0.1 * speed, rel=1e-9)
    assert pace.duration < slow.duration


@pytest.mark.parametrize("mode", sorted(BY_MODE))
def test_a_flight_k_times_as_slow_has_1_k_th_of_velocities_and_1_k2_th_of_forces(mode):
    k, motion = 3.0, bent_motion(2, mode, joints_bend=True)
    slower = {
        name: value / (k if name.endswith("velocity") else k * k)
        for name, value in BY_MODE[mode].items()
    }
    curve = curve_of(motion)
    fast, slow = (
        curve_flight(curve, limits_of(curve, **given)) for given in (BY_MODE[mode], slower)
    )
    assert slow.duration == pytest.approx(k * fast.duration, rel=1e-9)
    assert slow.delta_v == pytest.approx(fast.delta_v / k, rel=1e-9, abs=1e-12)


def test_the_same_curve_gives_the_same_flight_bit_for_bit():
    motion = bent_motion(4, "free-flying", joints_bend=True)
    one, two = (flown(motion, 400.0, **BY_MODE["free-flying"]) for _ in range(2))
    assert np.array_equal(one.switch_times, two.switch_times)
    assert one.at(one.clock(1.0)) == two.at(two.clock(1.0))
    assert one.delta_v == two.delta_v


def test_a_curve_along_which_nothing_moves_is_refused(point):
    motion = straight_motion(point, [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    with pytest.raises(InvalidInput, match="nothing moves"):
        flown(motion, thruster_acceleration=PUSH)


def test_an_acceleration_without_a_limit_is_refused(line):
    with pytest.raises(InvalidInput, match="thruster_acceleration"):
        flown(line)
    curve = curve_of(bent_motion(1, "attitude-held"))
    with pytest.raises(InvalidInput, match="turn_acceleration"):
        curve_flight(curve, limits_of(curve, joint_acceleration=0.1, thruster_acceleration=0.1))


def test_limits_of_actuators_that_the_mode_lacks_are_refused():
    curve = curve_of(bent_motion(1, "free-floating"))
    with pytest.raises(InvalidInput, match="thruster_acceleration"):
        limits_of(curve, joint_acceleration=0.1, thruster_acceleration=0.1)


def test_a_free_floating_flight_needs_no_thrust():
    flight = flown(bent_motion(1, "free-floating"), joint_acceleration=0.1)
    assert flight.delta_v == flight.straight_delta_v == 0.0


def test_flights_are_public():
    assert fp.SmoothFlight.__name__ == "SmoothFlight"


def test_a_law_that_does_not_end_at_rest_arrives_on_time_and_keeps_the_limits():
    motion = bent_motion(1, "free-flying", joints_bend=True)
    curve = curve_of(motion)
    given = limits_of(curve, **BY_MODE["free-flying"])
    fastest = curve_flight(curve, given, ends=EndSpeeds(0.0, 0.01))
    for factor in (1.001, 1.5, 4.0):
        duration = factor * fastest.duration
        speed = 0.5 * curve.pieces / duration
        flight = curve_flight(curve, given, duration, EndSpeeds(0.0, speed))
        assert flight.duration == duration
        s, last, _ = flight.speeds([0.0, duration])
        assert s == pytest.approx([0.0, curve.pieces], rel=1e-12)
        assert last == pytest.approx([0.0, speed], rel=1e-9)
        shares = shares_in_use(flight, given, instants(flight, 20))
        assert max(shares.values()) <= 1.0 + 1e-9


def test_a_law_too_fast_at_its_end_for_a_long_time_names_the_longest(line):
    curve = curve_of(line)
    limits = limits_of(curve, thruster_acceleration=PUSH)
    with pytest.raises(InvalidInput, match=r"duration.*at most .* with these speeds at the ends"):
        pace_within(curve, limits, 1e4, EndSpeeds(0.0, 0.2 / LENGTH))
