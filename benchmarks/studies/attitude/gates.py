"""Planning through gates that only stowed arms pass, with a goal attitude, varied by seed.

    python -m benchmarks.studies.attitude.gates

Each variation moves the gates, their openings and the size of their spheres a little, and draws the
goal's yaw from -10 to 10 degrees. Plans are verified. Times are those of
one plan, without compiling.
"""

import argparse
import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table
from ffsr_plan.scene.generators import gate


def variation(name: str, seed: int) -> fp.Problem:
    """The scenario with its gates and goal attitude varied."""
    problem, rng = fp.load_scenario(name), np.random.default_rng(seed)
    places = sorted(set(problem.scene.centers[:, 0].tolist()))
    parts = [
        gate(
            x + rng.uniform(-0.4, 0.4), rng.uniform(-0.4, 0.4), rng.uniform(1.3, 1.5),
            rng.uniform(0.7, 1.1),
        )
        for x in places
    ]  # fmt: skip
    scene = sum(parts, fp.Scene())
    yaw = math.radians(rng.uniform(-10.0, 10.0))
    goal = problem.robot.configuration((10.0, 0.0, 0.0), (yaw, 0.0, 0.0))
    return replace(problem, scene=scene, goal=goal)


def passable(problem: fp.Problem) -> bool:
    """Whether the lattice has a path without posture axes."""
    lattice = replace(problem.lattice, postures=())
    try:
        fp.plan(replace(problem, lattice=lattice, reach_attitude=False), fp.LatticeOptimum())
    except fp.NoPath:
        return False
    return True


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--variations", type=int, default=10)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--samples", type=int, default=500, help="of the verification, per edge")
    parser.add_argument("--out", type=Path, default=RESULTS / "gates.md")
    args = parser.parse_args()
    fp.plan(fp.load_scenario("gate"))  # compiles
    rows = []
    for name in ("gate", "double_gate"):
        solved, verified, closed, seconds, missed, gaps = 0, 0, 0, [], [], []
        for number in range(args.variations):
            problem = variation(name, number)
            closed += not passable(problem)
            for seed in range(args.seeds):
                begin = time.perf_counter()
                try:
                    plan = fp.plan(problem, seed=seed)
                except fp.PlanningError as error:
                    print(f"{name} {number}, seed {seed}: {error}")
                    continue
                seconds.append(time.perf_counter() - begin)
                solved += 1
                verified += plan.verify(args.samples).ok
                missed.append(plan.arrival_attitude_error)
                gaps.append(plan.gap)
        runs = args.variations * args.seeds
        rows.append(
            [name, f"{closed} / {args.variations}", f"{solved} / {runs}", f"{verified} / {solved}",
             f"{max(missed):.1e} rad", f"{np.median(gaps):.0%}", f"{np.median(seconds):.1f} s",
             f"{max(seconds):.1f} s"]
        )  # fmt: skip
    header = [
        "scenario", "no path without posture axes", "solved", "verified", "attitude missed by",
        "gap to the lower bound, median", "time, median", "longest",
    ]  # fmt: skip
    publish(
        f"# Gates\n\n`python -m benchmarks.studies.attitude.gates --variations {args.variations} "
        f"--seeds {args.seeds}`\n\nVariations of the scenarios `gate` and `double_gate`, goal yaw "
        "from -10 "
        "to 10 degrees. `LatticeOptimum` proves that there is no path\nwithout posture axes."
        "\n\n" + table(header, rows) + "\n",
        args.out,
    )


if __name__ == "__main__":
    main()
