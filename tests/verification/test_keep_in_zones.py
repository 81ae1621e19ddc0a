"""Distances of robot solids from the outside of zones, by all their points."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import ffsr_plan as fp
from ffsr_plan.scene.shapes.keep_in_zones import HalfSpace
from ffsr_plan.scene.shapes.obstacle_shapes import Ball, Box
from tests.helpers.placed_shapes import SOLIDS, measured, moved, quaternion, turn_of

EXACT = 1e-12  # [m]


def random_zone(rng, kind):
    """A zone about the origin, a few metres in size, or a half-space."""
    position = rng.normal(size=3)
    if kind == "ball":
        return Ball(float(rng.uniform(1.0, 5.0)), position)
    if kind == "half-space":
        direction = rng.normal(size=3) * 7.0
        return HalfSpace(direction, position + 0.3 * direction)
    return Box(rng.uniform(2.0, 10.0, 3), position, quaternion(rng))


def room(zone, points):
    """How far points (n, 3) are from the outside of a zone at least, negative beyond it [m]."""
    if isinstance(zone, Ball):
        return zone.radius - np.max(np.linalg.norm(points - zone.position, axis=1))
    if isinstance(zone, HalfSpace):
        normal = zone.direction / np.linalg.norm(zone.direction)
        return -np.max((points - zone.position) @ normal)
    local = (points - zone.position) @ turn_of(zone)
    return np.min(0.5 * zone.size - np.abs(local))


def robot_at(rng, solid):
    """A robot solid with its rotation and place."""
    turn = Rotation.from_quat(quaternion(rng)).as_matrix()
    return SOLIDS[solid](rng), turn, rng.normal(size=3)


@pytest.mark.parametrize("kind", ["box", "ball", "half-space"])
@pytest.mark.parametrize("solid", SOLIDS)
def test_the_distance_from_the_outside_is_that_of_the_farthest_point(solid, kind):
    rng = np.random.default_rng([len(solid), len(kind)])
    inside = 0
    for _ in range(40):
        zone, (robot, turn, place) = random_zone(rng, kind), robot_at(rng, solid)
        expected = room(zone, robot.points @ turn.T + place) - robot.swell
        found = measured(rng, robot, turn, place, fp.Scene(keep_in=[zone]))
        assert found == pytest.approx(expected, abs=EXACT)
        shrunk = fp.Scene(keep_in=[zone], growth=0.2).grown(0.1)
        found = measured(rng, robot, turn, place, shrunk)
        assert found == pytest.approx(expected - 0.3, abs=EXACT)
        inside += expected > 0.0
    assert 0 < inside < 40


def test_surfaces_of_widened_solids_stay_in_what_their_distance_allows():
    """Points on the surface of a capsule, not only on the segment in it."""
    rng = np.random.default_rng(1)
    for _ in range(20):
        zone, (robot, turn, place) = random_zone(rng, "box"), robot_at(rng, "capsule")
        outward = rng.normal(size=(20_000, 3))
        outward /= np.linalg.norm(outward, axis=1)[:, None]
        surface = (robot.points[:, None] + robot.swell * outward).reshape(-1, 3)
        least = room(zone, surface @ turn.T + place)
        found = measured(rng, robot, turn, place, fp.Scene(keep_in=[zone]))
        assert found <= least + EXACT
        assert found == pytest.approx(least, abs=2e-3)


@pytest.mark.parametrize("solid", SOLIDS)
def test_zones_spheres_and_shapes_together_give_the_least(solid):
    rng = np.random.default_rng([2, len(solid)])
    least_by = set()
    for _ in range(60):
        robot, turn, place = robot_at(rng, solid)
        zones = [random_zone(rng, kind) for kind in ("box", "ball", "half-space")]
        box, sphere = Box([0.5, 1.0, 0.0], rng.normal(size=3) * 2.0), rng.normal(size=3) * 2.0
        alone = [fp.Scene([sphere], [0.3]), fp.Scene(shapes=[box])]
        alone += [fp.Scene(keep_in=[zone]) for zone in zones]
        values = [measured(rng, robot, turn, place, scene) for scene in alone]
        scene = fp.Scene([sphere], [0.3], shapes=[box], keep_in=zones)
        found = measured(rng, robot, turn, place, scene)
        if min(values) > 0.0:
            assert found == pytest.approx(min(values), abs=1e-9)
            least_by.add(int(np.argmin(values)))
        else:
            assert found <= 0.0
    assert len(least_by) >= 3


def test_zones_far_from_the_origin_are_as_sharp():
    rng, origin = np.random.default_rng(3), np.array([9e4, -8e4, 7e4])
    for kind in ("box", "ball", "half-space"):
        robot, turn, place = robot_at(rng, "polytope")
        zone = random_zone(rng, kind)
        scene = fp.Scene(keep_in=[moved(zone, origin)])
        found = measured(rng, robot, turn, place + origin, scene, origin)
        expected = measured(rng, robot, turn, place, fp.Scene(keep_in=[zone]))
        assert found == pytest.approx(expected, abs=1e-9)
