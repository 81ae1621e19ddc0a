"""Ants on a roadmap around a path, against a lazy shortest path on it and other improvements.

    python -m benchmarks.studies.general.colony_around_path

All begin with the same path, the first that the trees find, straightened a little, and check the
same number of configurations. The colony is a max-min ant system on the layers of random states
that the tree search lays around its path (`layered_search.py`): 10 ants a cycle, visibility from
the cost of an edge and the least cost behind it, edges flown at the ant's attitude. Its settings
are the best of some on other problems.
"""

import argparse
import itertools
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table
from benchmarks.studies.general.families import drawn
from benchmarks.studies.general.free_space import NAMES
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.tree_search.kernels.flight import fly
from ffsr_plan.tree_search.kernels.layered_search import LANES, LAYERS, lay_out
from ffsr_plan.tree_search.kernels.path_cost import path_cost
from ffsr_plan.tree_search.kernels.path_moves import take_over
from ffsr_plan.tree_search.kernels.random_numbers import random_state, uniform
from ffsr_plan.tree_search.path_improvement import ImprovedPath, _layers
from ffsr_plan.tree_search.restarts import Restarts
from ffsr_plan.tree_search.search_space import SearchSpace
from ffsr_plan.tree_search.tree_settings import TreeSettings

CHECKS, PART = 150_000, 30_000
LEAST_TRAIL, ANTS, TRIES = 0.01, 10, 3
SETTINGS = list(itertools.product((1.0, 2.0), (2.0, 8.0), (0.02, 0.1)))
"""Exponents of pheromone and visibility, and evaporation."""


@kernel
def head_drawn(steps, barred, trails, rest, tail, heads, random, alpha, beta):
    """A node of the next layer, by pheromone and by what the way through it costs; -1 if none."""
    weights, total = np.zeros(LANES), 0.0
    for head in range(heads):
        if not barred[tail, head]:
            excess = steps[tail, head] + rest[1, head] - 0.98 * rest[0, tail]
            weights[head] = trails[tail, head] ** alpha * (1.0 / (excess + 1e-9)) ** beta
            total += weights[head]
    if total <= 0.0:
        return -1
    draw, head = uniform(random) * total, 0
    while head < heads - 1 and draw > weights[head]:
        draw -= weights[head]
        head += 1
    return head


@kernel
def walked(space, memory, layers, rest, trails, lanes, random, alpha, beta):
    """Whether an ant arrives; its nodes are in `lanes`, its corners in the memory."""
    corners, attitudes = memory.states[1], memory.attitudes[1]
    for layer in range(LAYERS + 1):
        heads, tail, arrived = 1 if layer == LAYERS else LANES, lanes[layer], False
        for _ in range(TRIES):
            part = layers.steps[layer], layers.barred[layer], trails[layer], rest[layer : layer + 2]
            head = head_drawn(*part, tail, heads, random, alpha, beta)
            if head < 0:
                return False
            corners[layer + 1] = layers.states[layer + 1, head]
            share = fly(
                space, corners[layer], attitudes[layer], corners[layer + 1],
                attitudes[layer + 1], True,
            )  # fmt: skip
            if share == 1.0:
                lanes[layer + 1], arrived = head, True
                break
            trails[layer, tail, head] = max(0.5 * trails[layer, tail, head], LEAST_TRAIL)
        if not arrived:
            return False
    return True


@kernel
def run_colony(space, memory, layers, random, alpha, beta, evaporation, checks):
    """Walk ants through the layers; the last corner of a better path, or -1."""
    steps = layers.steps
    rest = np.zeros((LAYERS + 2, LANES))
    for layer in range(LAYERS, -1, -1):
        heads = 1 if layer == LAYERS else LANES
        for tail in range(1 if layer == 0 else LANES):
            rest[layer, tail] = np.min(steps[layer, tail, :heads] + rest[layer + 1, :heads])
    trails, best, found = np.ones((LAYERS + 1, LANES, LANES)), math.inf, -1
    lanes, kept = np.zeros(LAYERS + 2, np.int64), np.zeros(LAYERS + 2, np.int64)
    least = path_cost(space, memory.states[0], memory.attitudes[0], layers.attempts[0])
    while space.setup[0].checks < checks:
        for _ in range(ANTS):
            space.setup[0].checks += 1
            if not walked(space, memory, layers, rest, trails, lanes, random, alpha, beta):
                continue
            cost = path_cost(space, memory.states[1], memory.attitudes[1], LAYERS + 1)
            if cost < best:
                best = cost
                kept[:] = lanes
            if cost < least - 1e-9:
                least, found = cost, take_over(space, memory, LAYERS + 1)
        if best < math.inf:
            trails *= 1.0 - evaporation
            for layer in range(LAYERS + 1):
                trails[layer, kept[layer], kept[layer + 1]] += evaporation
            trails[:] = np.maximum(trails, LEAST_TRAIL)
    return found


def ants(path: ImprovedPath, random: np.ndarray, checks: int, setting: tuple) -> None:
    """Improve a path by colonies, each on new layers around it."""
    space, memory = path._space.arrays, path._memory
    end = path._until(checks)
    while path._until(0) < end:
        layers = _layers(memory.states.shape[2])
        lay_out(space, memory, path.last, random, layers)
        layers.attempts[0] = path.last
        last = run_colony(space, memory, layers, random, *setting, min(path._until(PART), end))
        if last >= 0:
            path.last = last
            path._weigh()
        path.thin(min(PART // 3, max(end - path._until(0), 0)))


def lazily(path: ImprovedPath, random: np.ndarray, checks: int) -> None:
    """Improve a path by lazy shortest paths through new layers around it."""
    end = path._until(checks)
    while (left := end - path._until(0)) > 0:
        path.search_around(random, min(PART, left))
        path.thin(min(PART // 3, max(end - path._until(0), 0)))


def moves(path: ImprovedPath, random: np.ndarray, checks: int) -> None:
    """Improve a path by shortcuts and moved corners."""
    end = path._until(checks)
    path.move(random, checks - PART)
    path.thin(max(end - path._until(0), 0))


def begin(problem: fp.Problem, seed: int) -> tuple[SearchSpace, Restarts, ImprovedPath, np.ndarray]:
    """The space, searches, the first path straightened a little, and random numbers."""
    rng = np.random.default_rng(seed)
    space = SearchSpace(problem, 1e-3)
    restarts = Restarts(space, rng.spawn(1)[0], TreeSettings())
    found = restarts.find(10**9)
    path = ImprovedPath(space, *found)
    random = random_state(rng)
    path.move(random, 4_000)
    path.thin(20_000)
    return space, restarts, path, random


def again(problem: fp.Problem, seed: int) -> float:
    """The best of the first path and those of new searches, each straightened a little."""
    space, restarts, path, random = begin(problem, seed)
    best, end = path.cost, path._until(CHECKS)
    while path._until(0) < end:
        found = restarts.find(end - path._until(0))
        if found is not None:
            other = ImprovedPath(space, *found)
            other.move(random, 16_000)
            other.thin(20_000)
            best = min(best, other.cost)
    return best


def improved(problem: fp.Problem, seed: int, how: Callable[..., None], *given: object) -> float:
    """The cost of a path after one way to improve it."""
    _, _, path, random = begin(problem, seed)
    how(path, random, CHECKS, *given)
    return path.cost


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=4, help="problems of each kind")
    parser.add_argument("--tuning", type=int, default=2, help="problems of each kind for settings")
    parser.add_argument("--out", type=Path, default=RESULTS / "colony_around_path.md")
    args = parser.parse_args()
    kinds = (1, 2)
    tuning = [drawn(kind, 700 + k) for kind in kinds for k in range(args.tuning)]
    excess = {}
    for setting in SETTINGS:
        costs = [improved(problem, 0, ants, setting) for problem in tuning]
        excess[setting] = float(np.mean(np.log(costs)))
        print(setting, excess[setting], flush=True)
    best = min(excess, key=excess.__getitem__)
    rows, wins = [], np.zeros(4, dtype=np.int64)
    for kind in kinds:
        for k in range(args.count):
            problem = drawn(kind, 800 + k)
            first = begin(problem, 1)[2].cost
            costs = [
                improved(problem, 1, moves),
                improved(problem, 1, ants, best),
                improved(problem, 1, lazily),
                again(problem, 1),
            ]
            wins[int(np.argmin(costs))] += 1
            rows.append([f"{kind}, {800 + k}", *(f"{cost:.3f}" for cost in [first, *costs])])
            print(rows[-1], flush=True)
    rows.append(["shortest of the four", "", *(str(each) for each in wins.tolist())])
    heads = ["kind, seed", "begin", "moves", "ants", "lazy shortest path", "restarts"]
    alpha, beta, evaporation = best
    text = f"""# Ants around a path

    python -m benchmarks.studies.general.colony_around_path --count {args.count}

L [m] after {CHECKS:,} more configurations, from the same first path: {NAMES[1]} (1)
and {NAMES[2]} (2), drawn by `families.py`. The
colony is a max-min ant system on layers of random states around the best path, its settings (alpha
{alpha:g}, beta {beta:g}, evaporation {evaporation:g}) the best of {len(SETTINGS)} on
{len(tuning)} other problems. {wins[1]} of {len(rows) - 1} paths are the ants'.

{table(heads, rows)}
"""
    publish(text, args.out)


if __name__ == "__main__":
    main()
