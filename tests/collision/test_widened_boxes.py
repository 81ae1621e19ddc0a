"""Closed forms of distances between boxes, capsules and balls."""

import numpy as np
import pytest

from ffsr_plan.collision.nearest_obstacle_kernels import distance_to_solid
from ffsr_plan.collision.widened_box_kernels import box_distance
from tests.helpers.widened_boxes import RELATIONS, random_pair, signed_distance

STILL = np.zeros(3)


def by_closed_form(one, other, enough=np.inf):
    kind, frame = one.frame()
    return distance_to_solid(kind, frame, STILL, other.solid(), enough)


@pytest.mark.parametrize("relation", RELATIONS)
@pytest.mark.parametrize("second", ["box", "capsule", "ball"])
@pytest.mark.parametrize("first", ["box", "capsule", "ball"])
def test_the_closed_form_is_the_distance_of_a_quadratic_programme(first, second, relation):
    rng = np.random.default_rng(len(first) + 10 * len(second) + 100 * len(relation))
    for _ in range(40):
        pair = random_pair(rng, first, second, relation)
        assert by_closed_form(*pair) == pytest.approx(signed_distance(*pair), abs=2e-12)


def test_the_distance_does_not_depend_on_the_order_of_the_two():
    rng = np.random.default_rng(1)
    for relation in RELATIONS:
        for _ in range(50):
            one, other = random_pair(rng, "box", "box", relation)
            there, back = by_closed_form(one, other), by_closed_form(other, one)
            assert there == pytest.approx(back, abs=1e-13)


def test_a_displacement_counts_as_that_of_the_first_body():
    rng = np.random.default_rng(2)
    one, other = random_pair(rng, "box", "capsule", "apart")
    shift = rng.uniform(-0.5, 0.5, 3)
    kind, frame = one.frame()
    moved = distance_to_solid(kind, frame, shift, other.solid(), np.inf)
    assert moved == pytest.approx(by_closed_form(one._replace(middle=shift), other), abs=1e-14)


def test_what_is_returned_early_is_a_lower_bound_above_what_is_enough():
    rng = np.random.default_rng(3)
    early = 0
    for _ in range(300):
        pair = random_pair(rng, "box", "box", "apart")
        distance, enough = by_closed_form(*pair), rng.uniform(0.0, 2.0)
        found = by_closed_form(*pair, enough)
        assert found <= distance + 1e-13
        assert found == distance or found > enough
        early += found < distance - 1e-6
    assert early > 50


@pytest.mark.parametrize("sine", [0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3])
def test_edges_that_are_almost_parallel_cross_at_their_distance(sine):
    """Two upright square bars that touch each other's corners only: the gap is along x + y."""
    axes, half = np.eye(3), (0.5, 0.5, 2.0)
    tilted = np.array([[1.0, 0.0, 0.0], [0.0, np.sqrt(1 - sine**2), -sine]])
    tilted = np.vstack([tilted, np.cross(tilted[0], tilted[1])]).T
    for gap in (1e-9, 1e-3, 0.7):
        middle = np.array([1.0 + gap, 1.0 + gap, 0.0])
        one = np.concatenate([axes.ravel(), np.zeros(3)])
        other = np.concatenate([tilted.ravel(), middle])
        found = box_distance(one, half, other, half, STILL, np.inf)
        corners = middle + (np.array([[-0.5, -0.5, z] for z in (-2.0, 2.0)])) @ tilted.T
        low, high = corners[np.argsort(corners[:, 2])]
        shares = np.linspace(0.0, 1.0, 20_001)[:, None]
        edge = low + shares * (high - low)
        beyond = np.maximum(np.abs(edge) - half, 0.0)
        sampled = np.min(np.linalg.norm(beyond, axis=1))
        assert found <= sampled + 1e-12
        assert found >= sampled - 4.0 * 2.0 * sine / 20_000 - 1e-12 - 2.0 * sine**2
