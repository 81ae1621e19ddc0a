"""Planning without a lattice: success, time to the first proven path, and length.

    python -m benchmarks.studies.general.free_space

The problems are in `problems.json`, twenty of each: random postures among spheres, walls with gaps,
cups, a free-floating UR5 beside a box of spheres, a UR5 satellite with panels that flies past
spheres, and goal attitudes. Each plan is verified. Times are processor time of one thread, without
compiling.
"""

import argparse
import json
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.random_scenes import RESULTS, publish, table

PROBLEMS = Path(__file__).parent / "problems.json"
NAMES = {
    1: "random postures among spheres",
    2: "walls with gaps",
    3: "cups",
    4: "UR5 beside a box, free-floating",
    5: "UR5 satellite past spheres",
    6: "goal attitudes",
}


class Found(NamedTuple):
    """What one problem took: infinite times and lengths without a plan."""

    first: float
    first_length: float
    seconds: float
    length: float
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
    return Found(
        np.inf if first is None else first_seconds,
        np.inf if first is None else first.length,
        np.inf if best is None else seconds,
        np.inf if best is None else best.length,
        all(plan.verify(samples).ok for plan in plans),
    )


def row(kind: int, found: list[Found]) -> list[str]:
    """One row of the table."""
    firsts = np.array([each.first for each in found])
    solved = sum(np.isfinite(each.length) for each in found)
    shorter = [each.length / each.first_length for each in found if np.isfinite(each.length)]
    return [
        f"{kind}: {NAMES[kind]}",
        f"{solved} / {len(found)}",
        f"{sum(each.verified for each in found)} / {len(found)}",
        f"{np.median(firsts):.2f} s",
        f"{np.quantile(firsts, 0.9, method='lower'):.2f} s",
        f"{np.median([each.seconds for each in found]):.1f} s",
        f"{np.median([each.length for each in found]):.2f} m",
        f"{np.median(shorter):.2f}",
    ]


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20, help="problems of each class")
    parser.add_argument("--samples", type=int, default=50, help="of the verification, per edge")
    parser.add_argument("--out", type=Path, default=RESULTS / "free_space.md")
    args = parser.parse_args()
    for kind in NAMES:
        fp.plan(problems(kind, 1)[0], fp.TreePlanner(checks=100_000))  # compiles
    rows = []
    for kind in NAMES:
        rows.append(
            row(kind, [measured(each, args.samples) for each in problems(kind, args.count)])
        )
        print(rows[-1], flush=True)
    heads = [
        "class", "solved", "verified", "first proven path, median", "90 %", "all work, median",
        "L, median", "L / L of the first path, median",
    ]  # fmt: skip
    text = [
        "# Without a lattice",
        "",
        f"`python -m benchmarks.studies.general.free_space --count {args.count}`",
        "",
        "Problems without a lattice, solved by `TreePlanner` with its default settings; `solved`",
        "after 1 200 000 checked configurations. Times are processor time of one thread.",
        "",
        table(heads, rows),
    ]
    publish("\n".join(text) + "\n", args.out)


if __name__ == "__main__":
    main()
