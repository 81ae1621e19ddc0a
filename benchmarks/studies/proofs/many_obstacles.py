"""Time and error of node clearances against the number of obstacles.

    python -m benchmarks.studies.proofs.many_obstacles

Spheres are drawn into one box, their radii decreasing with their number, so that they always fill
the same share of it.
"""

import argparse
import time
from dataclasses import replace

import numpy as np

import ffsr_plan as fp
from benchmarks.paper_scenes import LATTICE
from benchmarks.report_pages import RESULTS, publish, table
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.scene.generators import cloud

COUNTS = (10, 100, 1_000, 10_000, 100_000)


def scene_of(count: int) -> fp.Scene:
    """The same share of the box filled by each number of spheres."""
    size = 0.5 * (10 / count) ** (1 / 3)
    box = {"low": (0.0, -4.0, -4.0), "high": (10.0, 4.0, 4.0)}
    return cloud(0, count, **box, radii=(0.2 * size, size))


def all_pairs(problem: fp.Problem, q: np.ndarray) -> float:
    """Least distance over every pair of a box link and a sphere, in closed form."""
    placed, least = shape_placements(problem.robot, q[None]), np.inf
    for i, shape in enumerate(problem.robot.collision_model.geometryObjects):
        local = (problem.scene.centers - placed.positions[0, i]) @ placed.rotations[0, i]
        beyond = np.abs(local) - shape.geometry.halfSide
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
        inside = np.minimum(beyond.max(axis=1), 0.0)
        least = min(least, float(np.min(outside + inside - problem.scene.radii)))
    return least


def measure(problem: fp.Problem, checked: int) -> tuple[float, float, float]:
    """Seconds of setup, microseconds a node, largest difference from all pairs [m]."""
    setups, times = [], []
    lattice = fp.LayeredLattice(problem)
    placed = shape_placements(problem.robot, lattice.nominal.configurations())
    layers = np.repeat(np.arange(1, lattice.divisions), lattice.size)
    offsets = np.tile(lattice.offsets, (lattice.divisions - 1, 1))
    for _ in range(5):
        begin = time.perf_counter()
        scene = fp.Scene(problem.scene.centers, problem.scene.radii)
        query = ObstacleQuery(problem.robot, scene)
        setups.append(time.perf_counter() - begin)
        begin = time.perf_counter()
        found = query.distances_at(placed, layers, offsets)
        times.append(time.perf_counter() - begin)
    error = 0.0
    for k in np.random.default_rng(0).choice(len(layers), checked, replace=False):
        q = lattice.nominal.configurations()[layers[k]].copy()
        q[:3] += offsets[k]
        error = max(error, abs(found[k] - all_pairs(problem, q)))
    return float(np.median(setups)), 1e6 * float(np.median(times)) / len(layers), error


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--checked", type=int, default=200, help="nodes compared with all pairs")
    args = parser.parse_args()
    ends = fp.load_scenario("fig2a")
    rows, first = [], None
    measure(replace(ends, lattice=LATTICE), 1)  # compiles
    for count in COUNTS:
        problem = replace(ends, scene=scene_of(count), lattice=LATTICE)
        setup, node, error = measure(problem, args.checked)
        first = first or node
        rows.append(
            [f"{count:,}".replace(",", " "), f"{setup * 1e3:.2f} ms", f"{node:.2f} µs",
             f"{node / first:.1f}", f"{error:.1e} m"]
        )  # fmt: skip
    text = "# Clearance among many obstacles\n\n"
    text += "`python -m benchmarks.studies.proofs.many_obstacles`\n\n"
    text += (
        "All nodes of a 41 x 41 lattice, planar dual-arm robot (7 box links), one thread. `setup` "
        "builds the tree over\nthe spheres; the time of a node includes Coal's distance of the "
        "nearest pair. The last column compares "
        f"{args.checked} nodes\nwith a closed form over all pairs.\n\n"
    )
    header = ["spheres", "setup", "a node", "against 10 spheres", "largest difference"]
    publish(text + table(header, rows) + "\n", RESULTS / "many_obstacles.md")


if __name__ == "__main__":
    main()
