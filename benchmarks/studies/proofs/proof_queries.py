"""Distance queries of a proof, by the travel bound that it uses.

    python -m benchmarks.studies.proofs.proof_queries

The same edges are certified with a simple bound on travel (every joint at its largest rate, in the
worst direction), with the sharp bound for all links together, and link by link. Verdicts differ
only for edges whose clearance falls below the tolerance.
"""

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.paper_scenes import LATTICE, NUMBERS, add_problems_option, paper_problem
from benchmarks.report_pages import RESULTS, publish, table
from benchmarks.studies.proofs.travel_bound import simple_speeds
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.interval_halving import Verdict, certify
from ffsr_plan.proof.motion_edges import ObstacleEdge
from ffsr_plan.proof.prover import Prover

TOLERANCE = 1e-4


class Together:
    """An edge judged by the least clearance of all links and the largest travel bound."""

    def __init__(self, edge: ObstacleEdge) -> None:
        self._edge = edge
        self.speed, self.rounding, self.clearance = edge.speed, edge.rounding, edge.clearance

    def margins(self, begin: float, end: float, ways: np.ndarray) -> np.ndarray:
        """(1,) [m]."""
        return min(self._edge.parts(begin)) + min(self._edge.parts(end)) - ways

    def travel(self, begin: float, end: float) -> np.ndarray:
        """(1,) [m]."""
        return self._edge.travel(begin, end).max(keepdims=True)


class Simple(Together):
    """The same with one speed bound for the whole edge."""

    def __init__(self, edge: ObstacleEdge, joint_speed: float) -> None:
        super().__init__(edge)
        self._fastest = joint_speed + np.linalg.norm(edge.base_step)

    def travel(self, begin: float, end: float) -> np.ndarray:
        """(1,) [m]."""
        return np.array([(end - begin) * self._fastest])


KINDS = ("simple bound", "sharp bound", "sharp, link by link")


class Task(NamedTuple):
    """Edges of one motion to be certified: layer, offsets of the base at both ends."""

    prover: Prover
    motion: Motion
    edges: list[tuple[int, np.ndarray, np.ndarray]]


def lattice_edges(problem: fp.Problem, count: int, seed: int) -> Task:
    """Random edges of a lattice between neighbouring offsets, both ends free."""
    roadmap, rng = fp.Roadmap(problem), np.random.default_rng(seed)
    offsets, chosen = roadmap.lattice.offsets, []
    while len(chosen) < count:
        layer, tail = rng.integers(1, LATTICE.divisions - 1), rng.integers(roadmap.lattice.size)
        near = np.flatnonzero(np.linalg.norm(offsets - offsets[tail], axis=1) <= 0.5)
        head = rng.choice(near)
        if roadmap.admissible[layer, tail] and roadmap.admissible[layer + 1, head]:
            chosen.append((int(layer), offsets[tail], offsets[head]))
    return Task(roadmap.prover, roadmap.lattice.nominal, chosen)


def arm_swing(seed: int) -> Task:
    """The arms move by half a radian a joint, the base reacts and stays where it is."""
    rng, robot = np.random.default_rng(seed), fp.load_robot("planar_dual_arm")
    begin, end = rng.uniform(-1.2, 1.2, 6) + np.array([[-0.25], [0.25]]) * rng.choice([-1, 1], 6)
    q = [
        robot.configuration(joints=dict(zip(robot.joint_names, v, strict=True)))
        for v in (begin, end)
    ]
    places = rng.uniform(-1.6, 1.6, (6, 3)) * (1, 1, 0.1)
    scene = fp.Scene(places, rng.uniform(0.05, 0.2, 6))
    motion = Motion(robot, "free-flying", *q, np.zeros((2, 3)))
    still = np.zeros(3)
    return Task(Prover(motion, scene, TOLERANCE), motion, [(0, still, still)])


def certified(task: Task) -> dict[str, list[Verdict]]:
    """The verdicts on the same edges, by each kind of proof; without edges whose ends collide."""
    joints, prover = task.motion.joint_values, task.prover
    steps = np.diff(joints[:2], axis=0)
    joint_speed = float(simple_speeds(task.motion.robot, joints[:1], steps, None).max())
    verdicts: dict[str, list[Verdict]] = {name: [] for name in KINDS}
    for layer, tail, head in task.edges:
        ends = prover.clearances(np.array([layer, layer + 1]), np.stack([tail, head]))
        if min(ends) > 0.0:
            edges = [prover.obstacle_edge(layer, tail, head) for _ in KINDS]
            judged = (Simple(edges[0], joint_speed), Together(edges[1]), edges[2])
            for name, edge in zip(KINDS, judged, strict=True):
                verdicts[name].append(certify(edge, (float(ends[0]), float(ends[1])), TOLERANCE))
    return verdicts


def tasks(problems: int, edges: int) -> Iterator[tuple[str, Task]]:
    """All edges to be certified, by group."""
    for number in NUMBERS[:problems]:
        problem = paper_problem(number, 0.0)
        yield "family `paper`, 4 to 11 spheres", lattice_edges(problem, edges, number)
    yield "lattice, 2 000 spheres", lattice_edges(fp.load_scenario("debris"), edges, 0)
    for seed in range(edges):
        yield "arm swings, 6 spheres", arm_swing(seed)


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--edges", type=int, default=2000, help="in each problem, and arm swings")
    add_problems_option(parser)
    parser.add_argument("--out", type=Path, default=RESULTS / "certification.md")
    args = parser.parse_args()
    totals: dict[tuple[str, str], list[Verdict]] = {}
    for group, task in tasks(args.problems, args.edges):
        for name, verdicts in certified(task).items():
            totals.setdefault((group, name), []).extend(verdicts)
    rows = []
    for (group, name), verdicts in totals.items():
        free = [v for v in verdicts if v.free]
        refused = [v.queries for v in verdicts if not v.free]
        rows.append(
            [f"{group}: {name}", f"{len(free)} / {len(verdicts)}",
             f"{np.mean([v.queries == 0 for v in free]):.1%}",
             f"{np.mean([v.queries for v in free]):.2f}", f"{np.mean(refused):.2f}"]
        )  # fmt: skip
    header = [
        "edges: proof", "free", "of these without a query", "queries for a free edge",
        "for a refused one",
    ]  # fmt: skip
    publish(
        "# Queries of a proof\n\n`python -m benchmarks.studies.proofs.proof_queries "
        f"--edges {args.edges} --problems {args.problems}`\n\nEdges of lattices between "
        f"neighbouring offsets, in {args.problems} problems of family `paper` of\n[the problem set]"
        "(../howto/problem_set.md) and past 2 000 spheres, and arms that "
        "swing by half a radian a joint while the\nbase reacts; both ends free. A query is Coal's "
        "distance between the ends of an edge, over all pairs.\nOn these lattices the base moves "
        "far more than the arms, so that all bounds are similar there.\n\n"
        + table(header, rows)
        + "\n",
        args.out,
    )


if __name__ == "__main__":
    main()
