"""Times of clearances, optimum and colony for every robot, as ratios to Pinocchio's.

    python -m benchmarks.studies.planners.times_by_robot

Robots travel 10 m through random spheres with their arms moving, on lattices of 41 layers with a
lateral axis of 41 offsets and with lateral and normal axes of 13 by 13. C is the time of plain
`pin.computeDistances` for all nodes of the same lattice, measured with each figure. Writes
docs/benchmarks/robots.md. The defaults take about ten minutes.
"""

import argparse
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table
from benchmarks.speed.reference import Reference

LATTICES = {
    "41": fp.Lattice(40, fp.Axis(20, 0.15)),
    "13 x 13": fp.Lattice(40, fp.Axis(6, 0.3), fp.Axis(6, 0.3)),
}
PANDA = {"panda_finger_joint1": 0.02}
UPRIGHT = {"panda_joint4": -1.5, "panda_joint6": 1.5}


class Task(NamedTuple):
    """A robot, and its joint values at start and goal."""

    robot: fp.SpaceRobot
    begin: dict[str, float]
    end: dict[str, float]


def tasks() -> dict[str, Task]:
    """The bundled robots with arms, and a satellite with two arms of example-robot-data."""
    fig2a, ur5 = fp.load_scenario("fig2a"), fp.load_robot("satellite_ur5")
    spatial = fp.load_robot("spatial_dual_arm")
    names = fig2a.robot.joint_names
    planar = (dict(zip(names, q[7:].tolist(), strict=True)) for q in (fig2a.start, fig2a.goal))
    two = fp.compose(
        fp.Bus((1.0, 1.0, 1.0), 150.0),
        [
            fp.Mount("panda", (0.5, 0.35, 0.0), (0.0, np.pi / 2, 0.0), "one_", PANDA),
            fp.Mount("panda", (0.5, -0.35, 0.0), (0.0, np.pi / 2, 0.0), "two_", PANDA),
        ],
        "two_pandas",
    )
    bent = {side + name: v for side in ("one_", "two_") for name, v in UPRIGHT.items()}
    moved = {"one_panda_joint1": 0.8, "one_panda_joint2": -0.6, "two_panda_joint3": 0.7}
    return {
        "planar_dual_arm": Task(fig2a.robot, *planar),
        "spatial_dual_arm": Task(spatial, spatial.postures["rest"], spatial.postures["reach"]),
        "satellite_ur5": Task(ur5, ur5.postures["ready"], ur5.postures["reach"]),
        "two Pandas on a bus": Task(two, bent, {**bent, **moved}),
    }


def problems(task: Task, lattice: fp.Lattice, seed: int, count: int) -> Iterator[fp.Problem]:
    """Random scenes that have a path; the spheres of a planar lattice lie in its plane."""
    rng = np.random.default_rng(seed)
    start = task.robot.configuration(joints=task.begin)
    goal = task.robot.configuration((10.0, 0.0, 0.0), joints=task.end)
    while count:
        spheres = int(rng.integers(4, 12))
        x, y, z = rng.uniform((2.5, -3.0, -3.0), (7.5, 3.0, 3.0), (spheres, 3)).T
        centers = np.stack([x, y, z if lattice.normal else 0.0 * z], axis=1)
        scene = fp.Scene(centers, rng.uniform(0.15, 0.5, spheres))
        problem = fp.Problem(task.robot, scene, start, goal, lattice=lattice, delta=0.1)
        try:
            fp.plan(problem, fp.LatticeOptimum(), refine=False)
        except fp.PlanningError:
            continue
        count -= 1
        yield problem


def seconds(run: Callable[[], object], repeats: int) -> float:
    """Median time."""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        run()
        times.append(time.perf_counter() - begin)
    return float(np.median(times))


class Figures(NamedTuple):
    """Figures of one problem; times in units of C."""

    nodes: float
    optimum: float
    colony: float
    gap: float
    queries: float
    verified: bool


def figures(problem: fp.Problem, repeats: int, samples: int) -> Figures:
    """Measure one problem."""
    reference = Reference(problem)
    roadmaps = iter([fp.Roadmap(problem) for _ in range(repeats)])

    def ratio(run: Callable[[], object]) -> float:
        return seconds(run, repeats) / reference.seconds(repeats)

    colony = fp.plan(problem, refine=False)
    best = fp.plan(problem, fp.LatticeOptimum())
    proof = best.certificate
    return Figures(
        ratio(lambda: next(roadmaps).clearances),
        ratio(lambda: fp.plan(problem, fp.LatticeOptimum(), refine=False)),
        ratio(lambda: fp.plan(problem, refine=False)),
        colony.gap,
        proof.edge_queries / (proof.edges_free + proof.edges_refused),
        all(p.verify(samples).ok for p in (colony, best)),
    )


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=5, help="for each robot and lattice")
    parser.add_argument("--repeats", type=int, default=3, help="timings; the median is shown")
    parser.add_argument("--samples", type=int, default=500, help="of the verification, per edge")
    parser.add_argument("--out", type=Path, default=RESULTS / "robots.md")
    args = parser.parse_args()
    fp.plan(fp.load_scenario("fig2a"))  # compiles
    rows = []
    for name, task in tasks().items():
        shapes = task.robot.collision_model.ngeoms
        for width, lattice in LATTICES.items():
            found = [
                figures(problem, args.repeats, args.samples)
                for problem in problems(task, lattice, 1, args.scenes)
            ]
            nodes, optimum, colony, gaps, queries, verified = zip(*found, strict=True)
            rows.append(
                [name, f"{task.robot.nd}", f"{shapes}", width,
                 *(f"{np.median(each):.2f} C" for each in (nodes, optimum, colony)),
                 f"{max(gaps):.2%}", f"{np.mean(queries):.1f}", f"{sum(verified)} / {len(found)}"]
            )  # fmt: skip
            print(rows[-1], flush=True)
    header = [
        "robot", "joints", "shapes", "nodes a layer", "node clearances", "LatticeOptimum",
        "default colony", "its largest gap", "queries per edge proven", "verified",
    ]  # fmt: skip
    publish(
        f"# Robots\n\n`python -m benchmarks.studies.planners.times_by_robot --scenes {args.scenes} "
        f"--repeats {args.repeats} --samples {args.samples}`\n\nRandom scenes of 4 to 11 spheres, "
        "delta 0.1; the arms move "
        "on the way. Times are medians, whole plans without refinement, certified; C is the time "
        "of `pin.computeDistances` for all nodes of the same lattice. Plans of the colony and of "
        "the optimum (refined) are verified.\n\n" + table(header, rows) + "\n",
        args.out,
    )


if __name__ == "__main__":
    main()
