"""Proven clearance against the clearance weight delta, on the lattice and after refinement.

    python -m benchmarks.studies.planners.clearance_weight

plans the same random scenes with several weights by the default planner, and writes
docs/benchmarks/clearance_weight.md.
"""

import argparse
import sys
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.random_scenes import RESULTS, publish, random_problem, table

FIRST_SEED = 5000
DELTAS = (0.0, 0.005, 0.02, 0.05, 0.2)
FAR_LESS = 0.5


class Figures(NamedTuple):
    """Figures of merit of a plan.

    Attributes:
        clearance: proven clearance [m].
        length: L [m].
        objective: F of Eq. 8.
        motion_objective: F of the whole motion.
        seconds: processor time of the plan [s].
    """

    clearance: float
    length: float
    objective: float
    motion_objective: float
    seconds: float


def planned(seed, delta, refine):
    """The `Figures` of a scene."""
    problem, begin = random_problem(seed, delta), time.process_time()
    plan = fp.plan(problem, refine=refine)
    return Figures(
        plan.certificate.least_clearance,
        plan.length,
        plan.objective,
        plan.motion_objective,
        time.process_time() - begin,
    )


def scenes(count):
    """Seeds of scenes that have a path."""
    seed = FIRST_SEED
    while count:
        try:
            fp.plan(random_problem(seed, 0.0), fp.LatticeOptimum(), refine=False)
        except (fp.NoPath, fp.StartInCollision, fp.GoalInCollision):
            pass
        else:
            count -= 1
            yield seed
        seed += 1


def row(delta, refine, plans, before):
    """A row of the table; `before` are the plans of the next smaller delta, or None."""
    clearances = np.array([plan.clearance for plan in plans])
    low, middle, high = 1e3 * np.quantile(clearances, [0.25, 0.5, 0.75])
    less = "-"
    if before is not None:
        less = f"{np.sum(clearances < FAR_LESS * np.array([plan.clearance for plan in before]))}"
    length, objective, whole = (
        np.median([getattr(plan, name) for plan in plans])
        for name in ("length", "objective", "motion_objective")
    )
    return [
        f"{delta:g}, {'refined' if refine else 'on the lattice'}",
        f"{middle:.0f}",
        f"{low:.0f} to {high:.0f}",
        f"{1e3 * clearances.min():.1f}",
        less,
        f"{length:.2f}",
        f"{objective:.2f}",
        f"{whole:.2f}",
        f"{1e3 * np.median([plan.seconds for plan in plans]):.0f}",
    ]


HEADER = (
    "delta",
    "proven clearance: median [mm]",
    "quartiles [mm]",
    "least [mm]",
    "scenes with less than half",
    "L [m]",
    "F",
    "F of the whole motion",
    "plan [ms]",
)
TEXT = """# Clearance against its weight

`{command}`: the default planner in {scenes} random scenes that have a path
(`benchmarks/random_scenes.py`, seeds from {first}), the same scenes for every delta. L, F and times
are medians; times are processor times. {minutes:.1f} minutes in all.

{results}

- F contains the clearances at the nodes; F of the whole motion, `plan.motion_objective`, the least
  clearance on every edge. Refinement lowers the latter.
- On the lattice, where F counts, a large delta lets some paths pass obstacles closely between two
  nodes. After refinement every quartile of the clearance grows with delta, and so does the least.
- "Scenes with less than half" have less than half of the clearance that they have at the delta
  before.
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scenes", type=int, default=50, help="number of random scenes")
    parser.add_argument("--out", type=Path, default=RESULTS / "clearance_weight.md")
    given = parser.parse_args()
    begin = time.process_time()
    fp.plan(fp.load_scenario("fig2a"))  # compiles
    seeds, rows = list(scenes(given.scenes)), []
    for refine in (False, True):
        before = None
        for delta in DELTAS:
            plans = [planned(seed, delta, refine) for seed in seeds]
            rows.append(row(delta, refine, plans, before))
            before = plans
            print(f"{rows[-1]} {time.process_time() - begin:.0f} s", file=sys.stderr)
    text = TEXT.format(
        command=f"python -m benchmarks.studies.planners.clearance_weight --scenes {given.scenes}",
        scenes=given.scenes,
        first=FIRST_SEED,
        minutes=(time.process_time() - begin) / 60.0,
        results=table(HEADER, rows),
    )
    publish(text, given.out)


if __name__ == "__main__":
    main()
