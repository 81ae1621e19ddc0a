"""The base's reaction along curves: momentum, the claimed error, and straight pieces."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import records
from ffsr_plan.curves.curved_reaction import CurvedReaction
from ffsr_plan.curves.kernels import curved_reaction as kernels
from ffsr_plan.curves.splines import pieces_with
from ffsr_plan.dynamics.kernels.rate_bound import EXCURSION, rate_bound
from ffsr_plan.dynamics.reaction import Reaction
from tests.dynamics.test_reaction_bound import complex_rate, states_at
from tests.helpers.dense_curve import attitudes, spline
from tests.helpers.urdf_builders import random_robot


def pieces_of(joints):
    """A curve with control points (m + 1, nd) of the joints."""
    table = np.hstack([np.zeros((len(joints), 3)), joints, np.zeros((len(joints), 1))])
    return pieces_with(table, np.zeros(3))


@pytest.mark.parametrize("seed", range(8))
def test_the_reaction_is_that_of_a_fine_integration_of_momentum(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    joints = rng.uniform(-2.0, 2.0, (6, robot.nd))
    found = CurvedReaction(robot, pieces_of(joints)).attitudes(rotations.IDENTITY)
    coarse, fine = (
        attitudes(robot, spline(joints), rotations.IDENTITY, steps) for steps in (1000, 2000)
    )
    error = rotations.angle_between(fine[::400], coarse[::200]).max() / 15.0  # of fourth order
    assert rotations.angle_between(found, fine[::400]).max() < 2.0 * error + 1e-10
    assert error < 1e-6


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-7, 1e-11])
def test_no_rotation_within_a_piece_exceeds_the_bound(tolerance):
    """Against the same with the least tolerance, at any time."""
    rng, shares = np.random.default_rng(5), []
    for seed in range(40):
        robot = random_robot(seed)
        pieces = pieces_of((0.3 if seed % 2 else 2.0) * rng.uniform(-1.0, 1.0, (6, robot.nd)))
        rough, fine = CurvedReaction(robot, pieces, tolerance), CurvedReaction(robot, pieces, 1e-13)
        edges, times = np.repeat(np.arange(5), 20), rng.uniform(0.0, 1.0, 100)
        wrong = rotations.angle_between(rough.rotation(edges, times), fine.rotation(edges, times))
        allowed = (rough.errors + fine.errors)[edges]
        assert np.all(wrong <= allowed + 1e-15)
        assert np.all(rough.errors <= tolerance + 1e-12)
        shares.append(np.max(wrong / allowed))
    assert max(shares) > 1e-6  # the bound is not beyond all measure


@pytest.mark.parametrize("seed", range(40))
def test_the_rate_at_complex_times_is_below_its_bound(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    pieces = pieces_of(rng.uniform(-2.0, 2.0, (4, robot.nd)))
    joints, half = pieces.values[1, :, 3:-1], 10.0 ** rng.uniform(-2.0, -0.5)
    memory = kernels.curve_memory_for(robot.nd + 1)
    values, rates = memory.straight.values, memory.rates
    kernels.joints_at(pieces, 1, 0.5, values, rates)
    kernels._expand_joints(pieces, 1, 0.5, half, memory.powers)
    links, _, least = states_at(robot, values, rates)
    moved, finite = records(EXCURSION, robot.nd + 1), 0
    for rho in (1.2, 2.0, 4.0, 10.0):
        imaginary = 0.5 * (rho - 1.0 / rho)
        kernels._move_away(robot.bodies, memory.powers, half, rho, imaginary, links, moved)
        bound = rate_bound(robot.bodies, least, links, moved)
        finite += np.isfinite(bound)
        for angle in np.linspace(0.0, 2.0 * np.pi, 37):
            u = 0.5 * (rho * np.exp(1j * angle) + np.exp(-1j * angle) / rho)
            t, s = 0.5 + half * u, 0.5 - half * u
            at = np.array([s**3, 3 * s * s * t, 3 * s * t * t, t**3]) @ joints
            change = 3.0 * np.array([s * s, 2 * s * t, t * t]) @ np.diff(joints, axis=0)
            assert np.linalg.norm(complex_rate(robot, at, change)) <= bound * (1 + 1e-12)
    assert finite >= 1


def test_straight_pieces_react_like_straight_segments():
    robot, rng = random_robot(4), np.random.default_rng(4)
    joints = rng.uniform(-1, 1, robot.nd) + np.arange(5.0)[:, None] * rng.normal(size=robot.nd)
    curved, straight = CurvedReaction(robot, pieces_of(joints)), Reaction.along(robot, joints)
    allowed = curved.errors.max() + straight.errors.max() + 1e-14
    apart = rotations.angle_between(curved.increments, straight.increments)
    assert apart.max() <= allowed
    still = CurvedReaction(robot, pieces_of(np.tile(joints[:1], (3, 1))))
    assert np.array_equal(still.increments, np.tile(rotations.IDENTITY, (2, 1)))


def test_a_piece_that_needs_too_many_substeps_is_refused():
    robot = random_robot(3)
    joints = np.array([[0.0], [1e6], [0.0]]) * np.ones(robot.nd)
    with pytest.raises(fp.IntegrationError, match="does not converge"):
        CurvedReaction(robot, pieces_of(joints))
