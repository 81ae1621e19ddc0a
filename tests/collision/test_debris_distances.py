"""Distances to drifting spheres, against all pairs."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.collision.debris.debris_distances import DebrisDistances
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.shape_placements import shape_placements
from tests.helpers.drifting_spheres import cloud_about

FAR = np.full(30, np.inf)


@pytest.fixture(params=["planar_dual_arm", "hull"], scope="module")
def robot(request):
    """A robot of boxes and round shapes, and one of hulls."""
    if request.param == "hull":
        return fp.load_robot("planar_dual_arm", cylinders="hull")
    return fp.load_robot(request.param)


def placements(robot, rng, count=30):
    q = [
        robot.configuration(
            rng.uniform((0.0, -1.0, -0.5), (4.0, 1.0, 0.5)),
            rng.uniform(-2.0, 2.0, 3),
            dict(zip(robot.joint_names, rng.uniform(-1.0, 1.0, robot.nd), strict=True)),
        )
        for _ in range(count)
    ]
    return np.array(q), shape_placements(robot, np.array(q))


@pytest.mark.parametrize("spread", [0.0, 5.0])
def test_distances_are_those_to_all_spheres_at_their_times(robot, spread):
    rng, cloud = np.random.default_rng(3), cloud_about(2, 200)
    scene = fp.Scene(debris=[cloud], growth=0.01)
    q, placed = placements(robot, rng)
    times, shifts = rng.uniform(0.0, 40.0, 30), rng.normal(size=(30, 3)) * 0.3
    query = DebrisDistances(robot, scene, 20.0)
    rows = np.arange(30)
    found = query.least(placed, rows, shifts, times, np.full(30, spread), FAR)
    own = 0.01 + 0.5 * spread * np.linalg.norm(cloud.velocities, axis=1)
    for k in range(30):
        there = fp.Scene(cloud.centers_at(times[k]) - shifts[k], cloud.radii + own)
        expected = ObstacleQuery(robot, there).nearest(q[k])
        assert found[k] == pytest.approx(expected.distance, abs=1e-10)
        links = query.links_at(placed, k, shifts[k], times[k], spread)
        assert links.min() == pytest.approx(expected.distance, abs=1e-10)
        if not spread:
            near = query.nearest_at(placed, k, shifts[k], times[k])
            assert near == (pytest.approx(found[k]), expected.link, expected.obstacle)


def test_a_sphere_is_measured_only_if_it_is_nearer_than_others(robot):
    rng, scene = np.random.default_rng(4), fp.Scene(debris=[cloud_about(5, 100)])
    _, placed = placements(robot, rng)
    where = np.arange(30), np.zeros((30, 3)), rng.uniform(0.0, 40.0, 30), np.zeros(30)
    query, others = DebrisDistances(robot, scene, 20.0), rng.uniform(-0.1, 0.5, 30)
    alone = query.least(placed, *where, FAR)
    assert np.array_equal(query.least(placed, *where, others), np.minimum(alone, others))
