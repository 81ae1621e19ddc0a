"""The max-min ant system: it reaches the optimum, proves what it returns, and repeats itself."""

import os
import signal
import subprocess
import sys
import time
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.lattice.edge_states import REFUSED
from ffsr_plan.lattice.optimum import lattice_optimum
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.search.ants.local_search_kernels import (
    _best_neighbour,
    improve,
    neighbourhood,
    path_cost,
)
from ffsr_plan.search.ants.max_min import _close_refused, _largest
from ffsr_plan.search.ants.max_min_kernels import CYCLE, DONE, run_cycles
from ffsr_plan.search.ants.open_edges import close_refused, find_open_edges
from tests.helpers.brute_force import optimum
from tests.helpers.urdf_builders import random_scene

seeds = st.integers(0, 100_000)


def random_problem(seed, delta, lattice=None):
    """A scene of the kind that the benchmarks use, from other seeds."""
    rng = np.random.default_rng([7, seed])
    given_ = fp.load_scenario("fig2a")
    scene = random_scene(rng, int(rng.integers(4, 12)), (1.8, -3, 0), (8.2, 3, 0), (0.15, 0.5))
    lattice = lattice or fp.Lattice(40, fp.Axis(20, 0.15))
    return fp.Problem(given_.robot, scene, given_.start, given_.goal, delta=delta, lattice=lattice)


def solvable(count, delta):
    found, seed = [], 0
    while len(found) < count:
        try:
            roadmap = Roadmap(random_problem(seed, delta))
            found.append((roadmap, roadmap.objective(lattice_optimum(roadmap))))
        except fp.PlanningError:
            pass
        seed += 1
    return found


@pytest.mark.parametrize("delta", [0.0, 0.1, 2.0, 6.0])
def test_the_default_colony_reaches_the_optimum(delta):
    gaps = [
        roadmap.objective(
            fp.MaxMinAntSystem()
            .search(roadmap.without_edge_states(), np.random.default_rng(seed))
            .path
        ) / best - 1.0
        for roadmap, best in solvable(12, delta)
        for seed in range(3)
    ]  # fmt: skip
    assert min(gaps) > -1e-9
    assert max(gaps) < 0.01
    assert np.percentile(gaps, 95) < 0.001


@given(seeds)
@settings(max_examples=30)
def test_it_never_beats_brute_force_and_its_path_is_proven(seed):
    rng = np.random.default_rng(seed)
    point = fp.load_robot("point")
    scene = random_scene(rng, 6, (1.0, -1.5, -0.1), (5.0, 1.5, 0.1), (0.2, 0.9))
    goal = point.configuration((6.0, 0.0, 0.0))
    problem = fp.Problem(point, scene, point.configuration(), goal, delta=1.0,
                         lattice=fp.Lattice(6, fp.Axis(2, 0.6), fp.Axis(1, 0.5)))  # fmt: skip
    try:
        roadmap = Roadmap(problem)
    except fp.PlanningError:
        return
    best, _ = optimum(roadmap.without_edge_states())
    if best == np.inf:
        return
    found = fp.MaxMinAntSystem(ants=5, cycles=10).search(roadmap, np.random.default_rng(seed))
    assert roadmap.objective(found.path) >= best - 1e-9
    assert roadmap.without_edge_states().prove_path(found.path)


ABLATIONS = {
    "without local search": {"improved": 0},
    "without cost-aware visibility": {"cost_aware": False},
    "without restarts": {"patience": 0},
    "without pheromone": {"pheromone": False},
    "with three improved ants": {"improved": 3},
    "with a general beta": {"beta": 3.5},
}


@pytest.mark.parametrize("change", ABLATIONS.values(), ids=ABLATIONS.keys())
def test_every_variant_returns_verified_plans(change):
    planner = fp.MaxMinAntSystem(cycles=30, **change)
    plan = fp.plan(fp.load_scenario("fig2a"), planner, 1, refine=False)
    assert plan.verify(50).ok
    assert plan.gap >= 0.0
    assert len(plan.history.best) == 30
    assert np.all(np.diff(plan.history.best) <= 0)


def test_local_search_improves_and_respects_closed_edges():
    roadmap = Roadmap(random_problem(3, 0.1))
    roadmap.prove_obvious()
    open_edges, _ = find_open_edges(roadmap.admissible, roadmap.status)
    edge_costs, node_costs = roadmap.edge_costs(), roadmap.node_costs()
    table = neighbourhood(roadmap.lattice.indices, wide=False)
    rng = np.random.default_rng(0)
    improved = 0
    for _ in range(50):
        path = fp.AntSystem(ants=1, cycles=1).search(roadmap.without_edge_states(), rng).path
        trial = path.copy()
        before = path_cost(trial, edge_costs, node_costs, open_edges)
        after = improve(trial, edge_costs, node_costs, open_edges, table)
        assert after <= before
        assert after == pytest.approx(path_cost(trial, edge_costs, node_costs, open_edges))
        assert after == pytest.approx(roadmap.objective(trial), rel=1e-12)
        improved += after < before
    assert improved > 40


@given(seeds)
@settings(max_examples=40)
def test_the_best_displaced_path_equals_brute_force_over_open_edges(seed):
    rng, m, n = np.random.default_rng(seed), 4, 5
    edge_costs = rng.uniform(1.0, 2.0, (n, n))
    edge_costs += edge_costs.T
    node_costs = rng.uniform(0.0, 1.0, (m + 1, n))
    node_costs[rng.random(node_costs.shape) < 0.1] = np.inf
    node_costs[[0, -1]] = 0.0
    open_edges = rng.random((m, n, n)) < rng.choice([0.5, 0.9, 1.0])
    table = neighbourhood(np.arange(n)[:, None], wide=False)
    path = rng.integers(0, n, m + 1)
    near = [[k for k in table[p] if k >= 0] for p in path]
    ends = [[path[0]], *near[1:-1], [path[-1]]]
    around = [np.array(nodes) for nodes in product(*ends)]
    least = min(path_cost(p, edge_costs, node_costs, open_edges) for p in around)
    before = path.copy()
    found = _best_neighbour(path, edge_costs, node_costs, open_edges, table)
    assert found == pytest.approx(least, rel=1e-12)
    if found == np.inf:
        assert np.array_equal(path, before)
    else:
        assert found == pytest.approx(path_cost(path, edge_costs, node_costs, open_edges))


@pytest.mark.parametrize("lattice", [fp.Lattice(20, fp.Axis(10, 0.3)), fp.Lattice(
    5, fp.Axis(5, 0.3), fp.Axis(5, 0.3))], ids=["by edge", "by node"])  # fmt: skip
def test_ants_walk_by_the_roulette_of_pheromone_times_visibility(lattice):
    """More ants than walk together, beside walks node by node with the same random numbers."""
    roadmap = Roadmap(random_problem(3, 0.1, lattice))
    state, open_counts = fp.MaxMinAntSystem(ants=70, cycles=9, improved=0)._prepared(roadmap)
    rng, m = np.random.default_rng(5), lattice.divisions
    for cycle in range(9):
        numbers = np.random.default_rng()
        numbers.bit_generator.state = rng.bit_generator.state
        tau, touched = state.tau.copy(), state.touched.copy()
        done = run_cycles(rng, cycle + 1, state) == DONE
        for path in state.paths:
            for i in range(m):
                p = path[i]
                row = p if tau.shape[1] > 1 else 0
                pheromone = tau[i, row] if touched[i, row] else 1.0
                sums = np.cumsum(pheromone * state.visibility[i, p])
                draw = numbers.random() * sums[-1]
                assert path[i + 1] == np.searchsorted(sums, draw, side="right")
        while not done:
            if not roadmap.prove_path(state.candidate):
                _close_refused(roadmap, state, open_counts)
            done = run_cycles(rng, cycle + 1, state) == DONE
    assert state.counters[CYCLE] == 9
    assert state.touched.any()


@given(st.lists(st.integers(0, 5), min_size=3, max_size=30), st.data())
def test_of_equally_walked_edges_the_first_ones_are_kept(numbers, data):
    numbers, count = np.array(numbers), data.draw(st.integers(1, len(numbers) - 1))
    expected = np.sort(np.argsort(-numbers, kind="stable")[:count])
    assert np.array_equal(_largest(numbers, count), expected)


def test_neighbourhoods_hold_displacements_along_the_axes():
    line = np.arange(-4, 5)[:, None]
    near = neighbourhood(line, wide=False)
    assert near[:, 0].tolist() == list(range(9))
    assert set(near[4]) == {0, 2, 3, 4, 5, 6, 8}  # 0, +-1, +-2, +-4
    assert set(near[0]) == {-1, 0, 1, 2, 4}
    grid = np.array([(i, j) for i in range(-2, 3) for j in range(-2, 3)])
    around = neighbourhood(grid, wide=True)[12]
    assert set(around) - {-1} == {6, 7, 8, 11, 12, 13, 16, 17, 18, 2, 10, 14, 22}


@given(seeds)
@settings(max_examples=40)
def test_closing_edges_keeps_the_ways_those_of_a_new_start(seed):
    """Closing one by one ends where computing afresh would."""
    rng = np.random.default_rng(seed)
    admissible = rng.random((6, 5)) < 0.8
    admissible[[0, -1]] = False
    admissible[[0, -1], 2] = True
    status = np.zeros((5, 5, 5), dtype=np.int8)
    open_edges, open_counts = find_open_edges(admissible, status)
    changed = np.zeros((5, 5), dtype=bool)
    for _ in range(12):
        before = open_edges.copy()
        status[tuple(rng.integers(0, 5, 3))] = REFUSED
        for layer in range(5):
            close_refused(layer, status, open_edges, open_counts, changed)
        fresh, fresh_exits = find_open_edges(admissible, status)
        assert np.array_equal(open_edges, fresh)
        assert np.array_equal(open_counts, fresh_exits)
        assert np.all(changed[np.any(before != open_edges, axis=2)])


def test_large_lattices_are_solved_by_both_planners():
    """21 x 21 nodes a layer, 40 layers, whole body."""
    given_ = fp.load_scenario("fig2a")
    problem = fp.Problem(
        given_.robot, given_.scene, given_.start, given_.goal, delta=2.0, length_unit=0.1,
        lattice=fp.Lattice(40, fp.Axis(10, 0.3), fp.Axis(10, 0.3)),
    )  # fmt: skip
    exact = fp.plan(problem, fp.LatticeOptimum(), refine=False)
    colony = fp.plan(problem, fp.MaxMinAntSystem(cycles=60), refine=False)
    assert exact.gap == 0.0
    assert colony.gap < 0.01
    assert colony.nodes.shape == (41, 2)
    assert exact.verify(20).ok
    assert colony.verify(20).ok


@pytest.mark.parametrize("planner", [fp.MaxMinAntSystem(cycles=40), fp.AntSystem(cycles=5)])
def test_the_plan_is_the_same_for_any_number_of_workers(planner):
    problem = fp.load_scenario("fig2a")
    plans = [fp.plan(problem, planner, 5, colonies=3, workers=w) for w in (1, 2, 4)]
    assert plans[0] == plans[1] == plans[2]
    single = fp.plan(problem, planner, 5)
    assert plans[0].lattice_objective <= single.lattice_objective * 1.05


class Dying(fp.MaxMinAntSystem):
    """A planner whose search ends the process that runs it."""

    def search(self, roadmap, rng, monitor=None):
        os.kill(os.getpid(), signal.SIGKILL)


def test_a_dead_worker_is_an_error_that_names_it():
    with pytest.raises(fp.WorkerDied, match=r"worker 0 \(colonies 0, 2\) .*SIGKILL\(-9\)"):
        fp.plan(fp.load_scenario("fig2a"), Dying(), seed=1, colonies=3, workers=2)


def test_colonies_that_find_no_path_pass_their_proof_on(point):
    wall = [[3.1, y, 0.0] for y in np.arange(-3, 3.1, 0.5)]
    scene = fp.Scene(wall, [0.3] * len(wall))
    goal = point.configuration((6.0, 0.0, 0.0))
    problem = fp.Problem(point, scene, point.configuration(), goal,
                         lattice=fp.Lattice(6, fp.Axis(2, 0.6)))  # fmt: skip
    with pytest.raises(fp.NoPath, match="layer 3"):
        fp.plan(problem, colonies=2, workers=2)


@pytest.mark.parametrize("planner", [fp.MaxMinAntSystem(cycles=10**6), fp.AntSystem(rho=0.999999)])
def test_a_time_limit_returns_the_best_so_far_marked_as_such(planner):
    plan = fp.plan(fp.load_scenario("fig2a"), planner, 0, time_limit=0.2, refine=False)
    assert plan.interrupted
    assert plan.verify(20).ok
    assert len(plan.history.best) < planner.cycles
    assert plan.objective == pytest.approx(plan.history.best[-1], rel=1e-9)


def test_ctrl_c_returns_the_best_so_far_marked_as_such():
    code = (
        "import ffsr_plan as fp\n"
        "p = fp.load_scenario('fig2a')\n"
        "fp.plan(p, fp.MaxMinAntSystem(cycles=5))\n"
        "print('planning', flush=True)\n"
        "plan = fp.plan(p, fp.MaxMinAntSystem(cycles=10**6))\n"
        "print(plan.interrupted, plan.verify(20).ok)\n"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "planning\n"
    time.sleep(1.0)
    os.kill(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert out == "True True\n", err


def test_the_callback_follows_the_colony_and_changes_nothing():
    problem = fp.load_scenario("fig2a")
    seen = []
    watched = fp.plan(problem, fp.MaxMinAntSystem(cycles=20), 2, on_cycle=seen.append)
    assert watched == fp.plan(problem, fp.MaxMinAntSystem(cycles=20), 2)
    assert [c.number for c in seen] == list(range(1, 21))
    assert seen[-1].best == pytest.approx(watched.lattice_objective, rel=1e-12)
    assert all(np.array_equal(c.counts.sum(axis=1), np.full(41, 30)) for c in seen)
    assert seen[0].pheromone.shape == (40, 81, 81)


def test_a_callback_needs_a_single_colony(robot):
    with pytest.raises(fp.InvalidInput, match="colonies = 1"):
        fp.plan(fp.load_scenario("fig2a"), colonies=2, on_cycle=print)


@pytest.mark.parametrize(
    "wrong", [{"ants": 0}, {"cycles": 0}, {"beta": -1}, {"rho": 1.0}, {"improved": -1},
              {"patience": 1.5}]
)  # fmt: skip
def test_its_parameters_are_checked(wrong):
    with pytest.raises(fp.InvalidInput, match=next(iter(wrong))):
        fp.MaxMinAntSystem(**wrong)


def test_numbers_of_colonies_workers_and_seconds_are_checked():
    problem = fp.load_scenario("fig2a")
    for wrong in ({"colonies": 0}, {"workers": 0}, {"time_limit": 0.0}, {"time_limit": -1}):
        with pytest.raises(fp.InvalidInput, match=next(iter(wrong))):
            fp.plan(problem, **wrong)


@pytest.mark.parametrize("workers", [1, 2])
def test_one_ctrl_c_ends_all_colonies_with_the_best_path(workers):
    code = (
        "import ffsr_plan as fp\n"
        "p = fp.load_scenario('fig2a')\n"
        "fp.plan(p, fp.MaxMinAntSystem(cycles=5))\n"
        "print('planning', flush=True)\n"
        "endless = fp.MaxMinAntSystem(cycles=10**6)\n"
        f"plan = fp.plan(p, endless, colonies=4, workers={workers})\n"
        "print(plan.interrupted, plan.verify(20).ok)\n"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "planning\n"
    time.sleep(6.0)  # workers have to start
    os.kill(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert out == "True True\n", err
