"""Best F of the colonies against time, relative to the exact lattice optimum.

    python -m benchmarks.studies.planners.anytime

records the time of every cycle of the Ant System and of the default colony on four
problems of family `paper` with delta = 2, and writes docs/benchmarks/anytime.md and anytime.png. It
takes a few seconds.
"""

import argparse
import time
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

import ffsr_plan as fp
from benchmarks.paper_scenes import NUMBERS, Case, cases
from benchmarks.report_pages import RESULTS, publish, table
from ffsr_plan.lattice.optimum import lattice_optimum
from ffsr_plan.search.records import SearchMonitor

DELTA = 2.0
SCENES = 4
WITHIN = (0.1, 0.01, 0.001)
FLOOR = 1e-4  # [1] gaps below this are drawn here
COLOURS = {"AntSystem": "tab:orange", "MaxMinAntSystem": "tab:blue"}


class Descent(NamedTuple):
    """One search.

    Attributes:
        times: CPU time [s] since the search began, after each cycle.
        gaps: gap of the best path after each cycle.
    """

    times: np.ndarray
    gaps: np.ndarray

    def seconds_to(self, gap: float) -> float:
        """Time [s] at which the gap was first this small; infinite if never."""
        return float(np.min(self.times, where=self.gaps <= gap, initial=np.inf))


def descend(planner: fp.AntSystem | fp.MaxMinAntSystem, case: Case, seed: int) -> Descent:
    """Run one search and record the time of every cycle."""
    roadmap, stamps = fp.Roadmap(case.roadmap.problem), []
    begin = time.process_time()
    watch = SearchMonitor(
        on_cycle=lambda cycle: stamps.append((time.process_time() - begin, cycle.best))
    )
    planner.search(roadmap, np.random.default_rng(seed), watch)
    times, best = np.array(stamps).T
    return Descent(times, np.maximum(best / case.optimum - 1.0, 0.0))


def optimum_seconds(case: Case) -> float:
    """Median CPU time [s] of the exact optimum on the same roadmap."""
    times = []
    for _ in range(7):
        roadmap, begin = fp.Roadmap(case.roadmap.problem), time.process_time()
        lattice_optimum(roadmap)
        times.append(time.process_time() - begin)
    return float(np.median(times))


def draw(axes: Axes, case: Case, runs: dict[str, list[Descent]], exact: float) -> None:
    """One panel: the runs of all planners on one scene."""
    for name, descents in runs.items():
        for k, run in enumerate(descents):
            axes.step(
                1e3 * run.times, np.maximum(run.gaps, FLOOR), where="post",
                color=COLOURS[name], alpha=0.7, linewidth=1.3, label=name if k == 0 else None,
            )  # fmt: skip
            for place, marker in ((0, "|"), (-1, "o")):
                gap = max(run.gaps[place], FLOOR)
                axes.plot(1e3 * run.times[place], gap, marker, ms=5, color=COLOURS[name])
    axes.plot(1e3 * exact, FLOOR, "k*", ms=11, label="LatticeOptimum", clip_on=False, zorder=5)
    axes.set(xscale="log", yscale="log", title=case.name, ylim=(FLOOR * 0.8, 3.0))
    axes.set_yticks([1.0, 0.1, 0.01, 0.001, FLOOR], ["100 %", "10 %", "1 %", "0.1 %", "≤ 0.01 %"])
    axes.xaxis.set_major_formatter("{x:g}")
    axes.grid(alpha=0.3)
    axes.tick_params(axis="y", which="minor", left=False)


def cell(descents: list[Descent], gap: float) -> str:
    """Median time [ms] to a gap, over the runs; those that never reach it count as infinite."""
    times = [run.seconds_to(gap) for run in descents]
    reached = int(np.sum(np.isfinite(times)))
    median = np.median(times)
    number = f"{1e3 * median:.1f}" if np.isfinite(median) else "never"
    return number if reached in (0, len(times)) else f"{number} ({reached} of {len(times)})"


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--runs", type=int, default=5, help="seeds for each problem")
    parser.add_argument("--out", type=Path, default=RESULTS, help="directory")
    args = parser.parse_args()
    found = list(islice(cases(NUMBERS, DELTA), SCENES))
    planners = {"AntSystem": fp.AntSystem(), "MaxMinAntSystem": fp.MaxMinAntSystem()}
    rows = []
    figure, panels = plt.subplots(2, 2, figsize=(10, 7), sharex=True, sharey=True)
    for axes, case in zip(panels.flat, found, strict=True):
        for planner in planners.values():
            descend(planner, case, 0)  # compiled before the clock runs
        runs = {
            name: [descend(planner, case, seed) for seed in range(args.runs)]
            for name, planner in planners.items()
        }
        exact = optimum_seconds(case)
        draw(axes, case, runs, exact)
        for name, descents in runs.items():
            end = f"{100.0 * np.median([run.gaps[-1] for run in descents]):.2f}"
            whole = f"{1e3 * np.median([run.times[-1] for run in descents]):.0f}"
            times = [cell(descents, gap) for gap in WITHIN]
            rows.append([f"{case.name}, {name}", *times, whole, end])
        rows.append([f"{case.name}, LatticeOptimum", *3 * [""], f"{1e3 * exact:.1f}", "0.00"])
    for axes in panels[1]:
        axes.set_xlabel("CPU time of the search [ms]")
    for axes in panels[:, 0]:
        axes.set_ylabel("best F above the optimum")
    handles, labels = panels[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, ncols=3, loc="upper center", frameon=False)
    figure.tight_layout(rect=(0, 0, 1, 0.96))
    args.out.mkdir(parents=True, exist_ok=True)
    figure.savefig(args.out / "anytime.png", dpi=110)
    header = [
        "problem, planner",
        "to 10 %",
        "to 1 %",
        "to 0.1 %",
        "whole search",
        "gap at the end, %",
    ]
    publish(
        "# Best F against time\n\n"
        f"    python -m benchmarks.studies.planners.anytime --runs {args.runs}\n\n"
        f"Median CPU time [ms] over {args.runs} seeds until the best path is within 10, 1 and "
        f"0.1 % of the exact lattice optimum; the first {SCENES} problems of family `paper` of "
        f"[the problem set](../howto/problem_set.md) that have a path, delta = {DELTA:g}, 41 x 41 "
        "nodes. The times include the evaluation of nodes, the proofs of edges, and the recording "
        "of "
        "each cycle. In brackets the number of runs that reached the gap, if some did not.\n\n"
        f"{table(header, rows)}\n\n![best F against time](anytime.png)\n\n"
        "A line begins at the end of the first cycle (bar) and ends with the search (dot).\n",
        args.out / "anytime.md",
    )


if __name__ == "__main__":
    main()
