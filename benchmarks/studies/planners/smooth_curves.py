"""Smooth curves of plans: how many are splines, how long they take, and how they bend.

    python -m benchmarks.studies.planners.smooth_curves

plans problems of family `paper` with several weights of the clearance, all bundled scenarios and
the problems without a lattice of `benchmarks/studies/general/problems.json`, smooths the plans and
writes docs/benchmarks/smooth_curves.md. It takes about ten minutes.
"""

import argparse
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.paper_scenes import NUMBERS, paper_problem
from benchmarks.report_pages import RESULTS, publish, table
from benchmarks.studies.general.free_space import NAMES, problems
from ffsr_plan.core.bundled_files import names
from ffsr_plan.curves.control_points import control_points_on
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.curves.splines import evaluate

DELTAS = (0.05, 0.001, 0.0)
SAMPLES = 64  # of a piece
AT_REST = 1e-7  # [m] speed below which a bend does not count


class Smoothed(NamedTuple):
    """A smooth plan, what it took, and how it and the spline through the nodes bend."""

    plan: fp.Plan
    smooth: "fp.SmoothPlan | None"
    seconds: float
    bends: tuple[float, float]
    through: tuple[float, float]


def bends(problem: fp.Problem, motion: fp.CurvedMotion) -> tuple[float, float]:
    """Change of the unit tangent in all [rad], and the largest curvature [1/m]."""
    m, robot = motion.edges, problem.robot
    piece, time_on = np.repeat(np.arange(m), SAMPLES), (np.arange(m * SAMPLES) % SAMPLES) + 0.5
    metres, radians = problem.position_weight, problem.rotation_weight
    weights = np.append(np.full(3, metres), np.where(robot.prismatic, metres, radians))
    rate, change = (
        evaluate(each[:, :, :-1], piece, time_on / SAMPLES) * weights
        for each in (motion.pieces.rates, motion.pieces.bends)
    )
    speeds = np.sum(rate**2, axis=1)
    moving = speeds > AT_REST**2
    rate, change, speeds = rate[moving], change[moving], speeds[moving]
    if not len(speeds):
        return 0.0, 0.0
    across = change - rate * (np.sum(change * rate, axis=1) / speeds)[:, None]
    curvature = np.linalg.norm(across, axis=1) / speeds
    return float(np.sum(curvature * np.sqrt(speeds)) / SAMPLES), float(curvature.max())


def smoothed(plans: Iterator[fp.Plan]) -> Iterator[Smoothed]:
    """The plans, smoothed."""
    for plan in plans:
        begin = time.process_time()
        try:
            smooth = plan.smooth()
        except fp.UnprovenCurve:
            smooth = None
        seconds, motion = time.process_time() - begin, plan.motion
        through = control_points_on(motion, np.arange(motion.edges + 1.0)).through()
        own = (np.inf, np.inf) if smooth is None else bends(plan.problem, smooth.curve.motion)
        other = bends(plan.problem, CurvedMotion(motion, through))
        yield Smoothed(plan, smooth, seconds, own, other)


def plans_of(
    each: Iterator[fp.Problem], planned: Callable[[fp.Problem], fp.Plan]
) -> Iterator[fp.Plan]:
    """Plans of those problems that have one."""
    for problem in each:
        try:
            yield planned(problem)
        except fp.PlanningError:
            continue


def row(name: str, found: list[Smoothed]) -> list[str]:
    """One row of the table."""
    proven = [each for each in found if each.smooth is not None]
    kinds = [each.smooth.kind for each in proven if each.smooth is not None]
    far = [each for each in found if each.plan.certificate.least_clearance >= 0.01]
    splines = sum(each.smooth is not None and each.smooth.kind == "spline" for each in far)
    lengths = [s.smooth.length / s.plan.length - 1.0 for s in proven if s.smooth is not None]
    values = [s.smooth.objective / s.plan.objective - 1.0 for s in proven if s.smooth is not None]
    seconds = np.array([each.seconds for each in found])
    ratios = np.array([[s.bends, s.through] for s in proven]) + 1e-9
    more = np.median(ratios[:, 1] / ratios[:, 0], axis=0)
    return [
        name,
        f"{len(proven)} / {len(found)}",
        f"{kinds.count('spline')}, {kinds.count('refined spline')}, "
        f"{kinds.count('through')}, {kinds.count('with rests')}",
        f"{splines} / {len(far)}",
        f"{np.median(lengths):+.2%}",
        f"{np.median(values):+.2%}",
        f"{1e3 * np.median(seconds):.0f}, {1e3 * seconds.max():.0f} ms",
        f"{more[0]:.2f}, {more[1]:.2f}",
    ]


def groups(count: int, seconds: float) -> Iterator[tuple[str, Iterator[fp.Plan]]]:
    """Names and plans of all rows."""
    optimum = fp.LatticeOptimum()
    for delta in DELTAS:
        scenes = (paper_problem(number, delta) for number in NUMBERS)
        yield f"family `paper`, delta {delta:g}", plans_of(scenes, lambda p: fp.plan(p, optimum))
    bundled = (fp.load_scenario(name) for name in names("scenarios", ".toml"))
    yield "bundled scenarios", plans_of(bundled, lambda p: fp.plan(p))
    for kind, name in NAMES.items():
        first = plans_of(iter(problems(kind, count)), lambda p: fp.plan(p, until="first"))
        yield f"{name}, first path", first
        later = plans_of(iter(problems(kind, count)), lambda p: fp.plan(p, time_limit=seconds))
        yield f"{name}, {seconds:g} s", later


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=20, help="problems of each kind")
    parser.add_argument("--seconds", type=float, default=1.0, help="time limit of the trees")
    parser.add_argument("--out", type=Path, default=RESULTS / "smooth_curves.md")
    args = parser.parse_args()
    fp.warm_up()
    rows = []
    for name, plans in groups(args.count, args.seconds):
        found = list(smoothed(plans))
        if found:
            rows.append(row(name, found))
            print(rows[-1], flush=True)
    heads = [
        "plans", "proven", "spline, refined, through, rests", "splines of those 1 cm clear",
        "L, median", "F, median", "time: median, longest", "through: turning, curvature",
    ]  # fmt: skip
    text = [
        "# Smooth curves",
        "",
        f"`python -m benchmarks.studies.planners.smooth_curves --count {args.count} --seconds "
        f"{args.seconds:g}`",
        "",
        "`plan.smooth()` on refined optima of the 28 problems of family `paper` of",
        "[the problem set](../howto/problem_set.md), on the bundled scenarios, and on the",
        "problems without a lattice of [Without a lattice](free_space.md): first paths, and",
        f"plans after {args.seconds:g} s. L and F are compared with the plan's; times are",
        "processor time for curve, proof and figures, on a machine that other work used",
        "too. The last column has the spline through the",
        "nodes, proven or not, against the curve that was taken: how much its direction turns in",
        "all, and its largest curvature, both in the weighted space of base position and joints.",
        "",
        table(heads, rows),
    ]
    publish("\n".join(text) + "\n", args.out)


if __name__ == "__main__":
    main()
