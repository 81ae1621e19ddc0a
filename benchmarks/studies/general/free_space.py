"""Planning without a lattice: success, time to the first proven path, and length.

    python -m benchmarks.studies.general.free_space

The problems are those of `problems.json`, twenty of each kind: random postures among spheres, walls
with gaps, cups, a free-floating UR5 beside a box of spheres, a UR5 satellite with panels that flies
past spheres, and goal attitudes; and as many of each kind drawn anew (`families.py`). Each plan is
verified. Times are processor time of one thread, without compiling.
"""

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table
from benchmarks.speed.reference import Reference
from benchmarks.studies.general.families import drawn
from ffsr_plan.core import rotations

PROBLEMS = Path(__file__).parent / "problems.json"
NAMES = {
    1: "random postures among spheres",
    2: "walls with gaps",
    3: "cups",
    4: "UR5 beside a box, free-floating",
    5: "UR5 satellite past spheres",
    6: "goal attitudes",
}


IN_TIME = 5.0  # [s]
CHECKS = 1_200_000  # of the default


class Found(NamedTuple):
    """What one problem took: infinite times and lengths without a plan."""

    first: float
    first_length: float
    seconds: float
    length: float
    missed: float
    verified: bool


def problems(kind: int, count: int) -> list[fp.Problem]:
    """The first problems of a class."""
    tables = [each for each in json.loads(PROBLEMS.read_text()) if each["cls"] == kind]
    robots = {name: fp.load_robot(name) for name in {each["robot"] for each in tables}}
    return [
        fp.Problem(
            robots[each["robot"]],
            fp.Scene(each["centers"], each["radii"]),
            each["start"],
            each["goal"],
            each["mode"],
            window=None if each["mode"] == "free-floating" else (each["low"], each["high"]),
            reach_attitude=each.get("reach_attitude", False),
        )
        for each in tables[:count]
    ]


def timed(problem: fp.Problem, **options: object) -> tuple[fp.Plan | None, float]:
    """A plan, or None, and the processor time that it took [s]."""
    begin = time.process_time()
    try:
        plan = fp.plan(problem, **options)  # type: ignore[arg-type]
    except fp.PathNotFound:
        return None, time.process_time() - begin
    return plan, time.process_time() - begin


def measured(problem: fp.Problem, samples: int) -> Found:
    """First path, and the path after the default amount of work."""
    first, first_seconds = timed(problem, until="first")
    best, seconds = timed(problem)
    plans = [plan for plan in (first, best) if plan is not None]
    missed = [
        float(rotations.angle_between(plan.configurations[-1, 3:7], problem.goal[3:7]))
        for plan in plans
        if problem.reach_attitude
    ]
    return Found(
        np.inf if first is None else first_seconds,
        np.inf if first is None else first.length,
        np.inf if best is None else seconds,
        np.inf if best is None else best.length,
        max(missed, default=0.0),
        all(plan.verify(samples).ok for plan in plans),
    )


def row(name: str, found: list[Found]) -> list[str]:
    """One row of the table."""
    firsts = np.array([each.first for each in found])
    solved = int(np.sum(firsts <= IN_TIME))
    shorter = [each.length / each.first_length for each in found if np.isfinite(each.length)]
    return [
        name,
        f"{solved} / {len(found)}",
        f"{sum(each.verified for each in found)} / {len(found)}",
        f"{np.median(firsts):.3f} s",
        f"{np.quantile(firsts, 0.9, method='lower'):.2f} s",
        f"{np.max(firsts):.2f} s",
        f"{np.median([each.seconds for each in found]):.1f} s",
        f"{np.median([each.length for each in found]):.2f} m",
        f"{np.median(shorter):.2f}",
        f"{max(each.missed for each in found):.0e} rad" if any(e.missed for e in found) else "",
    ]


def rows_of(sets: dict[str, Callable[[int], list[fp.Problem]]], samples: int) -> list[list[str]]:
    """Rows of all kinds, for each set of problems."""
    rows = []
    for label, of_kind in sets.items():
        for kind, name in NAMES.items():
            groups = {"": of_kind(kind)}
            if kind == 6:
                planar = [p for p in groups[""] if p.robot.name == "planar_dual_arm"]
                groups = {
                    ", planar": planar,
                    ", spatial": [p for p in groups[""] if p not in planar],
                }
            for part, chosen in groups.items():
                found = [measured(each, samples) for each in chosen]
                rows.append(row(f"{label} {kind}: {name}{part}", found))
                print(rows[-1], flush=True)
    return rows


def longer(count: int, factor: int) -> list[list[str]]:
    """Length after the default work against that after so many times as much."""
    rows = []
    for kind, name in NAMES.items():
        ratios = []
        for each in problems(kind, count):
            short, _ = timed(each)
            long, _ = timed(each, planner=fp.TreePlanner(checks=factor * CHECKS), seed=1)
            if short is not None and long is not None:
                ratios.append(short.length / min(short.length, long.length))
        rows.append([f"{kind}: {name}", f"{np.median(ratios):.3f}", f"{max(ratios):.3f}"])
        print(rows[-1], flush=True)
    return rows


def reference() -> float:
    """What Pinocchio and Coal take for all nodes of `fig2a` [ms]: how fast the machine is."""
    return 1e3 * Reference(fp.load_scenario("fig2a")).seconds(15)


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20, help="problems of each kind")
    parser.add_argument("--first-seed", type=int, default=0, help="of the problems drawn anew")
    parser.add_argument("--samples", type=int, default=50, help="of the verification, per edge")
    parser.add_argument(
        "--longer", type=int, default=5, help="problems of each kind, searched long"
    )
    parser.add_argument("--factor", type=int, default=12, help="times the default work for these")
    parser.add_argument("--out", type=Path, default=RESULTS / "free_space.md")
    args = parser.parse_args()
    for kind in NAMES:
        fp.plan(problems(kind, 1)[0], fp.TreePlanner(checks=100_000))  # compiles
    seeds = range(args.first_seed, args.first_seed + args.count)
    sets = {
        "set": lambda kind: problems(kind, args.count),
        "new": lambda kind: [drawn(kind, seed) for seed in seeds],
    }
    heads = [
        "problems", f"proven in {IN_TIME:g} s", "verified", "first proven path, median", "90 %",
        "longest", "all work, median", "L, median", "L / L of the first path, median", "missed",
    ]  # fmt: skip
    text = [
        "# Without a lattice",
        "",
        f"`python -m benchmarks.studies.general.free_space --count {args.count} --first-seed "
        f"{args.first_seed} --longer {args.longer}`",
        "",
        "Problems without a lattice, planned by `TreePlanner` with its default settings, that is,",
        f"{CHECKS:,} configurations checked. `set`: those of `problems.json`, beside the program;",
        "`new`: drawn by `families.py` for this table. Times are processor time of one thread;",
        f"`pin.computeDistances` for all nodes of `fig2a` takes {reference():.1f} ms here.",
        "",
        table(heads, rows_of(sets, args.samples)),
    ]
    if args.longer:
        text += [
            "",
            "## How much longer searches gain",
            "",
            "L after the default work, as a multiple of the shorter of that and L after",
            f"{args.factor} times the work (another seed); the first {args.longer} problems of",
            "each kind of the set.",
            "",
            table(["problems", "median", "largest"], longer(args.longer, args.factor)),
        ]
    publish("\n".join(text) + "\n", args.out)


if __name__ == "__main__":
    main()
