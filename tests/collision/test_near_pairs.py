"""Distances of near pairs as linear functions: exact where they are taken, nowhere too large."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.near_pairs import NearPairs
from ffsr_plan.collision.shape_placements import shape_placements
from tests.helpers.urdf_builders import random_scene

ROBOTS = ["point", "planar_dual_arm", "satellite_ur5"]


def case(robot_name, seed):
    rng = np.random.default_rng(seed)
    robot = fp.load_robot(robot_name)
    scene = random_scene(rng, 12, (-2.0, -2.0, -2.0), (2.0, 2.0, 2.0), (0.1, 0.6))
    q = robot.configuration(rng.uniform(-1.0, 1.0, 3), attitude=rng.uniform(-1.0, 1.0, 3))
    return robot, scene, q, shape_placements(robot, q[None]), rng


@pytest.mark.parametrize("robot_name", ROBOTS)
@pytest.mark.parametrize("seed", range(4))
def test_the_nearest_pair_is_the_first_one_and_all_below_the_limit_are_there(robot_name, seed):
    robot, scene, q, placed, rng = case(robot_name, seed)
    shift = rng.uniform(-0.3, 0.3, 3)
    gaps = NearPairs(robot, scene).at(placed, 0, shift, 10.0)
    moved = q + np.concatenate([shift, np.zeros(len(q) - 3)])
    assert gaps.distances[0] == pytest.approx(ObstacleQuery(robot, scene).nearest(moved).distance)
    assert np.all(np.diff(gaps.distances) >= 0.0)
    few = NearPairs(robot, scene).at(placed, 0, shift, 0.5)
    below = gaps.distances[gaps.distances < 0.5]
    assert few.distances[: len(below)] == pytest.approx(below)


@pytest.mark.parametrize("robot_name", ROBOTS)
@pytest.mark.parametrize("seed", range(4))
def test_linear_distances_are_nowhere_above_the_distance(robot_name, seed):
    robot, scene, _, placed, rng = case(robot_name, seed)
    pairs = NearPairs(robot, scene)
    gaps = pairs.at(placed, 0, np.zeros(3), 10.0)
    for size in (1e-3, 0.1, 1.0):
        for _ in range(10):
            shift = rng.normal(size=3) * size
            least = pairs.at(placed, 0, shift, 10.0).distances[0]
            assert np.min(gaps.distances + gaps.gradients @ shift) <= least + 1e-7


@pytest.mark.parametrize("seed", range(4))
def test_gradients_are_those_of_the_distance(seed):
    robot = fp.load_robot("planar_dual_arm")
    rng = np.random.default_rng(seed)
    q = robot.configuration(rng.uniform(-0.5, 0.5, 3), attitude=rng.uniform(-1.0, 1.0, 3))
    placed = shape_placements(robot, q[None])
    pairs = NearPairs(
        robot, fp.Scene(rng.uniform((0.5, -1.0, -1.0), (2.5, 1.0, 1.0), (1, 3)), [0.2])
    )
    first = pairs.at(placed, 0, np.zeros(3), 10.0)
    for axis in np.eye(3) * 1e-6:
        ahead, behind = (pairs.at(placed, 0, s * axis, 10.0).distances[0] for s in (1.0, -1.0))
        slope = (ahead - behind) / 2e-6
        assert first.gradients[0] @ axis * 1e6 == pytest.approx(slope, abs=1e-4)


def test_an_empty_scene_has_no_pairs():
    robot = fp.load_robot("planar_dual_arm")
    placed = shape_placements(robot, robot.neutral()[None])
    gaps = NearPairs(robot, fp.Scene([], [])).at(placed, 0, np.zeros(3), 1.0)
    assert gaps.distances.shape == (0,)
    assert gaps.gradients.shape == (0, 3)
