"""Time laws along the smooth curve of figure 2a: the fastest flight, and one of given duration."""

import pytest

import ffsr_plan as fp
from benchmarks.speed.reference import Reference, record
from ffsr_plan.smooth_flight.curve_flight import curve_flight
from ffsr_plan.smooth_flight.timed_curve import pace_within
from tests.helpers.smooth_flights import curve_of, limits_of

GIVEN = {"joint_acceleration": 0.05, "joint_velocity": 0.5, "joint_torque": 20.0}


@pytest.fixture(scope="module")
def reference(problem):
    return Reference(problem)


@pytest.fixture(scope="module")
def curve():
    problem = fp.load_scenario("fig2a")
    return curve_of(fp.plan(problem, fp.LatticeOptimum(), refine=True).motion)


@pytest.fixture(scope="module")
def limits(curve):
    return limits_of(curve, thruster_acceleration=0.01, **GIVEN)


def test_fastest_pace(benchmark, curve, limits, reference):
    """The law alone; 10 ms are wanted."""
    pace_within(curve, limits)  # compiles
    pace = benchmark.pedantic(lambda: pace_within(curve, limits), rounds=20)
    benchmark.extra_info["duration"] = pace.duration
    record(benchmark, reference)


@pytest.mark.parametrize("duration", [None, 423.0])
def test_smooth_flight(benchmark, curve, limits, reference, duration):
    """The whole flight, delta-v included."""
    flight = benchmark.pedantic(lambda: curve_flight(curve, limits, duration), rounds=20)
    benchmark.extra_info["delta_v"] = flight.delta_v
    record(benchmark, reference)


def test_limits_on_jerk(benchmark, curve, reference):
    """A dozen moving averages are tried."""
    limits = limits_of(curve, thruster_acceleration=0.01, joint_jerk=1e-3, **GIVEN)
    benchmark.pedantic(lambda: curve_flight(curve, limits), rounds=5)
    record(benchmark, reference)
