"""Lattices with posture axes against the search by trees, on the same problems.

    python -m benchmarks.studies.general.posture_lattices

The problems are those of `benchmarks.studies.attitude`: gates that only stowed arms pass, and turns
of the base by arm motion alone, in the plane and in space. Each is planned with its lattice by the
lattice's default planner, and without one by `TreePlanner`, both with default settings. All demand
a goal attitude. L and F are measured alike, with the clearances at 39 stations of the motion. As
the search by trees takes more time, it is run once more with as much work as fits the lattice's
time. Times are processor time of one thread, without compiling. The defaults take ten minutes.
"""

import argparse
import math
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table
from benchmarks.studies.attitude.gates import variation
from benchmarks.studies.attitude.turning import AXES, SPATIAL, planar
from ffsr_plan.problem.free_objective import stations_objective
from tests.helpers.spatial_robot import spatial_problem

_LATTICE, _TREES = "lattice", "trees"
_SAME_TIME, _FIRST = "trees, in the lattice's time", "trees, first path"
_WAYS = (_LATTICE, _TREES, _SAME_TIME, _FIRST)
_CHECKS = 1_200_000  # of the default
_TURNS = (("x", 0), ("z", 1), ("x + y", 2), ("z", 3))  # axis, and number of the setting in SPATIAL


class Run(NamedTuple):
    """One plan: infinite without one.

    Attributes:
        seconds: processor time [s].
        length: L of the motion [m].
        objective: F of the motion, with the clearances at its stations.
        missed: angle by which it misses the goal attitude [rad].
        verified: whether it verifies; true without a plan.
    """

    seconds: float
    length: float = math.inf
    objective: float = math.inf
    missed: float = math.inf
    verified: bool = True


def cases(planar_degrees: list[int]) -> dict[str, Callable[[int], fp.Problem]]:
    """Problems by name; those of gates vary with the seed."""
    found: dict[str, Callable[[int], fp.Problem]] = {
        "gate, varied": lambda seed: variation("gate", seed),
        "double gate, varied": lambda seed: variation("double_gate", seed),
    }
    for degrees in planar_degrees:
        found[f"plane, {degrees} degrees"] = lambda seed, d=degrees: planar(d)  # type: ignore[misc]
    for axis, number in _TURNS:
        setting = SPATIAL[number]
        name = f"space, {setting[0]} degrees about {axis}"
        found[name] = lambda seed, a=axis, s=setting: spatial_problem(s[0], AXES[a], *s[1:])  # type: ignore[misc]
    return found


def run(problem: fp.Problem, seed: int, samples: int, **options: object) -> Run:
    """Plan once, and verify the plan."""
    begin = time.process_time()
    try:
        plan = fp.plan(problem, seed=seed, **options)  # type: ignore[arg-type]
    except fp.PlanningError as error:
        print(f"seed {seed}: {error}", flush=True)
        return Run(time.process_time() - begin)
    seconds, error = time.process_time() - begin, plan.arrival_attitude_error
    length, objective = stations_objective(problem, plan.motion)
    missed = math.inf if error is None else error
    return Run(seconds, length, objective, missed, bool(plan.verify(samples).ok))


def rows_of(
    name: str, make: Callable[[int], fp.Problem], seeds: int, samples: int
) -> list[list[str]]:
    """Rows of one problem, one for each way to plan it."""
    runs: dict[str, list[Run]] = {way: [] for way in _WAYS}
    for seed in range(seeds):
        problem = make(seed)
        without = replace(problem, lattice=None)
        on_lattice = run(problem, seed, samples)
        by_trees = run(without, seed, samples)
        share = min(on_lattice.seconds / by_trees.seconds, 1.0)
        shorter = fp.TreePlanner(checks=max(1, int(share * _CHECKS)))
        runs[_LATTICE].append(on_lattice)
        runs[_TREES].append(by_trees)
        runs[_SAME_TIME].append(run(without, seed, samples, planner=shorter))
        runs[_FIRST].append(run(without, seed, samples, until="first"))
    return [row(name if way == _LATTICE else "", way, runs[way], runs[_LATTICE]) for way in _WAYS]


def row(name: str, way: str, runs: list[Run], on_lattice: list[Run]) -> list[str]:
    """One row of the table."""
    done = [each for each in runs if math.isfinite(each.length)]
    pairs = zip(runs, on_lattice, strict=True)
    ratios = [a.objective / b.objective for a, b in pairs if math.isfinite(a.length + b.length)]
    figures = ["", "", "", ""]
    if done:
        missed = max(each.missed for each in done)
        figures[:2] = [f"{np.median([e.length for e in done]):.2f} m", ""]
        figures[3] = f"{missed:.0e} rad" if missed > 0.0 else "0"
    if ratios and way != _LATTICE:
        figures[1:3] = [f"{np.median(ratios):.2f}", f"{max(ratios):.2f}"]
    seconds = [each.seconds for each in runs]
    return [
        name, way, f"{len(done)} / {len(runs)}", f"{sum(e.verified for e in done)} / {len(done)}",
        f"{np.median(seconds):.2f} s", f"{max(seconds):.2f} s", *figures,
    ]  # fmt: skip


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--planar", type=int, nargs="+", default=[10, 30, 75], help="degrees")
    parser.add_argument("--samples", type=int, default=50, help="of the verification, per edge")
    parser.add_argument("--out", type=Path, default=RESULTS / "posture_lattices.md")
    args = parser.parse_args()
    begin = time.process_time()
    for problem in (variation("gate", 0), planar(10)):  # compiles
        fp.plan(problem, seed=100)
        fp.plan(replace(problem, lattice=None), fp.TreePlanner(checks=200_000), seed=100)
    rows = []
    for name, make in cases(args.planar).items():
        rows += rows_of(name, make, args.seeds, args.samples)
        print(*rows[-len(_WAYS) :], sep="\n", flush=True)
    head = [
        "problem", "planned by", "solved", "verified", "time, median", "longest", "L, median",
        "F / F on the lattice, median", "worst", "attitude missed by",
    ]  # fmt: skip
    minutes = (time.process_time() - begin) / 60.0
    text = [
        "# Posture lattices and trees",
        "",
        "`python -m benchmarks.studies.general.posture_lattices "
        f"--seeds {args.seeds} --planar {' '.join(map(str, args.planar))}`",
        "",
        "The same problems, planned on their lattices with posture axes by `PostureAnnealing`, and",
        "without a lattice by `TreePlanner`: with its default work, with as much as fits the time",
        "that the lattice took, and until its first path. Otherwise default settings,",
        f"{args.seeds} seeds; gates vary with the seed. L and F are measured alike, F with the",
        "clearances at 39 stations; delta is 0.05 m^2 at gates and 0 where the base turns. Ratios",
        "are of runs with the same seed.",
        "Times are processor time of one thread.",
        "",
        table(head, rows),
        "",
        f"All in {minutes:.0f} minutes of processor time.",
    ]
    publish("\n".join(text) + "\n", args.out)


if __name__ == "__main__":
    main()
