"""Waiting lattices among bodies that move, against lattices that go forwards at a fixed pace.

    python -m benchmarks.studies.moving.waiting

plans 100 random scenes in the plane and 66 in space, looks at every flight found at every
millisecond by code that shares none with the package (`flight_check.py`), has OMPL plan those that
no fixed pace solves (needs `pip install ompl==2.0.1`; `--ompl 0` leaves it out), and writes
docs/benchmarks/waiting.md. It takes about a quarter of an hour on two cores.
"""

import argparse
import os
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table
from benchmarks.studies.moving.body_travel import paragraph
from benchmarks.studies.moving.flight_check import FAR, MILLISECOND, Obstacles, check_flight
from benchmarks.studies.moving.waiting_scenes import (
    DURATION,
    FAMILIES,
    STEADY,
    WAITING,
    drawn,
    drawn_in_space,
)

PACES = {"even": 0.0, "ramp": 0.2}
WAITS = "waiting"


class Flown(NamedTuple):
    """What a lattice made of a scene.

    Attributes:
        seconds: processor time of `plan`, also where it proves that there is no path [s].
        length: of the path [m]; infinite without one.
        back: steps in which the base goes back.
        least: the least separation of the flight, at every millisecond [m].
    """

    seconds: float
    length: float = np.inf
    back: int = 0
    least: float = np.inf

    @property
    def found(self):
        """Whether there is a path."""
        return np.isfinite(self.length)


class Run(NamedTuple):
    """A scene: its family, seed, what each lattice made of it, and the reference in seconds."""

    family: str
    seed: int
    flown: dict[str, Flown]
    reference: float
    load: float

    @property
    def solved(self):
        """Whether a fixed pace solves it."""
        return any(self.flown[label].found for label in PACES if label in self.flown)


def timed(problem):
    """The plan of the lattice's optimum, None if there is none, and processor time [s]."""
    begin = time.process_time()
    try:
        plan = fp.plan(problem, fp.LatticeOptimum(), refine=False)
    except fp.NoPath:
        plan = None
    return plan, time.process_time() - begin


def flown(problem, obstacles):
    """What a lattice makes of a scene."""
    plan, seconds = timed(problem)
    if plan is None:
        return Flown(seconds)
    waits = problem.lattice.progress is not None
    back = int(np.sum(np.diff(plan.nodes[:, -1]) < 0)) if waits else 0
    return Flown(seconds, plan.length, back, check_flight(plan, obstacles).separation)


def ends_are_free(problem):
    """Whether nothing touches start and goal, each at its time."""
    ends = (problem.start, 0.0), (problem.goal, problem.duration)
    return all(fp.clearance(problem.robot, problem.scene.at(t), q) > 0.0 for q, t in ends)


def runs(draws, count, steady=True, step=MILLISECOND):
    """The first `count` scenes whose ends are free, of (family, seed, problem).

    Flights are looked at every `step` [s].
    """
    reference, done = fp.load_scenario("fig2a"), 0
    timed(reference)
    for family, seed, problem in draws:
        if done == count:
            return
        if not ends_are_free(problem):
            continue
        done += 1
        if done == 1:
            timed(problem)  # compiles
        obstacles = Obstacles(problem.scene, problem.duration, step)
        lattices = {WAITS: problem}
        if steady:
            for label, ramp in PACES.items():
                lattices[label] = replace(problem, lattice=STEADY, ramp=ramp)
        seconds = [timed(reference)[1] for _ in range(3)]
        found = {label: flown(each, obstacles) for label, each in lattices.items()}
        yield Run(family, seed, found, float(np.median(seconds)), os.getloadavg()[0])


def in_plane(family, count):
    """`count` scenes of a family."""
    draws = ((FAMILIES[family], k, drawn(k, family)) for k in range(10 * count))
    return list(runs(draws, count))


def in_space(count):
    """`count` scenes in space."""
    draws = (("space", k, drawn_in_space(k)) for k in range(10 * count))
    return list(runs(draws, count, steady=False))


def _solved(scenes):
    """A row of counts: scenes, solved by each lattice, and by waiting of those otherwise not."""
    counts = [sum(run.flown[label].found for run in scenes) for label in (*PACES, WAITS)]
    left = [run for run in scenes if not run.solved]
    waited = sum(run.flown[WAITS].found for run in left)
    lost = sum(run.solved and not run.flown[WAITS].found for run in scenes)
    back = sum(run.flown[WAITS].back > 0 for run in scenes)
    return [str(len(scenes)), *map(str, counts), f"{waited} of {len(left)}", str(lost), str(back)]


def _times(name, scenes, label):
    """A row of processor times, and of ratios to the reference."""
    seconds = np.array([run.flown[label].seconds for run in scenes])
    ratios = seconds / np.median([run.reference for run in scenes])
    row = [name, str(len(scenes))]
    row += [f"{each:.2f}" for each in (np.median(seconds), seconds.max())]
    return [*row, *(f"{each:.0f}" for each in (np.median(ratios), ratios.max()))]


def _checked(name, scenes, label):
    """A row of what the look at every millisecond found."""
    least = np.array([run.flown[label].least for run in scenes if run.flown[label].found])
    if not len(least):
        return [name, "0", "", "", ""]
    counts = [str(len(least)), str(int(np.sum(least <= 0.0)))]
    return [name, *counts, f"{least.min():.4f}", f"{np.median(least):.3f}"]


def _on_counts(plane):
    """What was compared, and how many scenes each lattice solves."""
    progress = WAITING.progress
    words = paragraph(
        "The planar dual-arm robot moves 10 m in 200 s, delta 0.02 m^2. Scenes whose start or "
        "goal is blocked at its time are drawn again. *Fixed pace*: 40 divisions, 41 offsets of "
        f"0.15 m, at an even pace or with `ramp=0.2`. *Waiting*: {WAITING.divisions} divisions "
        f"of {DURATION / WAITING.divisions:g} s, {progress.steps} steps of progress, 25 offsets "
        f"of 0.25 m, `most={progress.most}`, `aside={progress.aside}`, "
        f"`before={progress.before}`, `beyond={progress.beyond}`: the base moves by at most 0.2 "
        "m/s along and across the way. At a fixed pace it has no limit across. All are exact "
        "optima of their lattices (`LatticeOptimum`), so that no path means that the lattice "
        "holds none."
    )
    heads = ["", "scenes", "even pace", "ramp", "waiting", "waiting, where no pace does"]
    heads += ["a pace only", "flights that go back"]
    rows = [[name, *_solved([run for run in plane if run.family == name])] for name in FAMILIES]
    return [words, table(heads, [*rows, ["all", *_solved(plane)]])]


def _on_times(plane, space):
    """Processor times."""
    loads = [run.load for run in [*plane, *space]]
    reference = np.median([run.reference for run in [*plane, *space]])
    left = [run for run in plane if not run.solved]
    rows = [
        _times("waiting, in the plane", plane, WAITS),
        *([_times("waiting, where no pace solves it", left, WAITS)] if left else []),
        *(_times(f"fixed pace, {label}", plane, label) for label in PACES),
        *([_times("waiting, in space", space, WAITS)] if space else []),
    ]
    solved = sum(run.flown[WAITS].found for run in space)
    words = paragraph(
        f"Processor time of `plan` on {os.cpu_count()} slow cores that other work used too (load "
        f"{min(loads):.1f} to {max(loads):.1f}). In the same run the static optimum of `fig2a` "
        f"took {1000 * reference:.0f} ms in the median; ratios are to its median while a row's "
        "scenes were planned. In space a satellite with a UR5 moves 10 m past four satellites, "
        "one of each motion, on 81 offsets of 0.5 m and 25 places: "
        f"{solved} of {len(space)} scenes are solved."
    )
    heads = ["", "scenes", "median [s]", "worst [s]", "median ratio", "worst ratio"]
    return ["## Time", words, table(heads, rows)]


def _on_checks(plane, space):
    """The flights at every millisecond."""
    words = paragraph(
        "Link poses and inertia come from the URDF's text, the base's attitude from an "
        "integration of zero angular momentum, poses of bodies from SciPy and a Runge-Kutta "
        "method, the pace from the integral of its trapezoid. Boxes are compared by separating "
        f"axes, of which the widest gap is a lower bound on their distance; more than {FAR:g} m "
        "is not told apart."
    )
    rows = [_checked(f"fixed pace, {label}", plane, label) for label in PACES]
    rows += [_checked("waiting, in the plane", plane, WAITS)]
    rows += [_checked("waiting, in space", space, WAITS)] if space else []
    heads = ["", "flights", "that collide", "least separation [m]", "median [m]"]
    return ["## Every flight at every millisecond", words, table(heads, rows)]


def _on_samples(sampled):
    """OMPL's paths, looked at in the same way."""
    found = [run for run in sampled if run.seconds < np.inf]
    scenes = {(run.family, run.seed) for run in sampled}
    kinds = [sum(family == name for family, _ in scenes) for name in FAMILIES]
    of_each = ", ".join(f"{name} {n}" for name, n in zip(FAMILIES, kinds, strict=True))
    bad = [run for run in found if run.least <= 0.0]
    words = paragraph(
        f"OMPL 2.0.1 plans x, y and time in {len(scenes)} scenes that neither fixed pace solves "
        f"({of_each}), "
        f"{len(sampled) // len(scenes)} runs each: `control.RRT` with velocities of at most 0.2 "
        "m/s each way, joints and attitude by progress as in the waiting lattice, at most 60 "
        "000 checked states a run. At its default resolution it checks states at 1 % of the "
        "extent of its space, which the 200 s dominate: one state in 2 s. Its states are "
        "checked, and its paths looked at every millisecond, by the same code as above."
    )
    row = [str(len(sampled)), str(len(found)), str(len(bad))]
    row += [str(len({(run.family, run.seed) for run in bad}))]
    deep = [-100.0 * run.least for run in bad]
    row += [f"{min(deep):.1f} to {max(deep):.1f}" if deep else ""]
    row += [f"{np.median([run.seconds for run in found]):.1f}" if found else ""]
    heads = ["runs", "paths", "that collide", "scenes with such", "depth [cm]", "median time [s]"]
    return ["## A sampled planner at its default resolution", words, table(heads, [row])]


def spread(scenes, count):
    """At most `count` of the scenes, evenly spread over their list and so over the families."""
    rows = np.linspace(0, len(scenes) - 1, min(count, len(scenes))).round().astype(np.int64)
    return [scenes[k] for k in rows]


def report(plane, space, sampled, options):
    """The page."""
    left = [run for run in plane if not run.solved]
    waited = sum(run.flown[WAITS].found for run in left)
    every = [flown for run in [*plane, *space] for flown in run.flown.values() if flown.found]
    hits = sum(flown.least <= 0.0 for flown in every)
    parts = [
        "# Waiting for bodies that move",
        f"    python -m benchmarks.studies.moving.waiting{options}",
        paragraph(
            f"**{waited} of {len(left)}** scenes that no fixed pace solves are solved by "
            f"waiting. **{hits} of {len(every)}** flights collide at any millisecond, looked at "
            "by code that shares none with the package."
        ),
        *_on_counts(plane),
        *_on_times(plane, space),
        *_on_checks(plane, space),
        *(_on_samples(sampled) if sampled else []),
    ]
    return "\n\n".join(parts) + "\n"


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scenes", type=int, default=25, help="of each family")
    parser.add_argument("--in-space", type=int, default=66, help="scenes in space")
    parser.add_argument("--ompl", type=int, default=20, help="scenes for OMPL")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--out", type=Path, default=RESULTS / "waiting.md")
    args = parser.parse_args()
    sampled = []
    with ProcessPoolExecutor(args.workers) as pool:
        of_space = pool.submit(in_space, args.in_space)
        of_families = [pool.submit(in_plane, k, args.scenes) for k in range(len(FAMILIES))]
        plane = [run for found in of_families for run in found.result()]
        space = of_space.result()
    for run in (*plane, *space):
        print(run, flush=True)
    if args.ompl:
        from benchmarks.studies.moving.ompl_in_time import sampled_runs

        left = [(run.family, run.seed) for run in plane if not run.solved]
        for each in sampled_runs(spread(left, args.ompl)):
            sampled.append(each)
            print(each, flush=True)
    options = f" --scenes {args.scenes} --in-space {args.in_space} --ompl {args.ompl}"
    publish(report(plane, space, sampled, options), args.out)


if __name__ == "__main__":
    main()
