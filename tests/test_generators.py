"""Seeded scenes: what was asked for, and the same every time."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.generators import cloud

BOX = {"low": (0, -2, -2), "high": (10, 2, 2), "radii": (0.02, 0.3)}


@given(st.integers(0, 2**31), st.integers(0, 300))
def test_a_cloud_has_the_spheres_that_were_asked_for_where_they_were_asked_for(seed, count):
    balls = [((0, 0, 0), 1.0), ((10, 0, 0), 1.5)]
    scene = cloud(seed, count, **BOX, spared=balls)
    assert len(scene) == count
    assert np.all((scene.centers >= (0, -2, -2)) & (scene.centers <= (10, 2, 2)))
    assert np.all((scene.radii >= 0.02) & (scene.radii <= 0.3))
    for center, room in balls:
        assert np.all(np.linalg.norm(scene.centers - center, axis=1) > room + scene.radii)


def test_a_cloud_is_the_same_for_the_same_seed_only():
    first, again, other = (cloud(seed, 50, **BOX) for seed in (3, 3, 4))
    assert np.array_equal(first.centers, again.centers)
    assert np.array_equal(first.radii, again.radii)
    assert not np.array_equal(first.centers, other.centers)


def test_small_spheres_are_as_many_as_large_ones_on_a_logarithmic_scale():
    radii = cloud(0, 4000, **BOX).radii
    assert np.median(radii) == pytest.approx(np.sqrt(0.02 * 0.3), rel=0.1)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"seed": -1}, "cloud seed"),
        ({"count": -1}, "cloud count"),
        ({"low": (11, 0, 0)}, "cloud high"),
        ({"radii": (0.3, 0.02)}, "cloud radii"),
        ({"radii": (0.0, 0.02)}, "cloud radii"),
        ({"spared": [((5, 0, 0), 50.0)]}, r"cloud spared: got '50 m about \(5, 0, 0\)'"),
    ],
)
def test_a_cloud_that_cannot_be_is_refused_by_name(wrong, named):
    with pytest.raises(fp.InvalidInput, match=named):
        cloud(**{"seed": 0, "count": 10, **BOX, **wrong})


def test_the_debris_scenario_is_planned_proven_and_verified():
    """Two thousand spheres, three dimensions, the planner of the scenario cut short."""
    problem = fp.load_scenario("debris")
    assert len(problem.scene) == 2000
    plan = fp.plan(problem, fp.LatticeOptimum())
    report = plan.verify(100)
    assert report.ok, report.problems
    assert 0.0 < plan.certificate.least_clearance <= report.least_clearance
    assert plan.gap == 0.0
