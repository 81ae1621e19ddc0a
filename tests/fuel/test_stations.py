"""Stations on a control polygon and its curve move with the control points as these do."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.curves.control_points import control_points_on
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.fuel.stations import on_curve, on_polygon, usual_stations
from ffsr_plan.lattice.layered_lattice import LayeredLattice


def random_places(divisions, count=40):
    rng = np.random.default_rng(divisions)
    return rng.integers(0, divisions, count), rng.uniform(0.0, 1.0, count)


@pytest.mark.parametrize("divisions", [2, 3, 7, 40])
def test_shares_are_not_negative_and_make_one(divisions):
    for stations in (
        on_polygon(*random_places(divisions)),
        on_curve(divisions, *random_places(divisions)),
        usual_stations(divisions),
    ):
        assert stations.shares.sum(axis=1) == pytest.approx(1.0, abs=1e-14)
        inner = (stations.points > 0) & (stations.points < divisions)
        assert np.all(stations.shares[inner] >= -1e-15)
        assert stations.points.min() >= 0
        assert stations.points.max() <= divisions


@pytest.mark.parametrize("divisions", [2, 3, 7, 40])
def test_stations_lie_on_the_motion_and_on_the_curve(divisions):
    robot = fp.load_robot("planar_dual_arm")
    start = robot.configuration()
    goal = robot.configuration((6.0, 1.0, 0.5), joints={"left_1": 0.5})
    lattice = fp.Lattice(divisions, fp.Axis(1, 1.0))
    nominal = LayeredLattice(fp.Problem(robot, fp.Scene([], []), start, goal, lattice=lattice))
    rng = np.random.default_rng(0)
    offsets = rng.normal(size=(divisions + 1, 3))
    offsets[[0, -1]] = 0.0
    motion = nominal.nominal.displaced(offsets)
    curve = CurvedMotion(motion, control_points_on(motion, np.arange(divisions + 1.0)))
    edges, times = random_places(divisions)
    at = nominal.nominal.at(edges, times)
    for stations, truth in (
        (on_polygon(edges, times), motion.at(edges, times)),
        (on_curve(divisions, edges, times), curve.at(edges, times)),
    ):
        assert at[:, :3] + stations.displaced(offsets) == pytest.approx(truth[:, :3], abs=1e-12)
        assert at[:, 3:] == pytest.approx(truth[:, 3:], abs=1e-12)
