"""A search for false proofs, with random robots, motions and grazing obstacles.

    python -m benchmarks.studies.proofs.soundness --edges 100000 --workers 2

Obstacles are enlarged until the motion passes them at a clearance drawn from 2e-5 to 1e-2 m, or
penetrates them by that depth (`tests/helpers/grazing_obstacles.py`).
"""

import argparse
import os
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: one thread each
from benchmarks.report_pages import RESULTS, publish, table
from tests.helpers.grazing_obstacles import Counts, look_at


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--edges", type=int, default=100_000, help="free edges to collect")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=RESULTS / "soundness.md")
    args = parser.parse_args()
    begin, total, seed = time.perf_counter(), Counts(), args.first_seed
    with ProcessPoolExecutor(args.workers) as pool:
        while total.free < args.edges:
            seeds = range(seed, seed + 100 * args.workers)
            for counts in pool.map(look_at, seeds, chunksize=10):
                total = total.plus(counts)
            seed = seeds.stop
    minutes = (time.perf_counter() - begin) / 60.0
    rows = [
        ["proven free", f"{total.free}"],
        ["of these, in collision at one of 2 000 samples", f"{total.false_free}"],
        ["of these, nearer than 1e-3 m", f"{total.grazing_free}"],
        ["of these, without a query between the ends", f"{total.unasked}"],
        ["queries between the ends, in the mean", f"{total.queries / total.free:.2f}"],
        ["refused", f"{total.refused}"],
        ["of these, with more than 1e-3 m at all samples", f"{total.wrongly_refused}"],
    ]
    publish(
        "# Looking for false proofs\n\n`python -m benchmarks.studies.proofs.soundness "
        f"--edges {args.edges} --first-seed {args.first_seed}`\n\nRandom trees of boxes, balls, "
        "capsules "
        "and, in every tenth, cylinders (inside prisms), revolute, continuous and\nprismatic "
        "joints, all modes, joint steps up to a radian and more; obstacles close to the motion.\n"
        f"{seed - args.first_seed} motions, {minutes:.0f} minutes.\n\n"
        + table(["edges", "number"], rows)
        + "\n",
        args.out,
    )
    if total.false_free or total.wrongly_refused:
        raise SystemExit("a proof was wrong")


if __name__ == "__main__":
    main()
