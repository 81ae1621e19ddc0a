"""The pair programme against all paths of small lattices, and its bound."""

import time
from itertools import product

import numpy as np
import pytest

from ffsr_plan.core.errors import OutOfTime
from ffsr_plan.fuel.pair_programme import BYTES_PER_EDGE, PairProgramme
from ffsr_plan.fuel.pair_programme_kernel import change_left
from ffsr_plan.lattice.edge_states import REFUSED
from ffsr_plan.time_limit.deadline import Deadline
from tests.helpers.least_change_by_hand import change_of, least_change, points


def grid(*half_counts):
    axes = [range(-half, half + 1) for half in half_counts]
    return np.array(list(product(*axes)), dtype=np.int64)


def small_case(seed, density=None):
    """Nodes and edges taken away at random from a small lattice of 0, 1 or 2 axes."""
    rng = np.random.default_rng(seed)
    indices = (grid(), grid(2), grid(3), grid(1, 1))[seed % 4]
    n, divisions = len(indices), int(rng.integers(2, 6))
    spacing, length = rng.uniform(0.1, 2.0, indices.shape[1]), float(rng.uniform(0.5, 8.0))
    blocked = rng.uniform(0.0, 0.7) if density is None else density
    allowed = rng.random((divisions + 1, n)) > blocked
    allowed[[0, -1]] = False
    allowed[[0, -1], n // 2] = True
    status = np.where(rng.random((divisions, n, n)) < 0.5 * blocked, REFUSED, 0).astype(np.int8)
    return indices, spacing, length, allowed, status


def programme_of(case, deadline=None):
    indices, spacing, length, _, status = case
    return PairProgramme(indices, spacing, length, len(status), deadline)


@pytest.mark.parametrize("seed", range(160))
def test_the_optimum_is_that_of_all_paths(seed):
    case = small_case(seed)
    programme, (path, least) = programme_of(case), least_change(*case)
    found = programme.optimum(*case[3:], programme.straight)
    if path is None:
        assert found.nodes is None
        assert found.change == np.inf
        return
    assert found.change == pytest.approx(least, rel=1e-12)
    for i, (tail, head) in enumerate(zip(found.nodes, found.nodes[1:], strict=False)):
        assert case[3][i, tail]
        assert case[4][i, tail, head] != REFUSED
    steps = np.diff(points(*case[:3], found.nodes), axis=0)
    assert programme.change(found.nodes) == pytest.approx(change_of(steps), rel=1e-12)


@pytest.mark.parametrize("seed", range(60))
def test_a_limit_changes_nothing_but_what_lies_above_it(seed):
    case = small_case(seed)
    programme, (_, least) = programme_of(case), least_change(*case)
    if least == np.inf:
        return
    assert programme.within(*case[3:], least).change == pytest.approx(least, rel=1e-12)
    below = programme.within(*case[3:], 0.999 * least)
    assert not below.change < least * (1.0 - 1e-12)
    assert below.beyond >= 0.999 * least
    exact = programme.optimum(*case[3:], 0.5 * programme.straight, least)
    assert exact.change == pytest.approx(least, rel=1e-12)


@pytest.mark.parametrize("seed", range(40))
def test_a_local_search_never_makes_a_path_worse_and_never_beats_the_optimum(seed):
    case = small_case(seed)
    programme, (best, least) = programme_of(case), least_change(*case)
    rng = np.random.default_rng(seed)
    choices = [np.flatnonzero(row) for row in case[3]]
    if best is None:
        return
    for _ in range(5):
        path = np.array([rng.choice(choice) for choice in choices])
        if any(case[4][i, path[i], path[i + 1]] == REFUSED for i in range(len(path) - 1)):
            continue
        found = programme.improved(path, *case[3:])
        assert least * (1.0 - 1e-12) <= found.change <= programme.change(path)


@pytest.mark.parametrize("seed", range(200))
def test_the_bound_on_what_is_left_is_never_above_the_true_cost(seed):
    """By all continuations of a state on a lattice without obstacles, and random ones off it."""
    rng = np.random.default_rng(seed)
    step, left = float(rng.uniform(0.1, 1.0)), int(rng.integers(1, 6))
    v, target = rng.normal(size=2), rng.normal(size=2)
    mean = target / left
    bound = change_left(step, *v, *mean)
    for _ in range(50):
        steps = rng.normal(size=(left, 2)) * rng.choice([0.1, 1.0, 5.0])
        steps += mean - steps.mean(axis=0)
        whole = np.vstack([v, steps])
        turns = np.linalg.norm(np.diff(whole, axis=0), axis=1).sum()
        assert bound <= turns + np.hypot(step, np.linalg.norm(steps[-1])) + 1e-12
    straight = np.linalg.norm(mean - v) + np.hypot(step, np.linalg.norm(mean))
    assert bound == pytest.approx(straight, rel=1e-14)
    assert bound >= np.hypot(step, np.linalg.norm(v)) - 1e-12
    assert bound >= np.hypot(step, np.linalg.norm(2.0 * mean - v)) - 1e-12


def test_without_obstacles_the_path_is_straight_and_needs_what_the_bound_says():
    indices = grid(8)
    programme = PairProgramme(indices, np.array([0.1]), 6.0, 12)
    free = np.ones((13, 17), dtype=bool)
    found = programme.optimum(free, np.zeros((12, 17, 17), dtype=np.int8), programme.straight)
    assert found.change == pytest.approx(12.0, rel=1e-12)
    assert np.all(found.nodes == 8)


def in_space(seed, divisions, half_count):
    """A large lattice with round obstacles that its nodes must keep out of."""
    rng, indices = np.random.default_rng(seed), grid(half_count, half_count)
    spacing = np.full(2, 2.0 / half_count)
    allowed = np.ones((divisions + 1, len(indices)), dtype=bool)
    for _ in range(14):
        center, radius = rng.uniform(-1.0, 1.0, 2), rng.uniform(0.4, 0.9)
        middle, reach = rng.uniform(0.2, 0.8) * divisions, radius * divisions / 10.0
        apart = np.linalg.norm(indices * spacing - center, axis=1)
        for i in range(1, divisions):
            inside = 1.0 - ((i - middle) / reach) ** 2
            allowed[i] &= apart > radius * np.sqrt(max(inside, 0.0)) - (inside <= 0.0)
    allowed[[0, -1]] = False
    allowed[[0, -1], len(indices) // 2] = True
    status = np.zeros((divisions, len(indices), len(indices)), dtype=np.int8)
    return indices, spacing, 10.0, allowed, status


@pytest.mark.parametrize("seed", range(4))
def test_a_limit_that_grows_finds_what_all_pairs_give_on_a_larger_lattice(seed):
    case = in_space(seed, 12, 5)
    programme = programme_of(case)
    every = programme.within(*case[3:])
    found = programme.optimum(*case[3:], programme.straight)
    assert found.change == pytest.approx(every.change, rel=1e-12)


def test_forty_layers_of_441_nodes_take_less_than_a_second_and_bounded_memory():
    case = in_space(0, 40, 10)
    programme = programme_of(case)
    programme.optimum(*case[3:], programme.straight)  # compiled
    begin = time.process_time()
    found = programme.optimum(*case[3:], programme.straight)
    assert time.process_time() - begin < 1.0
    assert found.change > programme.straight
    held = sum(each.nbytes for each in vars(programme).values() if isinstance(each, np.ndarray))
    assert held + case[4].nbytes <= BYTES_PER_EDGE * case[4].size


def test_a_deadline_ends_the_programme():
    case = in_space(0, 12, 3)
    with pytest.raises(OutOfTime):
        programme_of(case, Deadline(0.0)).optimum(*case[3:], 20.0)
