"""Robots that already rotate: the bounds that docs/limits.md derives for them are not exceeded."""

import numpy as np
import pytest

from ffsr_plan.core import rotations
from tests.helpers.travel_reference import ReferenceBound, link_motion
from tests.helpers.urdf_builders import random_robot

STEPS = 400


def flown(robot, reference, rates, begin, half, spin):
    """Angular velocities (STEPS + 1, 3) and accelerations (STEPS, 3) of the base, in base axes.

    The spin is the momentum that counts, in world axes, where the attitude is 0 at the begin.
    Attitudes advance by the midpoint rule; accelerations are differences of velocities.
    """
    times = np.linspace(0.0, 2.0 * half, 2 * STEPS + 1)
    values = begin + times[:, None] * rates
    motion = link_motion(robot.tree, values, np.tile(rates, (len(times), 1)), np.zeros(len(times)))
    terms = reference.reaction_terms(motion)
    step = 2.0 * half / STEPS
    attitude, velocities = np.array([0.0, 0.0, 0.0, 1.0]), []
    for k in range(STEPS + 1):
        velocities.append(rate_at(terms, 2 * k, attitude, spin))
        if k < STEPS:
            middle = rotations.multiply(attitude, rotations.exp(0.5 * step * velocities[-1]))
            turn = rotations.exp(step * rate_at(terms, 2 * k + 1, middle, spin))
            attitude = rotations.multiply(attitude, turn)
    velocities = np.array(velocities)
    return velocities, np.diff(velocities, axis=0) / step


def rate_at(terms, k, attitude, spin):
    """I omega + e = R^T h."""
    held = rotations.matrix(attitude).T @ spin
    return np.linalg.solve(terms.inertia[k], held - terms.momentum[k])


def bounds(terms, half, speed_now, spin):
    """Omega, by both ways, and kappa."""
    eta, least = np.linalg.norm(spin), terms.least[0]
    inertia, momentum = terms.inertia_change[0], terms.momentum_change[0]
    share = 1.0 - half * (inertia + eta) / least
    first = (speed_now + half * momentum / least) / share if share > 0.0 else np.inf
    second = np.sqrt(terms.energy[0] / least) + eta / least
    omega = min(first, second)
    return first, second, (eta * omega + inertia * omega + momentum) / least


@pytest.mark.parametrize("half", [0.5, 0.1, 0.01])
def test_a_spinning_base_does_not_outrun_its_bounds(half):
    closest = closest_change = 0.0
    for seed in range(20):
        robot, rng = random_robot(seed), np.random.default_rng(seed)
        reference = ReferenceBound(robot)
        begin, rates = rng.uniform(-1.0, 1.0, (2, robot.nd))
        middle = (begin + half * rates)[None]
        terms = reference.reaction_terms(
            link_motion(robot.tree, middle, rates[None], np.array([2.0 * half]))
        )
        spin = rng.normal(size=3) * np.linalg.eigvalsh(terms.inertia[0])[0] * 10.0 ** (seed % 3 - 1)
        velocities, accelerations = flown(robot, reference, rates, begin, half, spin)
        speeds = np.linalg.norm(velocities, axis=1)
        first, second, kappa = bounds(terms, half, speeds[STEPS // 2], spin)
        assert speeds.max() <= min(first, second) * (1.0 + 1e-6)
        changes = np.linalg.norm(accelerations, axis=1)
        assert changes.max() <= kappa * (1.0 + 1e-6)
        closest = max(closest, speeds.max() / min(first, second))
        closest_change = max(closest_change, changes.max() / kappa)
    assert closest > 0.6  # so that a bound of another law would be outrun
    assert closest_change > (0.2 if half < 0.05 else 0.0)


def test_a_tumbling_body_accelerates_by_its_spin_alone():
    """Joints at rest: kappa is eta Omega / lambda, and would be zero without the spin."""
    shares = []
    for seed in range(10):
        robot, rng = random_robot(seed), np.random.default_rng(seed)
        reference, half = ReferenceBound(robot), 0.05
        begin, rates = rng.uniform(-1.0, 1.0, robot.nd), np.zeros(robot.nd)
        terms = reference.reaction_terms(
            link_motion(robot.tree, begin[None], rates[None], np.array([2.0 * half]))
        )
        spin = rng.normal(size=3) * np.linalg.eigvalsh(terms.inertia[0])[0]
        velocities, accelerations = flown(robot, reference, rates, begin, half, spin)
        now = float(np.linalg.norm(velocities[STEPS // 2]))
        kappa = bounds(terms, half, now, spin)[2]
        assert terms.inertia_change[0] == terms.momentum_change[0] == 0.0
        shares.append(np.linalg.norm(accelerations, axis=1).max() / kappa)
    assert 0.1 < max(shares) <= 1.0
