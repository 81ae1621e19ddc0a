"""The bound on the error of the base reaction: its parts, and attempts to exceed it."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import records
from ffsr_plan.dynamics.kernels import reaction as reaction_kernels
from ffsr_plan.dynamics.kernels.bodies import (
    LINK_STATE,
    ROBOT_STATE,
    base_at_rest,
    base_rate,
    move_links,
    weigh_links,
)
from ffsr_plan.dynamics.kernels.rate_bound import EXCURSION, excursions_of_links, rate_bound
from ffsr_plan.dynamics.momentum import connections
from ffsr_plan.dynamics.reaction import Reaction
from tests.dynamics.test_reaction_error import two_bodies
from tests.helpers.sample_sizes import sample
from tests.helpers.urdf_builders import random_robot


def states_at(robot, values, rates):
    """States of the links and of the robot, and the least moment of inertia from below."""
    links = base_at_rest(records(LINK_STATE, robot.nd + 1))
    whole = records(ROBOT_STATE, 1)
    move_links(robot.bodies, values, rates, links)
    weigh_links(robot.bodies, links, whole)
    least = base_rate(whole)
    return links, whole[0], least


@pytest.mark.parametrize("seed", range(20))
def test_the_compiled_rate_is_the_connection_times_joint_rates(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    values, rates = rng.uniform(-2.0, 2.0, (2, robot.nd))
    _, whole, least = states_at(robot, values, rates)
    expected = connections(robot, values[None])[0] @ rates
    assert np.allclose(
        whole["rate"], expected, rtol=0.0, atol=1e-12 * (1.0 + np.abs(expected).max())
    )
    xx, yy, zz, xy, xz, yz = whole["inertia"]
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    smallest = np.linalg.eigvalsh(inertia)[0]
    assert smallest / np.sqrt(3.0) * (1 - 1e-9) <= least <= smallest * (1 + 1e-9)


def complex_rate(robot, values, rates):
    """The base's angular velocity (3,) at complex joint values, by matrices of numpy."""
    bodies, n = robot.bodies, robot.nd + 1
    turned = np.tile(np.eye(3, dtype=complex), (n, 1, 1))
    origins, angular, linear = np.zeros((3, n, 3), dtype=complex)
    for j in range(1, n):
        p, q, rate = bodies["parent"][j], values[j - 1], rates[j - 1]
        local = bodies["fixed"][j].astype(complex)
        if not bodies["prismatic"][j]:
            local = local + np.sin(q) * bodies["sine"][j] + (1.0 - np.cos(q)) * bodies["versine"][j]
        step = turned[p] @ (bodies["offset"][j] + q * bodies["slide"][j])
        turned[j] = turned[p] @ local
        along = turned[j] @ bodies["axis"][j] * rate
        origins[j] = origins[p] + step
        linear[j] = linear[p] + np.cross(angular[p], step) + along * bodies["prismatic"][j]
        angular[j] = angular[p] + along * (not bodies["prismatic"][j])
    levers = np.einsum("nij,nj->ni", turned, bodies["lever"])
    flows = linear + np.cross(angular, levers)
    arms = origins + levers
    arms = arms - bodies["mass"] @ arms / bodies["mass"].sum()
    own = turned @ bodies["inertia"] @ np.swapaxes(turned, 1, 2)
    squares = np.einsum("ni,ni->n", arms, arms)
    spread = squares[:, None, None] * np.eye(3) - arms[:, :, None] * arms[:, None]
    inertia = np.sum(own + bodies["mass"][:, None, None] * spread, axis=0)
    momentum = np.sum(
        np.einsum("nij,nj->ni", own, angular) + bodies["mass"][:, None] * np.cross(arms, flows), 0
    )
    return -np.linalg.solve(inertia, momentum)


@pytest.mark.parametrize("seed", range(sample(20, 60)))
def test_the_rate_at_complex_joint_values_is_below_its_bound(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    values, rates = rng.uniform(-2.0, 2.0, (2, robot.nd))
    links, whole, least = states_at(robot, values, rates)
    assert np.allclose(complex_rate(robot, values, rates), whole["rate"], atol=1e-12)
    moved, shares, finite = records(EXCURSION, robot.nd + 1), [], 0
    for _ in range(40):
        real, imaginary = 10.0 ** rng.uniform(-2.5, 0.0, 2)
        excursions_of_links(robot.bodies, rates, real, imaginary, links, moved)
        bound = rate_bound(robot.bodies, least, links, moved)
        finite += np.isfinite(bound)
        for angle in rng.uniform(0.0, 2.0 * np.pi, 20):
            away = real * np.cos(angle) + 1j * imaginary * np.sin(angle)
            found = np.linalg.norm(complex_rate(robot, values + away * rates, rates))
            shares.append(found / bound)
    assert max(shares) <= 1.0 + 1e-12
    assert finite >= 5


@pytest.mark.parametrize("moment", [1e-2, 1e-4, 1e-6])
def test_the_bound_goes_to_infinity_before_the_rate_does(moment):
    """A pole is close to the real axis where the arm carries the centre of mass past the base's."""
    robot, _ = two_bodies(np.random.default_rng(1), moment, 0.5, 0.5)
    values, rates = np.array([np.pi]), np.ones(1)
    links, _, least = states_at(robot, values, rates)
    moved, largest = records(EXCURSION, 2), 0.0
    for imaginary in np.geomspace(1e-4, 1.0, 400):
        excursions_of_links(robot.bodies, rates, 1e-9, imaginary, links, moved)
        bound = rate_bound(robot.bodies, least, links, moved)
        found = np.linalg.norm(complex_rate(robot, values + 1j * imaginary, rates))
        assert found <= bound * (1.0 + 1e-9)
        largest = max(largest, found)
    assert largest > 20.0  # within a few steps of the pole


def test_the_constant_of_the_interpolation_is_that_of_the_points():
    """1 plus the largest sum of the absolute Lagrange polynomials."""
    points = reaction_kernels.gauss_points()
    u = np.linspace(-1.0, 1.0, 20001)
    lagrange = np.vander(u, len(points), increasing=True) @ points["monomials"]
    assert np.allclose(lagrange.sum(axis=1), 1.0, atol=1e-11)
    integrals = np.abs(lagrange).mean(axis=0) * 2.0 / points["weight"]
    assert integrals.max() < reaction_kernels._ABSOLUTE
    largest = np.abs(lagrange).sum(axis=1).max()
    assert reaction_kernels.INTERPOLATION - 0.2 < 1.0 + largest < reaction_kernels.INTERPOLATION


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-7, 1e-11])
def test_no_rotation_within_a_segment_exceeds_the_bound(tolerance):
    """Against the same with the least tolerance, at any time."""
    rng = np.random.default_rng(5)
    shares = []
    for seed in range(40):
        robot = random_robot(seed)
        begin, steps = rng.uniform(-2.0, 2.0, (2, 5, robot.nd))
        rough, fine = Reaction(robot, begin, steps, tolerance), Reaction(robot, begin, steps, 1e-13)
        edges, times = np.repeat(np.arange(5), 20), rng.uniform(0.0, 1.0, 100)
        wrong = rotations.angle_between(rough.rotation(edges, times), fine.rotation(edges, times))
        allowed = (rough.errors + fine.errors)[edges]
        assert np.all(wrong <= allowed + 1e-15)
        assert np.all(rough.errors <= tolerance + 1e-12)
        shares.append(np.max(wrong / allowed))
    assert max(shares) > 1e-4  # the bound is not beyond all measure


def test_a_segment_that_needs_too_many_substeps_is_refused(monkeypatch):
    robot = random_robot(3)
    with pytest.raises(fp.IntegrationError, match="joint step 1e"):
        Reaction(robot, np.zeros((1, robot.nd)), np.full((1, robot.nd), 1e6))


def test_segments_are_cut_where_they_need_it():
    robot = random_robot(3)
    steps = np.array([[0.0], [1e-3], [3.0]]) * np.ones(robot.nd)
    reaction = Reaction(robot, np.zeros((3, robot.nd)), steps)
    substeps = reaction.partial.substeps
    counts = np.bincount(substeps["segment"], minlength=3)
    assert counts[0] == counts[1] == 1
    assert counts[2] > 4
    lengths = [substeps["length"][substeps["segment"] == k].sum() for k in range(3)]
    assert np.allclose(lengths, 1.0, rtol=0.0, atol=1e-15)
