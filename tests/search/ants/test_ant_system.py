"""The paper's Ant System, step by step against its equations."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.search.ants.ant_system import Walk
from tests.helpers.brute_force import first_layer_out_of_reach, optimum
from tests.helpers.urdf_builders import random_scene


def small(point, seed, obstacles=6, delta=1.0, half_count=2, divisions=6, radii=(0.2, 0.9)):
    rng = np.random.default_rng(seed)
    scene = random_scene(rng, obstacles, (1.0, -1.5, -0.1), (5.0, 1.5, 0.1), radii)
    goal = point.configuration((6.0, 0.0, 0.0))
    lattice = fp.Lattice(divisions, fp.Axis(half_count, 0.6))
    return fp.Problem(point, scene, point.configuration(), goal, delta=delta, lattice=lattice)


def test_equation_11_weights_the_roulette_wheel(point):
    problem = small(point, 0, obstacles=0)
    roadmap, rng = Roadmap(problem), np.random.default_rng(5)
    alpha, beta = 1.3, 2.0
    walk = Walk(fp.AntSystem(ants=40_000, alpha=alpha, beta=beta), roadmap, rng)
    tau = rng.uniform(0.5, 3.0, (6, 5, 5))
    paths = walk.tours(tau)
    for layer, tail in ((0, 2), (2, 1), (4, 3)):
        heads = paths[paths[:, layer] == tail, layer + 1]
        counts = np.bincount(heads, minlength=5)
        d = np.hypot(1.0, 0.6 * (np.arange(5) - tail))
        weight = tau[layer, tail] ** alpha * (1 / d) ** beta
        expected = counts.sum() * weight / weight.sum()
        assert np.sum((counts - expected) ** 2 / expected) < 20.0  # chi-square, 4 degrees: p < 5e-4


def test_a_refused_edge_leaves_the_others_in_proportion(point):
    """Barring an edge and drawing again is the roulette over the allowed edges."""
    scene = fp.Scene([[1.5, 0.6, 0.0]], [0.25])  # across some edges of layer 1
    goal = point.configuration((6.0, 0.0, 0.0))
    problem = fp.Problem(point, scene, point.configuration(), goal,
                         lattice=fp.Lattice(6, fp.Axis(2, 0.6)))  # fmt: skip
    roadmap = Roadmap(problem)
    free = np.array([roadmap.certify(1, 2, head).free for head in range(5)])
    assert 0 < free.sum() < 5
    walk = Walk(fp.AntSystem(ants=20_000, beta=1.0), Roadmap(problem), np.random.default_rng(0))
    paths = walk.tours(np.ones((6, 5, 5)))
    counts = np.bincount(paths[paths[:, 1] == 2, 2], minlength=5)
    weight = free / np.hypot(1.0, 0.6 * (np.arange(5) - 2))
    expected = counts.sum() * weight / weight.sum()
    assert np.all(counts[~free] == 0)
    assert np.sum((counts - expected)[free] ** 2 / expected[free]) < 20.0


def test_equations_12_and_13_update_the_pheromone(point):
    problem = small(point, 1, obstacles=2)
    planner = fp.AntSystem(ants=4, cycles=3, rho=0.6, Q=7.0, C=2.0)
    seen = []
    fp.plan(problem, planner, 3, on_cycle=lambda c: seen.append((c.counts, c.pheromone.copy())))
    # the same again by hand: the same generator draws the same tours
    roadmap, rng = Roadmap(problem), np.random.default_rng(3)
    walk, tau = Walk(planner, roadmap, rng), np.full((6, 5, 5), 2.0)
    for counts, pheromone in seen:
        paths = walk.tours(tau)
        expected = np.zeros_like(tau)
        for path in paths:
            for layer in range(6):
                expected[layer, path[layer], path[layer + 1]] += 7.0 / roadmap.objective(path)
        tau = 0.6 * tau + expected
        assert np.allclose(pheromone, tau, rtol=1e-12)
        for layer in range(7):
            assert np.array_equal(counts[layer], np.bincount(paths[:, layer], minlength=5))


@given(st.integers(0, 10_000))
@settings(max_examples=60)
def test_no_colony_beats_the_exact_optimum(seed):
    point = fp.load_robot("point")
    problem = small(point, seed)
    try:
        roadmap = Roadmap(problem)
    except fp.PlanningError:
        return
    best, _ = optimum(roadmap)
    try:
        plan = fp.plan(problem, fp.AntSystem(ants=5, cycles=10), seed)
    except fp.NoPath:
        assert best == np.inf
    else:
        assert plan.lattice_objective >= best - 1e-9


@given(st.integers(0, 10_000))
@settings(max_examples=40)
def test_no_path_is_found_out_wherever_obstacles_close_every_way(seed):
    point = fp.load_robot("point")
    problem = small(point, seed, obstacles=14, radii=(0.5, 1.0))
    try:
        roadmap = Roadmap(problem)
    except fp.PlanningError:
        return
    layer = first_layer_out_of_reach(roadmap)
    if layer is None:
        assert fp.plan(problem, fp.AntSystem(ants=2, cycles=1), seed).verify(50).ok
    else:
        with pytest.raises(fp.NoPath) as caught:
            fp.plan(problem, seed=seed)
        assert caught.value.layer == layer
        assert set(caught.value.obstacles) <= set(range(14))
        assert caught.value.obstacles


def test_a_wall_is_named_with_its_layer_and_obstacles(point):
    wall = [[3.1, y, 0.0] for y in np.arange(-3, 3.1, 0.5)]
    scene = fp.Scene([[0.9, 5.0, 0.0], *wall], [0.2] + [0.3] * len(wall))
    goal = point.configuration((6.0, 0.0, 0.0))
    problem = fp.Problem(point, scene, point.configuration(), goal,
                         lattice=fp.Lattice(6, fp.Axis(2, 0.6)))  # fmt: skip
    with pytest.raises(fp.NoPath, match=r"layer 3 of 6 .*0\.6 m: wider, or finer") as caught:
        fp.plan(problem)
    assert caught.value.layer == 3
    assert 0 not in caught.value.obstacles


def test_the_same_seed_gives_the_same_plan_bit_for_bit(fig2a_plan):
    scenario = fp.Scenario.load("fig2a")
    again = fp.plan(scenario.problem, scenario.planner, scenario.seed, refine=False)
    assert again == fig2a_plan
    other = fp.plan(scenario.problem, scenario.planner, scenario.seed + 1, refine=False)
    assert other != fig2a_plan


def test_a_generator_may_stand_for_the_seed(point):
    problem = small(point, 1, obstacles=2)
    by_seed = fp.plan(problem, seed=7)
    by_generator = fp.plan(problem, seed=np.random.default_rng(7))
    assert np.array_equal(by_seed.configurations, by_generator.configurations)
    assert by_generator.seed is None


def test_planning_leaves_the_global_random_state_alone(point):
    np.random.seed(0)  # noqa: NPY002 - the global state is what this is about
    before = np.random.get_state()[1].copy()  # noqa: NPY002
    fp.plan(small(point, 1, obstacles=2), seed=7)
    assert np.array_equal(before, np.random.get_state()[1])  # noqa: NPY002


def test_the_colony_stops_when_all_ants_take_one_path(point):
    plan = fp.plan(small(point, 1, obstacles=2), fp.AntSystem(), seed=0)
    assert len(plan.history.best) < fp.AntSystem().cycles
    assert plan.history.distinct[-1] == 1
    assert np.all(plan.history.distinct[:-1] > 1)


def test_the_best_path_met_is_the_one_returned(fig2a_plan):
    history = fig2a_plan.history
    assert np.all(np.diff(history.best) <= 0)
    assert fig2a_plan.lattice_objective == pytest.approx(history.iteration_best.min(), rel=1e-12)
    assert np.all(history.iteration_best <= history.mean + 1e-9)


def test_trails_count_every_ant_on_every_layer(fig2a_plan):
    trails, cycles = fig2a_plan.trails, len(fig2a_plan.history.best)
    for layer in range(40):
        assert trails.ants[trails.layer == layer].sum() == 30 * cycles


def test_the_defaults_are_the_papers(robot):
    planner = fp.AntSystem()
    assert (planner.ants, planner.cycles, planner.alpha) == (30, 242, 1.0)
    assert (planner.beta, planner.rho, planner.Q) == (5.0, 0.526, 320.0)


def test_long_runs_do_not_lose_their_pheromone_to_underflow(point):
    """rho^cycles is far below the least double; edges stay open all the same."""
    planner = fp.AntSystem(ants=2, cycles=60, rho=1e-12, C=1e-9)
    problem = small(point, 1, obstacles=2)
    assert fp.plan(problem, planner, 0).objective < np.inf
