"""Uniform cubic B-splines in Bernstein form, against SciPy's."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from ffsr_plan.core.arrays import Array
from ffsr_plan.curves.control_points import ControlPoints
from ffsr_plan.curves.kernels import pieces as kernels
from ffsr_plan.curves.splines import (
    bernstein_pieces,
    control_points_through,
    derivative,
    evaluate,
    pieces_with,
)
from tests.helpers.dense_curve import spline

RNG = np.random.default_rng(0)
CONTROL = [RNG.normal(size=(count, 3)) for count in (2, 3, 4, 9)]


def grid(pieces: int) -> tuple[Array, Array]:
    return np.repeat(np.arange(pieces), 21), np.tile(np.linspace(0.0, 1.0, 21), pieces)


@pytest.mark.parametrize("control", CONTROL)
def test_the_pieces_are_those_of_the_reflected_b_spline(control):
    values = bernstein_pieces(control)
    edge, time = grid(len(values))
    for order in range(3):
        found = evaluate(values, edge, time)
        assert found == pytest.approx(spline(control)(edge + time, order), abs=1e-13)
        values = derivative(values)


@pytest.mark.parametrize("control", CONTROL)
def test_a_curve_is_twice_continuously_differentiable_and_meets_its_ends(control):
    values = bernstein_pieces(control)
    assert np.array_equal(values[0, 0], control[0])
    assert np.array_equal(values[-1, 3], control[-1])
    assert np.array_equal(values[1:, 0], values[:-1, 3])
    for each in (derivative(values), derivative(derivative(values))):
        assert np.allclose(each[1:, 0], each[:-1, -1], rtol=0.0, atol=1e-13)
    bends = derivative(derivative(values))
    assert np.allclose([bends[0, 0], bends[-1, -1]], 0.0, atol=1e-13)


def test_equal_steps_on_a_line_give_that_line():
    line = np.array([1.0, -2.0, 0.5]) + np.arange(8.0)[:, None] * [0.3, 0.1, -0.7]
    edge, time = grid(7)
    wanted = line[0] + (edge + time)[:, None] * [0.3, 0.1, -0.7]
    assert evaluate(bernstein_pieces(line), edge, time) == pytest.approx(wanted, abs=1e-14)


def test_a_curve_stays_within_the_range_of_its_control_points():
    for control in CONTROL:
        values = bernstein_pieces(control)
        assert np.all(values <= control.max(axis=0) + 1e-15)
        assert np.all(values >= control.min(axis=0) - 1e-15)


@pytest.mark.parametrize("nodes", CONTROL)
def test_the_spline_through_nodes_is_the_natural_one(nodes):
    values = bernstein_pieces(control_points_through(nodes))
    edge, time = grid(len(values))
    if len(nodes) == 2:
        wanted = nodes[0] + time[:, None] * (nodes[1] - nodes[0])
    else:
        wanted = CubicSpline(np.arange(len(nodes)), nodes, bc_type="natural")(edge + time)
    assert evaluate(values, edge, time) == pytest.approx(wanted, abs=1e-12)


def test_a_curve_rests_at_a_control_point_that_is_there_thrice_and_keeps_to_the_polygon():
    corners = CONTROL[3]
    control = ControlPoints(corners, corners, corners[:, 0])
    counts = np.array([1, *[3] * 7, 1])
    values = bernstein_pieces(control.repeated(counts).positions)
    middle = np.cumsum(counts)[1:-1] - 2
    assert values[middle, 0] == pytest.approx(corners[1:-1])
    for each in (derivative(values), derivative(derivative(values))):
        assert np.allclose(each[middle, 0], 0.0, atol=1e-13)
    edge, time = grid(len(values))
    for point in evaluate(values, edge, time):
        steps = np.diff(corners, axis=0)
        share = np.clip(np.sum((point - corners[:-1]) * steps, 1) / np.sum(steps**2, 1), 0, 1)
        away = np.linalg.norm(corners[:-1] + share[:, None] * steps - point, axis=1)
        assert away.min() < 1e-13


@pytest.mark.parametrize("seed", range(50))
def test_bounds_over_a_part_hold_and_are_met_by_some_piece(seed):
    rng = np.random.default_rng(seed)
    made = pieces_with(rng.normal(size=(4, 5)), np.zeros(3))
    values = made.values
    begin, end = np.sort(rng.random(2)).tolist()
    edge, time = np.full(201, 1), np.linspace(begin, end, 201)
    rate, bend = evaluate(made.rates, edge, time), evaluate(made.bends, edge, time)
    for column in range(5):
        bound = kernels.largest_rate(made, 1, begin, end, column)
        assert np.abs(rate[:, column]).max() <= bound + 1e-13
        assert bound <= np.abs(rate[:, column]).max() + (end - begin) ** 2 * 20.0
        sharp = np.abs(bend[:, column]).max()
        assert kernels.largest_bend(made, 1, begin, end, column) == pytest.approx(sharp)
        for k in (0, 100, 200):
            at = kernels.value_at(made, 1, time[k], column)
            assert at == pytest.approx(evaluate(values, edge[:1], time[[k]])[0, column])
    speed, bending = kernels.largest_base_rates(made, 1, begin, end)
    assert np.linalg.norm(rate[:, :3], axis=1).max() <= speed + 1e-13
    assert np.linalg.norm(bend[:, :3], axis=1).max() == pytest.approx(bending)
