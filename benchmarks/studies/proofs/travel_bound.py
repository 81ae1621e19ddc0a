"""Travel bound against sampled travel on random intervals: violations and excess.

    python -m benchmarks.studies.proofs.travel_bound --robots 1000

samples the travel of every shape on intervals of random edges of random robots and of the planar
dual-arm robot, and writes docs/benchmarks/travel.md. It takes about five minutes.
"""

import argparse
import time
from collections.abc import Iterator
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from benchmarks.report_pages import RESULTS, publish, table
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.proof.kernels.travel import BaseMotion
from ffsr_plan.proof.travel_bound import TravelBound
from ffsr_plan.robots.kinematics import Tree, turned
from tests.helpers.random_robots import random_tree

STEPS = (0.03, 0.1, 0.3, 1.0)
"""Largest change of a joint over an edge [rad or m]."""
LENGTHS = (1.0, 1 / 4, 1 / 16, 1 / 64)
"""Of an interval, in units of edge time."""
BASES = ("base moves", "base still", "base keeps step")
"""By 0.25 m over an edge; not at all; such that a point of the robot is at rest at the middle."""
MODES = ("free-flying", "attitude-held")
BASE_STEP = 0.25
REPEATS = 4  # edges for each step, and intervals for each edge, length and motion of the base
SAMPLES = 32
ROUNDING = 1e-12


class Found(NamedTuple):
    """Results of one robot and mode; arrays over edge, repeat, length, base and shape.

    Attributes:
        steps: (edges,) joint steps.
        sampled: sampled travel [m].
        bound: the travel bound T [m].
        simple: the bound with every joint at its largest rate in the worst direction [m].
    """

    steps: np.ndarray
    sampled: np.ndarray
    bound: np.ndarray
    simple: np.ndarray


def measure(robot: fp.SpaceRobot, seed: int) -> Iterator[Found]:
    """Bound and sampled travel on random intervals, in one mode after the other."""
    rng = np.random.default_rng(seed)
    scales = np.repeat(STEPS, REPEATS)
    edges, shape = len(scales), (len(scales), REPEATS, len(LENGTHS), len(BASES))
    steps = scales[:, None] * rng.uniform(-1, 1, (edges, robot.nd))
    corners = np.concatenate([rng.uniform(-1.5, 1.5, (1, robot.nd)), steps]).cumsum(axis=0)
    begin = corners[:-1]
    edge = np.broadcast_to(np.arange(edges)[:, None, None, None], shape).ravel()
    lengths = np.broadcast_to(np.array(LENGTHS)[:, None], shape).ravel()
    middles = rng.uniform(0.5 * lengths, 1.0 - 0.5 * lengths)
    times = middles[:, None] + lengths[:, None] * np.linspace(-0.5, 0.5, SAMPLES + 1)
    every = np.repeat(edge, SAMPLES + 1)
    about = relative_places(robot, begin[every] + times.reshape(-1, 1) * steps[every])
    bound = TravelBound(robot)
    now, rates = begin[edge] + middles[:, None] * steps[edge], steps[edge]
    base = rng.normal(size=(len(edge), 3))
    base *= BASE_STEP / np.linalg.norm(base, axis=1, keepdims=True)
    which = np.broadcast_to(np.arange(len(BASES)), shape).ravel()
    base[which == 1] = 0.0
    turns = scales[:, None] * rng.uniform(-1, 1, (edges, 3))
    reaction = Reaction.along(robot, corners)
    for mode in MODES:
        if mode == "free-flying":
            quats = reaction.rotation(every, times.ravel())
            at_middle = reaction.rotation(edge, middles)
            moved = BaseMotion(True, False, np.zeros((len(edge), 3)), 0.0)
            travel = bound.in_world(now, rates, lengths, moved, at_middle)
            omega = None
        else:
            quats = rotations.exp(times.reshape(-1, 1) * turns[every])
            at_middle = rotations.exp(middles[:, None] * turns[edge])
            moved = BaseMotion(False, False, turns[edge], 0.0)
            travel = bound.in_world(now, rates, lengths, moved, at_middle)
            omega = np.linalg.norm(turns, axis=1)
        points = rng.integers(travel.points["speed"].shape[1], size=len(edge))
        follows = -travel.points["velocity"][np.arange(len(edge)), points]
        moves = np.where(which[:, None] == 2, follows, base)
        places = about @ np.swapaxes(rotations.matrix(quats), -1, -2)
        places = places.reshape(*times.shape, -1, 3)
        places += times[:, :, None, None] * moves[:, None, None]
        ways = np.sum(np.linalg.norm(np.diff(places, axis=1), axis=-1), axis=1)
        sampled = np.maximum.reduceat(ways, travel.first, axis=-1)
        fastest = simple_speeds(robot, begin, steps, omega)[edge]
        simple = lengths[:, None] * (fastest + np.linalg.norm(moves, axis=1)[:, None])
        bounds = travel.bounds(np.arange(len(edge)), moves)
        yield Found(scales, *(x.reshape(*shape, -1) for x in (sampled, bounds, simple)))


def relative_places(robot: fp.SpaceRobot, joint_values: np.ndarray) -> np.ndarray:
    """(N, P, 3) points of all shapes relative to the base; `Tree` is tested against Pinocchio."""
    poses, points = Tree(robot.model).poses(joint_values), TravelBound(robot).points
    links = points["link"]
    return poses.origins[:, links] + turned(poses.rotations[:, links], points["place"])


def simple_speeds(
    robot: fp.SpaceRobot, begin: np.ndarray, steps: np.ndarray, omega: "np.ndarray | None"
) -> np.ndarray:
    """(edges, g) speed bound of each shape about the base origin, every joint in the worst case."""
    model, tree = robot.model, Tree(robot.model)
    angular, linear, distance = np.zeros((3, len(steps), model.njoints - 1))
    ends = [np.linalg.norm(tree.offsets(q), axis=-1) for q in (begin, begin + steps)]
    offsets, rates = np.maximum(*ends), np.abs(steps)
    for j in range(1, model.njoints - 1):
        p, slides = tree.parents[j], tree.prismatic[j]
        angular[:, j] = angular[:, p] + (0.0 if slides else rates[:, j - 1])
        linear[:, j] = linear[:, p] + angular[:, p] * offsets[:, j]
        linear[:, j] += rates[:, j - 1] if slides else 0.0
        distance[:, j] = distance[:, p] + offsets[:, j]
    if omega is None:
        energy, inertia = np.zeros(len(steps)), 0.0
        for j, body in enumerate(list(model.inertias)[1:]):
            least, _, most = np.linalg.eigvalsh(body.inertia)
            speed = linear[:, j] + angular[:, j] * np.linalg.norm(body.lever)
            energy += body.mass * speed**2 + most * angular[:, j] ** 2
            inertia += least
        omega = np.sqrt(energy / inertia)
    bound = TravelBound(robot)
    links, reach = bound.points["link"], np.linalg.norm(bound.points["place"], axis=1)
    speeds = omega[:, None] * (distance[:, links] + reach)
    speeds += linear[:, links] + angular[:, links] * reach
    return np.maximum.reduceat(speeds, bound.shapes["first"], axis=-1)


class Ratios:
    """T / sampled travel and simple bound / sampled travel, sorted into the table's cells."""

    def __init__(self) -> None:
        self.cells: dict[tuple[float, ...], list[np.ndarray]] = {}
        self.count = self.violations = 0
        self.closest = np.inf

    def add(self, found: Found) -> None:
        """Add the results of one robot and mode."""
        self.count += found.sampled.size
        self.violations += int(np.sum(found.sampled > found.bound + ROUNDING))
        travels = found.sampled > 1e-9
        self.closest = min(self.closest, np.min((found.bound / found.sampled)[travels]))
        for s, h, b in product(range(len(STEPS)), range(len(LENGTHS)), range(len(BASES))):
            here = np.s_[found.steps == STEPS[s], :, h, b]
            there = travels[here]
            ratios = [x[here][there] / found.sampled[here][there] for x in found[2:]]
            self.cells.setdefault((s, h, b), []).append(np.array(ratios))

    def rows(self) -> Iterator[list[str]]:
        """Lines of the table."""
        for s, h in product(range(len(STEPS)), range(len(LENGTHS))):
            numbers = []
            for b in range(2):
                sharp, simple = np.concatenate(self.cells[s, h, b], axis=1)
                numbers += [*np.quantile(sharp, (0.5, 0.95)), np.median(simple)]
            length = str(Fraction(LENGTHS[h]))
            yield [f"{STEPS[s]:g}", length, *(f"{x:.3f}" for x in numbers)]

    def table(self) -> str:
        """Medians and 95th percentiles by joint step and length of the interval."""
        names = [f"{b}: {x}" for b in BASES[:2] for x in ("median", "95th", "simple bound")]
        return table(["joint step", "h", *names], self.rows())


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--robots", type=int, default=1000)
    parser.add_argument("--first-seed", type=int, default=1000, help="of the robots")
    parser.add_argument("--out", type=Path, default=RESULTS / "travel.md")
    args = parser.parse_args()
    begin = time.process_time()
    trees = {mode: Ratios() for mode in MODES}
    planar = Ratios()
    for seed in range(args.first_seed, args.first_seed + args.robots):
        for mode, found in zip(MODES, measure(random_tree(seed), seed), strict=True):
            trees[mode].add(found)
    for seed in range(max(1, args.robots // 20)):
        planar.add(next(measure(fp.load_robot("planar_dual_arm"), seed)))
    every = [*trees.values(), planar]
    closest = min(r.closest for r in every)
    print(f"{time.process_time() - begin:.0f} s", flush=True)
    publish(
        "# The travel bound against sampled travel\n\n"
        f"    python -m benchmarks.studies.proofs.travel_bound --robots {args.robots} "
        f"--first-seed {args.first_seed}\n\n"
        f"**{sum(r.violations for r in every)} violations** on {sum(r.count for r in every)} "
        f"link-intervals; the closest that T came to the sampled travel is {closest:.6f} times it. "
        "Random trees of revolute, continuous and prismatic joints with spheres, "
        "capsules, boxes and hulls; bases from far lighter than their arms to far heavier. Each "
        f"travel is the length of a polyline of {SAMPLES} chords. A third of the intervals have "
        f"a base that moves {BASE_STEP:g} m over the edge, a third one that stays, a third one "
        "that compensates the velocity of a point of the robot, so that only the curvature of its "
        "path remains; the last are checked like the others, but not in the tables.\n\n"
        "The tables give T as a multiple of the sampled travel, and the median of the simple "
        "bound, "
        "with every joint at its largest rate in the worst direction. The "
        "joint step is the most that a joint may change over the edge [rad or m], h the "
        "interval's share of the edge.\n\n"
        f"## planar_dual_arm, free-flying\n\n{planar.table()}\n\n"
        + "\n\n".join(f"## Random trees, {m}\n\n{r.table()}" for m, r in trees.items())
        + "\n",
        args.out,
    )


if __name__ == "__main__":
    main()
