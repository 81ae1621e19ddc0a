"""The fastest way along straight runs, and where a motion has them."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ruckig import InputParameter, Ruckig, Trajectory

from ffsr_plan.dynamics.mode import Mode
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.trajectory.straight_runs import StraightRuns, straight_runs
from ffsr_plan.trajectory.time_law import _s_curve, _trapezoid, time_law
from tests.helpers.random_motions import USUAL, bent_motion, flown, read

seeds = st.integers(0, 10_000)
sizes = st.floats(-6.0, 6.0).map(lambda power: 10.0**power)


def duration(phases):
    return sum(t for t, *_ in phases)


def way(phases, speed=0.0):
    """What x and x' have become in the end."""
    x = 0.0
    for t, acceleration, jerk in phases:
        x += speed * t + acceleration * t**2 / 2.0 + jerk * t**3 / 6.0
        speed += acceleration * t + jerk * t**2 / 2.0
    return x, speed


@given(sizes, sizes, sizes)
def test_rest_to_rest_uses_full_acceleration_speed_and_braking(length, top, push):
    """Bang-bang where the speed is not reached, a trapezoid where it is."""
    phases = _trapezoid(length, 0.0, 0.0, top, push)
    reached = top**2 < push * length
    best = length / top + top / push if reached else 2.0 * np.sqrt(length / push)
    assert duration(phases) == pytest.approx(best, rel=1e-9)
    x, speed = way(phases)
    assert x == pytest.approx(length, rel=1e-9)
    assert abs(speed) <= 1e-9 * push * best


@given(*[st.floats(0.1, 10.0)] * 3, st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_between_any_two_speeds_it_is_as_fast_as_ruckig(length, top, push, first, second):
    begin = first * top
    most, least = (max(begin**2 + sign * 2.0 * push * length, 0.0) ** 0.5 for sign in (1, -1))
    end = min(least + (0.001 + 0.998 * second) * (most - least), top)
    phases = _trapezoid(length, begin, end, top, push)
    query, answer = InputParameter(1), Trajectory(1)
    query.current_position, query.target_position = [0.0], [length]
    query.current_velocity, query.target_velocity = [begin], [end]
    query.max_velocity, query.max_acceleration, query.max_jerk = [top], [push], [np.inf]
    Ruckig(1).calculate(query, answer)
    assert duration(phases) == pytest.approx(answer.duration, rel=1e-6)
    x, speed = way(phases, begin)
    assert (x, speed) == pytest.approx((length, end), rel=1e-6, abs=1e-6)


@given(sizes, sizes)
def test_a_jerk_limited_duration_is_its_closed_form(length, jerk):
    second = np.cbrt(length / jerk)
    phases = _s_curve(length, 1e4 * length / second, 1e7 * length / second**2, jerk)
    assert duration(phases) == pytest.approx(4.0 * np.cbrt(length / (2.0 * jerk)), rel=1e-9)


@given(sizes, sizes, st.floats(0.01, 1.0), st.floats(0.01, 0.99))
def test_an_s_curve_at_its_limits_takes_its_closed_form(length, top, soft, full):
    """L / v + v / a + a / j, where a^2 <= v j, and v^2 / a + v a / j <= L."""
    push = top**2 * (1.0 + soft) / (full * length)
    jerk = push**2 / (top * soft)
    phases = _s_curve(length, top, push, jerk)
    assert duration(phases) == pytest.approx(length / top + top / push + push / jerk, rel=1e-9)


@given(sizes, sizes, sizes, sizes)
def test_s_curves_of_any_size_arrive_within_their_limits(length, top, push, jerk):
    phases = _s_curve(length, top, push, jerk)
    x, speed = way(phases)
    assert x == pytest.approx(length, rel=1e-9)
    assert abs(speed) <= 1e-9 * length / duration(phases)
    speed = 0.0
    for t, acceleration, change in phases:
        speed += acceleration * t + change * t**2 / 2.0
        assert speed <= top * (1.0 + 1e-9)
        assert abs(acceleration) <= push * (1.0 + 1e-9)
        assert abs(change) <= jerk * (1.0 + 1e-9)
    each = length / top, 2.0 * np.sqrt(length / push), 4.0 * np.cbrt(length / (2.0 * jerk))
    assert (1.0 - 1e-9) * max(each) <= duration(phases) <= 1.0001 * sum(each)


@given(seeds)
@settings(max_examples=30)
def test_no_faster_way_passes_the_corners_than_the_one_found(seed):
    """In the plane of x and x'^2, on a grid: below all limits, and below slopes from them."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 6))
    lengths, top = rng.uniform(0.02, 1.0, count), rng.uniform(0.2, 2.0, count)
    push = rng.uniform(0.1, 1.0, count)
    base, none = rng.normal(size=(count, 3)), np.zeros((count, 0))
    pulse = rng.uniform(0.1, 2.0)
    corners = np.concatenate([[0.0], np.cumsum(lengths)])
    runs = StraightRuns(
        corners, np.arange(count), np.arange(count), base, np.zeros((count, 3)), none
    )
    law, speeds = time_law(runs, (top, push, np.full(count, np.inf)), pulse)
    grid = np.concatenate([np.linspace(a, b, 300) for a, b in pairwise(corners)])
    owner = np.repeat(np.arange(count), 300)
    most = top[owner] ** 2
    jump = np.linalg.norm(np.diff(base, axis=0), axis=1)
    for k in range(count - 1):
        most[[300 * k + 299, 300 * k + 300]] = min(
            (pulse / jump[k]) ** 2, top[k] ** 2, top[k + 1] ** 2
        )
    most[[0, -1]] = 0.0
    climbed = np.concatenate([[0.0], np.cumsum(np.diff(grid) * 2.0 * push[owner[1:]])])
    highest = np.min(most + np.abs(climbed[:, None] - climbed), axis=1)
    assert np.allclose(speeds[1:-1] ** 2, highest[300 * np.arange(1, count)], atol=1e-9)
    x, speed, _ = law.on(*(lambda t: (law.piece(t), t))(np.linspace(0.0, law.duration, 4000)))
    assert np.all(speed**2 <= np.interp(x, grid, highest) + 1e-2)
    middle = np.interp((grid[1:] + grid[:-1]) / 2.0, grid, highest)
    assert law.duration == pytest.approx(np.sum(np.diff(grid) / np.sqrt(middle)), rel=0.05)


def test_a_straight_path_is_one_run_however_its_nodes_are_spaced(robot):
    start = robot.configuration(joints={"left_1": -0.6})
    goal = robot.configuration((3, 1, 0), joints={"left_1": 0.7, "right_2": 0.4})
    even = np.linspace(start[:3], goal[:3], 7)
    runs = straight_runs(Motion(robot, "free-flying", start, goal, even))
    assert (list(runs.first), list(runs.last)) == ([0], [5])
    share = np.array([0.0, 0.1, 0.5, 0.9, 1.0])[:, None]
    values = robot.joint_values(start) + share * robot.joint_change(start, goal)
    uneven = start[:3] + share * (goal - start)[:3]
    motion = Motion(robot, "free-flying", start, goal, uneven, values)
    assert len(straight_runs(motion).first) == 1
    assert len(flown(motion, **USUAL).rests) == 0
    out_of_step = Motion(robot, "free-flying", start, goal, even[[0, 1, 3, 5, 6]], values)
    assert len(straight_runs(out_of_step).first) > 1  # the base goes straight, at another pace


def test_edges_along_which_nothing_moves_take_no_time(robot):
    q = robot.configuration()
    way = np.array([[0.0, 0, 0], [1, 0, 0], [1, 0, 0], [2, 0, 0], [2, 0, 0]])
    flight = flown(Motion(robot, "free-flying", q, q, way), **USUAL)
    assert len(flight.rests) == 0
    assert flight.duration == pytest.approx(2.0 * np.sqrt(2.0 / 0.02))
    ends = flight.at([0.0, flight.duration])
    assert np.allclose(ends.configurations[:, 0], [0.0, 2.0], atol=1e-12)


@given(seeds, st.sampled_from(list(Mode)), st.booleans())
@settings(max_examples=20)
def test_corners_are_where_a_direction_changes(seed, mode, joints_bend):
    motion = bent_motion(seed, mode, 5, joints_bend)
    flight = flown(motion, **USUAL)
    corners = 0 if mode == "free-floating" and not joints_bend else 4
    assert len(flight.rests) == corners
    if corners:
        at = flight.at(flight.rests)
        assert np.allclose(at.parameters, np.arange(1, 5) / 5, atol=1e-9)
        assert np.abs(at.velocities).max() < 1e-9


def test_limits_of_x_are_the_tightest_along_each_run():
    motion, rng = bent_motion(3, "attitude-held"), np.random.default_rng(3)
    runs, robot = straight_runs(motion), motion.robot
    names = np.array([
        ["base_velocity", "turn_velocity", "joint_velocity"],
        ["thruster_acceleration", "turn_acceleration", "joint_acceleration"],
        ["thruster_jerk", "none", "joint_jerk"],
    ])  # fmt: skip
    binding = set()
    for _ in range(30):
        values = 10.0 ** rng.uniform(-2.0, 2.0, (3, 3))
        values[2, 1] = np.inf
        given = dict(zip(names.ravel().tolist(), values.ravel().tolist(), strict=True))
        given.pop("none")
        found = read(robot, **given).along(runs)
        for k in range(len(runs.first)):
            rates = np.array([
                np.linalg.norm(runs.base[k]), np.linalg.norm(runs.turn[k]),
                np.abs(runs.joints[k]).max(),
            ])  # fmt: skip
            due = values / rates
            assert np.allclose([each[k] for each in found], due.min(axis=1), rtol=1e-12)
            binding |= set(names[np.arange(3), due.argmin(axis=1)].tolist())
    assert len(binding) == 8


def test_limits_by_name_are_those_of_their_joints():
    robot = bent_motion(3, "free-floating").robot
    numbers = {name: 0.1 + k for k, name in enumerate(robot.joint_names)}
    found = read(robot, joint_acceleration=numbers, joint_jerk=numbers, joint_torque=numbers)
    values = list(numbers.values())
    assert np.array_equal(found.acceleration[2:], values)
    assert np.array_equal(found.jerk[2:], values)
    assert np.array_equal(found.torque, values)
