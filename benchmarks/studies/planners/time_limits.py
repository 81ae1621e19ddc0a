"""By how much `plan` returns later than its time limit, on all bundled scenarios.

    python -m benchmarks.studies.planners.time_limits

plans every scenario under limits from 20 ms to 5 s with several seeds, kernels loaded, and writes
docs/benchmarks/time_limits.md. A limit of T is kept if `plan` returns or raises within 1.05 T + 20
ms. It takes some minutes. Run it on an idle machine: times are those of the clock on the wall.
"""

import argparse
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table
from ffsr_plan.core import bundled_files

LIMITS = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
SHARE, SECONDS = 0.05, 0.02


class Call(NamedTuple):
    """One call of `plan`.

    Attributes:
        overrun: time beyond the limit, its tolerance included [s]; negative if it was kept.
        outcome: `whole`, `cut` for a plan that the limit cut short, or `none` without a plan.
    """

    overrun: float
    outcome: str


def call(problem: fp.Problem, limit: float, seed: int) -> Call:
    """Plan once under a limit."""
    begin = time.monotonic()
    try:
        outcome = "cut" if fp.plan(problem, seed=seed, time_limit=limit).interrupted else "whole"
    except fp.PlanningError:
        outcome = "none"
    elapsed = time.monotonic() - begin
    return Call(elapsed - (1.0 + SHARE) * limit - SECONDS, outcome)


def cell(calls: list[Call]) -> str:
    """The largest overrun [ms], and how many of the plans are whole, cut short and missing."""
    counts = [sum(each.outcome == name for each in calls) for name in ("whole", "cut", "none")]
    worst = 1e3 * float(np.max([each.overrun for each in calls]))
    return f"{worst:.0f} ({' / '.join(map(str, counts))})"


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--runs", type=int, default=5, help="seeds for each limit")
    parser.add_argument("--out", type=Path, default=RESULTS, help="directory")
    args = parser.parse_args()
    rows, kept, total = [], 0, 0
    for name in bundled_files.names("scenarios", ".toml"):
        problem = fp.load_scenario(name)
        for limit in (5.0, 0.2, 0.5):
            call(problem, limit, 0)  # compiled, loaded, and in the caches
        cells = []
        for limit in LIMITS:
            calls = [call(problem, limit, seed) for seed in range(args.runs)]
            kept += sum(each.overrun <= 0.0 for each in calls)
            total += len(calls)
            cells.append(cell(calls))
        rows.append([name, *cells])
    header = ["scenario", *(f"{limit:g} s" for limit in LIMITS)]
    publish(
        "# Time limits\n\n"
        f"    python -m benchmarks.studies.planners.time_limits --runs {args.runs}\n\n"
        "Time [ms] by which `plan(problem, time_limit=T)` returns, or raises `OutOfTime`, later "
        f"than {1.0 + SHARE:g} T + {1e3 * SECONDS:g} ms, from its call on, with kernels loaded: "
        f"the largest of {args.runs} seeds; negative where it is earlier. In brackets how many "
        "plans are whole, cut short with a proven path, and missing because no path was proven "
        f"in time. {kept} of {total} calls keep the limit.\n\n"
        f"{table(header, rows)}\n",
        args.out / "time_limits.md",
    )


if __name__ == "__main__":
    main()
