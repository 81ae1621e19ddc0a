"""Bands of offsets: the places half-way on edges, and the best path over them."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.lattice.shortest_path_kernel import promising
from ffsr_plan.proof.prover import Prover
from ffsr_plan.refinement.band_search import BandSearch
from ffsr_plan.refinement.edge_clearances import EdgeClearances
from ffsr_plan.refinement.offset_band import OffsetBand
from tests.helpers.urdf_builders import random_scene

seeds = st.integers(0, 100_000)


def around(seed, delta, two_axes=False, reach=1):
    """A band about a random path of a point among spheres, and what measures it."""
    rng = np.random.default_rng(seed)
    robot = fp.load_robot("point")
    problem = fp.Problem(
        robot,
        random_scene(rng, 5, (1.0, -1.0, -0.3), (5.0, 1.0, 0.3), (0.1, 0.5)),
        robot.configuration(),
        robot.configuration((6.0, 0.5, 0.0)),
        delta=delta,
        lattice=fp.Lattice(4, fp.Axis(3, 0.4), fp.Axis(3, 0.3) if two_axes else None),
    )
    lattice = LayeredLattice(problem)
    axes = len(lattice.directions)
    unit = lattice.directions * np.array([0.4, 0.3][:axes])[:, None]
    path = rng.integers(-2, 3, (5, axes))
    path[[0, -1]] = 0
    rim = np.full(axes, 3)
    band = OffsetBand(problem, path, rim, unit, 1, np.full(axes, reach))
    return band, EdgeClearances(problem, Prover(lattice.nominal, problem.scene, problem.tolerance))


def node_clearances(band, edges):
    layers, nodes = np.nonzero(band.present)
    clearances = np.full(band.present.shape, -np.inf)
    at = band.offsets[layers, nodes]
    clearances[layers, nodes] = edges._prover.clearances(layers, at)
    return clearances


@pytest.mark.parametrize("two_axes", [False, True])
@given(seed=seeds)
@settings(max_examples=20)
def test_every_edge_gets_the_place_half_way_on_it(two_axes, seed):
    band, _ = around(seed, 0.1, two_axes, reach=2)
    wanted = np.random.default_rng(seed).random(band.lengths.shape) < 0.3
    wanted &= band.present[:-1, :, None] & band.present[1:, None]
    layers, places, place = band.half_way(wanted)
    layer, tail, head = np.nonzero(wanted)
    middles = (band.offsets[layer, tail] + band.offsets[layer + 1, head]) / 2.0
    assert np.array_equal(layers[place], layer)
    assert np.allclose(places[place], middles, atol=1e-12)
    assert len(np.unique(np.column_stack([layers, places.round(9)]), axis=0)) == len(places)


@pytest.mark.parametrize("straight", [False, True])
@given(seed=seeds)
@settings(max_examples=10)
def test_edges_are_as_long_as_equation_6_says(straight, seed):
    band, edges = around(seed, 0.1, two_axes=True)
    if straight:
        path = np.zeros((6, 2), dtype=np.int64)
        path[1:-1] = (1, -1)
        unit = np.array([[0.0, 0.4, 0.0], [0.0, 0.0, 0.3]])
        band = OffsetBand(edges._problem, path, np.full(2, 3), unit, 1, np.full(2, 1))
    apart = np.linalg.norm(band.offsets[1:, None] - band.offsets[:-1, :, None], axis=3)
    expected = np.hypot(edges._problem.delta_d, apart) / edges._problem.length_unit
    assert band.lengths == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize("two_axes", [False, True])
@given(seed=seeds, delta=st.sampled_from([0.0, 0.02, 0.5]))
@settings(max_examples=8)
def test_the_best_path_of_a_band_equals_brute_force(two_axes, seed, delta):
    band, edges = around(seed, delta, two_axes)
    clearances = node_clearances(band, edges)
    found = BandSearch(edges._problem, edges, band, clearances, np.inf).best_path(10**6)
    best, layers = np.inf, np.arange(5)
    inner = [np.flatnonzero(clearances[i] > 0.0) for i in (1, 2, 3)]
    for nodes in product(*inner):
        path = np.array([0, *nodes, 0])
        at = (band.offsets[layers, path], clearances[layers, path])
        best = min(best, edges.motion_objective(*at))
    if found is None:
        assert best == np.inf
        return
    value = edges.motion_objective(band.offsets[layers, found], clearances[layers, found])
    assert value == pytest.approx(best, rel=1e-12)
    assert BandSearch(edges._problem, edges, band, clearances, best).best_path(10**6) is None
    more = BandSearch(edges._problem, edges, band, clearances, best * (1.0 + 1e-9))
    assert more.best_path(10**6) is not None


@given(seeds)
@settings(max_examples=40)
def test_promising_edges_are_those_of_cheap_paths(seed):
    rng = np.random.default_rng(seed)
    costs = rng.uniform(0.5, 2.0, (4, 3, 3))
    costs[rng.random(costs.shape) < 0.2] = np.inf
    most, expected = rng.uniform(2.0, 8.0), np.zeros(costs.shape, dtype=bool)
    for nodes in product(range(3), repeat=3):
        path = np.array([0, *nodes, 0])
        steps = np.arange(4), path[:-1], path[1:]
        if np.sum(costs[steps]) < most:
            expected[steps] = True
    found = promising(costs, most)
    assert np.array_equal(found, expected)
