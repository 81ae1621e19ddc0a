"""Comparison of the colony with a dynamic programme over attitude bins, on planar gates.

    python -m benchmarks.studies.attitude.colony_versus_dynamic_programme

In the plane an attitude is one angle, so a dynamic programme over (layer, node, yaw bin) is an
alternative to the colony (`yaw_programme.py` explains in what sense it is exact). The cost of both
is counted in distance queries: distances from the robot to the obstacles at one node and attitude.
Searches run as shipped, and with as many queries as the programme with 81 bins needs. The defaults
take ten to twenty minutes. Writes docs/benchmarks/attitude_programme.md.
"""

import argparse
import math
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table
from benchmarks.studies.attitude.gates import variation
from benchmarks.studies.attitude.yaw_dynamic_programme import (
    REACHABLE,
    Way,
    cheapest_way,
    coarse_to_fine,
)
from ffsr_plan.search.postures.colony import PostureColony
from ffsr_plan.search.postures.path_proof import corners, prove_path
from ffsr_plan.search.postures.posture_lattice import PostureLattice
from ffsr_plan.search.postures.posture_lattice_arrays import posture_grid
from ffsr_plan.search.records import SearchMonitor
from ffsr_plan.time_limit.deadline import Deadline
from tests.helpers.spatial_robot import spatial_problem

BINS, FINEST = 81, 161
LADDER = (11, 21, 41, 81, 161)
ANTS, ANNEALED = fp.PostureAnnealing(), fp.PostureAnnealing(ants=1, cycles=1)
FREE_ANTS = fp.PostureAnnealing(pheromone=False)
WALKING = fp.PostureAnnealing(cycles=1_000_000, temperatures=(), patience=1_000_000)
NAMES = {
    "ants, pheromone, annealing": ANTS,
    "ants without pheromone, annealing": FREE_ANTS,
    "one ant, one cycle, annealing": ANNEALED,
}


INTRODUCTION = f"""\
Variations of the scenarios `gate` and `double_gate` as in [gates.md](gates.md). The programme's
states are (layer, base offset, posture, yaw bin). Its bins divide the yaws from
-{math.degrees(REACHABLE):.0f} to {math.degrees(REACHABLE):.0f} degrees; each state keeps the true
yaw of its cheapest path, so the cost is that of the path at its true attitudes, by the colony's own
functions. "Coarse to fine" runs {", ".join(map(str, LADDER))} bins in turn, and drops states from
which no path can be cheaper than the best path so far; the remaining cost is bounded by distances
of the base origin alone, which are not counted.

A query is a distance from the robot to the obstacles at one node and attitude. Rows without "as
shipped" used as many queries as the programme with {BINS} bins: annealing by the number of its
shifts, ants without annealing by the number of cycles. "Proven at once" counts paths whose edges
are all proven free as the search returned them, before the planner excludes an edge or corrects the
path. CPU times are of one thread, without compiling and without the proof.

The cost is F in metres, plus {ANTS.attitude_weights[1]:.0f} m for each radian beyond half a degree
by which the goal attitude is missed. It is given relative to the least cost of a programme on the
same problem. Programmes have no seed: one run for each variation."""

VERDICT = """\
The programme has no seed and no temperature: its cost is the same in each run, and finer bins show
the remaining error of rounding. It does not prove an optimum, because only one path into each bin
is kept. Where it applies, in the plane, it is as good as the colony or better for the same number
of queries, and no slower. The advantages of the colony there: it needs no range of yaws and no
bins, stores one path instead of all states, and can be stopped at any time with a path. Ants
without shifts are worse than both, and neither ants nor pheromone improve much on annealing
alone."""


class Run(NamedTuple):
    """One search.

    Attributes:
        cost: of its path [m]; infinite if there is none.
        queries: number of distance queries.
        seconds: CPU time [s].
        holds: whether its path is proven free as it is and ends within a degree of the goal
            attitude.
    """

    cost: float
    queries: int
    seconds: float
    holds: bool


def programme(lattice: PostureLattice, solve: Callable[[], Way]) -> Run:
    """Run a dynamic programme; its value must equal the colony's cost of its path."""
    begin = time.process_time()
    way = solve()
    seconds = time.process_time() - begin
    if way.cost == np.inf:
        return Run(way.cost, way.queries, seconds, False)
    colony = PostureColony(lattice, posture_grid(lattice), ANTS, np.random.default_rng(0))
    again = colony.cost(way.path)
    if not math.isclose(again, way.cost, rel_tol=1e-9):
        raise RuntimeError(f"a programme's path costs {again}, not {way.cost}")
    holds = prove_path(lattice, *corners(lattice, way.path)).holds
    return Run(way.cost, way.queries, seconds, holds)


def colony_run(
    lattice: PostureLattice, settings: fp.PostureAnnealing, seed: int, budget: float = math.inf
) -> tuple[Run, int]:
    """Run the colony until `budget` queries.

    Returns:
        The run, and the number of queries of its annealings.
    """
    grid = posture_grid(lattice)
    queries = grid.queries
    by_ants = [0]
    monitor = SearchMonitor(
        on_cycle=lambda _: by_ants.append(int(queries[0])),
        deadline=Deadline(stop_requested=lambda: bool(queries[0] >= budget)),
    )
    begin = time.process_time()
    colony = PostureColony(lattice, grid, settings, np.random.default_rng(seed))
    found = colony.search(monitor)
    seconds, total = time.process_time() - begin, int(queries[0])
    holds = prove_path(lattice, *corners(lattice, found.path)).holds
    return Run(found.cost, total, seconds, holds), total - by_ants[-1]


def compared(problem: fp.Problem, seeds: int) -> dict[str, list[Run]]:
    """Every search on one problem."""
    lattice = PostureLattice(problem)
    _ = lattice.step_rotations, lattice.frames, lattice.allowed, lattice.squared_steps  # shared
    runs: dict[str, list[Run]] = {
        f"programme, {bins} bins": [programme(lattice, lambda b=bins: cheapest_way(lattice, b))]
        for bins in (41, BINS, FINEST)
    }
    runs["programme, coarse to fine"] = [
        programme(lattice, lambda: coarse_to_fine(lattice, LADDER))
    ]
    budget = runs[f"programme, {BINS} bins"][0].queries
    for seed in range(seeds):
        for name, settings in NAMES.items():
            shipped, annealing = colony_run(lattice, settings, seed)
            runs.setdefault(f"{name}, as shipped", []).append(shipped)
            left = max(0.05 * budget, budget - (shipped.queries - annealing))
            per_layer = settings.shifts_per_layer(problem.reach_attitude)
            shifts = round(per_layer * left / annealing)
            run, _ = colony_run(lattice, replace(settings, annealing_shifts=shifts), seed)
            runs.setdefault(name, []).append(run)
        for name, settings in {
            "ants, pheromone, no annealing": WALKING,
            "ants, pheromone, no shifts at all": replace(WALKING, descent_shifts=0),
        }.items():
            run, _ = colony_run(lattice, settings, seed, budget)
            runs.setdefault(name, []).append(run)
    return runs


def row(name: str, runs: Sequence[Run], best: Sequence[float]) -> list[str]:
    """A line of the table; `best` is the programme's least cost for each run."""
    found = [(r.cost / least - 1.0) for r, least in zip(runs, best, strict=True) if r.cost < np.inf]
    return [
        name,
        f"{sum(r.holds for r in runs)} / {len(runs)}",
        *(f"{f(found):+.2%}" if found else "" for f in (np.mean, np.min, np.max)),
        f"{np.mean([r.queries for r in runs]) / 1e6:.2f}",
        f"{np.mean([r.seconds for r in runs]):.1f}",
    ]


def least(runs: dict[str, list[Run]]) -> float:
    """The least cost that a programme found."""
    return min(r.cost for name, rs in runs.items() if name.startswith("programme") for r in rs)


HEADER = (
    "search", "proven at once", "cost above the programme's best, mean", "least", "most",
    "million queries", "CPU s",
)  # fmt: skip


def section(name: str, every: Sequence[dict[str, list[Run]]]) -> str:
    """A table for one scenario: programmes and equal budgets first, then as shipped."""
    names = sorted(every[0], key=lambda n: n.endswith("as shipped"))
    rows = []
    for search in names:
        runs = [(run, least(of)) for of in every for run in of[search]]
        rows.append(row(search, *zip(*runs, strict=True)))
    return f"## {name}\n\n" + table(HEADER, rows)


def verdict(every: Iterable[dict[str, list[Run]]]) -> str:
    """Share of runs below, at and above the programme, at equal queries and as shipped."""
    every, parts = list(every), []
    for when, suffix in (("At equal queries", ""), ("As shipped", ", as shipped")):
        name = "ants, pheromone, annealing" + suffix
        excess = [r.cost / of[f"programme, {BINS} bins"][0].cost - 1.0 for of in every
                  for r in of[name]]  # fmt: skip
        below = sum(e < -1e-9 for e in excess)
        near = sum(-1e-9 <= e <= 1e-3 for e in excess)
        far = sum(e > 1e-2 for e in excess)
        parts.append(
            f"{when}, ants, pheromone and annealing together end below the programme with {BINS} "
            f"bins in {below} of {len(excess)} runs, equal to it or at most 0.1 % above in {near}, "
            f"and more than 1 % above in {far}."
        )
    equal = [n for n in every[0] if not n.endswith("as shipped")]
    means = [np.mean([r.cost / least(of) - 1.0 for of in every for r in of[n]]) for n in equal]
    parts.append(
        "Means over both scenarios, above the programme's best: "
        + "; ".join(f"{n} {mean:.1%}" for n, mean in zip(equal, means, strict=True))
        + "."
    )
    return " ".join(parts)


def in_space(every: Iterable[dict[str, list[Run]]]) -> str:
    """States, memory and time of a programme with bins of the same width in three dimensions."""
    planar = [of[f"programme, {BINS} bins"][0] for of in every]
    states, width = float(np.mean([r.queries for r in planar])), 2.0 * REACHABLE / BINS
    rate = states / float(np.mean([r.seconds for r in planar]))
    lattice = PostureLattice(spatial_problem(10, (1, 0, 0)))
    nodes, steps = int(lattice.allowed[lattice.rows[1:-1]].sum()), lattice.successors.shape[1]
    ball = 8.0 * math.pi * (REACHABLE - math.sin(REACHABLE))
    bins = ball / width**3
    needed = nodes * bins
    return (
        "## In space, computed and not run\n\n"
        "The robot of tests/helpers/spatial_robot.py turns by 10 degrees on the spot: "
        f"{lattice.size} postures of three axes on each of {len(lattice.joint_values)} layers, "
        f"{nodes} nodes between the ends in which no links touch, {steps} steps from each. "
        f"Rotations by up to r = {math.degrees(REACHABLE):.0f} degrees fill a volume of "
        f"8 pi (r - sin r), which is {bins:,.0f} bins of {math.degrees(width):.2f} degrees "
        f"instead of {BINS}. That makes "
        f"{needed:.1e} states and {needed * steps:.1e} steps; to remember where each state came "
        f"from takes {needed * 8 / 1e9:,.0f} GB at eight bytes, and at the planar programme's "
        f"{rate / 1e6:.1f} million states a second it would run for {needed / rate / 3600:.1f} "
        f"hours. Held to as many states as in the plane, {states / 1e6:.1f} million, its bins "
        f"would be {math.degrees((ball * nodes / states) ** (1 / 3)):.0f} degrees wide. The "
        "colony's cost does not depend on bins: [turning.md](turning.md) has its times for such "
        "turns."
    )


def compile_all() -> None:
    """Compile all kernels and check the counter of queries."""
    lattice = PostureLattice(variation("gate", 0))
    cheapest_way(lattice, 3)
    colony_run(lattice, ANNEALED, 0)
    grid = posture_grid(lattice)
    colony = PostureColony(lattice, grid, ANTS, np.random.default_rng(0))
    straight = np.tile(grid.origin, (len(lattice.joint_values), 1))
    before = int(grid.queries[0])
    colony.cost(straight)
    counted = int(grid.queries[0]) - before
    if counted != len(lattice.joint_values) - 1:
        raise RuntimeError(f"{counted} queries counted along a path, not one for each edge")


def main(argv: Sequence[str] | None = None) -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--variations", type=int, default=4, help="of each scenario")
    parser.add_argument("--seeds", type=int, default=2, help="of each search by ants")
    parser.add_argument("--out", type=Path, default=RESULTS / "attitude_programme.md")
    args = parser.parse_args(argv)
    begin = time.perf_counter()
    compile_all()
    results: dict[str, list[dict[str, list[Run]]]] = {"gate": [], "double_gate": []}
    for name, of in results.items():
        for number in range(args.variations):
            of.append(compared(variation(name, number), args.seeds))
            print(f"{name} {number}", file=sys.stderr, flush=True)
    every = [of for parts in results.values() for of in parts]
    parts = [
        "# A dynamic programme over attitude bins",
        "`python -m benchmarks.studies.attitude.colony_versus_dynamic_programme "
        f"--variations {args.variations} --seeds {args.seeds}`",
        INTRODUCTION,
        *(section(name, of) for name, of in results.items()),
        "## Comparison",
        verdict(every),
        VERDICT,
        in_space(every),
        f"All in {(time.perf_counter() - begin) / 60:.0f} minutes.",
    ]
    publish("\n\n".join(parts) + "\n", args.out)


if __name__ == "__main__":
    main()
