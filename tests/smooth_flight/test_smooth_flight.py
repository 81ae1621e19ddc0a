"""Smooth flights: states that fit together, momentum, delta-v, tables."""

import csv

import numpy as np
import pytest

from ffsr_plan.core.errors import InvalidInput
from tests.helpers.random_motions import bent_motion, inside
from tests.helpers.smooth_flights import BY_MODE, flown

CASES = [(seed, mode) for seed in (1, 4) for mode in sorted(BY_MODE)]


@pytest.mark.parametrize(("seed", "mode"), CASES)
def test_velocities_and_accelerations_are_derivatives(seed, mode):
    flight = flown(bent_motion(seed, mode, joints_bend=True), **BY_MODE[mode])
    times, h = inside(flight, share=1e-2)
    before, now, after = (flight.at(times + k * h) for k in (-1, 0, 1))
    for name, rate in (
        ("base_position", "base_velocity"),
        ("joint_positions", "joint_velocities"),
        ("base_velocity", "base_acceleration"),
        ("velocities", "accelerations"),
    ):
        change = (getattr(after, name) - getattr(before, name)) / (2.0 * h[:, None])
        assert np.allclose(change, getattr(now, rate), atol=1e-5), name


@pytest.mark.parametrize(("seed", "mode"), CASES)
def test_thrust_is_the_change_of_momentum_and_nothing_else_turns_the_robot(seed, mode):
    flight = flown(bent_motion(seed, mode, joints_bend=True), **BY_MODE[mode])
    times, h = inside(flight, share=1e-2)
    linear, angular = [], []
    for k in (-1, 0, 1):
        states = flight.at(times + k * h)
        one, other = _momentum(flight.robot, states)
        linear.append(one)
        angular.append(other)
    thrust = flight.at(times).thrust
    assert np.allclose((linear[2] - linear[0]) / (2.0 * h[:, None]), thrust, atol=1e-6)
    if flight.mode.attitude_reacts:
        assert np.abs(angular).max() < 1e-10
    if flight.mode.floats:
        assert np.abs(linear).max() < 1e-10


def _momentum(robot, states):
    import pinocchio as pin

    data, found = robot.model.createData(), []
    for q, v in zip(states.configurations, states.velocities, strict=True):
        pin.computeCentroidalMomentum(robot.model, data, q, v)
        found.append(data.hg.vector.copy())
    return np.split(np.array(found), 2, axis=1)


@pytest.mark.parametrize("mode", ["free-flying", "attitude-held"])
def test_delta_v_is_the_integral_of_thrust_by_mass(mode):
    flight = flown(bent_motion(1, mode, joints_bend=True), **BY_MODE[mode])
    count, ends = 40, flight.switch_times
    steps = np.diff(ends) / count
    middles = ends[:-1, None] + steps[:, None] * (np.arange(count) + 0.5)
    push = np.linalg.norm(flight.at(middles.ravel()).thrust, axis=1) / flight.robot.mass
    total = float(np.sum(steps[:, None] * push.reshape(middles.shape)))
    assert flight.delta_v == pytest.approx(total, rel=1e-5)


@pytest.mark.parametrize("mode", sorted(BY_MODE))
def test_it_rests_at_start_and_goal_and_nowhere_else(mode):
    motion = bent_motion(3, mode, joints_bend=True)
    flight = flown(motion, **BY_MODE[mode])
    ends = flight.at([0.0, flight.duration])
    assert np.abs(ends.velocities).max() < 1e-6
    assert np.allclose(ends.joints, motion.joint_values[[0, -1]], atol=1e-12)
    assert np.allclose(ends.parameters, [0.0, 1.0], atol=1e-12)
    s, speed, _ = flight.speeds(np.linspace(0.0, flight.duration, 1001))
    assert np.all(np.diff(s) > 0.0)
    assert np.all(speed[1:-1] > 0.0)


def test_tables_have_a_row_for_each_time_and_units_on_top(tmp_path):
    flight = flown(bent_motion(1, "free-flying"), **BY_MODE["free-flying"])
    flight.to_csv(tmp_path / "flight.csv", 2.0)
    with (tmp_path / "flight.csv").open() as file:
        header, *rows = list(csv.reader(file))
    assert header[:3] == ["t [s]", "s [1]", "base_x [m]"]
    assert "base_vx (world axes) [m/s]" in header
    times = flight.clock(2.0)
    assert np.array_equal(np.array(rows, dtype=float)[:, 0], times)
    column = header.index("base_vx (world axes) [m/s]")
    assert np.array_equal(
        np.array(rows, dtype=float)[:, column], flight.at(times).base_velocity[:, 0]
    )


def test_times_outside_the_flight_are_refused():
    flight = flown(bent_motion(1, "free-flying"), **BY_MODE["free-flying"])
    for times in ([], [-1.0], [flight.duration * 1.01], [np.nan]):
        with pytest.raises(InvalidInput, match="times"):
            flight.at(times)
        with pytest.raises(InvalidInput, match="times"):
            flight.speeds(times)


def test_it_has_no_pulses():
    flight = flown(bent_motion(1, "free-flying"), **BY_MODE["free-flying"])
    assert flight.pulses.shape == (0, 3)
    assert len(flight.pulse_times) == len(flight.pulse_durations) == flight.corner_cut == 0
    assert np.array_equal(flight.pulse_accelerations([0.0, 1.0]), np.zeros((2, 3)))


def test_a_flight_says_what_it_is():
    flight = flown(bent_motion(1, "free-flying"), **BY_MODE["free-flying"])
    assert repr(flight).startswith(f"CurveFlight({flight.duration:.4g} s, delta-v")
