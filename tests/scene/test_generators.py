"""Seeded scenes: what was asked for, and the same every time."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.core.rotations import from_angles, matrix
from ffsr_plan.scene.generators import belt, cloud, scatter, truss

BOX = {"low": (0, -2, -2), "high": (10, 2, 2), "radii": (0.02, 0.3)}


@given(st.integers(0, 2**31), st.integers(0, 300))
def test_a_cloud_has_the_requested_number_and_place(seed, count):
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


def test_radii_are_uniform_on_a_logarithmic_scale():
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
def test_an_impossible_cloud_is_refused_by_name(wrong, named):
    with pytest.raises(fp.InvalidInput, match=named):
        cloud(**{"seed": 0, "count": 10, **BOX, **wrong})


RING = {"radius": 5.0, "thickness": 1.0, "radii": (0.02, 0.1)}
BOOM = {"begin": (0, 0, 0), "end": (3, 0, 0), "width": 0.5, "bays": 4, "radius": 0.05}
FEW = {"seed": 0, "counts": (2, 4), "low": (0, 0), "high": (1, 1), "radii": (0.1, 0.2)}
PLACE = {"center": (1.0, 2.0, 3.0), "attitude": (0.4, 0.7, -1.1)}


def in_the_ring(scene):
    """Angles from the ring's x axis, distances outwards and along its axis."""
    turned = matrix(from_angles(np.array(PLACE["attitude"])))
    x, y, z = ((scene.centers - PLACE["center"]) @ turned).T
    return np.arctan2(y, x), np.hypot(x, y) - 5.0, z


@given(st.integers(0, 2**31), st.integers(0, 300))
def test_a_belt_lies_in_its_ring_and_outside_spared_balls(seed, count):
    ball = (PLACE["center"] + matrix(from_angles(np.array(PLACE["attitude"])))[:, 0] * 5.0, 1.2)
    scene = belt(seed, count, **RING, **PLACE, arc=(-1.0, 2.0), spared=[ball])
    assert len(scene) == count
    angle, out, up = in_the_ring(scene)
    assert np.all((angle >= -1.0) & (angle <= 2.0))
    assert np.all(np.hypot(out, up) <= 1.0 + 1e-12)
    assert np.all((scene.radii >= 0.02) & (scene.radii <= 0.1))
    assert np.all(np.linalg.norm(scene.centers - ball[0], axis=1) > ball[1] + scene.radii)


def test_a_belt_is_uniform_by_volume():
    """Pappus: the outer half of a ring holds more, by the longer way of its middle."""
    _, out, up = in_the_ring(belt(0, 40_000, **{**RING, "thickness": 4.0}, **PLACE))
    outer = 0.5 + 4.0 / (3.0 * np.pi) * 4.0 / 5.0 / 2.0
    assert np.mean(out > 0.0) == pytest.approx(outer, abs=0.01)
    assert np.mean(up > 0.0) == pytest.approx(0.5, abs=0.01)


def test_a_scatter_is_the_random_scene_of_the_benchmarks():
    rng = np.random.default_rng(1003)
    count = int(rng.integers(4, 12))
    x, y = rng.uniform(1.8, 8.2, count), rng.uniform(-3.0, 3.0, count)
    radii = rng.uniform(0.15, 0.5, count)
    scene = scatter(1003, (4, 11), (1.8, -3.0), (8.2, 3.0), (0.15, 0.5))
    assert np.array_equal(scene.centers, np.stack([x, y, np.zeros(count)], axis=1))
    assert np.array_equal(scene.radii, radii)


@pytest.mark.parametrize(("begin", "end"), [((0, 0, 0), (3, 4, 0)), ((1, 1, 1), (1, 1, 4))])
def test_spheres_of_a_truss_cover_its_struts_and_no_more(begin, end):
    radius, width, bays = 0.05, 0.6, 3
    scene = truss(begin, end, width, bays, radius, roll=0.3)
    begin, end = np.array(begin, float), np.array(end, float)
    along = (end - begin) / np.linalg.norm(end - begin)
    step = np.linalg.norm(end - begin) / bays
    # joints: a square at each end of a bay, each corner as far from the middle
    first, last = scene.centers[:4], scene.centers[4 * bays : 4 * bays + 4]
    for square, middle in ((first, begin), (last, end)):
        assert square.mean(axis=0) == pytest.approx(middle, abs=1e-12)
        assert (square - middle) @ along == pytest.approx(np.zeros(4), abs=1e-12)
        sides = np.linalg.norm(np.roll(square, -1, axis=0) - square, axis=1)
        assert sides == pytest.approx(np.full(4, width))
        assert np.linalg.norm(square[2] - square[0]) == pytest.approx(np.sqrt(2) * width)
    struts = [(first[i], first[i] + step * along) for i in range(4)]
    struts += [(first[i], first[i - 1]) for i in range(4)]
    struts += [(first[i], first[i - 1] + step * along) for i in range(4)]
    rng = np.random.default_rng(0)
    for tail, tip in struts:
        aside = np.cross(tip - tail, rng.normal(size=(40, 3)))
        aside *= 0.86 * radius / np.linalg.norm(aside, axis=1)[:, None]
        for point in tail + rng.uniform(0, 1, (40, 1)) * (tip - tail) + aside:
            assert np.min(np.linalg.norm(scene.centers - point, axis=1)) <= radius
    for middle in (begin, 0.5 * (begin + end), begin + 0.5 * step * along):
        assert np.min(np.linalg.norm(scene.centers - middle, axis=1)) > 0.4 * width


@pytest.mark.parametrize(
    ("make", "good", "wrong", "named"),
    [
        (belt, {"seed": 0, "count": 3, **RING}, {"thickness": 6.0}, "belt thickness.*at most 5"),
        (belt, {"seed": 0, "count": 3, **RING}, {"arc": (1.0, 9.0)}, "belt arc.*2 pi"),
        (belt, {"seed": 0, "count": 3, **RING}, {"radii": (0.2, 0.1)}, "belt radii"),
        (belt, {"seed": 0, "count": 3, **RING}, {"spared": [((0, 0, 0), 9.0)]}, "belt spared"),
        (truss, BOOM, {"end": (0, 0, 0)}, "truss end"),
        (truss, BOOM, {"bays": 0}, "truss bays"),
        (truss, BOOM, {"radius": 0.3}, "truss radius.*at most 0.25"),
        (scatter, FEW, {"counts": (5, 4)}, "scatter counts"),
        (scatter, FEW, {"counts": 5}, "scatter counts"),
        (scatter, FEW, {"high": (0, 0)}, "scatter high"),
        (scatter, FEW, {"radii": (0, 1)}, "scatter radii"),
    ],
)
def test_other_impossible_scenes_are_refused_by_name(make, good, wrong, named):
    make(**good)
    with pytest.raises(fp.InvalidInput, match=named):
        make(**{**good, **wrong})


def test_the_debris_scenario_is_planned_proven_and_verified():
    """Two thousand spheres, three dimensions, the planner of the scenario cut short."""
    problem = fp.load_scenario("debris")
    assert len(problem.scene) == 2000
    plan = fp.plan(problem, fp.LatticeOptimum())
    report = plan.verify(100)
    assert report.ok, report.problems
    assert 0.0 < plan.certificate.least_clearance <= report.least_clearance
    assert plan.gap == 0.0
