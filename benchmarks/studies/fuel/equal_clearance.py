"""Delta-v of `LeastFuel` plans and of F-optimal plans, at a margin of 2 cm and at equal clearance.

    python -m benchmarks.studies.fuel.equal_clearance

plans problems of family `paper` by the optimum of F, refined, and by `LeastFuel`, and writes
docs/benchmarks/least_fuel.md.
"""

import argparse
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import ffsr_plan as fp
from benchmarks.paper_scenes import NUMBERS, add_problems_option, paper_problem
from benchmarks.report_pages import RESULTS, publish, table

DELTAS = (0.0, 0.001, 0.05)
WEIGHT = 0.05
"""Delta of the F-optimal paths whose clearance is asked for."""
MARGIN = 0.02
SPARE = 0.99
"""Share of the F-optimal path's proven clearance that is asked for: a margin has to be less."""


def curve_change(positions):
    """Change of velocity along the smooth curve of control points, for unit duration [m]."""
    m, steps = len(positions) - 1, np.diff(positions, axis=0)
    turns = np.zeros_like(positions)
    turns[1:-1] = np.diff(steps, axis=0)
    t = (np.arange(64) + 0.5)[:, None, None] / 64
    along = np.linalg.norm((1.0 - t) * turns[:-1] + t * turns[1:], axis=2).mean(axis=0).sum()
    return m * float(along + np.linalg.norm(steps[[0, -1]], axis=1).sum())


@dataclass
class Case:
    """One problem: changes of velocity of curves [m], and what `LeastFuel` took."""

    number: int
    by_delta: dict[float, float]
    at_margin: float
    at_clearance: float | None
    clearance: float
    reached: float | None
    seconds: list[float]
    kinds: list[str]
    gaps: list[float]


def least_fuel(problem, margin):
    """A plan, or None without a path, and its processor time [s]."""
    begin = time.process_time()
    try:
        plan = fp.plan(problem, fp.LeastFuel(margin=margin))
    except (fp.PlanningError, fp.InvalidInput):
        plan = None
    return plan, time.process_time() - begin


def examine(number):
    """A `Case`; None if the problem has no path."""
    try:
        optimal = {d: fp.plan(paper_problem(number, d), fp.LatticeOptimum()) for d in DELTAS}
    except fp.PlanningError:
        return None
    wide, problem = optimal[WEIGHT], paper_problem(number, WEIGHT)
    first, spent = least_fuel(problem, MARGIN)
    if first is None:
        return None
    second, more = least_fuel(problem, SPARE * wide.certificate.least_clearance)
    plans = [plan for plan in (first, second) if plan is not None]
    return Case(
        number=number,
        by_delta={d: curve_change(plan.motion.positions) for d, plan in optimal.items()},
        at_margin=curve_change(first.motion.positions),
        at_clearance=None if second is None else curve_change(second.motion.positions),
        clearance=wide.certificate.least_clearance,
        reached=None if second is None else second.certificate.least_clearance,
        seconds=[spent, more],
        kinds=[plan.smooth().kind for plan in plans],
        gaps=[plan.fuel.gap for plan in plans if plan.fuel.gap is not None],
    )


def share(ratios):
    """Median, least and greatest change, as percentages."""
    percent = 100.0 * (np.array(ratios) - 1.0)
    return [f"{len(percent)}", *(f"{f(percent):.0f}" for f in (np.median, np.min, np.max))]


def rows(cases):
    """The lines of the table."""
    for delta in DELTAS:
        ratios = [case.at_margin / case.by_delta[delta] for case in cases]
        yield [f"margin {100 * MARGIN:g} cm, against delta {delta:g}", *share(ratios)]
    both = [case for case in cases if case.at_clearance is not None]
    ratios = [case.at_clearance / case.by_delta[WEIGHT] for case in both]
    yield [f"**equal clearance, against delta {WEIGHT:g}**", *share(ratios)]


HEADER = ("`LeastFuel` with", "plans", "median [%]", "least [%]", "greatest [%]")
TEXT = """# Delta-v of paths of least fuel

`python -m benchmarks.studies.fuel.equal_clearance --problems {problems}`

{count} of {problems} problems of family `paper` of [the problem set](../howto/problem_set.md),
those that have a path. Their F-optimal plans are `LatticeOptimum()`, refined; `LeastFuel` has
default settings but for the margin. Compared is the total change of velocity along the
smooth curve of the plan's nodes at constant pace, by which delta-v at a given duration differs.

{results}

Equal clearance: the margin is {spare:.0f} % of the proven clearance of the F-optimal path.
{missing}
The proven clearance is then {reached:+.1f} % of it in the median. `LeastFuel` takes {seconds:.2f} s
of processor time in the median, {most:.2f} s at most. The smooth curve is proven as it is
(`plan.smooth().kind == "spline"`) for {spline} of {plans} plans. The search on the planner's
lattice is exact: gap 0 in {exact} of {gaps} plans.

On `fig2a` at 200 s and a margin of 2 cm the bound on delta-v is {fig2a:.4f} m/s; along the straight
line it is 0.1 m/s.
"""


def main():
    """Run the study and write its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    add_problems_option(parser)
    parser.add_argument("--out", type=Path, default=RESULTS / "least_fuel.md", help="the report")
    given = parser.parse_args()
    fig2a = fp.plan(fp.load_scenario("fig2a"), fp.LeastFuel(margin=MARGIN))
    numbers = NUMBERS[: given.problems]
    cases = [case for case in map(examine, numbers) if case is not None]
    both = [case for case in cases if case.reached is not None]
    lost = len(cases) - len(both)
    kinds = [kind for case in cases for kind in case.kinds]
    gaps = [gap for case in cases for gap in case.gaps]
    seconds = [each for case in cases for each in case.seconds]
    change = np.median([case.reached / case.clearance - 1.0 for case in both])
    text = TEXT.format(
        count=len(cases),
        problems=given.problems,
        results=table(HEADER, rows(cases)),
        spare=100 * SPARE,
        missing=f"With it no path was found and proven in {lost} of {len(cases)} problems.",
        reached=100 * change,
        seconds=np.median(seconds),
        most=max(seconds),
        spline=kinds.count("spline"),
        plans=len(kinds),
        exact=sum(gap == 0.0 for gap in gaps),
        gaps=len(gaps),
        fig2a=fig2a.fuel.delta_v(200.0),
    )
    publish(text, given.out)


if __name__ == "__main__":
    main()
