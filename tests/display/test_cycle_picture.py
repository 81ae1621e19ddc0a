"""The picture of a cycle shows the cycle's pheromone, ants and best path."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.display.live.cycle_picture import commands, take
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from tests.helpers.watched_cycles import cycles_of, unpacked


def middles(command):
    """(k, 3) middles of the ends at which the quads of a ribbon begin, and where they end."""
    (mesh,) = command["object"]["geometries"]
    data = mesh["data"]["attributes"]["position"]["array"].data
    corners = np.frombuffer(data, dtype=np.float32).reshape(-1, 4, 3)
    return corners[:, :2].mean(axis=1), corners[:, 2:].mean(axis=1)


def test_a_callback_sees_the_pheromone_after_evaporation(problem):
    """After one cycle of max-min: rho everywhere, and 1 - rho more along one path, up to 1."""
    first = cycles_of(problem, fp.MaxMinAntSystem(cycles=1, rho=0.6))[0]
    expected = np.full((8, 7, 7), 0.6)
    expected[np.arange(8), first.path[:-1], first.path[1:]] = 1.0
    assert np.allclose(first.pheromone, expected, rtol=1e-12)


def test_pheromone_is_even_again_after_a_restart(problem):
    """Then the cycle after it leaves rho everywhere, and more along one path of eight edges."""
    seen = cycles_of(problem, fp.MaxMinAntSystem(cycles=60, rho=0.6, patience=8))
    restarts = [k for k, c in enumerate(seen[:-1]) if np.all(c.pheromone == 1.0)]
    assert len(restarts) >= 3
    for k in restarts:
        tau = seen[k + 1].pheromone
        assert sorted(np.unique(tau.round(12))) == [0.6, 1.0]
        assert np.array_equal(np.count_nonzero(tau > 0.8, axis=(1, 2)), np.ones(8))


@pytest.mark.parametrize("planner", [fp.AntSystem(cycles=12), fp.MaxMinAntSystem(cycles=12)])
def test_trails_are_the_edges_where_ants_laid_pheromone(problem, planner):
    lattice = LayeredLattice(problem)
    for cycle in cycles_of(problem, planner):
        tau, shot = cycle.pheromone, take(cycle, lattice)
        excess = (tau - tau.min()) / (tau.max() - tau.min())
        expected = {tuple(e) for e in np.argwhere(excess > 1e-3)}
        assert {tuple(e) for e in shot.edges} == expected
        values = excess[tuple(shot.edges.T)]
        assert np.allclose(shot.strength, 1.0 + np.log10(values) / 3.0, atol=1e-12)
        assert shot.strength[-1] == 1.0


def test_only_the_strongest_of_many_trails_are_drawn(fig2a_plan):
    problem = fig2a_plan.problem
    cycle = cycles_of(problem, fp.AntSystem(cycles=3, ants=100))[-1]
    shot = take(cycle, LayeredLattice(problem))
    assert len(shot.edges) == 1200
    assert len(np.unique(shot.edges, axis=0)) == 1200
    drawn = cycle.pheromone[tuple(shot.edges.T)]
    assert np.array_equal(np.sort(drawn), np.sort(cycle.pheromone.ravel())[-1200:])


def test_pheromone_on_nodes_is_drawn_between_such_nodes(wide_problem):
    lattice = LayeredLattice(wide_problem)
    for cycle in cycles_of(wide_problem, fp.MaxMinAntSystem(cycles=10)):
        assert cycle.pheromone.shape == (8, 1, 121)
        tau = cycle.pheromone[:, 0]
        marked = [{lattice.origin}, *(set(np.flatnonzero(t > tau.min() + 1e-9)) for t in tau)]
        edges = take(cycle, lattice).edges
        assert all(t in marked[i] and h in marked[i + 1] for i, t, h in edges)
        ends = [{h for i, _, h in edges if i == k} for k in range(8)]
        assert all(
            len(end) == min(len(there), 12) for end, there in zip(ends, marked[1:], strict=True)
        )


def test_every_layer_counts_all_ants_of_all_postures(turning_problem):
    lattice = LayeredLattice(turning_problem)
    rng = np.random.default_rng(0)
    for cycle in cycles_of(turning_problem, fp.PostureAnnealing(ants=7, cycles=4)):
        anywhere = rng.integers(0, 25, 7)
        shot = take(cycle._replace(path=anywhere), lattice)
        assert shot.counts.shape == (7, 5)
        assert np.array_equal(shot.counts, cycle.counts.reshape(7, 5, 5).sum(axis=2))
        assert np.array_equal(shot.path, np.unravel_index(anywhere, (5, 5))[0])
        assert np.all(shot.counts.sum(axis=1) == cycle.counts.sum(axis=1)[0])


def test_drawn_objects_are_where_the_lattice_has_them(problem):
    """Ribbons run from node to node, dots stand on nodes, larger where more ants are."""
    lattice = LayeredLattice(problem)
    cycle = cycles_of(problem, fp.MaxMinAntSystem(cycles=6))[-1]
    shot = take(cycle, lattice)
    drawn = unpacked(commands(shot, lattice))

    def place(layer, node):  # along x, lateral is y
        return np.array([0.5 * layer, 0.2 * (node - 3), 0.0])

    begin, end = middles(drawn["/meshcat/trails/tau"])
    for (layer, tail, head), a, b in zip(shot.edges, begin, end, strict=True):
        assert np.allclose(a, place(layer, tail), atol=0.011)  # a little below the plane
        assert np.allclose(b, place(layer + 1, head), atol=0.011)
    begin, end = middles(drawn["/meshcat/tracks/best"])
    path = np.array([place(i, j) for i, j in enumerate(cycle.path)])
    assert np.allclose(begin, path[:-1], atol=1e-6)
    assert np.allclose(end, path[1:], atol=1e-6)
    dots = drawn["/meshcat/ants/dots"]["object"]["object"]
    placed = np.reshape(dots["instanceMatrix"]["array"], (dots["count"], 4, 4))
    nodes = np.argwhere(cycle.counts)
    assert np.allclose(placed[:, 3, :3], [place(*node) for node in nodes], atol=1e-6)
    volume = placed[:, 0, 0] ** 3
    assert np.allclose(volume / volume[0], cycle.counts[tuple(nodes.T)] / 30, atol=1e-3)


def test_without_pheromone_and_path_only_ants_are_drawn(problem):
    lattice = LayeredLattice(problem)
    cycle = cycles_of(problem, fp.MaxMinAntSystem(cycles=2, pheromone=False))[0]
    drawn = unpacked(commands(take(cycle._replace(best=np.inf), lattice), lattice))
    assert drawn["/meshcat/trails/tau"]["type"] == "delete"
    assert "/meshcat/tracks/best" not in drawn
