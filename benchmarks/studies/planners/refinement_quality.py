"""F of the whole motion after refinement relative to the best known, and the gain and time.

    python -m benchmarks.studies.planners.refinement_quality

plans problems of family `paper` with default settings, compares F of the whole motion with the
least one on finer lattices with the same number of divisions, and writes
docs/benchmarks/refinement.md.
"""

import argparse
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import ffsr_plan as fp
from benchmarks.paper_scenes import (
    LATTICE,
    NUMBERS,
    add_problems_option,
    paper_problem,
    problem_name,
)
from benchmarks.report_pages import RESULTS, publish, table

DELTAS = (0.0, 0.1, 2.0, 6.0)
FINEST_DELTAS = (0.0, 6.0)
TARGET = 1e-3
ROUNDING = 1e-12


@dataclass
class Case:
    """One problem at one delta for which the default plan has a path."""

    number: int
    lattice_f: float
    refined_f: float
    rivals: dict[str, float]
    milliseconds: float
    verified: bool

    @property
    def excess(self):
        """F after refinement above the best known, relative."""
        return self.refined_f / min(self.refined_f, *self.rivals.values()) - 1.0


def finer(times):
    """The lattice with its lateral spacing divided by `times`, in the same window."""
    axis = LATTICE.lateral
    return fp.Lattice(LATTICE.divisions, fp.Axis(axis.half_count * times, axis.spacing / times))


def rival(number, delta, times, refine):
    """F of the whole motion from the optimum on a finer lattice; infinite if it has no path."""
    try:
        problem = paper_problem(number, delta, finer(times))
        return fp.plan(problem, fp.LatticeOptimum(), refine=refine).motion_objective
    except fp.NoPath:
        return np.inf


def examine(number, delta, finest):
    """A `Case`, or None if the default plan has no path; whether a finer lattice has a path."""
    problem = paper_problem(number, delta)
    rivals = {
        "4 times finer": rival(number, delta, 4, False),
        "4 times finer, refined": rival(number, delta, 4, True),
    }
    if finest:
        rivals["16 times finer, refined"] = rival(number, delta, 16, True)
    try:
        before, after = fp.plan(problem, refine=False), fp.plan(problem)
    except fp.NoPath:
        return None, min(rivals.values()) < np.inf
    begin = time.process_time()
    fp.refine(before)
    spent = 1e3 * (time.process_time() - begin)
    verified = after.verify(samples=100).ok
    return Case(
        number, before.motion_objective, after.motion_objective, rivals, spent, verified
    ), True


def row(delta, cases):
    excess = np.array([c.excess for c in cases])
    gain = [1.0 - c.refined_f / c.lattice_f for c in cases]
    worst = cases[int(np.argmax(excess))]
    return [
        f"{delta:g}",
        f"{len(cases)}",
        f"{100 * np.median(excess):.4f}",
        f"{100 * np.quantile(excess, 0.9):.3f}",
        f"{100 * worst.excess:.3f} ({problem_name(worst.number)})" if worst.excess > 0.0 else "0",
        f"{np.sum(excess <= TARGET)}",
        f"{100 * np.median(gain):.2f}",
        f"{np.median([c.milliseconds for c in cases]):.0f}",
        f"{sum(c.refined_f > c.lattice_f * (1.0 + ROUNDING) for c in cases)}",
        f"{sum(c.verified for c in cases)}",
    ]


HEADER = (
    "delta",
    "plans",
    "above the best known: median [%]",
    "90th percentile [%]",
    "worst [%]",
    f"plans within {100 * TARGET:g} %",
    "F saved by refinement, median [%]",
    "refinement, median [ms]",
    "F rose",
    "verified",
)
TEXT = """# How close refinement comes

`{command}`

{problems} problems of family `paper` of [the problem set](../howto/problem_set.md), each with every
delta: default plan on the lattice of {divisions} divisions and {nodes} nodes a layer. Times are
processor times; {minutes:.1f} minutes in all.

{results}

{rivals}

- F is that of the whole motion, `plan.motion_objective`, which refinement lowers.
- The best known F is the least of the default plan and of the plan from the optimum of a lattice
  with four times finer lateral spacing, refined or not, and, for delta = {finest} in the
  first {subset} problems, of a refined one of a 16 times finer lattice. Layers and window are the
  same, so that F is.
- "F rose" counts plans whose F is higher than that of their path on the lattice; "verified" those
  that pass `plan.verify(samples=100)`. The time is that of `fp.refine` alone; within `plan()`,
  where the clearances of the nodes are known, it is less.
- Without a plan, since the lattice has no path: {missing} of {all}; the finer lattices have one in
  {opened} of these.
"""


def below(differences):
    return int(np.sum(np.array(differences) < -TARGET))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    add_problems_option(parser)
    parser.add_argument("--finest", type=int, default=28, help="those with a 16 times finer rival")
    parser.add_argument("--out", type=Path, default=RESULTS / "refinement.md", help="the report")
    given = parser.parse_args()
    begin = time.process_time()
    for planner in (None, fp.LatticeOptimum()):
        fp.plan(fp.load_scenario("fig2a"), planner)  # compiles
    cases, opened = {delta: [] for delta in DELTAS}, []
    for delta in DELTAS:
        for k, number in enumerate(NUMBERS[: given.problems]):
            finest = delta in FINEST_DELTAS and k < given.finest
            case, exists = examine(number, delta, finest)
            cases[delta] += [case] if case else []
            opened += [] if case else [exists]
        print(f"delta = {delta:g}: {time.process_time() - begin:.0f} s", file=sys.stderr)
    every = [c for group in cases.values() for c in group]
    best = {}
    for case in every:
        for name, value in case.rivals.items():
            best.setdefault(name, []).append(value / case.refined_f - 1.0)
    against = [
        [name, f"{len(d)}", f"{100 * np.median(d):+.4f}", f"{below(d)}", f"{below(-np.array(d))}"]
        for name, d in best.items()
    ]
    names = ["rival, all deltas", "plans", "F against ours, median [%]", "lower", "higher"]
    text = TEXT.format(
        command=f"python -m benchmarks.studies.planners.refinement_quality "
        f"--problems {given.problems} --finest {given.finest}",
        problems=given.problems,
        divisions=LATTICE.divisions,
        nodes=2 * LATTICE.lateral.half_count + 1,
        minutes=(time.process_time() - begin) / 60.0,
        results=table(HEADER, [row(d, group) for d, group in cases.items() if group]),
        rivals=table(names, against),
        finest=" and ".join(f"{d:g}" for d in FINEST_DELTAS),
        subset=min(given.finest, given.problems),
        missing=len(opened),
        all=len(DELTAS) * given.problems,
        opened=sum(opened),
    )
    publish(text, given.out)


if __name__ == "__main__":
    main()
