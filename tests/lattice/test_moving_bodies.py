"""Lattices among bodies that move, against all paths."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.bodies.body_motion import Drift, Spin
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.track import Track
from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.core.errors import GoalInCollision, InvalidInput, NoPath, StartInCollision
from ffsr_plan.lattice.layered_lattice import LayeredLattice

DURATION = 60.0


def some_body(rng, place):
    """A body of one of four kinds near a place."""
    shapes = [fp.Box(rng.uniform(0.1, 1.2, 3)), fp.Ball(0.2, rng.uniform(-0.5, 0.5, 3))]
    kind, angles = rng.integers(4), rng.uniform(-3.0, 3.0, 3)
    if kind == 0:
        velocity = rng.normal(size=3) * (0.05, 0.05, 0.0)
        return MovingBody(shapes, Drift(velocity), place - 0.5 * DURATION * velocity, angles)
    if kind == 1:
        return MovingBody(shapes, Spin((0.0, 0.0, rng.uniform(-0.2, 0.2))), place, angles)
    if kind == 2:
        tumble = Tumble((1.0, 1.5, 2.0), rng.normal(size=3) * 0.1, known_until=DURATION)
        return MovingBody(shapes, tumble, place, angles)
    times = np.linspace(0.0, DURATION, 5)
    ways = place + np.cumsum(rng.normal(size=(5, 3)) * (0.2, 0.2, 0.0), axis=0)
    return MovingBody(shapes, Track(times, ways, np.tile([0.0, 0.0, 0.0, 1.0], (5, 1))))


def some_problem(seed, divisions=3, half=2):
    """A way of 4 m with bodies in it."""
    rng, robot = np.random.default_rng(seed), fp.load_robot("planar_dual_arm")
    bodies = [some_body(rng, np.array([rng.uniform(1.2, 2.8), rng.uniform(-1.5, 1.5), 0.0]))]
    if rng.random() < 0.5:
        bodies.append(some_body(rng, np.array([2.0, rng.uniform(-2.0, 2.0), 0.0])))
    still = [fp.Box((0.2, 0.2, 1.0), (2.0, rng.uniform(-1.5, 1.5), 0.0))]
    return fp.Problem(
        robot,
        fp.Scene(shapes=still, bodies=bodies),
        start=robot.neutral(),
        goal=robot.configuration((4.0, 0.0, 0.0), joints={"left_1": 0.6}),
        lattice=fp.Lattice(divisions, lateral=fp.Axis(half, 0.5)),
        delta=0.5,
        duration=DURATION,
        ramp=float(rng.choice([0.0, 0.25])),
    )


def clearances_at(problem, q, times):
    """(n,) distances of configurations, one scene an instant."""
    found = []
    for row, time in zip(q, times, strict=True):
        found.append(ObstacleQuery(problem.robot, problem.scene.at(time)).distances(row[None])[0])
    return np.array(found)


def time_at(problem, share):
    """The time at which a share of the path has been run, from the law of a trapezoid [s]."""
    ramp, low, high = problem.ramp, 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        first, last = min(middle, ramp), max(middle - 1.0 + ramp, 0.0)
        run = middle - ramp / 2.0 if ramp else middle
        if ramp and middle < ramp:
            run = first**2 / (2.0 * ramp)
        elif ramp and last > 0.0:
            run = 1.0 - ramp - (ramp - last) ** 2 / (2.0 * ramp)
        low, high = (middle, high) if run / (1.0 - ramp) < share else (low, middle)
    return 0.5 * (low + high) * problem.duration


def best_of_all_paths(problem, samples=120):
    """F of the best path of all, edges sampled; and how near an undecided edge comes [m]."""
    lattice, m = LayeredLattice(problem), problem.lattice.divisions
    times = [time_at(problem, k / m) for k in range(m + 1)]
    nodes = {}
    for layer, node in product(range(m + 1), range(lattice.size)):
        q = lattice.nominal.configurations()[layer].copy()
        q[:3] += lattice.offsets[node]
        nodes[layer, node] = clearances_at(problem, [q], [times[layer]])[0]
    edges, closest = {}, np.inf
    shares = np.linspace(0.0, 1.0, samples + 1)

    def least(layer, tail, head):
        nonlocal closest
        if (layer, tail, head) not in edges:
            q = lattice.nominal.at(np.full(samples + 1, layer), shares)
            ways = np.outer(1.0 - shares, lattice.offsets[tail])
            q[:, :3] += ways + np.outer(shares, lattice.offsets[head])
            at = [time_at(problem, (layer + share) / m) for share in shares]
            edges[layer, tail, head] = clearances_at(problem, q, at).min()
            closest = min(closest, abs(edges[layer, tail, head]))
        return edges[layer, tail, head]

    best = np.inf
    for inner in product(range(lattice.size), repeat=m - 1):
        path = (lattice.origin, *inner, lattice.origin)
        if min(nodes[k, path[k]] for k in range(m + 1)) <= 0.0:
            continue
        ways = np.diff(lattice.offsets[list(path)], axis=0)
        length = np.sqrt(problem.delta_d**2 + np.sum(ways**2, axis=1)).sum()
        cost = length + problem.delta * sum(1.0 / nodes[k, path[k]] for k in range(1, m))
        if cost < best and all(least(k, *path[k : k + 2]) > 0.0 for k in range(m)):
            best = cost
    return best, closest


@pytest.mark.parametrize("seed", range(12))
def test_the_optimum_past_moving_bodies_is_the_best_of_all_paths(seed):
    problem = some_problem(seed)
    try:
        found = fp.plan(problem, fp.LatticeOptimum()).lattice_objective
    except (NoPath, StartInCollision, GoalInCollision):
        found = np.inf
    best, closest = best_of_all_paths(problem)
    if closest < 1e-3:
        assert found >= best * (1.0 - 1e-12)  # an edge that grazes may be refused
    elif np.isinf(best):
        assert np.isinf(found)
    else:
        assert found == pytest.approx(best, rel=1e-12)


def test_bodies_that_move_need_a_duration_that_their_motions_know():
    problem = some_problem(0)
    changed = {"duration": None, "ramp": 0.0}
    with pytest.raises(InvalidInput, match="duration"):
        replace(problem, **changed)
    body = MovingBody([fp.Ball(0.2)], Tumble((1.0, 1.5, 2.0), (0.1, 0.0, 0.0), known_until=50.0))
    with pytest.raises(InvalidInput, match="at most 50 s"):
        replace(problem, scene=fp.Scene(bodies=[body]))
    with pytest.raises(InvalidInput, match="ramp"):
        replace(problem, scene=fp.Scene(), **changed | {"ramp": 0.1})


def test_nothing_measures_a_scene_whose_bodies_have_no_time():
    problem = some_problem(0)
    with pytest.raises(InvalidInput, match="scene bodies"):
        fp.clearance(problem.robot, problem.scene, problem.start)
    with pytest.raises(InvalidInput, match="scene bodies"):
        fp.plan(replace(problem, lattice=None))


def test_a_start_that_a_body_touches_is_named():
    problem = some_problem(0)
    body = MovingBody([fp.Ball(0.2)], Drift((0.1, 0.0, 0.0)), name="debris")
    with pytest.raises(StartInCollision, match="ball 'debris'"):
        fp.plan(replace(problem, scene=fp.Scene(bodies=[body])))
    late = MovingBody([fp.Ball(0.2)], Drift((0.1, 0.0, 0.0)), (-2.0, 0.0, 0.0), name="debris")
    with pytest.raises(GoalInCollision, match="ball 'debris'"):
        fp.plan(replace(problem, scene=fp.Scene(bodies=[late])))
