"""Attitude manoeuvres by arm motion alone: error, length above the optimum, time.

    python -m benchmarks.studies.attitude.turning

The planar dual-arm robot turns its base by 5 to 75 degrees, either way, and ends in the posture it
began with; lengths are compared with those of tests/helpers/turning_dynamic_programme.py. A robot
with two arms of three joints (tests/helpers/spatial_robot.py) turns about five axes. Last, the
parts of the search are compared with each other. Writes docs/benchmarks/turning.md. The defaults
take about 40 minutes on a busy machine.
"""

import argparse
import math
import sys
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.search.postures.posture_lattice import PostureLattice
from tests.helpers.spatial_robot import spatial_problem
from tests.helpers.turning_dynamic_programme import turning_oracle

REST = {"left_2": 0.8, "right_2": -0.8}
LATTICE = fp.Lattice(
    80,
    postures=[
        fp.PostureAxis({"left_1": 1, "right_1": -1}, 8, 0.25),
        fp.PostureAxis({"left_2": 1, "right_2": 1}, 12, 0.25),
    ],
)
AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1), "x + y": (1, 1, 0), "x - y + z": (1, -1, 1)}
SPATIAL = ((10, 60, 4, 0.3), (30, 60, 4, 0.3), (45, 80, 4, 0.4), (60, 80, 4, 0.4))
"""Degrees, divisions, levels to either side, spacing."""


class Turn(NamedTuple):
    """One plan.

    Attributes:
        before: attitude error before the correction [deg].
        after: attitude error after the correction [deg].
        lattice: L of the lattice path [m].
        final: L after the correction [m].
        seconds: time of the plan.
    """

    before: float
    after: float
    lattice: float
    final: float
    seconds: float


def planar(degrees: float) -> fp.Problem:
    """The planar robot turns by `degrees` and returns to the same posture."""
    robot = fp.load_robot("planar_dual_arm")
    start = robot.configuration(joints=REST)
    goal = robot.configuration((0, 0, 0), (math.radians(degrees), 0, 0), REST)
    return fp.Problem(robot, fp.Scene(), start, goal, lattice=LATTICE, reach_attitude=True)


def turn(problem: fp.Problem, seed: int, planner: fp.PostureAnnealing | None = None) -> Turn | None:
    """Plan; None if the goal attitude was not reached."""
    try:
        plan = fp.plan(problem, planner, seed)
    except fp.AttitudeOutOfReach:
        return None
    error = plan.arrival_attitude_error
    if error is None or not np.isfinite(error):
        raise RuntimeError("a plan that does not reach the goal attitude")
    return Turn(
        _before(plan), math.degrees(error), plan.lattice_objective, plan.objective, plan.seconds
    )


def _before(plan: fp.Plan) -> float:
    """Attitude error of the lattice path through the plan's nodes [deg]."""
    lattice, problem = PostureLattice(plan.problem), plan.problem
    number = {tuple(index): p for p, index in enumerate(lattice.indices.tolist())}
    nodes = [number[tuple(node)] for node in plan.nodes.tolist()]
    joints = lattice.joint_values[np.arange(len(nodes)), nodes]
    places = lattice.base.nominal.positions
    path = Motion(problem.robot, problem.mode, problem.start, problem.goal, places, joints)
    return math.degrees(float(angle_between(path.attitudes[-1], problem.goal[3:7])))


def planar_table(angles: Iterable[int], seeds: int) -> str:
    """Results of the planar robot, either direction."""
    oracle = turning_oracle(planar(10), math.radians(0.1))
    rows, every, missed = [], [], 0
    for size in angles:
        for degrees in (size, -size):
            tries = [turn(planar(degrees), seed) for seed in range(seeds)]
            turns = [t for t in tries if t is not None]
            missed += seeds - len(turns)
            least = oracle.least(math.radians(degrees))
            excess = [t.lattice / least - 1.0 for t in turns]
            every += excess
            if turns:
                rows.append(_row(f"{degrees:+d}", turns, seeds, least, excess))
            print(f"{degrees:+d} degrees", file=sys.stderr, flush=True)
    head = ("degrees", "reached", "error before [deg]", "after", "oracle L [m]")
    more = ("L above it, median", "worst", "L corrected [m]", "seconds")
    above = np.array(every)
    return table((*head, *more), rows) + (
        f"\n\nOf {len(every) + missed} runs {len(every)} reached the goal; L lies "
        f"{above.mean():.1%} above the oracle on average, {above.max():.1%} at worst, "
        f"and by more than 5 % in {int(np.sum(above > 0.05))} runs."
    )


def _row(
    name: str, turns: Sequence[Turn], seeds: int, least: float, excess: Sequence[float]
) -> tuple[str, ...]:
    return (
        name,
        f"{len(turns)} of {seeds}",
        f"{max(t.before for t in turns):.2f}",
        f"{max(t.after for t in turns):.0e}",
        f"{least:.2f}",
        f"{np.median(excess):.1%}",
        f"{max(excess):.1%}",
        f"{np.median([t.final for t in turns]):.2f}",
        f"{np.median([t.seconds for t in turns]):.1f}",
    )


def spatial_table(settings: Iterable[tuple[int, int, int, float]], seeds: int) -> str:
    """Results of the robot with three posture axes, about five axes."""
    rows = []
    for degrees, divisions, levels, spacing in settings:
        for name, axis in AXES.items():
            problem = spatial_problem(degrees, axis, divisions, levels, spacing)
            turns = [t for seed in range(seeds) if (t := turn(problem, seed)) is not None]
            figures = (
                (
                    f"{max(t.before for t in turns):.2f}",
                    f"{max(t.after for t in turns):.0e}",
                    f"{np.median([t.lattice for t in turns]):.2f}",
                    f"{np.median([t.seconds for t in turns]):.1f}",
                )
                if turns
                else ("", "", "", "")
            )
            lattice = f"{divisions} x {2 * levels + 1}^3 of {spacing:g}"
            rows.append((f"{degrees}, {name}", lattice, f"{len(turns)} of {seeds}", *figures))
            print(f"{degrees} degrees about {name}", file=sys.stderr, flush=True)
    head = ("degrees, axis", "lattice", "reached", "error before [deg]", "after", "L [m]", "s")
    return table(head, rows)


def parts_table(angles: Sequence[int], seeds: int) -> str:
    """Results of the default search, without pheromone, and without ants."""
    oracle = turning_oracle(planar(10), math.radians(0.1))
    colony = fp.PostureAnnealing
    planners = {
        "ants, pheromone, annealing": colony(),
        "ants without pheromone, annealing": colony(pheromone=False),
        "one ant, one cycle, annealing": colony(ants=1, cycles=1),
    }
    rows = []
    for name, planner in planners.items():
        tries = [
            (turn(planar(d), 100 + seed, planner), oracle.least(math.radians(d)))
            for d in angles
            for seed in range(seeds)
        ]
        excess = np.array([t.lattice / least - 1.0 for t, least in tries if t is not None])
        seconds = np.median([t.seconds for t, _ in tries if t is not None])
        reached = f"{len(excess)} of {len(tries)}"
        rows.append(
            (name, reached, f"{excess.mean():.2%}", f"{excess.max():.1%}", f"{seconds:.1f}")
        )
        print(name, file=sys.stderr, flush=True)
    return table(("search", "reached", "L above the oracle, mean", "worst", "s"), rows)


def main(argv: Sequence[str] | None = None) -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--angles", type=int, nargs="+", default=list(range(5, 80, 5)))
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--spatial-seeds", type=int, default=5)
    parser.add_argument("--spatial-up-to", type=int, default=60, help="degrees")
    parser.add_argument("--parts-seeds", type=int, default=5)
    parser.add_argument("--out", type=Path, default=RESULTS / "turning.md")
    options = parser.parse_args(argv)
    settings = [s for s in SPATIAL if s[0] <= options.spatial_up_to]
    begin = time.perf_counter()
    turn(planar(10), 0)  # compiles
    given = " ".join(sys.argv[1:] if argv is None else argv)
    default = fp.PostureAnnealing()
    shifts = len(default.temperatures) * default.shifts_per_layer(reach_attitude=True)
    parts = [
        "# Turning by arm motion alone",
        f"`python -m benchmarks.studies.attitude.turning {given}".rstrip()
        + "`, times on a machine under other load.",
        "Errors are the largest over all seeds. The oracle is the shortest joint path that ends "
        "within half a degree of the goal; the search does not penalise smaller errors.",
        f"## Planar, {options.seeds} seeds",
        planar_table(options.angles, options.seeds),
        f"## Three posture axes, {options.spatial_seeds} seeds",
        spatial_table(settings, options.spatial_seeds),
    ]
    if options.parts_seeds:
        parts += [
            "## Contribution of the ants",
            f"30, 60 and 75 degrees, {options.parts_seeds} seeds other than above. Annealing tries "
            f"{shifts} paths for each layer in every row; a cycle of ants tries 30 paths and 200 "
            "shifts more.",
            parts_table((30, 60, 75), options.parts_seeds),
        ]
    parts.append(f"All in {(time.perf_counter() - begin) / 60:.0f} minutes.")
    publish("\n\n".join(parts) + "\n", options.out)


if __name__ == "__main__":
    main()
