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
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import ffsr_plan as fp
from benchmarks.random_scenes import RESULTS, publish, table
from benchmarks.studies.general.families import drawn
from ffsr_plan.core.kernels.compilation import kernel
from ffsr_plan.tree_search.kernels.flight import fly
from ffsr_plan.tree_search.kernels.layered_search import LANES, LAYERS, lay_out
from ffsr_plan.tree_search.kernels.path_cost import path_cost
from ffsr_plan.tree_search.kernels.path_moves import take_over
from ffsr_plan.tree_search.kernels.random_numbers import random_state, uniform
from ffsr_plan.tree_search.path_improvement import ImprovedPath, _layers
from ffsr_plan.tree_search.restarts import Restarts
from ffsr_plan.tree_search.search_space import SearchSpace

CHECKS, PART = 150_000, 30_000
SETTINGS = list(itertools.product((1.0, 2.0), (2.0, 8.0), (0.02, 0.1)))
"""Exponents of pheromone and visibility, and evaporation."""


@kernel
def run_colony(space, memory, layers, random, alpha, beta, evaporation, checks):
    """Walk ants through the layers; the last corner of a better path, or -1."""
    states, steps, barred = layers.states, layers.steps, layers.barred
    corners, attitudes = memory.states[1], memory.attitudes[1]
    rest = np.zeros((LAYERS + 2, LANES))
    for layer in range(LAYERS, -1, -1):
        heads = 1 if layer == LAYERS else LANES
        for tail in range(1 if layer == 0 else LANES):
            rest[layer, tail] = np.min(steps[layer, tail, :heads] + rest[layer + 1, :heads])
    trails, best, found = np.ones((LAYERS + 1, LANES, LANES)), math.inf, -1
    lanes, kept = np.zeros(LAYERS + 2, np.int64), np.zeros(LAYERS + 2, np.int64)
    weights = np.empty(LANES)
    while space.setup[0].checks < checks:
        for _ in range(10):
            layer = 0
            while layer <= LAYERS:
                heads, tail = 1 if layer == LAYERS else LANES, lanes[layer]
                arrived = False
                for _ in range(3):
                    total = 0.0
                    for head in range(heads):
                        behind = steps[layer, tail, head] + rest[layer + 1, head]
                        excess = behind - rest[layer, tail] + 0.02 * rest[layer, tail]
                        weights[head] = 0.0
                        if not barred[layer, tail, head]:
                            trail = trails[layer, tail, head]
                            weights[head] = trail**alpha * (1.0 / (excess + 1e-9)) ** beta
                        total += weights[head]
                    if total <= 0.0:
                        break
                    draw, head = uniform(random) * total, 0
                    while head < heads - 1 and draw > weights[head]:
                        draw -= weights[head]
                        head += 1
                    corners[layer + 1] = states[layer + 1, head]
                    share = fly(
                        space, corners[layer], attitudes[layer], corners[layer + 1],
                        attitudes[layer + 1], True,
                    )  # fmt: skip
                    if share == 1.0:
                        lanes[layer + 1] = head
                        arrived = True
                        break
                    trails[layer, tail, head] *= 0.5
                if not arrived:
                    break
                layer += 1
            if layer > LAYERS:
                cost = path_cost(space, corners, attitudes, LAYERS + 1)
                if cost < best:
                    best = cost
                    kept[:] = lanes
                    if (
                        cost
                        < path_cost(
                            space, memory.states[0], memory.attitudes[0], layers.attempts[0]
                        )
                        - 1e-9
                    ):
                        found = take_over(space, memory, LAYERS + 1)
                        layers.attempts[0] = found
        if best < math.inf:
            trails *= 1.0 - evaporation
            for layer in range(LAYERS + 1):
                trails[layer, kept[layer], kept[layer + 1]] += evaporation
            trails[:] = np.maximum(trails, 0.01)
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
    restarts = Restarts(space, rng.spawn(1)[0], (1.6, 4.0), 40_000, 12)
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
    kinds, clock = (1, 2, 4, 5), time.process_time()
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

L [m] after {CHECKS:,} more configurations, from the same first path; problems of `families.py`. The
colony is a max-min ant system on layers of random states around the best path, its settings (alpha
{alpha:g}, beta {beta:g}, evaporation {evaporation:g}) the best of {len(SETTINGS)} on
{len(tuning)} other problems. {(time.process_time() - clock) / 60.0:.0f} minutes of processor time.

{table(heads, rows)}
"""
    publish(text, args.out)


if __name__ == "__main__":
    main()
