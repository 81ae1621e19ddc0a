"""Plans without a lattice flown by MuJoCo: where the base is, against where it was planned.

    python -m benchmarks.studies.general.mujoco_flights

needs `pip install mujoco`. MuJoCo shares no code with the planner: it compiles the robot's URDF and
is told forces, not motions. Each edge is flown from rest to rest. Distances to the spheres are
those of the states that it finds, in closed form.
"""

import argparse
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table
from benchmarks.studies.general.free_space import NAMES, problems
from tests.helpers.dense_flight import least_gap
from tests.helpers.free_scenes import held_turn
from tests.helpers.mujoco_plans import EDGE, RECORDED, STEP, configurations, departures, flown

HELD = "attitude held, turned by wheels"
ANGLES = (0.3, -0.5, 0.8, -1.0, 1.2, -1.5)  # [rad], of held bases
GOAL_ATTITUDES = 6  # long paths, flown by half the step
AGREEMENT = 1e-5  # [rad] and [m]


class Flown(NamedTuple):
    """One flight: edges, largest errors [rad], [m], least clearances [m], sampled and proven."""

    edges: int
    turned: float
    away: float
    clearance: float
    proven: float


def groups(count: int) -> Iterator[tuple[str, float, list[fp.Problem]]]:
    """Name, step of the engine [s] and problems of each row."""
    for kind, name in NAMES.items():
        step = 0.5 * STEP if kind == GOAL_ATTITUDES else STEP
        yield f"{kind}: {name}", step, problems(kind, count)
    held = [
        held_turn(problem, ANGLES[k % len(ANGLES)])
        for k, problem in enumerate(problems(1, 2 * count))
    ]
    free = [p for p in held if fp.clearance(p.robot, p.scene, p.goal) > 0.03]
    yield HELD, STEP, free[:count]


def flight_of(problem: fp.Problem, step: float, seed: int) -> Flown:
    """Plan with the default settings, and fly the plan."""
    plan = fp.plan(problem, seed=seed)
    flight, _ = flown(plan, step)
    turned, away, _ = departures(plan, flight)
    least, touching = least_gap(plan, configurations(plan, flight))
    if touching:
        raise RuntimeError(f"links touch in flight: {plan}")
    return Flown(plan.motion.edges, turned, away, least, plan.certificate.least_clearance)


def row(name: str, flights: list[Flown]) -> list[str]:
    """One row of the table."""
    edges, turned, away, clearance, proven = np.array(flights).T
    return [
        name,
        f"{len(flights)}",
        f"{int(edges.sum())}",
        f"{turned.max():.1e}",
        f"{away.max():.1e}",
        f"{1e3 * clearance.min():.2f}",
        f"{1e3 * proven.min():.2f}",
        f"{int(np.sum((turned < AGREEMENT) & (away < AGREEMENT) & (clearance > 0.0)))}",
    ]


def main() -> None:
    """Fly and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=6, help="problems of each kind")
    parser.add_argument("--out", type=Path, default=RESULTS / "free_flights.md")
    args = parser.parse_args()
    rows, total, begin = [], 0, time.process_time()
    for name, step, chosen in groups(args.count):
        flights = [flight_of(problem, step, seed) for seed, problem in enumerate(chosen)]
        total += len(flights)
        rows.append(row(name, flights))
        print(rows[-1], flush=True)
    heads = [
        "problems", "flights", "edges", "largest error of attitude [rad]", "of position [m]",
        "least clearance in flight [mm]", "proven [mm]", "as planned",
    ]  # fmt: skip
    text = f"""# Plans without a lattice, flown by MuJoCo

`python -m benchmarks.studies.general.mujoco_flights --count {args.count}`

{total} plans of `TreePlanner` with its default settings: the first {args.count} problems of each
kind of `problems.json`, and as many of the first kind in which wheels hold the base's attitude and
turn it by .3 to 1.5 rad on the way. MuJoCo flies them from the robot's URDF, by forces on joints
and base; where the attitude reacts, nothing but MuJoCo's equations of motion turns the base.
{(time.process_time() - begin) / 60.0:.0f} minutes of processor time.

{table(heads, rows)}

- Errors are differences from the plan at {RECORDED} times an edge. Each edge takes {EDGE:g} s from
  rest to rest; steps are {1e3 * STEP:g} ms, and {500 * STEP:g} ms for goal attitudes. The errors
  are those of these steps: half the step leaves a sixteenth.
- Clearances in flight are distances from the URDF's shapes to the spheres at MuJoCo's states, in
  closed form; no two links touch at any of them (Coal's collision test). Proven: the least
  clearance that the plans claim, a lower bound along the whole motion.
- As planned: base within {AGREEMENT:g} rad and m, and no collision.
"""
    publish(text, args.out)


if __name__ == "__main__":
    main()
