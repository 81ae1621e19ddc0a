"""Travel bound along curves against sampled travel on random intervals.

    python -m benchmarks.studies.proofs.curved_travel --robots 2800

samples the travel of every shape over parts of the pieces of random curves of random robots, in all
modes, and writes docs/benchmarks/curved_travel.md. It takes about an hour.
"""

import argparse
import time
from pathlib import Path

import numpy as np

from benchmarks.report_pages import RESULTS, publish, table
from tests.helpers.curved_flights import MODES, SAMPLES, random_curve, shares_of_the_bound

LENGTHS = (1.0, 1 / 2, 1 / 4, 1 / 8, 1 / 16, 1 / 32, 1 / 64)
"""Of an interval, in units of a piece."""


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--robots", type=int, default=2800)
    parser.add_argument("--first-seed", type=int, default=1000, help="of the robots")
    parser.add_argument("--out", type=Path, default=RESULTS / "curved_travel.md")
    args = parser.parse_args()
    begin, intervals, links, beyond = time.process_time(), 0, 0, 0
    found: dict[tuple[str, float], list[np.ndarray]] = {}
    kinds = [(mode, False) for mode in MODES] + [("in the base", True)]
    for seed in range(args.first_seed, args.first_seed + args.robots):
        rng = np.random.default_rng(seed)
        for name, in_base in kinds:
            curve = random_curve(seed, MODES[0] if in_base else name, edges=12)
            for length in LENGTHS:
                start = float(rng.uniform(0.0, 1.0 - length))
                shares = shares_of_the_bound(curve, start, start + length, in_base)
                intervals, links = intervals + len(shares), links + shares.size
                beyond += int(np.sum(shares > 1.0))
                found.setdefault((name, length), []).append(shares.ravel())
        if (seed + 1) % 200 == 0:
            print(f"{intervals} intervals, {time.process_time() - begin:.0f} s", flush=True)
    rows = []
    for name, _ in kinds:
        for length in LENGTHS:
            shares = np.concatenate(found[name, length])
            middle, high = np.quantile(shares[shares > 0.0], (0.5, 0.95))
            rows.append([name, f"1/{1 / length:.0f}"])
            rows[-1] += [f"{middle:.3f}", f"{high:.3f}", f"{shares.max():.5f}"]
    heads = ["", "length", "median", "95 %", "largest"]
    text = [
        "# The travel bound along curves",
        "",
        f"    python -m benchmarks.studies.proofs.curved_travel --robots {args.robots} "
        f"--first-seed {args.first_seed}",
        "",
        f"**{beyond} violations** on {intervals:,} intervals, {links:,} with each shape counted. "
        "Random trees of revolute,",
        "continuous and prismatic joints, bases from far lighter than their arms to far heavier, "
        "on cubic splines whose control",
        "points scatter by 0.01 to 2 rad or m. The table has sampled travel / bound; a travel is "
        f"the length of {SAMPLES} chords, of the",
        "shape's point with the longest. [Derivation](../proof.md), section 10.",
        "",
        table(heads, rows),
    ]
    publish("\n".join(text) + "\n", args.out)


if __name__ == "__main__":
    main()
