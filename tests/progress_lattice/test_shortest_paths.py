"""Shortest paths that go on from the last ones are those found anew."""

import numpy as np
import pytest

from ffsr_plan.lattice.edge_states import REFUSED
from ffsr_plan.progress_lattice.progress_kernels import extend, remain, trace
from ffsr_plan.progress_lattice.progress_search import offsets_before

LAYERS, PLACES, OFFSETS, REACH = 9, 5, 4, 1
GOAL, ORIGIN = 3, 1


class Lattice:
    """A random lattice whose nodes and edges become dearer."""

    def __init__(self, seed):
        self.rng = rng = np.random.default_rng(seed)
        ends = np.arange(PLACES)[:, None] + np.arange(-REACH, REACH + 1)
        steps = np.arange(ends.size).reshape(ends.shape)
        self.edges = np.where((ends >= 0) & (ends < PLACES), steps, -1)
        to = np.arange(OFFSETS)[:, None] + np.array([-1, 0, 1])
        self.heads = np.where((to >= 0) & (to < OFFSETS), to, -1)
        self.edge_costs = rng.choice([0.0, 0.1, 0.3, 0.5], (ends.size, 3))  # with ties
        self.node_costs = rng.choice([0.1, 0.2, 0.4], (LAYERS, PLACES, OFFSETS))
        self.at_rest = np.zeros((ends.size, OFFSETS, 3), dtype=np.int8)
        self.moving = np.zeros((LAYERS - 1, *self.at_rest.shape), dtype=np.int8)
        self.begin = np.full((PLACES, OFFSETS), np.inf)
        self.begin[1, ORIGIN] = 0.0

    def raise_some(self):
        """The first layer whose outgoing edges are to be searched again, and what was refused."""
        layers = np.sort(self.rng.integers(1, LAYERS, 3))
        for k in layers:
            place, offset = self.rng.integers(PLACES), self.rng.integers(OFFSETS)
            self.node_costs[k, place, offset] += self.rng.choice([0.0, 0.5, np.inf])
        refused = bool(self.rng.random() < 0.5)
        if refused:
            k, e = layers[0] - 1, self.rng.integers(len(self.edge_costs))
            self.moving[k, e] = REFUSED
        return int(layers[0]) - 1, refused

    def anew(self):
        """(m + 1, A, n) least costs of reaching nodes, by a loop over all edges."""
        costs = np.full(self.node_costs.shape, np.inf)
        costs[0] = self.begin
        for k, a, d, j, w in np.ndindex(LAYERS - 1, *self.edges.shape, OFFSETS, 3):
            e, h, b = self.edges[a, d], self.heads[j, w], a + d - REACH
            if e >= 0 and h >= 0 and self.moving[k, e, j, w] != REFUSED:
                total = costs[k, a, j] + self.edge_costs[e, w] + self.node_costs[k + 1, b, h]
                costs[k + 1, b, h] = min(costs[k + 1, b, h], total)
        return costs


def lengths(lattice, path):
    """F of a path whose steps exist."""
    total = 0.0
    for k, (a, j, w) in enumerate(path[:-1]):
        b, h = path[k + 1, :2]
        assert lattice.heads[j, w] == h
        e = lattice.edges[a, b - a + REACH]
        assert e >= 0
        assert lattice.moving[k, e, j, w] != REFUSED
        total += lattice.edge_costs[e, w] + lattice.node_costs[k + 1, b, h]
    return total


@pytest.mark.parametrize("seed", range(20))
def test_costs_after_changes_are_those_found_anew(seed):
    lattice = Lattice(seed)
    shape = lattice.node_costs.shape
    entered, costs, remaining = np.full(shape, np.inf), np.full(shape, np.inf), np.empty(shape)
    costs[0] = lattice.begin
    before = np.full((*shape, 3), -1, dtype=np.int64)
    grid = lattice.edges, lattice.heads
    remain(GOAL, ORIGIN, *grid, lattice.edge_costs, lattice.node_costs, remaining)
    assert remaining[0, 1, ORIGIN] == pytest.approx(lattice.anew()[-1, GOAL, ORIGIN], abs=1e-12)
    limit = np.inf if seed % 2 else 1.2 * remaining[0, 1, ORIGIN]
    first, refused, fresh, reached = 0, False, True, 0
    for _ in range(12):
        extend(
            first, fresh, refused, *grid, offsets_before(lattice.heads), lattice.edge_costs,
            lattice.node_costs, lattice.at_rest, lattice.moving, remaining, limit, entered, costs,
            before,
        )  # fmt: skip
        expected = lattice.anew()
        counts = expected + remaining <= limit - 1e-9  # the others may be left out
        assert costs[counts] == pytest.approx(expected[counts], abs=1e-12)
        assert np.all(costs[~counts] + remaining[~counts] >= limit - 1e-9)
        if costs[-1, GOAL, ORIGIN] < np.inf:
            path, reached = np.empty((LAYERS, 3), dtype=np.int64), reached + 1
            trace(before, GOAL, ORIGIN, path)
            assert lengths(lattice, path) == pytest.approx(costs[-1, GOAL, ORIGIN], abs=1e-12)
        fresh = False
        first, refused = lattice.raise_some()
    assert reached
