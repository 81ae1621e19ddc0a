"""The fastest time law along straight runs, and the straight runs of a motion."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.trajectory.straight_runs import StraightRuns, straight_runs
from ffsr_plan.trajectory.time_law import PulseLimits, time_law
from tests.helpers.random_motions import USUAL, bent_motion, flown

seeds = st.integers(0, 10_000)


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
    each = np.arange(count)
    runs = StraightRuns(corners, lengths, each, each, base, np.zeros((count, 3)), none)
    at_once = PulseLimits(pulse, 1e12)
    law, speeds, _ = time_law(runs, (top, push, np.full(count, np.inf)), at_once)
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


@given(seeds)
@settings(max_examples=50)
def test_speeds_between_runs_are_the_highest_that_pulses_leave(seed):
    """A linear programme in x'^2, where no pulse needs more thrust than the run's own limit."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 7))
    lengths, top = 10.0 ** rng.uniform(-2, 1, count), rng.uniform(0.2, 3.0, count)
    strength, velocity_jump = rng.uniform(0.1, 1.0), 10.0 ** rng.uniform(-2, 1)
    base = rng.normal(size=3) + 0.4 * rng.normal(size=(count, 3))
    jump = np.linalg.norm(np.diff(base, axis=0), axis=1)
    turning = np.concatenate([[0.0], jump / strength, [0.0]])
    steepest = 1.0 / np.maximum(turning[:-1], turning[1:])
    push = np.minimum(strength / np.linalg.norm(base, axis=1), steepest)
    corners = np.concatenate([[0.0], np.cumsum(lengths)])
    each = np.arange(count)
    none = np.zeros((count, 0))
    runs = StraightRuns(corners, lengths, each, each, base, np.zeros((count, 3)), none)
    pulses = PulseLimits(velocity_jump, strength)
    _, speeds, lasting = time_law(runs, (top, push, np.full(count, np.inf)), pulses)
    rows, bounds = [], []
    for k in range(count):
        for sign in (-1.0, 1.0):
            row = np.zeros(count + 1)
            row[k] = turning[k] + sign / push[k]
            row[k + 1] = turning[k + 1] - sign / push[k]
            rows.append(row)
            bounds.append(2.0 * lengths[k])
    most = np.zeros(count + 1)
    most[1:-1] = np.minimum(velocity_jump / jump, np.minimum(top[:-1], top[1:])) ** 2
    most[1:-1] = np.minimum(most[1:-1], np.minimum(lengths[:-1], lengths[1:]) / turning[1:-1])
    best = linprog(
        -np.ones(count + 1), rows, bounds, bounds=list(zip(0.0 * most, most, strict=True))
    )
    assert np.allclose(speeds**2, best.x, rtol=1e-6, atol=1e-9)
    assert np.allclose(lasting[1:-1] * strength, speeds[1:-1] * jump)


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
