"""Gap of the colonies to the exact lattice optimum, and an ablation of their parts.

    python -m benchmarks.studies.planners.gap --problems 28 --runs 9

runs the Ant System, the default colony and its ablations on problems of family `paper` for four
deltas, refinement off, and writes docs/benchmarks/gap.md.
It takes about six minutes.
"""

import argparse
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.paper_scenes import NUMBERS, Case, add_problems_option, cases, gap
from benchmarks.report_pages import RESULTS, publish, table

DELTAS = (0.0, 0.1, 2.0, 6.0)
ENOUGH = 1e-3  # a gap above this counts
FULL = "MaxMinAntSystem"
PARTS = {
    "local search": {"improved": 0},
    "cost-aware visibility": {"cost_aware": False},
    "restarts": {"patience": 0},
    "pheromone": {"pheromone": False},
}
"""The parts of the default colony, and the settings that disable them."""
NEITHER = "without local search and pheromone"
PLANNERS = {
    "AntSystem": fp.AntSystem(),
    FULL: fp.MaxMinAntSystem(),
    **{f"without {part}": fp.MaxMinAntSystem(**off) for part, off in PARTS.items()},
    NEITHER: fp.MaxMinAntSystem(**PARTS["local search"], **PARTS["pheromone"]),
}


class Runs(NamedTuple):
    """All runs of a planner, in the same order for all planners.

    Attributes:
        gaps: gap of each run; infinite without a path.
        seconds: CPU time [s].
        cycles: cycles until the best path was within 0.1 % of the optimum; infinite if never.
    """

    gaps: np.ndarray
    seconds: np.ndarray
    cycles: np.ndarray

    @property
    def above(self) -> float:
        """Share of runs above 0.1 %, failures included."""
        return float(np.mean(self.gaps > ENOUGH))


def run(planner: fp.AntSystem | fp.MaxMinAntSystem, case: Case, seed: int) -> tuple[float, ...]:
    """Gap, CPU seconds and cycles to 0.1 % of one search; infinite without a path."""
    roadmap = case.roadmap.without_edge_states()
    begin = time.process_time()
    try:
        found = planner.search(roadmap, np.random.default_rng(seed))
    except fp.PlanningError:
        return np.inf, time.process_time() - begin, np.inf
    seconds = time.process_time() - begin
    near = np.flatnonzero(found.history.best <= case.optimum * (1.0 + ENOUGH))
    return gap(case, roadmap, found.path), seconds, near[0] + 1.0 if len(near) else np.inf


def measure(problems: int, runs: int) -> tuple[dict[str, Runs], int]:
    """All runs by planner, and how many problems have a path."""
    found: dict[str, list[tuple[float, ...]]] = {name: [] for name in PLANNERS}
    for delta in DELTAS:
        count = 0
        for case in cases(NUMBERS[:problems], delta):
            if delta == DELTAS[0] and count == 0:
                for planner in PLANNERS.values():  # compiled before the clock runs
                    run(planner, case, 0)
            count += 1
            for name, planner in PLANNERS.items():
                found[name] += [run(planner, case, seed) for seed in range(runs)]
        print(f"delta {delta:g}: {count} of {problems} problems have a path", flush=True)
    return {name: Runs(*np.array(list_).T) for name, list_ in found.items()}, count


def row(name: str, runs: Runs) -> list[str]:
    """A line of the table."""
    found = runs.gaps[np.isfinite(runs.gaps)]
    numbers = [np.median(found), *np.quantile(found, (0.95, 0.99)), found.max(), runs.above]
    share = [f"{100.0 * x:.2f}" for x in numbers]
    failures = len(runs.gaps) - len(found)
    quantiles = np.quantile(runs.cycles, (0.5, 0.95), method="higher")
    cycles = [f"{x:.0f}" if np.isfinite(x) else "never" for x in quantiles]
    milliseconds = f"{1e3 * np.median(runs.seconds):.0f}"
    return [name, f"{len(runs.gaps)}", *share, f"{failures}", *cycles, milliseconds]


def reading(runs: dict[str, Runs]) -> str:
    """Summary of the table in sentences."""
    above = {part: runs[f"without {part}"].above for part in PARTS}
    first, *others = sorted(PARTS, key=lambda part: -above[part])
    listed = ", ".join(f"without {part} {100.0 * above[part]:.2f} %" for part in (first, *others))
    extra, next_extra = (max(0.0, above[p] - runs[FULL].above) for p in (first, others[0]))
    if extra < 0.01:
        verdict = "Removing any one part alone makes no difference"
    elif extra > 5.0 * next_extra:
        verdict = f"The {first} matters most, far more than any other part"
    else:
        verdict = f"The {first} matters most, followed by the {others[0]}"
    at_optimum = [part for part in PARTS if above[part] <= runs[FULL].above]
    if at_optimum:
        verdict += (
            f". Without {' or '.join(at_optimum)} the final gap is no worse; the difference is in "
            "the "
            "number of cycles"
        )
    bare, neither = runs["without local search"], runs[NEITHER]
    return (
        f"**Ablation.** Runs more than {100.0 * ENOUGH:g} % above the optimum: "
        f"{100.0 * runs[FULL].above:.2f} % with all parts; {listed}. {verdict}.\n\n"
        "**Contribution of the pheromone**, run by run on the same problem and seed. With local "
        f"search: {compare(runs[FULL], runs['without pheromone'])}. "
        f"Without local search: {compare(bare, neither)}; the median gap is "
        f"{100.0 * np.median(bare.gaps):.2f} % with pheromone, "
        f"{100.0 * np.median(neither.gaps):.2f} % without."
    )


def compare(one: Runs, other: Runs) -> str:
    """How often pheromone made a run better or worse, in its end and in the cycles to 0.1 %."""
    change = np.minimum(one.gaps, 1e9) - np.minimum(other.gaps, 1e9)  # below 0.01 % is none
    better, worse = int(np.sum(change < -1e-4)), int(np.sum(change > 1e-4))
    sooner, later = int(np.sum(one.cycles < other.cycles)), int(np.sum(one.cycles > other.cycles))
    verdict = "hardly any difference" if better + worse < 0.01 * len(change) else "a difference"
    return (
        f"{verdict} in the final gap (of {len(change)} runs {better} are better with it, {worse} "
        "worse); "
        f"{sooner} reach {100.0 * ENOUGH:g} % in fewer cycles with it, {later} in more"
    )


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    add_problems_option(parser)
    parser.add_argument("--runs", type=int, default=9, help="seeds for each problem and delta")
    parser.add_argument("--out", type=Path, default=RESULTS / "gap.md")
    args = parser.parse_args()
    runs, count = measure(args.problems, args.runs)
    header = ["planner", "runs", "median", "95th", "99th", "worst", "above 0.1 %", "failures"]
    header += ["cycles to 0.1 %", "95th", "ms"]
    publish(
        "# Gap to the exact lattice optimum\n\n"
        f"    python -m benchmarks.studies.planners.gap --problems {args.problems} "
        f"--runs {args.runs}\n\n"
        f"{count} of {args.problems} problems of family `paper` of "
        "[the problem set](../howto/problem_set.md), those that have a path on the lattice, "
        f"delta in {', '.join(f'{d:g}' for d in DELTAS)}, {args.runs} seeds each, "
        "41 x 41 nodes, no refinement. Gaps and shares in percent; gaps are over the runs with a "
        "path, "
        "failures have their own column. The time is the median CPU time of the search with the "
        "proofs of its edges, on a roadmap whose nodes earlier searches have evaluated.\n\n"
        f"{table(header, [row(*item) for item in runs.items()])}\n\n{reading(runs)}\n",
        args.out,
    )


if __name__ == "__main__":
    main()
