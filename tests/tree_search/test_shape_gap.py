"""Lower bounds on the distance of two shapes."""

import coal
import numpy as np
import pytest

from ffsr_plan.core import rotations
from ffsr_plan.tree_search.kernels.shape_gap import core_gap


def shape(rng, kind):
    """A Coal solid, the half sides of its core and the distance around it."""
    a, b, c = rng.uniform(0.05, 0.5, 3)
    if kind == "box":
        return coal.Box(2 * a, 2 * b, 2 * c), np.array([a, b, c]), 0.0
    if kind == "capsule":
        return coal.Capsule(a, 2 * b), np.array([0.0, 0.0, b]), a
    return coal.Sphere(a), np.zeros(3), a


def placement(rng, spread):
    turn = rotations.matrix(rotations.exp(rng.normal(size=3)))
    return turn, rng.normal(size=3) * spread


def pair(rng, kinds):
    gaps = []
    solids = [shape(rng, kind) for kind in kinds]
    places = [placement(rng, 0.8) for _ in kinds]
    frames = [np.concatenate([t.ravel(), p, np.zeros(3)]) for t, p in places]
    result = coal.DistanceResult()
    poses = [coal.Transform3s(t, p) for t, p in places]
    exact = coal.distance(
        solids[0][0], poses[0], solids[1][0], poses[1], coal.DistanceRequest(), result
    )
    gaps = core_gap(
        frames[0], frames[1], solids[0][1], solids[1][1], solids[0][2] + solids[1][2], np.inf
    )
    return gaps, exact


KINDS = ("box", "capsule", "sphere")


@pytest.mark.parametrize("first", KINDS)
@pytest.mark.parametrize("second", KINDS)
def test_no_gap_is_larger_than_the_distance(first, second):
    rng = np.random.default_rng(7)
    found = np.array([pair(rng, (first, second)) for _ in range(400)])
    apart = found[:, 1] > 0.0
    assert np.all(found[apart, 0] <= found[apart, 1] + 1e-6)
    assert np.all(found[~apart, 0] <= 1e-6)
    assert np.mean(found[apart, 0] / found[apart, 1]) > 0.8


def test_spheres_are_measured_exactly():
    rng = np.random.default_rng(8)
    found = np.array([pair(rng, ("sphere", "sphere")) for _ in range(100)])
    assert np.allclose(found[:, 0], found[:, 1], atol=1e-9)
