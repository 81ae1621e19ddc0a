"""Every limit is kept at all times, and the law is the fastest that keeps them."""

import numpy as np
import pytest

from ffsr_plan.smooth_flight.curve_flight import curve_flight
from ffsr_plan.smooth_flight.curve_samples import PARTS, curve_samples
from ffsr_plan.smooth_flight.fastest_pace_kernel import squares_of
from ffsr_plan.smooth_flight.limits_on_pace import Demands, demands, step_limits
from ffsr_plan.smooth_flight.pace_search import Search, duration_of
from tests.helpers.random_motions import bent_motion
from tests.helpers.smooth_flights import (
    BY_MODE,
    THRUST,
    curve_of,
    flown,
    instants,
    limits_of,
    shares_in_use,
)

SEEDS = range(5)
CASES = [(seed, mode, bend) for seed in SEEDS for mode in sorted(BY_MODE) for bend in (False, True)]
JERKS = {
    "free-flying": {"joint_jerk": 1e-3, "thruster_jerk": 2e-3},
    "free-floating": {"joint_jerk": 1e-3},
}


@pytest.mark.parametrize(("seed", "mode", "bend"), CASES)
def test_no_limit_is_exceeded_at_100_times_a_step(seed, mode, bend):
    curve = curve_of(bent_motion(seed, mode, edges=6, joints_bend=bend))
    limits = limits_of(curve, **BY_MODE[mode])
    flight = curve_flight(curve, limits)
    shares = shares_in_use(flight, limits, instants(flight))
    assert max(shares.values()) <= 1.0 + 1e-9
    assert max(shares.values()) > 0.99


@pytest.mark.parametrize("torque", [20.0, 8e-4])
def test_figure_2a_keeps_its_limits_and_is_as_fast_as_toppra(fig2a_plan, torque):
    """The oracle's linear programmes have 64 facets in place of the disc of the thrust."""
    toppra_law = pytest.importorskip("tests.helpers.toppra_law")
    curve = curve_of(fig2a_plan.motion)
    limits = limits_of(
        curve, joint_acceleration=0.05, joint_velocity=0.5, joint_torque=torque, **THRUST
    )
    flight = curve_flight(curve, limits)
    assert max(shares_in_use(flight, limits, instants(flight)).values()) <= 1.0 + 1e-9
    samples = curve_samples(curve)
    wanted = demands(limits, samples.path, samples.dynamics, curve.robot.mass)
    at_ends = Demands(*(np.ascontiguousarray(each[::PARTS]) for each in wanted))
    oracle = toppra_law.duration_by_toppra(samples.ends, at_ends, 64)
    assert flight.duration == pytest.approx(oracle, rel=3e-3)


@pytest.mark.parametrize("mode", ["free-flying", "attitude-held"])
@pytest.mark.parametrize("seed", SEEDS)
def test_limits_asked_for_thrice_a_step_hold_in_between_and_the_rest_costs_little_time(seed, mode):
    curve = curve_of(bent_motion(seed, mode, edges=40, joints_bend=True))
    limits = limits_of(curve, **BY_MODE[mode])
    samples = curve_samples(curve)
    wanted = demands(limits, samples.path, samples.dynamics, curve.robot.mass)
    squares, _ = squares_of(step_limits(samples, wanted), 0.0, 0.0)
    assert (
        np.max(Search(samples, wanted).excess(squares)) < 1.03
    )  # 2 to 3 where asked for at one end
    fastest = Search(samples, wanted).fastest()
    assert np.max(Search(samples, wanted).excess(fastest)) < 1.0 + 1e-9
    assert duration_of(samples.ends, fastest) < 1.003 * duration_of(samples.ends, squares)


@pytest.mark.parametrize("mode", sorted(JERKS))
@pytest.mark.parametrize("seed", SEEDS)
def test_limits_on_jerk_are_kept_and_so_are_the_others(seed, mode):
    curve = curve_of(bent_motion(seed, mode, joints_bend=True))
    limits = limits_of(curve, **BY_MODE[mode], **JERKS[mode])
    flight = curve_flight(curve, limits)
    times = instants(flight, 10)
    assert max(shares_in_use(flight, limits, times).values()) <= 1.0 + 1e-9
    states = flight.at(times)
    steps = np.diff(times)
    longer = steps > 1e-6 * flight.duration
    steps = steps[longer, None]
    joints = np.diff(states.joint_accelerations, axis=0)[longer] / steps
    assert np.max(np.abs(joints) / limits.jerk[2:]) <= 1.0 + 1e-6
    if mode == "free-flying":
        base = np.linalg.norm(np.diff(states.base_acceleration, axis=0)[longer] / steps, axis=1)
        assert np.max(base) <= limits.jerk[0] * (1.0 + 1e-6)
    assert flight.duration > curve_flight(curve, limits_of(curve, **BY_MODE[mode])).duration


def test_limits_on_jerk_are_kept_in_a_given_time_too():
    curve = curve_of(bent_motion(1, "free-flying", joints_bend=True))
    limits = limits_of(curve, **BY_MODE["free-flying"], **JERKS["free-flying"])
    fastest = curve_flight(curve, limits)
    flight = curve_flight(curve, limits, 1.7 * fastest.duration)
    assert flight.duration == pytest.approx(1.7 * fastest.duration, rel=1e-12)
    assert flight.delta_v < 0.8 * fastest.delta_v
    assert max(shares_in_use(flight, limits, instants(flight, 10)).values()) <= 1.0 + 1e-9


def test_a_curve_that_rests_on_its_way_is_flown_within_the_limits():
    """At such a rest s' may be as high as one likes, because nothing moves with s."""
    motion = bent_motion(3, "free-flying", edges=6)
    curve = curve_of(motion, np.array([1, 1, 3, 1, 3, 1, 1]))
    limits = limits_of(curve, **BY_MODE["free-flying"])
    flight = curve_flight(curve, limits)
    assert max(shares_in_use(flight, limits, instants(flight)).values()) <= 1.0 + 1e-9
    assert len(flight.rests) == 2
    assert np.abs(flight.at(flight.rests).velocities).max() < 1e-6
    straight = curve_flight(curve_of(motion), limits)
    assert len(straight.rests) == 0
    assert straight.duration < flight.duration < 3.0 * straight.duration


def test_a_longer_flight_needs_less_thrust_in_all():
    motion = bent_motion(2, "free-flying", edges=6)
    fastest = flown(motion, **BY_MODE["free-flying"])
    slower = [flown(motion, k * fastest.duration, **BY_MODE["free-flying"]) for k in (1.2, 2, 4)]
    needed = [flight.delta_v for flight in (fastest, *slower)]
    assert needed == sorted(needed, reverse=True)
    assert all(flight.delta_v >= flight.straight_delta_v for flight in (fastest, *slower))
