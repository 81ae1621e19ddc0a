"""Plans verified among shapes and in zones that were put around them later."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core.arrays import frozen
from ffsr_plan.scene.shapes.keep_in_zones import HalfSpace
from ffsr_plan.scene.shapes.obstacle_shapes import Ball, Box, Capsule, Cylinder, Ellipsoid, Hull
from ffsr_plan.verification.flights.verify_flight import verify_flight
from ffsr_plan.verification.recomputed_objective import objective_of, station_clearances
from ffsr_plan.verification.urdf_reading import Bodies
from tests.helpers.careless_plans import MODES, careless_plan, placed
from tests.helpers.placed_shapes import moved, nearest_points

AROUND = {
    "box": Box([0.2, 0.3, 0.1], attitude=[0.3, 0.5, -0.2]),
    "panel": Box([0.3, 0.3, 0.0], attitude=[0.3, 0.5, -0.2]),
    "ball": Ball(0.1),
    "capsule": Capsule(0.05, 0.3, attitude=[0.3, 0.5, -0.2]),
    "cylinder": Cylinder(0.1, 0.2, attitude=[0.3, 0.5, -0.2]),
    "ellipsoid": Ellipsoid([0.1, 0.05, 0.2], attitude=[0.3, 0.5, -0.2]),
    "hull": Hull([[0.2, 0, 0], [0, 0.2, 0], [0, 0, 0.2], [0, 0, 0], [-0.1, -0.1, -0.1]]),
}
"""One shape of each kind about the origin."""


def among(plan, **obstacles):
    """The plan in another scene, with node clearances of zero: those are not looked at here."""
    problem = replace(plan.problem, scene=fp.Scene(**obstacles))
    certificate = plan.certificate._replace(least_clearance=0.0)
    return replace(plan, problem=problem, certificate=certificate)


def hits(report):
    """What a report says of obstacles."""
    return [each for each in report.problems if "on edge" in each or "proven clearance" in each]


@pytest.fixture(scope="module")
def straight():
    """A point that flies ten metres along x in an empty scene."""
    point = fp.load_robot("point")
    goal = point.configuration((10.0, 0, 0))
    problem = fp.Problem(point, fp.Scene(), point.configuration(), goal, lattice=fp.Lattice(2))
    return fp.plan(problem, fp.LatticeOptimum(), refine=False)


@pytest.mark.parametrize("kind", AROUND)
@pytest.mark.parametrize("samples", [1, 50])
def test_a_shape_between_two_samples_is_found_and_named(straight, kind, samples):
    shape = moved(AROUND[kind], np.array([3.217, 0.0, 0.0]))
    report = among(straight, shapes=[replace(shape, name="relic")]).verify(samples)
    assert not report.ok
    if kind == "panel":  # a point passes through it between any two samples
        assert "may touch an obstacle on edge 0" in hits(report)[0]
        return
    assert report.least_clearance < 0.0
    assert f"{shape.word} 'relic' on edge 0" in hits(report)[0]


@pytest.mark.parametrize("kind", AROUND)
def test_a_shape_beside_the_way_is_passed_with_its_clearance(straight, kind):
    shape = moved(AROUND[kind], np.array([3.217, 2.0, 0.5]))
    (solid, poses), *rest = placed(straight, np.linspace(0.3, 0.35, 101))
    assert not rest
    away = min(nearest_points(solid, pose[:3, :3], pose[:3, 3], shape) for pose in poses)
    report = among(straight, shapes=[shape]).verify()
    assert not hits(report)
    assert report.least_clearance == pytest.approx(away, abs=2e-3)
    grown = among(straight, shapes=[shape], growth=away - 0.01).verify()
    assert not hits(grown)
    assert 0.0 < grown.clearance_bound <= grown.least_clearance < 0.02
    assert hits(among(straight, shapes=[shape], growth=away + 0.01).verify())


@pytest.mark.parametrize(
    "zone", [Box([4.0, 4.0, 4.0]), Ball(2.0), HalfSpace([1.0, 0.0, 0.0], [2.0, 0.0, 0.0])]
)
def test_a_plan_that_leaves_a_zone_is_found_out(straight, zone):
    report = among(straight, keep_in=[zone]).verify()
    assert report.least_clearance < -7.0
    assert f"outside of {zone.word} (keep_in.0)" in hits(report)[0]


def test_a_plan_inside_its_zones_verifies(straight):
    corridor = Box([12.0, 2.0, 2.0], [5.0, 0.0, 0.0])
    scene = {"keep_in": [corridor, HalfSpace([1.0, 0.0, 0.0], [10.4, 0.0, 0.0])]}
    report = among(straight, **scene).verify()
    assert not hits(report)
    assert 0.0 < report.clearance_bound <= report.least_clearance <= 0.4


def test_a_claim_without_obstacles_is_not_confirmed_among_shapes(straight):
    """Scenes of shapes alone and of zones alone are not empty."""
    for obstacles in ({"shapes": [Ball(0.1, [0, 5.0, 0])]}, {"keep_in": [Ball(20.0)]}):
        problem = replace(straight.problem, scene=fp.Scene(**obstacles))
        report = replace(straight, problem=problem).verify()
        assert np.isinf(straight.certificate.least_clearance)
        assert np.isfinite(report.least_clearance)
        assert hits(report)


@pytest.mark.parametrize("mode", MODES)
def test_a_shape_anywhere_in_the_way_of_a_robot_is_found(mode):
    for seed in range(4):
        plan, rng = careless_plan(seed, mode)
        shapes = placed(plan, np.array([rng.uniform(0.05, 0.95)]))
        solid, at = shapes[int(rng.integers(len(shapes)))]
        corner = solid.points[int(rng.integers(len(solid.points)))]
        center = at[0, :3, :3] @ corner + at[0, :3, 3]
        kind = list(AROUND)[int(rng.integers(len(AROUND)))]
        small = replace(moved(AROUND[kind], center), name="relic")
        for samples in (1, 7):
            assert "relic" in " ".join(hits(among(plan, shapes=[small]).verify(samples)))


def test_min_clearance_grows_shapes_and_shrinks_zones(straight):
    shape = Box([0.2, 0.2, 0.2], [5.0, 3.0, 0.0])
    zone = Box([30.0, 20.0, 20.0])
    for obstacles in ({"shapes": [shape]}, {"keep_in": [zone]}):
        plain = among(straight, **obstacles).verify()
        kept = among(straight, **obstacles)
        kept = replace(kept, problem=replace(kept.problem, min_clearance=0.5))
        assert kept.verify().least_clearance == pytest.approx(plain.least_clearance - 0.5, abs=1e-9)


def test_the_objective_counts_shapes_and_zones(straight):
    """d_i of Eq. 7 at the node in the middle, by hand."""
    (solid, _), *_ = placed(straight, np.array([0.5]))
    far = Box([1.0, 1.0, 1.0], [5.0, 4.0, 0.0])
    for obstacles, away in (
        ({"shapes": [far]}, 3.5 - solid.swell),
        ({"keep_in": [Box([40.0, 5.0, 40.0])]}, 2.5 - solid.swell),
    ):
        counted = among(straight, **obstacles)
        counted = replace(counted, problem=replace(counted.problem, delta=0.5))
        report = counted.verify()
        nodes = frozen(np.full(3, away))
        expected = objective_of(counted.problem, counted.length, nodes)
        stated = replace(counted, objective=expected, clearances=nodes)
        assert any("F is" in each for each in report.problems)
        again = stated.verify()
        assert again.objective_error < 1e-12, away
        assert not any("F is" in each for each in again.problems)


def test_clearances_between_nodes_count_shapes_without_a_lattice():
    """The stations of a path without a lattice, which are measured by themselves."""
    point = fp.load_robot("point")
    goal = point.configuration((10.0, 0, 0))
    plan = fp.plan(fp.Problem(point, fp.Scene(), point.configuration(), goal))
    shape = Cylinder(0.5, 1.0, [5.0, 3.0, 0.0], attitude=[0.0, np.pi / 2, 0.0])
    plan = among(plan, shapes=[shape])
    bodies = Bodies(point.urdf)
    found = station_clearances(plan, bodies, np.ones(plan.edges))
    (solid, poses), *_ = placed(plan, np.linspace(0.0, 1.0, 41))
    expected = [nearest_points(solid, pose[:3, :3], pose[:3, 3], shape) for pose in poses]
    assert np.allclose(found, expected, rtol=0.0, atol=1e-6)


class Elsewhere:
    """A flight in another scene."""

    def __init__(self, flight, scene):
        self._flight, self.problem = flight, replace(flight.problem, scene=scene)

    def __getattr__(self, name):
        return getattr(self._flight, name)


def flown_among(flight, **obstacles):
    """Report of a flight in another scene, without a clearance to confirm."""
    return verify_flight(Elsewhere(flight, fp.Scene(**obstacles)), 0.0)


@pytest.mark.parametrize("kind", AROUND)
def test_a_shape_in_the_way_of_a_flight_is_found(fig2a_plan, kind):
    flight = fig2a_plan.timed(joint_acceleration=0.05, thruster_acceleration=0.01)
    place = flight.at([0.4 * flight.duration]).base_position[0]
    shape = moved(replace(AROUND[kind], name="relic"), place)
    assert "'relic' on piece" in " ".join(flown_among(flight, shapes=[shape]).problems)
    far = flown_among(flight, shapes=[moved(shape, np.array([0.0, 0.0, 30.0]))])
    assert far.ok, far.problems
    assert 20.0 < far.least_clearance < 30.0


def test_a_flight_out_of_a_zone_is_found(fig2a_plan):
    flight = fig2a_plan.timed(joint_acceleration=0.05, thruster_acceleration=0.01)
    ends = flight.problem.start[:3], flight.problem.goal[:3]
    middle, size = np.mean(ends, axis=0), np.abs(ends[1] - ends[0])
    narrow = flown_among(flight, keep_in=[Box(size + 0.01, middle)])
    assert "outside of box (keep_in.0) on piece" in " ".join(narrow.problems)
    wide = flown_among(flight, keep_in=[Box(size + 20.0, middle)])
    assert wide.ok, wide.problems
    assert 0.0 < wide.clearance_bound <= wide.least_clearance < 10.0
