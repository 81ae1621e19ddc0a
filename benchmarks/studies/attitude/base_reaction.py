"""Collisions of plans that assume a held attitude, on a robot whose base reacts.

    python -m benchmarks.studies.attitude.base_reaction

Problems of family `paper` are planned with the attitude held. The same base path and arm motion is
then flown with the base reacting, for several base masses, and compared with plans of the same
problems made with reaction. Writes docs/benchmarks/base_reaction.md and
base_reaction.png. It takes about ten minutes.

A base of another mass is the base of the paper's robot with its mass and moments of inertia scaled
by one factor, in the `<inertial>` of the URDF's root link. Its shape and the arms do not change.
"""

import argparse
import sys
import time
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import matplotlib.pyplot as plt
import numpy as np

import ffsr_plan as fp
from benchmarks.paper_scenes import NUMBERS, add_problems_option, paper_problem, problem_name
from benchmarks.report_pages import RESULTS, publish, table
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.prover import Prover
from ffsr_plan.robots.loading import robot_from_urdf

MASSES = (5.0, 20.0, 100.0, 500.0, 2000.0)
DELTAS = (0.0, 0.001, 0.1, 2.0)
PLANNER = fp.LatticeOptimum()
DEEP = 0.01  # [m] a penetration deeper than any calibration error
COLOURS = ("#d95f02", "#7a5fa8", "#2a7f9e", "#3b4252")
REACTING = "#2f8f4e"


class Flight(NamedTuple):
    """A plan that assumes a held attitude, flown by a base that reacts.

    Attributes:
        number: of the problem in family `paper`.
        delta: weight of clearances in F.
        mass: of the base [kg].
        least: least distance of a link to an obstacle [m], in closed form at all samples.
        proven: whether every edge of the flown motion is proven free.
        rival: least distance [m] of the plan made with reaction, same scene and base.
        verified: whether that plan passes `verify()`.
    """

    number: int
    delta: float
    mass: float
    least: float
    proven: bool
    rival: float
    verified: bool


def with_base(robot: fp.SpaceRobot, mass: float) -> fp.SpaceRobot:
    """The robot with a base of another mass [kg], moments of inertia in proportion."""
    root = ElementTree.fromstring(robot.urdf)
    carried = {str(child.get("link")) for child in root.iterfind("joint/child")}
    base = next(link for link in root.iterfind("link") if link.get("name") not in carried)
    weight, moments = base.find("inertial/mass"), base.find("inertial/inertia")
    factor = mass / float(weight.get("value"))
    weight.set("value", repr(mass))
    for name, value in moments.items():
        moments.set(name, repr(factor * float(value)))
    return robot_from_urdf(ElementTree.tostring(root, encoding="unicode"), robot.name)


def flown(plan: fp.Plan, robot: fp.SpaceRobot) -> fp.Plan:
    """The base path and the arm motion of a plan, on a robot whose base reacts."""
    problem = replace(plan.problem, robot=robot, mode="free-flying")
    along = plan.configurations[:, :3]
    motion = Motion(robot, problem.mode, problem.start, problem.goal, along)
    return replace(plan, problem=problem, motion=motion)


def turns(robot: fp.SpaceRobot, problem: fp.Problem) -> float:
    """Largest angle between the attitude at the start and later on [deg]; the same on any path."""
    motion = fp.LayeredLattice(replace(problem, robot=robot)).nominal
    edge = np.repeat(np.arange(motion.edges), 20)
    q = motion.at(edge, np.tile(np.linspace(0.0, 1.0, 20), motion.edges))
    return float(np.degrees(rotations.angle_between(problem.start[3:7], q[:, 3:7]).max()))


def proven(plan: fp.Plan) -> bool:
    """Whether every edge is proven free. Distances between links do not depend on the attitude."""
    motion = plan.motion
    prover = Prover(motion, plan.problem.scene, plan.problem.tolerance)
    still = np.zeros(3)
    ends = prover.clearances(np.arange(motion.edges + 1), np.zeros((motion.edges + 1, 3)))
    return all(
        prover.certify(k, still, still, (float(ends[k]), float(ends[k + 1]))).free
        for k in range(motion.edges)
    )


def planned(
    number: int, robots: Iterable[fp.SpaceRobot]
) -> Iterator[tuple[fp.Plan, list[fp.Plan]]]:
    """For each delta the plan with the attitude held, and those with reaction."""
    for delta in DELTAS:
        problem = paper_problem(number, delta)
        held = fp.plan(replace(problem, mode="attitude-held"), PLANNER)
        yield held, [fp.plan(replace(problem, robot=robot), PLANNER) for robot in robots]


def measure(
    numbers: Iterable[int], samples: int
) -> tuple[list[Flight], dict[type[fp.PlanningError], int]]:
    """The flights of the scenes with a path in both modes, and why others were skipped.

    A scene counts if it has a path with the attitude held and with reaction for every base mass.
    Then no collision is caused by a goal or a passage that cannot be reached.
    """
    ends = paper_problem(NUMBERS[0], 0.0)
    robots = {mass: with_base(ends.robot, mass) for mass in MASSES}
    flights: list[Flight] = []
    refused: dict[type[fp.PlanningError], int] = {}
    for number in numbers:
        try:
            plans = list(planned(number, robots.values()))
        except fp.PlanningError as error:
            refused[type(error)] = refused.get(type(error), 0) + 1
            continue
        for held, reacting in plans:
            for (mass, robot), rival in zip(robots.items(), reacting, strict=True):
                flight = flown(held, robot)
                least, free = flight.verify(samples).least_clearance, proven(flight)
                if free and least <= 0.0:
                    raise RuntimeError(
                        f"{problem_name(number)}: proven free, {-least:.3g} m inside"
                    )
                report = rival.verify(samples)
                delta = held.problem.delta
                flights.append(
                    Flight(number, delta, mass, least, free, report.least_clearance, report.ok)
                )
        print(problem_name(number), file=sys.stderr, flush=True)
    return flights, refused


def draw(flights: list[Flight], angles: dict[float, float], scenes: int, out: Path) -> None:
    """Left the number of collisions, right their depth (bars: medians), both by base mass."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 3.9), layout="constrained")
    places = np.arange(len(MASSES))
    for k, (delta, colour) in enumerate(zip(DELTAS, COLOURS, strict=True)):
        hits = [sum(f.least <= 0.0 for f in pick(flights, delta, mass)) for mass in MASSES]
        left.plot(places, hits, "o-", color=colour, label=f"as if held, δ = {delta:g}")
        for place, mass in enumerate(MASSES):
            depths = [-1e3 * f.least for f in pick(flights, delta, mass) if f.least <= 0.0]
            at = np.full(len(depths), place + 0.18 * (k - 1.5))
            right.plot(at, depths, "o", ms=4, color=colour, alpha=0.5, mew=0)
            if depths:
                middle = np.median(depths)
                right.plot(at[0] + np.array([-0.07, 0.07]), [middle] * 2, "-", color=colour, lw=2)
    rivals = [
        max(sum(f.rival <= 0.0 for f in pick(flights, delta, mass)) for delta in DELTAS)
        for mass in MASSES
    ]
    left.plot(places, rivals, "s--", color=REACTING, label="with reaction, any δ")
    left.set_ylim(-0.03 * scenes, 1.03 * scenes)
    left.set_ylabel(f"plans that collide when flown, of {scenes}")
    figure.legend(loc="outside upper center", ncols=5, frameon=False, fontsize=9)
    right.set_yscale("log")
    right.set_ylabel("depth of each collision [mm]")
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
        axes.set_xticks(places, [f"{mass:g}\n{angles[mass]:.2g}°" for mass in MASSES])
        axes.set_xlim(-0.5, len(MASSES) - 0.5)
        axes.set_xlabel("base mass [kg], and how far the base turns")
        axes.grid(alpha=0.3, axis="y")
    figure.savefig(out, dpi=110)


def pick(flights: list[Flight], delta: float, mass: float) -> list[Flight]:
    """The flights of one delta and base mass."""
    return [f for f in flights if f.delta == delta and f.mass == mass]


def row(flights: list[Flight], mass: float, angle: float) -> list[str]:
    """A line of the table."""
    groups = [pick(flights, delta, mass) for delta in DELTAS]
    every = [f for group in groups for f in group]
    worst = min(f.least for f in every)
    counts = [
        f"{sum(f.least <= 0.0 for f in group)} ({sum(f.least <= -DEEP for f in group)})"
        for group in groups
    ]
    return [
        f"{mass:g}",
        f"{angle:.2g}" if angle < 10.0 else f"{angle:.1f}",
        *counts,
        f"{-1e3 * worst:.1f}" if worst <= 0.0 else "-",
        f"{sum(f.rival <= 0.0 for f in every)} of {len(every)}",
        f"{sum(f.verified for f in every)} of {len(every)}",
    ]


TEXT = """# Planned as if the attitude were held, flown with a base that reacts

`{command}`

{scenes} of {problems} problems of family `paper` of [the problem set](../howto/problem_set.md), the
exact lattice optimum, refined. Each is planned with the attitude held, start and goal attitude
equal, and proven free in that mode. Then the same base path and arm motion is flown with the base
reacting. The last columns show plans of the same problems made with reaction. The table counts
colliding plans out of {scenes} for each delta and base mass, in brackets those that collide by
{deep:g} mm or more.

{results}

![Colliding plans and their depth by base mass; bars are medians](base_reaction.png)

- Collisions and depths are found by `plan.verify()`: in closed form at {samples} samples on every
  edge, without the planner's distance code; "verified" counts the plans made with reaction that
  pass all its checks, momentum included. The flown motions were certified too, edge by edge:
  {proofs}.
- The depth is how far a link would have to be moved to come free.
- The arms' motion is that of `scenarios/fig2a.toml` in all problems. It alone determines how far
  the base turns, the same on every path. A plan with the attitude held does not depend on masses,
  so there is one plan for all bases.
- The base is that of the paper's robot, 5 kg; for the others its mass and its moments of inertia
  are multiplied by one factor in the URDF. Its shape and the arms (2.2 kg in all) do not change.
  Only the ratio matters: 20 kg corresponds to a satellite whose arms have a tenth of its mass.
- A problem counts if it has a path with the attitude held and with reaction for every base mass,
  where the goal is checked at the attitude that is reached. So no collision counted here is caused
  by the goal or by a closed passage. Skipped: {refused}.
- Plans with little clearance collide at small rotations. At delta = 0 the lattice spacing alone
  determines the clearance, and for most plans one degree suffices. With clearance in the cost fewer
  plans collide, because the clearance exceeds the error. Which delta is enough depends on the scene
  and on the base; only a plan with reaction is known to be free.
"""


def main() -> None:
    """Measure and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    add_problems_option(parser)
    parser.add_argument("--samples", type=int, default=500, help="distance checks per edge")
    parser.add_argument("--out", type=Path, default=RESULTS, help="directory")
    args = parser.parse_args()
    begin = time.perf_counter()
    flights, refused = measure(NUMBERS[: args.problems], args.samples)
    scenes = len({flight.number for flight in flights})
    ends = paper_problem(NUMBERS[0], 0.0)
    angles = {mass: turns(with_base(ends.robot, mass), ends) for mass in MASSES}
    args.out.mkdir(parents=True, exist_ok=True)
    draw(flights, angles, scenes, args.out / "base_reaction.png")
    header = ["base mass [kg]", "base turns by [deg]"]
    header += [f"planned as if held, delta = {delta:g}: collide" for delta in DELTAS]
    header += ["deepest [mm]", "planned with reaction, all deltas: collide", "verified"]
    hits = sum(f.least <= 0.0 for f in flights)
    cautious = sum(f.least > 0.0 and not f.proven for f in flights)
    lost = ", ".join(f"{n} with `{kind.__name__}`" for kind, n in refused.items())
    publish(
        TEXT.format(
            command=f"python -m benchmarks.studies.attitude.base_reaction "
            f"--problems {args.problems} --samples {args.samples}",
            scenes=scenes,
            problems=args.problems,
            samples=f"{args.samples:,}".replace(",", " "),
            results=table(header, [row(flights, mass, angles[mass]) for mass in MASSES]),
            proofs=f"all {hits} that collide are refused, and of the {len(flights) - hits} others "
            f"{cautious}",
            deep=1e3 * DEEP,
            refused=lost or "none",
        ),
        args.out / "base_reaction.md",
    )
    print(f"{(time.perf_counter() - begin) / 60.0:.1f} minutes", file=sys.stderr)


if __name__ == "__main__":
    main()
