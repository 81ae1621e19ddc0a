"""`certify_edge`: the proof that one motion between two configurations is free, on its own."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array, frozen
from ffsr_plan.core.checks import number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.dynamics.mode import Mode
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.prover import Prover
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene


class EdgeProof(NamedTuple):
    """What `certify_edge` found out."""

    free: bool
    """Whether the whole motion is proven free, of obstacles and of other links."""
    least_clearance: float
    """Least distance met [m], negative in penetration: to an obstacle, or, where two links stand in
    the way, between them. Infinite in an empty scene."""
    link: str
    """The link that is nearest there; empty in an empty scene."""
    obstacle: int | str | None
    """What it is nearest to: index of a sphere, or name of another link."""
    time: float
    """Where on the motion that is, in [0, 1]."""
    proven_clearance: float
    """Lower bound on the distance to any obstacle all along [m]; 0 where the motion is not free."""
    queries: int
    """Configurations at which Coal was asked, over all pairs."""
    arrival: Array
    """(nq,) configuration at the end, its attitude the one really reached."""


def certify_edge(
    robot: SpaceRobot,
    scene: Scene,
    begin: ArrayLike,
    end: ArrayLike,
    mode: Mode | str = Mode.FREE_FLYING,
    tolerance: float = 1e-4,
) -> EdgeProof:
    """Prove that the motion from `begin` to `end` touches nothing, base reaction included.

    Base origin and joints move linearly, continuous joints the shorter way round. The proof is by
    interval halving with a bound on how far any point of the robot can travel (docs/proof.md), not
    by sampling. A motion that keeps more than `tolerance` all along is never refused; touching
    counts as a collision.

    Args:
        robot: the robot.
        scene: the obstacles.
        begin: (nq,) configuration to start from.
        end: (nq,) configuration to go to. In the mode `free-flying` its attitude is not looked at,
            in the mode `free-floating` nor is its base position: they follow from the arms' motion.
        mode: `free-flying` (thrusters move the base origin from `begin` to `end`), `attitude-held`
            (they do, and wheels turn the base steadily to the attitude of `end`) or `free-floating`
            (neither: the centre of mass stays put).
        tolerance: clearance [m] below which the motion may be refused, at least 1e-7.

    Raises:
        InvalidInput: naming the argument, its value and what is allowed.
    """
    if not isinstance(robot, SpaceRobot):
        raise InvalidInput("robot", robot, "a SpaceRobot")
    if not isinstance(scene, Scene):
        raise InvalidInput("scene", scene, "a Scene")
    first, last = robot.check_configuration("begin", begin), robot.check_configuration("end", end)
    positions = np.stack([first[:3], last[:3]])
    motion = Motion(robot, Mode.parse("mode", mode), first, last, positions)
    prover = Prover(motion, scene, number("tolerance", tolerance, at_least=1e-7))
    still = np.zeros(3)
    ends = prover.clearances(np.array([0, 1]), np.zeros((2, 3)))
    (apart,) = prover.self_verdicts()
    verdict = prover.certify(0, still, still, (float(ends[0]), float(ends[1])))
    if verdict.free and not apart.free:
        verdict, near = apart, prover.nearest_links(0, apart.time)
    else:
        near = prover.nearest(0, still, still, verdict.time)
    free = verdict.free
    proven = prover.least_clearance(np.zeros((2, 3)), ends) if free else 0.0
    arrival = frozen(motion.configurations()[-1])
    other = near.other if near.link else None
    return EdgeProof(
        free, verdict.least_clearance, near.link, other, verdict.time, proven,
        prover.queries, arrival,
    )  # fmt: skip
