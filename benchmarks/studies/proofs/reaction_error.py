"""Error of the integrated attitude against its bound, on random joint segments.

    python -m benchmarks.studies.proofs.reaction_error --segments 1000000

integrates segments of random robots with light and heavy bodies and joint steps of up to three
radians at several tolerances, compares them with the least tolerance, and writes
docs/benchmarks/reaction_error.md. It takes more than half an hour.
"""

import argparse
from pathlib import Path

import numpy as np

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.reaction import Reaction
from tests.helpers.random_robots import random_tree

TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-11)
STEPS = (0.03, 0.3, 1.0, 3.0)
"""Largest change of a joint over a segment [rad or m]."""
REFERENCE = 1e-14
OF_EACH = 60  # segments of a robot and step


def errors(robot: fp.SpaceRobot, seed: int) -> "dict[float, np.ndarray]":
    """Errors of random segments relative to their bounds, by tolerance."""
    rng = np.random.default_rng(seed)
    count = len(STEPS) * OF_EACH
    begin = rng.uniform(-2.0, 2.0, (count, robot.nd))
    steps = np.repeat(STEPS, OF_EACH)[:, None] * rng.uniform(-1.0, 1.0, (count, robot.nd))
    which, times = np.repeat(np.arange(count), 2), rng.uniform(0.0, 1.0, 2 * count)
    times[::2] = 1.0
    exact = Reaction(robot, begin, steps, REFERENCE)
    at = exact.rotation(which, times)
    found = {}
    for tolerance in TOLERANCES:
        rough = Reaction(robot, begin, steps, tolerance)
        wrong = rotations.angle_between(rough.rotation(which, times), at)
        found[tolerance] = (wrong / (rough.errors + exact.errors)[which]).reshape(-1, 2).max(axis=1)
    return found


def main() -> None:
    """Integrate, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--segments", type=int, default=1_000_000, help="at each tolerance")
    parser.add_argument("--first-seed", type=int, default=1000, help="of the robots")
    parser.add_argument("--out", type=Path, default=RESULTS / "reaction_error.md")
    args = parser.parse_args()
    shares: dict[float, list[np.ndarray]] = {tolerance: [] for tolerance in TOLERANCES}
    seed, refused, done = args.first_seed, 0, 0
    while done < args.segments:
        try:
            found = errors(random_tree(seed), seed)
        except fp.IntegrationError:
            found = {}
            refused += 1
        for tolerance, each in found.items():
            shares[tolerance].append(each)
        done += len(STEPS) * OF_EACH * bool(found)
        seed += 1
    every = {tolerance: np.concatenate(parts) for tolerance, parts in shares.items()}
    rows = [
        [f"{tolerance:g}", f"{each.max():.2g}", f"{np.median(each):.1g}"]
        for tolerance, each in every.items()
    ]
    above = sum(int(np.count_nonzero(each > 1.0)) for each in every.values())
    publish(
        "# The attitude's error against its bound\n\n"
        f"    python -m benchmarks.studies.proofs.reaction_error --segments {args.segments} "
        f"--first-seed {args.first_seed}\n\n"
        f"**{above} of {done} segments** have an error above the [bound](../proof.md) at one of "
        f"{len(TOLERANCES)} tolerances. Random trees of revolute, continuous and prismatic joints, "
        "bases from far lighter than their arms to far heavier; a quarter of the segments each "
        f"with joint steps of up to {', '.join(f'{step:g}' for step in STEPS)} rad or m. Errors "
        f"are differences from an integration at {REFERENCE:g} rad, at the segment's end and at "
        "a random time in it; the share is that of the larger one in the bound. "
        f"{refused} robots are left out, as one of their segments is refused (`IntegrationError`)."
        "\n\n" + table(["tolerance [rad]", "largest share", "median share"], rows) + "\n",
        args.out,
    )


if __name__ == "__main__":
    main()
