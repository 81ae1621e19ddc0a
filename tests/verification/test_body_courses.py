"""Poses of bodies and bounds on their travel, by the verification's own code."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import ffsr_plan as fp
from ffsr_plan.bodies.body_motion import Spin
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.pace import Pace
from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.core import rotations
from ffsr_plan.core.errors import IntegrationError
from ffsr_plan.verification.moving_bodies.body_courses import course_of
from ffsr_plan.verification.moving_bodies.free_rotation import FreeRotation
from ffsr_plan.verification.moving_bodies.scene_bodies import SceneBodies, reach_of
from ffsr_plan.verification.moving_bodies.trapezoid_time import times_at
from ffsr_plan.verification.moving_bodies.turns import angles_between, turns_by, turns_of
from tests.helpers.moving_scenes import KINDS, body_of, poses_by_hand

LONG = 600.0


def random_inertia(seed):
    """A body's inertia about axes that are not principal, and a rate."""
    rng = np.random.default_rng(seed)
    semi = rng.uniform(0.3, 1.0, 3) ** 2
    moments = semi.sum() - semi
    turn = Rotation.random(random_state=seed).as_matrix()
    return turn @ np.diag(moments) @ turn.T, rng.normal(size=3) * 0.1


@pytest.mark.parametrize("seed", range(8))
def test_a_tumble_is_that_of_the_package_for_ten_minutes(seed):
    inertia, rate = random_inertia(seed)
    rng = np.random.default_rng(seed)
    motion = Tumble(inertia, rate, rng.normal(size=3) * 0.01, LONG)
    body = MovingBody([fp.Ball(0.1)], motion, rng.normal(size=3), rng.uniform(-3.0, 3.0, 3))
    times = np.sort(rng.uniform(0.0, LONG, 300))
    places, turns = course_of(body, LONG).poses(times)
    given = body.poses(times)
    assert np.max(np.abs(places - given.positions)) < 1e-9
    assert np.max(angles_between(turns, rotations.matrix(given.attitudes))) < 1e-9


@pytest.mark.parametrize("seed", range(8))
def test_a_tumble_conserves_energy_and_angular_momentum_in_the_world(seed):
    inertia, rate = random_inertia(seed)
    rates, turns = FreeRotation(inertia, rate, LONG).states(np.linspace(0.0, LONG, 2000))
    carried = rates @ inertia
    momentum = np.einsum("nij,nj->ni", turns, carried)
    energy = np.sum(rates * carried, axis=1)
    assert np.max(np.linalg.norm(momentum - momentum[0], axis=1)) < 1e-10 * np.linalg.norm(
        momentum[0]
    )
    assert np.max(np.abs(energy / energy[0] - 1.0)) < 1e-10
    assert np.allclose(rates[0], rate, rtol=1e-14)
    slope = np.gradient(turns, LONG / 1999, axis=0)[500]  # R' = R [w] x
    skew = turns[500].T @ slope
    assert np.array([skew[2, 1], skew[0, 2], skew[1, 0]]) == pytest.approx(rates[500], abs=2e-3)


@pytest.mark.parametrize("seed", range(8))
def test_a_tumble_turns_by_no_more_than_its_bounds(seed):
    inertia, rate = random_inertia(seed)
    rotation, rng = FreeRotation(inertia, rate, LONG), np.random.default_rng(seed)
    rates, _ = rotation.states(np.linspace(0.0, LONG, 20_000))
    speeds = np.linalg.norm(rates, axis=1)
    assert speeds.max() <= rotation.largest_rate
    most = Tumble(inertia, rate, known_until=LONG).largest_rate
    assert rotation.largest_rate == pytest.approx(most, rel=1e-9)
    changes = np.linalg.norm(np.diff(rates, axis=0), axis=1) / (LONG / 19_999)
    assert changes.max() <= rotation.largest_change
    begins = rng.uniform(0.0, LONG - 10.0, 200)
    ends = begins + 10.0 ** rng.uniform(-3.0, 1.0, 200)
    bounds = rotation.angles(begins, ends)
    for begin, end, bound in zip(begins, ends, bounds, strict=True):
        rates, _ = rotation.states(np.linspace(begin, end, 101))
        turned = np.trapezoid(np.linalg.norm(rates, axis=1), dx=(end - begin) / 100)
        assert turned <= bound * (1.0 + 1e-6)
    short = rotation.angles(begins, begins + 1e-3)
    speeds = np.linalg.norm(rotation.states(begins)[0], axis=1)
    assert np.all(short <= 1e-3 * speeds * (1.0 + 1e-2) + 1e-9)


def test_a_tumble_that_cannot_be_foretold_is_refused():
    moments = np.diag([1.0, 1.5, 2.0])
    with pytest.raises(IntegrationError, match=r"cannot be foretold: .*middle moment"):
        FreeRotation(moments, np.array([1e-9, 0.3, 0.0]), LONG)
    FreeRotation(moments, np.array([1e-9, 0.3, 0.0]), 20.0)
    assert FreeRotation(moments, np.array([0.3, 1e-9, 0.0]), LONG).error < 1e-9


def test_a_body_at_rest_tumbles_nowhere():
    rotation = FreeRotation(np.diag([1.0, 2.0, 2.5]), np.zeros(3), 10.0)
    rates, turns = rotation.states(np.array([0.0, 5.0]))
    assert not np.any(rates)
    assert np.array_equal(turns, np.tile(np.eye(3), (2, 1, 1)))
    assert not np.any(rotation.angles(np.zeros(1), np.ones(1)))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(3))
def test_poses_are_those_of_the_package_and_of_scipy(kind, seed):
    body, times = body_of(kind, seed), np.linspace(0.0, 20.0, 4001)
    places, turns = course_of(body, 20.0).poses(times)
    given = body.poses(times)
    by_hand = poses_by_hand(body, times)
    assert places == pytest.approx(np.asarray(given.positions), abs=1e-12)
    assert places == pytest.approx(by_hand[0], abs=1e-12)
    assert np.max(angles_between(turns, rotations.matrix(given.attitudes))) < 1e-9
    assert np.max(angles_between(turns, by_hand[1].as_matrix())) < 1e-9


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(3))
def test_no_point_of_a_body_outruns_its_bound(kind, seed):
    rng, body = np.random.default_rng(seed), body_of(kind, seed)
    moving = SceneBodies([body], np.ones(3), 20.0)
    shares = []
    for _ in range(40):
        begin = rng.uniform(0.0, 15.0)
        end = begin + 10.0 ** rng.uniform(-2.0, 0.5)
        poses = moving.poses(np.linspace(begin, end, 300))
        (bound,) = moving.ways(np.array([begin]), np.array([end]))[0]
        for ball in body.shapes:
            track = poses.places[:, 0] + poses.turns[:, 0] @ ball.position
            travelled = np.sum(np.linalg.norm(np.diff(track, axis=0), axis=1))
            assert travelled <= bound
            shares.append(travelled / bound)
        step = (
            poses.at(np.array([0])),
            poses.at(np.array([299])),
            np.array([begin]),
            np.array([end]),
        )
        assert moving.excess(*step)[0] < 1e-12
    assert max(shares) > 0.5


def test_the_reach_of_a_spin_is_from_its_axis():
    bar = [fp.Capsule(0.1, 4.0), fp.Ball(0.5, (0.3, 0.0, 1.0))]  # along z
    spin = MovingBody(bar, Spin((0.0, 0.0, 1.0)))
    assert reach_of(spin) == pytest.approx(2.0)  # a capsule may lie anyhow in the sphere around it
    ball = MovingBody(bar[1:], Spin((0.0, 0.0, 1.0)))
    assert reach_of(ball) == pytest.approx(0.3)
    tumble = MovingBody(bar[1:], Tumble((1.0, 1.0, 1.0), (0.0, 0.0, 1.0)))
    assert reach_of(tumble) == pytest.approx(np.hypot(0.3, 1.0))


@pytest.mark.parametrize("ramp", [0.0, 1e-3, 0.2, 0.5])
def test_times_on_the_path_are_those_of_the_trapezoid(ramp):
    times = np.linspace(0.0, 40.0, 100_001)
    speed = np.ones(len(times))
    if ramp > 0.0:
        speed = np.clip(np.minimum(times, 40.0 - times) / (40.0 * ramp), 0.0, 1.0)
    run = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))])
    found = times_at(run / run[-1], 40.0, ramp)
    assert found == pytest.approx(times, abs=1e-4)
    shares = np.sort(np.random.default_rng(0).uniform(0.0, 1.0, 1000))
    assert times_at(shares, 40.0, ramp) == pytest.approx(
        Pace(40.0, ramp, 7).instants(7.0 * shares), abs=1e-12
    )
    assert list(times_at(np.array([0.0, 1.0]), 40.0, ramp)) == [0.0, 40.0]


def test_rotations_are_those_of_scipy():
    rng = np.random.default_rng(1)
    vectors = np.vstack([rng.normal(size=(50, 3)) * 3.0, np.zeros((1, 3)), [[1e-9, 0.0, 0.0]]])
    expected = Rotation.from_rotvec(vectors)
    assert turns_by(vectors) == pytest.approx(expected.as_matrix(), abs=1e-14)
    assert turns_of(-2.0 * expected.as_quat()) == pytest.approx(expected.as_matrix(), abs=1e-14)
    apart = (expected[:-1].inv() * expected[1:]).magnitude()
    found = angles_between(turns_by(vectors[:-1]), turns_by(vectors[1:]))
    assert found == pytest.approx(apart, abs=1e-7)
