"""Proven clearance against the clearance weight delta, on the lattice and after refinement.

    python -m benchmarks.studies.planners.clearance_weight

plans problems of family `paper` with several weights by the default planner, and writes
docs/benchmarks/clearance_weight.md.
"""

import argparse
import sys
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.paper_scenes import NUMBERS, add_problems_option, cases, paper_problem
from benchmarks.report_pages import RESULTS, publish, table

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


def planned(number, delta, refine):
    """The `Figures` of a problem."""
    problem, begin = paper_problem(number, delta), time.process_time()
    plan = fp.plan(problem, refine=refine)
    return Figures(
        plan.certificate.least_clearance,
        plan.length,
        plan.objective,
        plan.motion_objective,
        time.process_time() - begin,
    )


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
    "problems with less than half",
    "L [m]",
    "F",
    "F of the whole motion",
    "plan [ms]",
)
TEXT = """# Clearance against its weight

`{command}`

The default planner on {count} of {problems} problems of family `paper` of
[the problem set](../howto/problem_set.md), those that have a path, the same for every delta. L, F
and times are medians; times are processor times. {minutes:.1f} minutes in all.

{results}

- F contains the clearances at the nodes; F of the whole motion, `plan.motion_objective`, the least
  clearance on every edge. Refinement lowers the latter.
- On the lattice, where F counts, a large delta lets some paths pass obstacles closely between two
  nodes. {refined}
- "Problems with less than half" have less than half of the clearance that they have at the delta
  before.
"""


def monotone(groups):
    """What happens to quartiles and least clearance as delta grows, in a sentence."""
    quantiles = np.array(
        [np.quantile([p.clearance for p in g], [0, 0.25, 0.5, 0.75]) for g in groups]
    )
    if np.all(np.diff(quantiles, axis=0) >= -1e-4):
        return "After refinement neither a quartile nor the least clearance shrinks as delta grows."
    return "After refinement a quartile or the least clearance still shrinks at one of the steps."


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    add_problems_option(parser)
    parser.add_argument("--out", type=Path, default=RESULTS / "clearance_weight.md")
    given = parser.parse_args()
    begin = time.process_time()
    fp.plan(fp.load_scenario("fig2a"))  # compiles
    rows, numbers = [], [case.number for case in cases(NUMBERS[: given.problems], 0.0)]
    for refine in (False, True):
        before, groups = None, []
        for delta in DELTAS:
            plans = [planned(number, delta, refine) for number in numbers]
            rows.append(row(delta, refine, plans, before))
            before = plans
            groups.append(plans)
            print(f"{rows[-1]} {time.process_time() - begin:.0f} s", file=sys.stderr)
    text = TEXT.format(
        command=f"python -m benchmarks.studies.planners.clearance_weight "
        f"--problems {given.problems}",
        count=len(numbers),
        problems=given.problems,
        minutes=(time.process_time() - begin) / 60.0,
        results=table(HEADER, rows),
        refined=monotone(groups),
    )
    publish(text, given.out)


if __name__ == "__main__":
    main()
