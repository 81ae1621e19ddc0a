"""The compiled travel bound is that of the reference, which computes with arrays of intervals."""

import numpy as np
import pytest

from ffsr_plan.core import rotations
from ffsr_plan.proof.kernels.travel import BaseMotion, least_eigenvalue
from ffsr_plan.proof.travel_bound import TravelBound
from tests.helpers.random_robots import random_tree
from tests.helpers.travel_reference import ReferenceBound, link_motion

COUNT = 30


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.parametrize("kind", ["flying", "floating", "held", "in the base"])
def test_the_bound_is_that_of_the_reference(seed, kind):
    rng, robot = np.random.default_rng(seed), random_tree(seed)
    values = rng.uniform(-1.5, 1.5, (COUNT, robot.nd))
    rates = rng.uniform(-1.0, 1.0, (COUNT, robot.nd)) * rng.choice([0.03, 0.3, 2.0])
    lengths, quats = 0.5 ** rng.uniform(0.0, 6.0, COUNT), rotations.exp(rng.normal(size=(COUNT, 3)))
    links, turns = link_motion(robot.tree, values, rates, lengths), rng.normal(size=(COUNT, 3))
    bound, reference = TravelBound(robot), ReferenceBound(robot)
    if kind == "in the base":
        found = bound.in_base(values, rates, lengths)
        expected = reference.reacting(links, quats, 0.0).in_base
    elif kind == "held":
        base = BaseMotion(False, False, turns, 0.0)
        found = bound.in_world(values, rates, lengths, base, quats)
        expected = reference.held(links, quats, turns).world
    else:
        floats = kind == "floating"
        base = BaseMotion(True, floats, np.zeros((COUNT, 3)), 1e-5)
        found = bound.in_world(values, rates, lengths, base, quats)
        expected = reference.reacting(links, quats, 1e-5, floats).world
    points = found.points
    for ours, theirs in zip(
        (
            points["velocity"],
            points["speed"],
            points["curvature"],
            points["attitude_error"],
            *found[1:],
        ),
        expected,
        strict=True,
    ):
        assert np.allclose(ours, theirs, rtol=1e-11, atol=1e-11 * np.abs(theirs).max(initial=0.0))


@pytest.mark.parametrize("seed", range(50))
def test_the_least_eigenvalue_is_that_of_numpy(seed):
    rng = np.random.default_rng(seed)
    turned = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    wanted = 10.0 ** rng.uniform(-6.0, 0.0, 3)
    matrix = turned @ np.diag(wanted) @ turned.T
    entries = matrix[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    assert least_eigenvalue(entries) == pytest.approx(wanted.min(), rel=1e-9)
    assert least_eigenvalue(np.array([3.0, 1.0, 2.0, 0.0, 0.0, 0.0])) == 1.0
