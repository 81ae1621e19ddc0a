"""Distances of robot solids from obstacle shapes: bodies put at a known distance, and scipy."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import ffsr_plan as fp
from ffsr_plan.scene.shapes.obstacle_shapes import Ball, Box, Cylinder, Ellipsoid
from ffsr_plan.verification import solids
from ffsr_plan.verification.separation import SampledDistances
from tests.helpers.placed_shapes import (
    SHAPES,
    SOLIDS,
    corners_of,
    directions,
    farthest_of_shape,
    farthest_of_solid,
    measured,
    middle_and_depth,
    moved,
    nearest_points,
    placed_samples,
    quaternion,
    robot_of,
    round_part,
    scene_of,
    turn_of,
)

EXACT = 1e-9  # [m]
PAIRS = [(solid, shape) for solid in SOLIDS for shape in SHAPES]
HERE = np.eye(3), np.zeros(3)


def bodies(rng, solid, shape):
    """A robot solid with its rotation and place, and a shape about the origin."""
    turn = Rotation.from_quat(quaternion(rng)).as_matrix()
    return SOLIDS[solid](rng), turn, rng.normal(size=3), SHAPES[shape](rng)


def put_apart(solid, turn, place, shape, direction, distance):
    """The shape, displaced so that the farthest points of both are that far apart."""
    own = farthest_of_solid(solid, turn, place, direction)
    other = farthest_of_shape(shape, -direction)
    return moved(shape, own + distance * direction - other)


@pytest.mark.parametrize(("solid", "shape"), PAIRS)
def test_bodies_put_at_a_distance_are_at_that_distance(solid, shape):
    rng = np.random.default_rng(PAIRS.index((solid, shape)))
    for _ in range(12):
        robot, turn, place, obstacle = bodies(rng, solid, shape)
        for direction in directions(rng, robot, turn, obstacle):
            for distance, sharp in ((2.5, EXACT), (0.1, EXACT), (1e-4, EXACT), (1e-7, 1e-8)):
                placed = put_apart(robot, turn, place, obstacle, direction, distance)
                found = measured(rng, robot, turn, place, scene_of(placed))
                assert found == pytest.approx(distance, abs=sharp)
            placed = put_apart(robot, turn, place, obstacle, direction, 0.0)
            assert measured(rng, robot, turn, place, scene_of(placed)) < 1e-12


@pytest.mark.parametrize(("solid", "shape"), PAIRS)
def test_distances_at_any_place_are_those_of_nearest_points(solid, shape):
    rng = np.random.default_rng([1, PAIRS.index((solid, shape))])
    apart = 0
    for _ in range(5):
        robot, turn, place, obstacle = bodies(rng, solid, shape)
        obstacle = moved(obstacle, rng.normal(size=3) * 1.5)
        found = measured(rng, robot, turn, place, scene_of(obstacle))
        bound = nearest_points(robot, turn, place, obstacle)
        assert found <= bound + EXACT
        if bound > 1e-3:
            apart += 1
            assert found == pytest.approx(bound, abs=1e-6)
    assert apart


@pytest.mark.parametrize(("solid", "shape"), PAIRS)
def test_growth_is_taken_from_every_distance(solid, shape):
    rng = np.random.default_rng([2, PAIRS.index((solid, shape))])
    for _ in range(10):
        robot, turn, place, obstacle = bodies(rng, solid, shape)
        direction = directions(rng, robot, turn, obstacle)[0]
        placed = put_apart(robot, turn, place, obstacle, direction, 0.3)
        scene = scene_of(placed, growth=0.1).grown(0.05)
        assert measured(rng, robot, turn, place, scene) == pytest.approx(0.15, abs=EXACT)
        touching = scene_of(placed).grown(0.4)
        found = measured(rng, robot, turn, place, touching)
        assert (
            found == pytest.approx(-0.1, abs=EXACT) or found < -0.1
        )  # exact if the cores are apart


@pytest.mark.parametrize(("solid", "shape"), PAIRS)
def test_where_bodies_overlap_no_distance_is_above_the_truth(solid, shape):
    """A ball inside each about its middle is known, and how far their surfaces are beyond."""
    rng = np.random.default_rng([3, PAIRS.index((solid, shape))])
    for k in range(15):
        robot, turn, place, obstacle = bodies(rng, solid, shape)
        own, room = middle_and_depth(robot.points, np.full(3, robot.swell))
        other, more = middle_and_depth(corners_of(obstacle), round_part(obstacle))
        off = rng.normal(size=3)
        off *= rng.uniform(0.0, 1.0) * (k % 3 > 0) * (room + more) / np.linalg.norm(off)
        by = place + turn @ own - turn_of(obstacle) @ other + off
        found = measured(rng, robot, turn, place, scene_of(moved(obstacle, by)))
        assert np.isfinite(found)
        assert found <= -(room + more - np.linalg.norm(off)) + EXACT


@pytest.mark.parametrize("half", [(0.3, 0.2, 0.1), (0.3, 0.2, 0.0), (0.3, 0.0, 0.0)])
def test_level_boxes_of_all_kinds_have_the_distance_of_their_sides(half):
    """Faces, edges and corners that lie exactly on one another."""
    robot = solids.box("link", np.eye(4), np.array([0.5, 0.4, 0.2]))
    reach, rng = robot.half + half, np.random.default_rng(4)
    for x, y, z in np.ndindex(5, 5, 5):
        beyond = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])[[x, y, z]]
        place = (reach + np.abs(beyond)) * np.sign(beyond)
        place[beyond == 0.0] = 0.0
        scene = scene_of(Box(2.0 * np.array(half), position=place))
        found = measured(rng, robot, *HERE, scene)
        assert found == pytest.approx(np.linalg.norm(beyond), abs=EXACT) or not beyond.any()
        assert found > 0.0 or not beyond.any()


def test_balls_are_measured_as_spheres_are():
    rng = np.random.default_rng(5)
    for k, name in enumerate(list(SOLIDS) * 20):
        robot, turn, place, _ = bodies(rng, name, "ball")
        center, radius = rng.normal(size=3) * (k % 4 + 1) / 2, float(rng.uniform(0.01, 0.5))
        sphere = measured(rng, robot, turn, place, fp.Scene([center], [radius]))
        ball = measured(rng, robot, turn, place, scene_of(Ball(radius, position=center)))
        assert ball == pytest.approx(sphere, abs=1e-12)


@pytest.mark.parametrize("ratio", [1e2, 1e4])
def test_needles_and_pancakes_are_measured_as_sharply(ratio):
    rng = np.random.default_rng(int(ratio))
    for axes in ([1.0, 1.0, 1.0 / ratio], [1.0, 1.0 / ratio, 1.0 / ratio]):
        for made in (Ellipsoid(axes), Cylinder(axes[1], axes[2]), Box(axes)):
            for name in SOLIDS:
                robot, turn, place, _ = bodies(rng, name, "ball")
                for direction in directions(rng, robot, turn, made):
                    placed = put_apart(robot, turn, place, made, direction, 0.02)
                    found = measured(rng, robot, turn, place, scene_of(placed))
                    assert found == pytest.approx(0.02, abs=EXACT)


def test_a_station_far_from_the_origin_is_measured_as_sharply():
    rng, origin = np.random.default_rng(6), np.array([9e4, -8e4, 7e4])
    for name in SHAPES:
        robot, turn, place, obstacle = bodies(rng, "polytope", name)
        direction = directions(rng, robot, turn, obstacle)[0]
        placed = put_apart(robot, turn, place, obstacle, direction, 0.1)
        scene = scene_of(moved(placed, origin))
        found = measured(rng, robot, turn, place + origin, scene, origin)
        assert found == pytest.approx(0.1, abs=EXACT)


def debris(rng, count):
    """Shapes of all kinds and sizes, some of them long, and a few spheres, all about."""
    makers = list(SHAPES.values())
    shapes = [moved(makers[k % len(makers)](rng), rng.uniform(-6.0, 6.0, 3)) for k in range(count)]
    return fp.Scene(rng.uniform(-6.0, 6.0, (20, 3)), rng.uniform(0.05, 0.5, 20), shapes=shapes)


def test_many_shapes_give_the_least_of_all_pairs():
    rng = np.random.default_rng(7)
    scene, robot = debris(rng, 400), robot_of(*(make(rng) for make in SOLIDS.values()))
    count, parts = 40, len(SOLIDS)
    turns = Rotation.from_quat(rng.normal(size=(count * parts, 4))).as_matrix()
    turns = turns.reshape(count, parts, 3, 3)
    places = np.cumsum(rng.normal(size=(count, 1, 3)) * 0.2, axis=0)
    places = places + rng.normal(size=(count, parts, 3))
    samples = placed_samples(rng, turns, places)
    singles = [fp.Scene([c], [r]) for c, r in zip(scene.centers, scene.radii, strict=True)]
    singles += [scene_of(shape) for shape in scene.shapes]
    order = np.arange(count)
    which, part = np.repeat(order, parts), np.tile(np.arange(parts), count)
    stretch = order // 8

    def each(obstacles):
        distances = SampledDistances(robot, obstacles, np.zeros(3))
        middles = distances.middles(samples)
        distances.stretches(stretch, np.zeros(count), middles, np.zeros((count, parts)))
        return distances.at(samples, which, part, stretch[which], np.zeros(len(which)))

    least = np.min([each(single) for single in singles], axis=0)
    found = each(scene)
    assert np.allclose(found[least > 0.0], least[least > 0.0], rtol=0.0, atol=EXACT)
    assert np.all(found[least <= 0.0] <= 0.0)
    assert 20 < np.sum(least > 0.0) < len(least) - 20


def test_a_long_shape_hides_no_other_one():
    """A sphere around a boom contains the solid, but the boom is farther away than a ball is."""
    rng, robot = np.random.default_rng(8), solids.ball("link", np.eye(4), 0.1)
    boom = Box([0.0, 0.0, 20.0], position=[5.0, 0.0, 0.0])
    scene = scene_of(boom, Ball(0.5, position=[-3.0, 0.0, 0.0]))
    assert measured(rng, robot, *HERE, scene) == pytest.approx(2.4, abs=EXACT)


def test_shapes_far_away_are_not_measured():
    """The list of a stretch holds few of ten thousand shapes."""
    rng = np.random.default_rng(8)
    shapes = [Cylinder(0.05, 0.2, position=p) for p in rng.uniform(-20.0, 20.0, (10_000, 3))]
    distances = SampledDistances(robot_of(SOLIDS["box"](rng)), scene_of(*shapes), np.zeros(3))
    samples = placed_samples(rng, np.eye(3)[None, None], np.zeros((1, 1, 3)))
    distances.clearances(samples)
    assert 0 < len(distances._near_shapes) < 100


def test_the_nearest_obstacle_is_named():
    rng = np.random.default_rng(9)
    robot = robot_of(solids.ball("link", np.eye(4), 0.1))
    scene = fp.Scene(
        [[5.0, 0, 0]], [1.0],
        shapes=[Box([1, 1, 1], [0, 5.0, 0], name="bus"), Cylinder(1.0, 1.0, [0, 0, 5.0])],
        keep_in=[Ball(10.0, name="sphere of approach")],
    )  # fmt: skip
    distances = SampledDistances(robot, scene, np.zeros(3))
    places = np.array([[4.5, 0, 0], [0, 5.0, 0], [0, 0, 5.0], [-9.99, 0, 0]])[:, None]
    samples = placed_samples(rng, np.tile(np.eye(3), (4, 1, 1, 1)), places)
    assert np.all(distances.clearances(samples) <= 0.0)
    assert [distances.nearest_obstacle(samples, k, 0) for k in range(4)] == [
        "an obstacle",
        "box 'bus'",
        "cylinder (shapes.1)",
        "ball 'sphere of approach'",
    ]
