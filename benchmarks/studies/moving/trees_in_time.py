"""Trees without a lattice among bodies that move, in the scenes of the study of waiting.

    python -m benchmarks.studies.moving.trees_in_time

plans 100 random scenes in the plane and 10 in space by `TreePlanner` until its first run and with
all its work, looks at every flight found at every millisecond by code that shares none with the
package (`flight_check.py`), and writes docs/benchmarks/trees_in_time.md. It takes about an hour.
"""

import argparse
import os
import time
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table
from benchmarks.studies.moving.body_travel import paragraph
from benchmarks.studies.moving.flight_check import MILLISECOND, Obstacles, check_flight
from benchmarks.studies.moving.waiting import ends_are_free
from benchmarks.studies.moving.waiting_scenes import FAMILIES, drawn, drawn_in_space

FIRST, ALL, WAITS = "first run", "all work", "waiting lattice"


class Flown(NamedTuple):
    """What a planner made of a scene: processor time [s], L, F, and the least separation [m]."""

    seconds: float
    length: float = np.inf
    objective: float = np.inf
    least: float = np.inf


def flown(problem, obstacles, planner, **options):
    """What a planner makes of a scene."""
    begin = time.process_time()
    try:
        plan = fp.plan(problem, planner, refine=False if problem.lattice else None, **options)
    except (fp.NoPath, fp.PathNotFound):
        return Flown(time.process_time() - begin)
    seconds = time.process_time() - begin
    least = check_flight(plan, obstacles).separation
    return Flown(seconds, plan.length, plan.objective, least)


def runs(draws, count, work, step=MILLISECOND):
    """What each planner makes of the first `count` scenes whose ends are free."""
    done = 0
    for problem in draws:
        if done == count:
            return
        if not ends_are_free(problem):
            continue
        done += 1
        obstacles = Obstacles(problem.scene, problem.duration, step)
        free = replace(problem, lattice=None)
        found = {
            FIRST: flown(free, obstacles, fp.TreePlanner(checks=work), until="first"),
            ALL: flown(free, obstacles, fp.TreePlanner(checks=work)),
            WAITS: flown(problem, obstacles, fp.LatticeOptimum()),
        }
        print(found, flush=True)
        yield found


def row(name, scenes, label):
    """A row: scenes, solved, processor times, and length against the lattice's."""
    each = [scene[label] for scene in scenes]
    solved = [k for k, one in enumerate(each) if np.isfinite(one.length)]
    both = [k for k in solved if np.isfinite(scenes[k][WAITS].length)]
    ratios = [each[k].length / scenes[k][WAITS].length for k in both]
    seconds, least = [one.seconds for one in each], [each[k].least for k in solved]
    return [
        f"{name}, {label}", str(len(scenes)), str(len(solved)), f"{np.median(seconds):.2f}",
        f"{max(seconds):.1f}", f"{np.median(ratios):.3f}", str(int(np.sum(np.array(least) <= 0))),
        f"{min(least):.4f}",
    ]  # fmt: skip


def report(families, work, options):
    """The page; `families` are names and what was made of their scenes."""
    every = [one for _, scenes in families for scene in scenes for one in scene.values()]
    found = [one for one in every if np.isfinite(one.length)]
    scenes = [scene for _, scenes in families for scene in scenes]
    solved = sum(np.isfinite(scene[ALL].length) for scene in scenes)
    heads = ["", "scenes", "solved", "median [s]", "worst [s]", "L / L of the lattice"]
    heads += ["that collide", "least separation [m]"]
    rows = [row(name, some, label) for name, some in families for label in (FIRST, ALL, WAITS)]
    words = paragraph(
        f"The trees solve **{solved} of {len(scenes)}** scenes of the study of waiting without a "
        f"lattice, with {work} configurations checked at most. "
        f"**{sum(one.least <= 0.0 for one in found)} of {len(found)}** flights collide at any "
        "millisecond, looked at by code that shares none with the package. A planner that does "
        "not find a path spends all its work. Processor time of `plan` on "
        f"{os.cpu_count()} slow cores that other work used too."
    )
    parts = ["# Trees among bodies that move"]
    parts += [f"    python -m benchmarks.studies.moving.trees_in_time{options}", words]
    return "\n\n".join([*parts, table(heads, rows)]) + "\n"


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scenes", type=int, default=25, help="of each family")
    parser.add_argument("--in-space", type=int, default=10, help="scenes in space")
    parser.add_argument("--work", type=int, default=1_200_000, help="configurations checked")
    parser.add_argument("--out", type=Path, default=RESULTS / "trees_in_time.md")
    args = parser.parse_args()
    families = []
    for k, name in enumerate(FAMILIES):
        draws = (drawn(seed, k) for seed in range(10 * args.scenes))
        families.append((name, list(runs(draws, args.scenes, args.work))))
    draws = (drawn_in_space(seed) for seed in range(10 * args.in_space))
    families.append(("space", list(runs(draws, args.in_space, args.work))))
    options = f" --scenes {args.scenes} --in-space {args.in_space} --work {args.work}"
    publish(report(families, args.work, options), args.out)


if __name__ == "__main__":
    main()
