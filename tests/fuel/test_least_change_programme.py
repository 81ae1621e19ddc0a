"""The linear programme of least change of velocity, against closed forms and a general solver."""

import numpy as np
import pytest
from scipy.optimize import minimize

from ffsr_plan.fuel.least_change_programme import Cuts, Programme
from ffsr_plan.search.fuel_figures import velocity_change

NONE = np.zeros(0, dtype=np.int64)
NO_CUTS = Cuts(NONE.reshape(0, 4), np.zeros((0, 4, 1)), np.zeros(0), NONE)


def cuts_at(points, slopes, values):
    """One clearance a station, each by the offset of one control point."""
    points, slopes = np.asarray(points), np.asarray(slopes, dtype=float)
    four = np.repeat(points[:, None], 4, axis=1)
    shares = np.zeros((len(points), 4, slopes.shape[1]))
    shares[:, 0] = slopes
    return Cuts(four, shares, np.asarray(values, dtype=float), np.arange(len(points)))


def positions(offsets, step):
    along = np.arange(len(offsets))[:, None] * step
    return np.hstack([along, offsets, np.zeros((len(offsets), 2 - offsets.shape[1]))])


@pytest.mark.parametrize("axes", [1, 2])
def test_the_change_is_that_of_the_polygon(axes):
    offsets = np.random.default_rng(axes).normal(size=(9, axes))
    programme = Programme.lateral(8, 0.5, np.full(axes, 3.0))
    change = velocity_change(positions(offsets, 0.5))
    assert 8 * programme.change(offsets) == pytest.approx(change, rel=1e-14)


def test_without_clearances_the_way_becomes_straight():
    offsets = np.zeros((9, 1))
    offsets[1:-1] = np.random.default_rng(0).normal(size=(7, 1))
    programme = Programme.lateral(8, 0.5, np.array([5.0]))
    found = programme.best(offsets, NO_CUTS, 10.0)
    assert found == pytest.approx(0.0, abs=1e-7)
    near = programme.best(offsets, NO_CUTS, 0.1)
    assert np.abs(near - offsets).max() <= 0.1 + 1e-9
    assert programme.change(near) < programme.change(offsets)


def test_past_one_wall_in_the_plane_two_turns_at_most_are_made():
    """A wall of height 1 at the middle: to the side at once, one turn there."""
    programme, still = Programme.lateral(8, 0.5, np.array([5.0])), np.zeros((9, 1))
    found = programme.best(still, cuts_at([4], [[1.0]], [-1.0]), 10.0)
    assert found[4, 0] == pytest.approx(1.0, abs=1e-7)
    tent = np.interp(np.arange(9), [0, 4, 8], [0, 1, 0])[:, None]
    assert programme.change(found) == pytest.approx(programme.change(tent), rel=5e-4)


@pytest.mark.parametrize("seed", range(4))
def test_in_space_it_agrees_with_a_general_solver(seed):
    rng = np.random.default_rng(seed)
    points = np.arange(1, 6)
    slopes = rng.normal(size=(5, 2))
    slopes /= np.linalg.norm(slopes, axis=1)[:, None]
    values = rng.uniform(-0.6, 0.2, 5)
    programme = Programme.lateral(6, 0.3, np.full(2, 9.0))
    found = programme.best(np.zeros((7, 2)), cuts_at(points, slopes, values), 9.0)
    assert np.all(values + np.sum(slopes * found[points], axis=1) >= -1e-7)

    def change(flat):
        return programme.change(np.vstack([np.zeros(2), flat.reshape(5, 2), np.zeros(2)]))

    walls = {"type": "ineq", "fun": lambda x: values + np.sum(slopes * x.reshape(5, 2), axis=1)}
    best = min(
        minimize(change, rng.normal(size=10) * 0.1, constraints=walls, options={"maxiter": 500}).fun
        for _ in range(5)
    )
    assert programme.change(found) <= best * (1.0 + 1e-3)


def test_a_clearance_that_cannot_be_had_is_missed_by_as_little_as_possible():
    programme, still = Programme.lateral(4, 1.0, np.array([0.5])), np.zeros((5, 1))
    found = programme.best(still, cuts_at([2], [[1.0]], [-2.0]), 9.0)
    assert found[2, 0] == pytest.approx(0.5, abs=1e-9)  # the rim


def test_many_clearances_at_one_station_all_count():
    values = np.linspace(-0.5, -0.1, 9)
    points = np.full((9, 4), 2)
    slopes = np.zeros((9, 4, 1))
    slopes[:, 0, 0] = np.linspace(1.0, 0.1, 9)  # the last needs 1 m, the nearest ones 0.5 m
    cuts = Cuts(points, slopes, values, np.zeros(9, dtype=int))
    found = Programme.lateral(4, 1.0, np.array([9.0])).best(np.zeros((5, 1)), cuts, 9.0)
    needed = np.max(-values / slopes[:, 0, 0])
    assert found[2, 0] == pytest.approx(needed, abs=1e-6)
