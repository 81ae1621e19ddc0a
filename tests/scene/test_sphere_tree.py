"""The tree over the spheres: it holds them all, and a search in it equals one of all pairs."""

from unittest import mock

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.scene.shapes import sphere_tree as module
from ffsr_plan.scene.shapes.sphere_tree import sphere_tree
from tests.helpers.closed_forms import clearances, shape_distance
from tests.helpers.urdf_builders import capsule, cylinder, random_configuration, random_robot

seeds = st.integers(0, 100_000)


def mixed_scene(rng, count):
    """Dust, debris and a few large bodies, some of them inside others or at one place."""
    centers = rng.uniform(-4, 4, (count, 3))
    centers[rng.random(count) < 0.1] = centers[0]
    return fp.Scene(centers, np.exp(rng.uniform(np.log(1e-3), np.log(1.0), count)))


def compiled_tree(scene):
    """The tree as of many spheres."""
    with mock.patch.object(module, "_FEW", 0):
        return sphere_tree(scene.centers, scene.radii)


@given(seeds, st.sampled_from([1, 2, 3, 5, 40, 700]), st.booleans())
def test_every_node_of_the_tree_contains_what_lies_below(seed, count, compiled):
    scene = mixed_scene(np.random.default_rng(seed), count)
    tree = compiled_tree(scene) if compiled else sphere_tree(scene.centers, scene.radii)
    assert sorted(tree.order.tolist()) == list(range(count))
    assert np.array_equal(tree.spheres[:, :3], scene.centers[tree.order])
    assert np.array_equal(tree.spheres[:, 3], scene.radii[tree.order])
    waiting, leaves = [0], []
    while waiting:
        node = waiting.pop()
        left, right = tree.children[node]
        below = tree.nodes[[left, right]] if left >= 0 else tree.spheres[-1 - left : right]
        reach = np.linalg.norm(below[:, :3] - tree.nodes[node, :3], axis=1) + below[:, 3]
        if left < 0:
            leaves += range(-1 - left, right)
            assert np.all(reach <= tree.nodes[node, 3] * (1 + 1e-12))
        else:
            waiting += [left, right]
    assert sorted(leaves) == list(range(count))


@given(seeds, st.sampled_from([2, 3, 5, 40, 700, 3000]))
@settings(max_examples=40)
def test_few_and_many_spheres_are_halved_alike(seed, count):
    rng = np.random.default_rng(seed)
    scene = fp.Scene(rng.normal(size=(count, 3)), rng.uniform(0.01, 0.1, count))
    many, few = compiled_tree(scene), sphere_tree(scene.centers, scene.radii)
    assert np.array_equal(many.children, few.children)
    assert many.nodes == pytest.approx(few.nodes, abs=1e-12)


ORDERS = {
    "at one place": lambda n: np.zeros((n, 3)),
    "sorted": lambda n: np.arange(n)[:, None] * np.ones(3) / n,
    "up and down": lambda n: np.abs(np.arange(n) - n // 2)[:, None] * np.ones(3) / n,
    "at two places": lambda n: np.arange(n)[:, None] % 2 * np.ones(3),
}


@pytest.mark.parametrize("name", ORDERS)
def test_no_order_of_many_spheres_makes_the_tree_deep(name):
    """The stack of a search has 64 entries; a tree of halves over 100 000 has 17 levels."""
    scene = fp.Scene(ORDERS[name](100_000), np.full(100_000, 0.1))
    tree, again = scene.tree, sphere_tree(scene.centers, scene.radii)
    assert all(np.array_equal(a, b) for a, b in zip(tree[:4], again, strict=True))
    depth = np.zeros(len(tree.nodes), dtype=int)
    for node, (left, right) in enumerate(tree.children):
        if left >= 0:
            depth[[left, right]] = depth[node] + 1
    assert depth.max() <= 16
    leaves = tree.children[tree.children[:, 0] < 0]
    assert np.sum(leaves[:, 1] + 1 + leaves[:, 0]) == 100_000


def all_pairs(robot, scene, q):
    """(g, N) distances of all shapes to all spheres, one by one."""
    data, geometry = robot.model.createData(), robot.collision_model.createData()
    pin.updateGeometryPlacements(robot.model, data, robot.collision_model, geometry, q)
    shapes = zip(robot.collision_model.geometryObjects, geometry.oMg, strict=True)
    balls = list(zip(scene.centers, scene.radii, strict=True))
    return np.array([[shape_distance(g.geometry, at, *b) for b in balls] for g, at in shapes])


@given(seeds, st.sampled_from([1, 4, 30, 150]))
@settings(max_examples=60)
def test_the_search_agrees_with_all_pairs(seed, count):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    scene = mixed_scene(rng, count)
    q = np.array([random_configuration(robot, rng, spread=3.0) for _ in range(6)])
    query = ObstacleQuery(robot, scene)
    placed = shape_placements(robot, q)
    shifts = rng.normal(size=(12, 3)) * rng.choice([0.0, 0.05, 1.0], (12, 1))
    found = query.distances_at(placed, np.repeat(np.arange(6), 2), shifts)
    for k, shift in enumerate(shifts):
        moved = np.array(q[k // 2])
        moved[:3] += shift
        each = all_pairs(robot, scene, moved)
        assert found[k] == pytest.approx(each.min(), abs=1e-9)
        assert query.links_at(placed, k // 2, shift) == pytest.approx(each.min(axis=1), abs=1e-9)
        near = query.nearest_at(placed, k // 2, shift)
        links = [robot.link_of(g) for g in robot.collision_model.geometryObjects]
        named = [i for i, name in enumerate(links) if name == near.link]
        assert each[named, near.obstacle].min() == pytest.approx(each.min(), abs=1e-9)


@pytest.mark.parametrize("count", [10_000, 200_000])
def test_the_sphere_tree_agrees_with_all_pairs_of_many(robot, count):
    rng = np.random.default_rng(5)
    scene = fp.Scene(rng.uniform(-8, 8, (count, 3)), rng.uniform(0.005, 0.05, count))
    q = np.array([random_configuration(robot, rng) for _ in range(5)])
    found = ObstacleQuery(robot, scene).distances(q)
    shapes, placed = robot.collision_model.geometryObjects, shape_placements(robot, q)
    for k in range(len(q)):
        least = np.inf
        for i, shape in enumerate(shapes):
            local = (scene.centers - placed.positions[k, i]) @ placed.rotations[k, i]
            beyond = np.abs(local) - shape.geometry.halfSide
            outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
            distances = outside + np.minimum(beyond.max(axis=1), 0.0) - scene.radii
            least = min(least, float(distances.min()))
        assert found[k] == pytest.approx(least, abs=1e-9)


@given(seeds)
def test_shapes_are_placed_where_pinocchio_places_them(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    q = np.array([random_configuration(robot, rng) for _ in range(3)])
    placed = shape_placements(robot, q)
    data, geometry = robot.model.createData(), robot.collision_model.createData()
    for k in range(len(q)):
        pin.updateGeometryPlacements(robot.model, data, robot.collision_model, geometry, q[k])
        for i, pose in enumerate(geometry.oMg):
            assert placed.rotations[k, i] == pytest.approx(pose.rotation, abs=1e-12)
            assert placed.positions[k, i] == pytest.approx(pose.translation, abs=1e-12)


@given(seeds)
@settings(max_examples=40)
def test_hulls_are_searched_through_the_boxes_around_them(seed):
    """The nearest box need not be that of the nearest hull: all that may be nearer are measured."""
    robot, rng = random_robot(seed, solids=(capsule, cylinder)), np.random.default_rng(seed)
    scene = mixed_scene(rng, 60)
    q = np.array([random_configuration(robot, rng, spread=3.0) for _ in range(8)])
    query = ObstacleQuery(robot, scene)
    exact = clearances(robot, scene, q)
    assert query.distances(q) == pytest.approx(exact, abs=1e-7)
    placed = shape_placements(robot, q)
    for k in range(len(q)):
        least = query.links_at(placed, k, np.zeros(3)).min()
        assert least <= exact[k] + 1e-12
        assert query.nearest(q[k]).distance == pytest.approx(exact[k], abs=1e-7)
