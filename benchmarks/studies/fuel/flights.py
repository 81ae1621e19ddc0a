"""Durations and delta-v of flights: rests at corners, smooth, least fuel, and the straight line.

    python -m benchmarks.studies.fuel.flights

times plans of the paper's scenarios, of problems of family `paper` and of gates, verifies every
flight, and writes docs/benchmarks/flights_and_fuel.md.
"""

import argparse
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.paper_scenes import NUMBERS, add_problems_option, paper_problem, problem_name
from benchmarks.report_pages import RESULTS, publish, table
from benchmarks.studies.attitude.gates import variation

LIMITS = {"joint_acceleration": 0.05, "thruster_acceleration": 0.01}
DELTA = 0.05
SPARE = 0.99
"""Share of the plan's proven clearance that `LeastFuel` keeps: a margin has to be less."""
GATES = ("gate", "double_gate")
FIG2A = 423.0
"""[s] at which fig2a is flown too."""


class Flights(NamedTuple):
    """Flights of one problem.

    Attributes:
        rests: with a rest at every corner, the law before smooth curves.
        fastest: along the smooth curve.
        calm: along it, in the time of `rests`.
        fuel: along the smooth curve of `LeastFuel`, in that time; None where there is no such path.
        verified: flights that verify, and their number.
        seconds: processor time of the verification of each [s].
    """

    rests: fp.TimedPlan
    fastest: fp.SmoothFlight
    calm: fp.SmoothFlight
    fuel: fp.SmoothFlight | None
    verified: tuple[int, int]
    seconds: list[float]


def least_fuel(plan: fp.Plan) -> fp.Plan | None:
    """The path of least fuel at the plan's clearance; None where the planner has none."""
    problem = plan.problem
    if problem.lattice is None or problem.lattice.postures:
        return None
    try:
        return fp.plan(problem, fp.LeastFuel(margin=SPARE * plan.certificate.least_clearance))
    except fp.PlanningError:
        return None


def flights_of(plan: fp.Plan) -> Flights:
    """Time a plan in every way, and verify the flights."""
    rests, fastest = plan.timed(**LIMITS, corners="rest"), plan.timed(**LIMITS)
    calm, other = plan.timed(**LIMITS, duration=rests.duration), least_fuel(plan)
    fuel = None if other is None else other.timed(**LIMITS, duration=rests.duration)
    every = [flight for flight in (rests, fastest, calm, fuel) if flight is not None]
    verified, seconds = 0, []
    for flight in every:
        begin = time.process_time()
        report = flight.verify()
        seconds.append(time.process_time() - begin)
        verified += report.ok
        if not report.ok:
            print(plan, flight, report.problems, flush=True)
    return Flights(rests, fastest, calm, fuel, (verified, len(every)), seconds)


def family_flights(numbers: range) -> list[Flights]:
    """Those of the problems of family `paper` that have a path."""
    found = []
    for number in numbers:
        try:
            plan = fp.plan(paper_problem(number, DELTA), fp.LatticeOptimum())
        except fp.PlanningError:
            continue
        found.append(flights_of(plan))
        print(problem_name(number), found[-1].rests, found[-1].calm, found[-1].fuel, flush=True)
    return found


def row(name: str, each: list[Flights]) -> list[str]:
    """Medians of durations and delta-v."""
    fuel = [flights.fuel.delta_v for flights in each if flights.fuel is not None]

    def median(values: list[float], digits: int) -> str:
        return f"{np.median(values):.{digits}f}" if values else "-"

    return [
        name,
        median([f.rests.duration for f in each], 0),
        median([f.rests.delta_v for f in each], 2),
        median([f.fastest.duration for f in each], 0),
        median([f.fastest.delta_v for f in each], 2),
        median([f.calm.delta_v for f in each], 3),
        median(fuel, 3),
        median([f.calm.straight_delta_v for f in each], 3),
    ]


def ratio_rows(each: list[Flights]) -> list[list[str]]:
    """Median, least and greatest of ratios."""
    both = [f for f in each if f.fuel is not None]
    named = {
        "duration, rests / smooth": [f.rests.duration / f.fastest.duration for f in each],
        "delta-v, rests / smooth": [f.rests.delta_v / f.fastest.delta_v for f in each],
        "delta-v, rests / smooth in the same time": [
            f.rests.delta_v / f.calm.delta_v for f in each
        ],
        "delta-v, rests / least fuel in the same time": [
            f.rests.delta_v / f.fuel.delta_v for f in both
        ],
        "delta-v, smooth / least fuel in the same time": [
            f.calm.delta_v / f.fuel.delta_v for f in both
        ],
        "delta-v, least fuel / straight line in the same time": [
            f.fuel.delta_v / f.fuel.straight_delta_v for f in both
        ],
    }
    return [
        [name, f"{len(v)}", *(f"{g(v):.2f}" for g in (np.median, np.min, np.max))]
        for name, v in named.items()
    ]


HEADER = (
    "problem", "rests: s", "m/s", "smooth, fastest: s", "m/s", "smooth, time of rests: m/s",
    "least fuel: m/s", "straight line: m/s",
)  # fmt: skip
RATIOS = ("ratio", "problems", "median", "least", "greatest")
TEXT = """# Durations and delta-v of flights

`python -m benchmarks.studies.fuel.flights --problems {problems} --variations {variations}`

Joints may accelerate at {joints:g} rad/s^2, thrusters at {thrust:g} m/s^2; the limits on velocity
are the URDF's. {count} of {problems} problems of family `paper` of
[the problem set](../howto/problem_set.md) have a path and are planned with delta {delta:g} and
`LatticeOptimum()`, refined; gates are the variations of [gates.md](gates.md), the others have the
planner of their scenario.

{results}

Rows of several problems hold medians. Rests: `plan.timed(corners="rest")`. Smooth: the default, the
fastest, and with the duration of the flight with rests. Least fuel: `LeastFuel` at {spare:.0f} % of
the plan's proven clearance in the same time; it has no lattices with posture axes, such as those of
gates. Straight line: one push, a coast and one push in the same time, if nothing were in the way.

## Family `paper`, medians of ratios

{ratios}

## fig2a at {fig2a:g} s

{smooth:.4f} m/s along the smooth curve of the plan, {fuel} m/s along that of `LeastFuel` at the
plan's clearance; {straight:.4f} m/s along the straight line.

## Verification

{ok} of {flights} flights verify (`flight.verify()`), in {seconds:.2f} s of processor time in the
median, {most:.2f} s at most.
"""


def main() -> None:
    """Run the study and write its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    add_problems_option(parser)
    parser.add_argument("--variations", type=int, default=3, help="of each gate")
    parser.add_argument("--out", type=Path, default=RESULTS / "flights_and_fuel.md")
    given = parser.parse_args()
    groups = {f"`{name}`": [fp.plan(fp.load_scenario(name), seed=0)] for name in ("fig2a", "fig2b")}
    fig2a = groups["`fig2a`"][0]
    flown = {name: [flights_of(plan) for plan in plans] for name, plans in groups.items()}
    for name in GATES:
        plans = (fp.plan(variation(name, k), seed=0) for k in range(given.variations))
        flown[f"`{name}`, {given.variations} variations"] = [flights_of(plan) for plan in plans]
    family = family_flights(NUMBERS[: given.problems])
    flown[f"{len(family)} problems of family `paper`"] = family
    every = [flights for group in flown.values() for flights in group]
    seconds = [each for flights in every for each in flights.seconds]
    calm, fuel = fig2a.timed(**LIMITS, duration=FIG2A), least_fuel(fig2a)
    text = TEXT.format(
        problems=given.problems,
        variations=given.variations,
        joints=LIMITS["joint_acceleration"],
        thrust=LIMITS["thruster_acceleration"],
        count=len(family),
        delta=DELTA,
        results=table(HEADER, [row(name, group) for name, group in flown.items()]),
        spare=100 * SPARE,
        ratios=table(RATIOS, ratio_rows(family)),
        fig2a=FIG2A,
        smooth=calm.delta_v,
        fuel="-" if fuel is None else f"{fuel.timed(**LIMITS, duration=FIG2A).delta_v:.4f}",
        straight=calm.straight_delta_v,
        ok=sum(flights.verified[0] for flights in every),
        flights=sum(flights.verified[1] for flights in every),
        seconds=np.median(seconds),
        most=max(seconds),
    )
    publish(text, given.out)


if __name__ == "__main__":
    main()
