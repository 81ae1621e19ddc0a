"""Free rotation of a rigid body."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.core import rotations
from ffsr_plan.core.errors import InvalidInput


def random_tumble(seed, known_until=200.0):
    rng = np.random.default_rng(seed)
    semi = rng.uniform(0.3, 1.0, 3) ** 2
    moments = np.array([semi[1] + semi[2], semi[0] + semi[2], semi[0] + semi[1]])
    turn = Rotation.random(random_state=seed).as_matrix()
    inertia = turn @ np.diag(moments) @ turn.T
    return Tumble(inertia, rng.normal(size=3) * 0.05, rng.normal(size=3) * 0.01, known_until)


@pytest.mark.parametrize("seed", range(6))
def test_the_angular_momentum_stays_in_the_world(seed):
    body, times = random_tumble(seed, 600.0), np.linspace(0.0, 600.0, 61)
    rates, turns = body.rates(times), rotations.matrix(body.poses(times).attitudes)
    momentum = np.einsum("nij,jk,nk->ni", turns, body.inertia, rates)
    assert np.max(np.linalg.norm(momentum - momentum[0], axis=1)) < 1e-10 * np.linalg.norm(
        momentum[0]
    )
    assert turns[0] == pytest.approx(np.eye(3), abs=1e-14)


@pytest.mark.parametrize("seed", range(6))
def test_the_motion_is_that_of_another_integrator(seed):
    body = random_tumble(seed)
    inverse = np.linalg.inv(body.inertia)

    def slope(_, state):
        rate, turn = state[:3], state[3:].reshape(3, 3)
        x, y, z = rate
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        return np.concatenate(
            [inverse @ -np.cross(rate, body.inertia @ rate), (turn @ cross).ravel()]
        )

    begin = np.concatenate([body.rate, np.eye(3).ravel()])
    found = solve_ivp(slope, (0.0, 200.0), begin, "DOP853", [200.0], rtol=3e-14, atol=1e-14).y[:, 0]
    times = np.array([200.0])
    assert body.rates(times)[0] == pytest.approx(found[:3], abs=1e-10)
    turn = rotations.matrix(body.poses(times).attitudes)[0]
    assert turn == pytest.approx(found[3:].reshape(3, 3), abs=1e-10)


@pytest.mark.parametrize("seed", range(20))
def test_the_largest_rate_is_reached_and_never_passed(seed):
    body = random_tumble(seed, 3000.0)
    found = np.linalg.norm(body._nodes.rates, axis=1)
    assert np.max(found) <= body.largest_rate * (1.0 + 1e-11)
    assert np.max(found) >= body.largest_rate * (1.0 - 1e-4)
    slopes = np.linalg.norm(np.diff(body._nodes.rates, axis=0), axis=1) / body._nodes.step
    assert np.max(slopes) <= body.largest_acceleration * (1.0 + 1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_the_angle_is_never_above_its_bound_and_near_it(seed):
    body, rng = random_tumble(seed), np.random.default_rng(seed)
    shares = []
    for _ in range(40):
        begin = rng.uniform(0.0, 190.0)
        end = begin + 10.0 ** rng.uniform(-2.0, 1.0)
        rates = np.linalg.norm(body.rates(np.linspace(begin, end, 201)), axis=1)
        turned = np.trapezoid(rates, dx=(end - begin) / 200)
        bound = body.turned(begin, end)
        assert turned <= bound * (1.0 + 1e-7)
        shares.append(turned / bound)
    assert np.median(shares) > 0.98


@pytest.mark.parametrize("value", [(1.0, 1.0, 3.0), (1.0, -1.0, 1.0), np.arange(9.0).reshape(3, 3)])
def test_an_inertia_that_no_body_has_is_refused(value):
    with pytest.raises(InvalidInput, match="inertia"):
        Tumble(value, (0.1, 0.0, 0.0))


def test_a_tumble_about_the_middle_axis_is_known_for_as_long_as_its_digits_tell():
    wild = Tumble((1.0, 1.5, 2.0), (1e-9, 0.3, 0.0), known_until=600.0)
    with pytest.raises(InvalidInput, match="middle axis"):
        wild.poses(np.array([600.0]))
    early = wild.poses(np.linspace(0.0, 20.0, 5))
    assert np.all(np.isfinite(early.attitudes))
    tame = Tumble((1.0, 1.5, 2.0), (0.02, 0.0, 0.3), known_until=3600.0)
    assert np.all(np.isfinite(tame.poses(np.array([3600.0])).attitudes))
