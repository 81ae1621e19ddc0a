"""The colony against a dynamic programme over attitude bins, on gates in the plane.

    python -m benchmarks.studies.attitude.attitude_programme

In the plane an attitude is one angle, so that a programme over (layer, node, yaw bin) competes with
the colony (benchmarks/studies/attitude/yaw_programme.py says in what sense it is exact). Both pay in distance queries:
distances from the robot to the obstacles at one node and attitude. Searches run as shipped and at
as many queries as the programme with 81 bins asks for. The defaults take ten to twenty
minutes. Writes docs/benchmarks/attitude_programme.md.
"""

import argparse
import math
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple
from unittest.mock import patch

import numpy as np
from ffsr_plan.search.postures.posture_planner import _worked_out

import ffsr_plan as fp
from benchmarks.random_scenes import RESULTS, publish, table
from benchmarks.studies.attitude.gates import variation
from benchmarks.studies.attitude.query_count import count_queries, posture_grid, queries
from benchmarks.studies.attitude.yaw_programme import REACHABLE, Way, cheapest_way, coarse_to_fine
from ffsr_plan.search.postures import colony
from ffsr_plan.search.postures.cost_kernels import PostureGrid
from ffsr_plan.search.postures.posture_lattice import PostureLattice
from ffsr_plan.search.records import Watch
from tests.helpers.spatial_robot import spatial_problem

BINS, FINEST = 81, 161
LADDER = (11, 21, 41, 81, 161)
ANTS, ANNEALED = fp.MaxMinAntSystem(), fp.MaxMinAntSystem(ants=1, cycles=1)
FREE_ANTS = fp.MaxMinAntSystem(pheromone=False)
ENDLESS = fp.MaxMinAntSystem(cycles=1_000_000)
WALKING = {"_HEATS": (), "_PATIENCE": math.inf}
NAMES = {
    "ants, pheromone, annealing": ANTS,
    "ants without pheromone, annealing": FREE_ANTS,
    "one ant, one cycle, annealing": ANNEALED,
}


INTRODUCTION = f"""\
Variations of the scenarios `gate` and `double_gate` as in [gates.md](gates.md). The programme's
states are (layer, base offset, posture, yaw bin). Its bins share the yaws from
-{math.degrees(REACHABLE):.0f} to {math.degrees(REACHABLE):.0f} degrees; each state keeps the true
yaw of its cheapest way, so that the cost is that of the path at its true attitudes, by the colony's
own functions. "Coarse to fine" runs {", ".join(map(str, LADDER))} bins in turn, and drops states
from which no path can be cheaper than the one found so far; what is to come is bounded by distances
of the base origin alone, which are not counted.

A query is a distance from the robot to the obstacles at one node and attitude. Rows without "as
shipped" had as many queries as the programme with {BINS} bins: annealing by the number of its
shifts, ants without annealing by the number of cycles. "Proven at once" counts paths that are
proven free edge by edge as they were found, before the planner bars an edge or squared_steps the path.
CPU times are of one thread, without compiling and without the proof; counting the queries adds
about a fifth to those of the ants and of annealing, nothing to the programme's.

The cost is F in metres, plus {colony._MISSED[1]:.0f} m for each radian beyond half a degree
by which the goal attitude is missed. It is given relative to the least that a programme found on
the same problem. Programmes have no seed: one run a variation."""

VERDICT = """\
The programme has no seed and no temperature: the same cost each time, and finer bins show how much
rounding may still hide. It knows no optimum for certain, as only one way into each bin lives on.
Where it applies, in the plane, it is level with the colony or ahead of it for the same queries, and
no slower. What the colony has ahead of it there: it is told no range of yaws and no bins, holds one
path instead of all states, and can be stopped at any time with a path in hand. Ants without shifts
are no match for either, and neither ants nor pheromone gain much over annealing alone."""


class Run(NamedTuple):
    """One search."""

    cost: float
    """[m]; infinite where it found nothing."""
    queries: int
    seconds: float
    """CPU time."""
    holds: bool
    """Whether its path is proven free as it is, the goal attitude met within a degree."""


@dataclass(frozen=True)
class Tally(Watch):
    """Notes the queries after each cycle and each annealing; ends a search at its budget."""

    grid: PostureGrid = field(kw_only=True)
    budget: float = math.inf
    counts: list[int] = field(default_factory=list)

    def over(self) -> bool:
        """Whether the budget is used up."""
        self.counts.append(queries(self.grid))
        return self.counts[-1] >= self.budget


def programme(lattice: PostureLattice, solve: Callable[[], Way]) -> Run:
    """Run a dynamic programme; its value must be what the colony would say of its path."""
    begin = time.process_time()
    way = solve()
    seconds = time.process_time() - begin
    if way.cost == np.inf:
        return Run(way.cost, way.queries, seconds, False)
    again = colony.cost_of(posture_grid(lattice), way.path)
    if not math.isclose(again, way.cost, rel_tol=1e-9):
        raise RuntimeError(f"a programme's path costs {again}, not {way.cost}")
    holds = _worked_out(lattice, way.path).holds
    return Run(way.cost, way.queries, seconds, holds)


def colony(
    lattice: PostureLattice,
    planner: fp.MaxMinAntSystem,
    seed: int,
    budget: float = math.inf,
    **settings: object,
) -> tuple[Run, int]:
    """Run the colony with some of its module's settings changed; also the queries of annealing."""
    grid = posture_grid(lattice)
    watch = Tally(grid=grid, budget=budget)
    begin = time.process_time()
    with patch.multiple(colony, _COLD=colony._COLD, **settings):
        found = colony.search(
            lattice, grid, planner.ants, planner.cycles, planner.pheromone,
            np.random.default_rng(seed), watch,
        )  # fmt: skip
        rounds = len(colony._HEATS)
    seconds, asked = time.process_time() - begin, queries(grid)
    before = [0, *watch.counts][-1 - rounds]
    holds = _worked_out(lattice, found.path).holds
    return Run(found.cost, asked, seconds, holds), asked - before


def compared(problem: fp.Problem, seeds: int) -> dict[str, list[Run]]:
    """Every search on one problem."""
    lattice = PostureLattice(problem)
    _ = (
        lattice.step_rotations,
        lattice.frames,
        lattice.allowed,
        lattice.squared_steps,
    )  # common to all
    runs: dict[str, list[Run]] = {
        f"programme, {bins} bins": [programme(lattice, lambda b=bins: cheapest_way(lattice, b))]
        for bins in (41, BINS, FINEST)
    }
    runs["programme, coarse to fine"] = [
        programme(lattice, lambda: coarse_to_fine(lattice, LADDER))
    ]
    budget = runs[f"programme, {BINS} bins"][0].queries
    for seed in range(seeds):
        for name, planner in NAMES.items():
            shipped, annealing = colony(lattice, planner, seed)
            runs.setdefault(f"{name}, as shipped", []).append(shipped)
            left = max(0.05 * budget, budget - (shipped.queries - annealing))
            shifts = round(colony._ANNEALING * left / annealing)
            run, _ = colony(lattice, planner, seed, _ANNEALING=shifts)
            runs.setdefault(name, []).append(run)
        for name, settings in {
            "ants, pheromone, no annealing": WALKING,
            "ants, pheromone, no shifts at all": {**WALKING, "_SHIFTS": 0},
        }.items():
            run, _ = colony(lattice, ENDLESS, seed, budget, **settings)
            runs.setdefault(name, []).append(run)
    return runs


def row(name: str, runs: Sequence[Run], best: Sequence[float]) -> list[str]:
    """How one search did; `best` is the programme's least cost for each run."""
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
    """A table for one scenario: programmes and equal budgets first, as shipped behind."""
    names = sorted(every[0], key=lambda n: n.endswith("as shipped"))
    rows = []
    for search in names:
        runs = [(run, least(of)) for of in every for run in of[search]]
        rows.append(row(search, *zip(*runs, strict=True)))
    return f"## {name}\n\n" + table(HEADER, rows)


def verdict(every: Iterable[dict[str, list[Run]]]) -> str:
    """How often the whole colony ended where, at equal queries and as shipped."""
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
    """What a programme over bins of the same width would need for a turn in space."""
    planar = [of[f"programme, {BINS} bins"][0] for of in every]
    states, width = float(np.mean([r.queries for r in planar])), 2.0 * REACHABLE / BINS
    rate = states / float(np.mean([r.seconds for r in planar]))
    lattice = PostureLattice(spatial_problem(10, (1, 0, 0)))
    nodes, steps = int(lattice.allowed[1:-1].sum()), lattice.successors.shape[1]
    ball = 8.0 * math.pi * (REACHABLE - math.sin(REACHABLE))
    bins = ball / width**3
    needed = nodes * bins
    return (
        "## In space, computed and not run\n\n"
        f"The robot of tests/helpers/spatial_robot.py step_rotations by 10 degrees on the spot: {lattice.size} postures "
        f"of three axes on each of {len(lattice.joint_values)} layers, {nodes} nodes between the "
        f"ends in which no links touch, {steps} steps from each. Rotations by up to "
        f"r = {math.degrees(REACHABLE):.0f} degrees fill a volume of 8 pi (r - sin r), which is "
        f"{bins:,.0f} bins of {math.degrees(width):.2f} degrees instead of {BINS}. That makes "
        f"{needed:.1e} states and {needed * steps:.1e} steps; to remember where each state came "
        f"from takes {needed * 8 / 1e9:,.0f} GB at eight bytes, and at the planar programme's "
        f"{rate / 1e6:.1f} million states a second it would run for {needed / rate / 3600:.1f} "
        f"hours. Held to as many states as in the plane, {states / 1e6:.1f} million, its bins "
        f"would be {math.degrees((ball * nodes / states) ** (1 / 3)):.0f} degrees wide. The "
        "colony's cost does not depend on bins: [turning.md](turning.md) has its times for such "
        "step_rotations."
    )


def compile_all() -> None:
    """Compile everything, and see that the count counts."""
    count_queries()
    lattice = PostureLattice(variation("gate", 0))
    cheapest_way(lattice, 3)
    colony(lattice, ANNEALED, 0)
    grid = posture_grid(lattice)
    straight = np.tile(grid.origin, (len(lattice.joint_values), 1))
    colony.cost_of(grid, straight)
    if queries(grid) != len(lattice.joint_values) - 1:
        raise RuntimeError(f"{queries(grid)} queries counted along a path, not one for each edge")


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
        f"`python -m benchmarks.studies.attitude.attitude_programme --variations {args.variations} --seeds "
        f"{args.seeds}`",
        INTRODUCTION,
        *(section(name, of) for name, of in results.items()),
        "## Who wins what",
        verdict(every),
        VERDICT,
        in_space(every),
        f"All in {(time.perf_counter() - begin) / 60:.0f} minutes.",
    ]
    publish("\n\n".join(parts) + "\n", args.out)


if __name__ == "__main__":
    main()
