"""The exact lattice optimum against brute force, and what it proves."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.lattice.edge_states import FREE, REFUSED
from ffsr_plan.lattice.optimum import lattice_optimum
from ffsr_plan.lattice.roadmap import Roadmap
from tests.helpers.brute_force import first_layer_out_of_reach, optimum
from tests.helpers.urdf_builders import random_scene

seeds = st.integers(0, 100_000)


def problem(seed, robot_name="point", obstacles=6, normal=False, radii=(0.2, 0.9)):
    rng = np.random.default_rng(seed)
    robot = fp.load_robot(robot_name)
    scene = random_scene(rng, obstacles, (1.0, -1.5, -0.2), (5.0, 1.5, 0.2), radii)
    arms = {} if robot_name == "point" else {"left_1": -1.2, "right_1": 1.3, "left_2": 0.6}
    goal = robot.configuration((6.0, 0.0, 0.0), joints=arms)
    return fp.Problem(
        robot, scene, robot.configuration(), goal,
        delta=float(rng.choice([0.0, 0.1, 2.0])),
        lattice=fp.Lattice(6, fp.Axis(2, 0.6), fp.Axis(1, 0.5) if normal else None),
    )  # fmt: skip


def roadmap_or_none(p):
    try:
        return Roadmap(p)
    except fp.PlanningError:
        return None


@pytest.mark.parametrize("robot_name", ["point", "planar_dual_arm"])
@pytest.mark.parametrize("normal", [False, True])
@given(seed=seeds)
@settings(max_examples=40)
def test_the_optimum_equals_brute_force_over_certified_edges(robot_name, normal, seed):
    roadmap = roadmap_or_none(problem(seed, robot_name, normal=normal, obstacles=4))
    if roadmap is None:
        return
    best, _ = optimum(roadmap.without_edge_states())
    if best == np.inf:
        with pytest.raises(fp.NoPath):
            lattice_optimum(roadmap)
        return
    path = lattice_optimum(roadmap)
    assert roadmap.objective(path) == pytest.approx(best, rel=1e-12)
    fresh = roadmap.without_edge_states()
    assert fresh.prove_path(path)


@given(seeds)
@settings(max_examples=40)
def test_no_path_names_the_same_layer_for_all_planners(seed):
    p = problem(seed, obstacles=14, radii=(0.5, 1.0))
    roadmap = roadmap_or_none(p)
    if roadmap is None:
        return
    layer = first_layer_out_of_reach(roadmap.without_edge_states())
    for planner in (fp.LatticeOptimum(), fp.MaxMinAntSystem(cycles=5), fp.AntSystem(cycles=2)):
        if layer is None:
            assert (
                planner.search(roadmap.without_edge_states(), np.random.default_rng(0)).path
                is not None
            )
        else:
            with pytest.raises(fp.NoPath) as caught:
                planner.search(roadmap.without_edge_states(), np.random.default_rng(0))
            assert caught.value.layer == layer
            assert caught.value.obstacles


@given(seeds)
@settings(max_examples=40)
def test_what_a_refusal_rules_out_is_really_blocked(seed):
    """Edges refused for another one's sake are refused when they are looked at themselves."""
    roadmap = roadmap_or_none(problem(seed, "planar_dual_arm", obstacles=4))
    if roadmap is None:
        return
    rng = np.random.default_rng(seed)
    for _ in range(60):
        roadmap.certify(int(rng.integers(1, 5)), *map(int, rng.integers(0, 5, 2)))
    ruled_out = [tuple(map(int, e)) for e in np.argwhere(roadmap.status == REFUSED)]
    fresh = roadmap.without_edge_states()
    for edge in ruled_out:
        assert not fresh.certify(*edge).free


@given(seeds)
@settings(max_examples=30)
def test_what_is_obviously_free_is_free(seed):
    roadmap = roadmap_or_none(problem(seed, "planar_dual_arm", obstacles=4))
    if roadmap is None:
        return
    roadmap.prove_obvious()
    fresh = roadmap.without_edge_states()
    for edge in np.argwhere(roadmap.status == FREE):
        assert fresh.certify(*map(int, edge)).free


@pytest.mark.parametrize("delta", [0.0, 0.1, 2.0, 6.0])
def test_lazy_node_evaluation_gives_the_same_optimum(delta):
    given_ = fp.load_scenario("fig2a")
    rng = np.random.default_rng(11)
    for _ in range(5):
        scene = random_scene(rng, 6, (1.8, -3, 0), (8.2, 3, 0), (0.15, 0.5))
        p = fp.Problem(given_.robot, scene, given_.start, given_.goal, delta=delta,
                       lattice=fp.Lattice(40, fp.Axis(20, 0.15)))  # fmt: skip
        lazy, eager = Roadmap(p), Roadmap(p)
        assert eager.counts().node_queries == 2
        assert np.isfinite(eager.clearances[1:-1]).all()
        assert eager.counts().node_queries == 39 * 41 + 2
        try:
            best = eager.objective(lattice_optimum(eager))
        except fp.NoPath:
            with pytest.raises(fp.NoPath):
                lattice_optimum(lazy)
            continue
        assert lazy.objective(lattice_optimum(lazy)) == pytest.approx(best, rel=1e-12)
        assert lazy.counts().node_queries < 0.6 * eager.counts().node_queries


@given(seeds)
@settings(max_examples=25)
def test_bounds_from_neighbours_are_never_below_a_clearance(seed):
    roadmap = roadmap_or_none(problem(seed, "planar_dual_arm", normal=True, obstacles=4))
    if roadmap is None:
        return
    rng = np.random.default_rng(seed)
    m, n = roadmap.lattice.divisions, roadmap.lattice.size
    for _ in range(3):
        path = rng.integers(0, n, m + 1)
        path[[0, -1]] = roadmap.lattice.origin
        news = roadmap.nodes.learn(path)
        assert np.all((news >= 1) & (news < m))
        assert len(roadmap.nodes.learn(path)) == 0
    bounds = roadmap.nodes.bounds.copy()
    exact = roadmap.clearances
    assert np.all(bounds[1:-1] >= exact[1:-1] - 1e-9)


def test_equally_good_paths_give_the_same_answer_every_time(point):
    goal = point.configuration((6.0, 0.0, 0.0))
    scene = fp.Scene([[3.0, 0.0, 0.0]], [0.5])  # the ways round are mirror images
    p = fp.Problem(point, scene, point.configuration(), goal, delta=0.1,
                   lattice=fp.Lattice(6, fp.Axis(3, 0.4)))  # fmt: skip
    first = lattice_optimum(Roadmap(p))
    assert all(np.array_equal(lattice_optimum(Roadmap(p)), first) for _ in range(5))
    assert np.any(first != 3)


def test_the_optimum_certifies_far_fewer_edges_than_there_are():
    roadmap = Roadmap(fp.load_scenario("fig2a"))
    lattice_optimum(roadmap)
    proofs = roadmap.counts()
    assert proofs.edges_free + proofs.edges_refused < 1000 < roadmap.status.size


@pytest.mark.parametrize("argument", [{"colonies": 2}, {"on_cycle": print}])
def test_the_exact_planner_refuses_colonies_and_callbacks(argument):
    with pytest.raises(fp.InvalidInput, match=f"{next(iter(argument))}.*lattice-optimum"):
        fp.plan(fp.load_scenario("fig2a"), fp.LatticeOptimum(), **argument)
