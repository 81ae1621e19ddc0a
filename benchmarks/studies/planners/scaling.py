"""Search time against ants, cycles, divisions and nodes in a layer.

    python -m benchmarks.studies.planners.scaling

varies one of them at a time around 30 ants x 242 cycles on 41 x 41 nodes, over problems
of family `paper` with delta = 2, fits exponents, and writes docs/benchmarks/scaling.md
and scaling.png. It takes about two minutes.

With its default settings the Ant System stops early by stagnation, and no exponent could be fitted.
Here rho = 0.999999 and Q = 1e-9: the pheromone stays uniform and all cycles run.
"""

import argparse
import time
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np

import ffsr_plan as fp
from benchmarks.paper_scenes import NUMBERS, cases, paper_problem, problem_name
from benchmarks.report_pages import RESULTS, publish, table

DELTA = 2.0
DEFAULTS = {"ants": 30, "cycles": 242, "divisions": 40, "nodes": 41}
VALUES = {
    "ants": (30, 120, 480, 1920),
    "cycles": (242, 968, 3872, 15488),
    "divisions": (20, 40, 80, 160),
    "nodes": (21, 41, 81, 161, 321),
}
WIDTH = 6.0  # [m] of the lateral window, however many nodes it holds
TIMES = ("search", "plan")
COLOURS = {"AntSystem": "tab:orange", "MaxMinAntSystem": "tab:blue"}


class Law(NamedTuple):
    """Times of one planner while one size varies.

    Attributes:
        planner: name of the planner.
        size: name of the size that varies, a key of `VALUES`.
        kind: "search" alone, or "plan" as a whole.
        seconds: CPU time for each value [s].
    """

    planner: str
    size: str
    kind: str
    seconds: list[float]

    @property
    def exponent(self) -> float:
        """Slope of the least-squares line through log time against log size."""
        return float(np.polyfit(np.log(VALUES[self.size]), np.log(self.seconds), 1)[0])

    @property
    def last(self) -> float:
        """The same between the two largest sizes."""
        (small, large), (short, long) = VALUES[self.size][-2:], self.seconds[-2:]
        return float(np.log(long / short) / np.log(large / small))


def planners(ants: int, cycles: int) -> dict[str, fp.AntSystem | fp.MaxMinAntSystem]:
    """The planners that are timed, by name."""
    return {
        "AntSystem": fp.AntSystem(ants=ants, cycles=cycles, rho=0.999999, Q=1e-9),
        "MaxMinAntSystem": fp.MaxMinAntSystem(ants=ants, cycles=cycles),
    }


def lattice(divisions: int, nodes: int) -> fp.Lattice:
    """A lattice of constant lateral width."""
    return fp.Lattice(divisions, fp.Axis(nodes // 2, WIDTH / (nodes - 1)))


def measure(
    numbers: list[int], repeats: int, ants: int, cycles: int, divisions: int, nodes: int
) -> dict[tuple[str, str], float]:
    """Mean over the problems of the least CPU time [s], by planner and kind of time.

    Every search gets a new roadmap; a copy without edge states would keep the prover's bounds.
    """
    problems = [paper_problem(n, DELTA, lattice(divisions, nodes)) for n in numbers]
    seconds = {}
    for name, planner in planners(ants, cycles).items():
        least = np.full((2, len(numbers)), np.inf)
        for k, problem in enumerate(problems):
            for repeat in range(repeats):
                fresh, rng = fp.Roadmap(problem), np.random.default_rng(repeat)
                np.sum(fresh.clearances)  # evaluates all nodes now; otherwise on first use
                begin = time.process_time()
                found = planner.search(fresh, rng)
                between = time.process_time()
                fp.plan(problem, planner, seed=repeat, refine=False)
                spent = (between - begin, time.process_time() - between)
                least[:, k] = np.minimum(least[:, k], spent)
                if len(found.history.best) != cycles:
                    raise RuntimeError(f"{name} stopped early, no exponent can be fitted")
        seconds |= {(name, kind): float(least[i].mean()) for i, kind in enumerate(TIMES)}
    return seconds


def draw(laws: list[Law], out: Path) -> None:
    """One panel for each size, on logarithmic axes."""
    figure, panels = plt.subplots(1, 4, figsize=(14, 4.4), sharey=True)
    for axes, size in zip(panels, VALUES, strict=True):
        for law in (law for law in laws if law.size == size):
            axes.loglog(
                VALUES[size], law.seconds, "o-" if law.kind == "search" else "s:", ms=4,
                color=COLOURS[law.planner], label=f"{law.planner}, {law.kind}: {law.exponent:.2f}",
            )  # fmt: skip
        axes.set_xticks(VALUES[size], [f"{v}" for v in VALUES[size]])
        axes.minorticks_off()
        axes.set_xlabel({"nodes": "nodes a layer"}.get(size, size))
        axes.grid(alpha=0.3)
        axes.legend(fontsize=7, title="fitted exponents", title_fontsize=7, loc="upper left")
    panels[0].set_ylabel("CPU time [s]")
    low, high = panels[0].get_ylim()
    panels[0].set_ylim(low, high * 4.0)  # room for the legends
    figure.tight_layout()
    figure.savefig(out, dpi=110)


def reading(laws: list[Law]) -> str:
    """Comparison of the exponents with O(M_h K), M_h ants times K cycles."""
    lines = []
    for name in COLOURS:
        fits = {law.size: law for law in laws if (law.planner, law.kind) == (name, "search")}
        both = [fits["ants"].exponent, fits["cycles"].exponent]
        if max(abs(exponent - 1.0) for exponent in both) <= 0.1:
            verdict = "O(M_h K) holds to a tenth in the exponents"
        elif max(both) <= 1.1:
            verdict = (
                "in this range time grows more slowly than M_h K, which bounds it but is not its "
                "law: a part of the time does not depend on ants, or on cycles"
            )
        else:
            verdict = "O(M_h K) does not hold"
        numbers = ", ".join(f"{law.exponent:.2f} in {size}" for size, law in fits.items())
        lines.append(f"- {name}, search: {verdict}. Exponents: {numbers}.")
    return "\n".join(lines)


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--problems", type=int, default=2, help="of which the mean is taken")
    parser.add_argument("--repeats", type=int, default=1, help="of which the least time counts")
    parser.add_argument("--out", type=Path, default=RESULTS, help="directory")
    args = parser.parse_args()
    # problems with a path on the coarsest lattices have one on all that are measured here
    coarsest = lattice(20, 41), lattice(40, 21)
    fit = (n for n in NUMBERS if all(list(cases([n], DELTA, each)) for each in coarsest))
    numbers = list(islice(fit, args.problems))
    measure(numbers[:1], 1, **DEFAULTS)  # compiled before the clock runs
    laws, rows = [], []
    for size, values in VALUES.items():
        found = [measure(numbers, args.repeats, **DEFAULTS | {size: value}) for value in values]
        for name, kind in found[0]:
            law = Law(name, size, kind, [times[name, kind] for times in found])
            laws.append(law)
            span = [
                f"{values[0]} to {values[-1]}",
                *(f"{1e3 * law.seconds[i]:.0f}" for i in (0, -1)),
            ]
            rows.append([f"{name}, {kind}", size, *span, f"{law.exponent:.2f}", f"{law.last:.2f}"])
    args.out.mkdir(parents=True, exist_ok=True)
    draw(laws, args.out / "scaling.png")
    header = ["planner, time", "size", "from", "first ms", "last ms", "exponent", "last two"]
    publish(
        "# Scaling\n\n"
        f"    python -m benchmarks.studies.planners.scaling --problems {args.problems} "
        f"--repeats {args.repeats}\n\n"
        f"One size at a time around {DEFAULTS}, the lateral window always {WIDTH:g} m wide; CPU "
        f"time, mean over "
        f"{', '.join(map(problem_name, numbers))} of [the problem set](../howto/problem_set.md), "
        f"delta = {DELTA:g}. 'search' leaves out the "
        "roadmap and the clearances of all its nodes, 'plan' is the whole of `plan(refine=False)`, "
        "exact optimum included; the last column is the exponent between the two largest sizes. "
        "The Ant System runs with rho = 0.999999 and Q = 1e-9, so that pheromone stays flat and "
        "it does not stop early by stagnation; MaxMinAntSystem as is, with pheromone on edges "
        "below 100 nodes a layer and on nodes above.\n\n"
        f"{table(header, rows)}\n\n{reading(laws)}\n\n![times and exponents](scaling.png)\n",
        args.out / "scaling.md",
    )


if __name__ == "__main__":
    main()
