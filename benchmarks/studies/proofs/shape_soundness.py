"""A search for false proofs among obstacles of every shape, which random motions graze.

    python -m benchmarks.studies.proofs.shape_soundness --motions 2000 --workers 2

Each motion passes obstacles of one kind at clearances from -2 to 3 mm; the distances of the
verification are taken at 401 instants (`tests/helpers/grazing_shapes.py`). It takes hours; the
kinds that are done are kept in the folder `--work`, and not repeated.
"""

import argparse
import json
import os
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: one thread each
from benchmarks.report_pages import RESULTS, publish, table
from tests.helpers.grazing_shapes import ZONES, Counts, look_at
from tests.helpers.obstacle_shapes import KINDS


def counted(kind: str, args: argparse.Namespace, kept: Path) -> Counts:
    """The counts of a kind, from the file where they are kept if it is there."""
    if kept.exists():
        return Counts(**json.loads(kept.read_text()))
    total, seeds = Counts(), range(args.first_seed, args.first_seed + args.motions)
    with ProcessPoolExecutor(args.workers) as pool:
        for one in pool.map(partial(look_at, kind=kind), seeds, chunksize=5):
            total = Counts(*(a + b for a, b in zip(total, one, strict=True)))
    kept.write_text(json.dumps(total._asdict()))
    return total


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--motions", type=int, default=2000, help="for each kind of obstacle")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--first-seed", type=int, default=1000)
    parser.add_argument("--work", type=Path, default=Path("shape-soundness"), help="for results")
    parser.add_argument("--out", type=Path, default=RESULTS / "shape_soundness.md")
    args = parser.parse_args()
    rows, wrong = [], 0
    folder = args.work / f"{args.motions}-from-{args.first_seed}"
    folder.mkdir(parents=True, exist_ok=True)
    for kind in (*KINDS, *ZONES):
        total = counted(kind, args, folder / f"{kind}.json")
        wrong += total.false_free + total.wrongly_refused
        rows.append([kind, *map(str, total)])
        print(rows[-1], flush=True)
    heads = [
        "obstacle", "proven free", "of these, touching", "refused",
        "of these, clear by more than 1 mm", "proven free and nearer than 1 mm",
    ]  # fmt: skip
    publish(
        "# Looking for false proofs among shapes\n\n"
        f"`python -m benchmarks.studies.proofs.shape_soundness --motions {args.motions} "
        f"--first-seed {args.first_seed}`\n\n"
        "Random trees of boxes, balls, capsules and, in every fourth, cylinders (inside prisms),\n"
        "in all modes, past an obstacle that the motion grazes; five obstacles a motion. The\n"
        "distances of the verification are taken at 401 instants, and where something was refused\n"
        "that is clear at all of these, at 401 more around the place.\n\n"
        + table(heads, rows)
        + "\n",
        args.out,
    )
    if wrong:
        raise SystemExit("a proof was wrong")


if __name__ == "__main__":
    main()
