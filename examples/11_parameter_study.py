"""Run a study over scenes and clearance weights that can be interrupted and resumed.

Each result is one line of a JSON Lines file. A second run reads the file and computes only what is
missing. Failures are results too.

Writes `study.jsonl`; the table is printed at the end.
"""

import itertools
import json
from pathlib import Path
from statistics import median

import ffsr_plan as fp

RESULTS = Path("study.jsonl")
FOLDED = {"left_1": -0.6, "left_2": -0.9, "right_1": 0.6, "right_2": 0.9}
SCENES, DELTAS = range(8), (0.0, 0.02, 0.2)


def run(seed: int, delta: float) -> dict[str, object]:
    """Plan past random spheres and return what the study is about."""
    robot = fp.load_robot("planar_dual_arm")
    start = robot.configuration(joints=FOLDED)
    goal = robot.configuration((8.0, 0.0, 0.0), joints=FOLDED)
    scene = fp.generators.scatter(seed, (2, 6), (1.5, -2.0), (6.5, 2.0), (0.1, 0.3))
    lattice = fp.Lattice(32, fp.Axis(20, 0.1))
    problem = fp.Problem(robot, scene, start, goal, lattice=lattice, delta=delta)
    try:
        plan = fp.plan(problem, fp.LatticeOptimum())
    except fp.PlanningError as reason:
        return {"seed": seed, "delta": delta, "failure": type(reason).__name__}
    clearance = plan.certificate.least_clearance
    return {"seed": seed, "delta": delta, "length": plan.length, "clearance": clearance}


def main() -> None:
    """Compute the missing results and print medians."""
    lines = RESULTS.read_text().splitlines() if RESULTS.exists() else []
    results = [json.loads(line) for line in lines]
    done = {(result["seed"], result["delta"]) for result in results}
    with RESULTS.open("a") as file:
        for seed, delta in itertools.product(SCENES, DELTAS):
            if (seed, delta) not in done:
                results.append(run(seed, delta))
                file.write(json.dumps(results[-1]) + "\n")
                file.flush()  # an interrupted study keeps all complete lines
    for delta in DELTAS:
        planned = [r for r in results if r["delta"] == delta and "length" in r]
        lengths, clearances = ([r[key] for r in planned] for key in ("length", "clearance"))
        print(
            f"delta {delta:4}: {len(planned)} of {len(SCENES)} planned, median length "
            f"{median(lengths):.3f} m, median proven clearance {median(clearances):.3f} m"
        )


if __name__ == "__main__":
    main()
