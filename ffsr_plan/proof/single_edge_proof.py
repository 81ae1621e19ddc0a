"""`certify_edge`: the proof that one motion between two configurations is free."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array, equal_by_content, frozen
from ffsr_plan.core.checks import number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.prover import Prover
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene


@equal_by_content
class EdgeProof(NamedTuple):
    """Result of `certify_edge`.

    Attributes:
        free: whether the whole motion is proven free, of obstacles and of other links.
        least_clearance: least distance computed [m], negative in penetration: to an obstacle, or
            between two links if these are the reason for a refusal. Infinite in an empty scene.
        link: name of the link of that distance; empty in an empty scene.
        obstacle: the object nearest to it: index of a sphere, name of another link, or None in an
            empty scene.
        time: the time in [0, 1] of that distance.
        proven_clearance: lower bound on the distance to any obstacle along the whole motion [m];
            0 if the motion is not free.
        queries: number of configurations at which distances were computed, over all pairs.
        arrival: (nq,) configuration at the end, with the attitude that is reached.
    """

    free: bool
    least_clearance: float
    link: str
    obstacle: int | str | None
    time: float
    proven_clearance: float
    queries: int
    arrival: Array


def certify_edge(
    robot: SpaceRobot,
    scene: Scene,
    start: ArrayLike,
    goal: ArrayLike,
    mode: Mode | str = Mode.FREE_FLYING,
    tolerance: float = 1e-4,
) -> EdgeProof:
    """Prove that the motion from `start` to `goal` touches nothing, base reaction included.

    Base origin and joints move linearly, continuous joints the shorter way round. The proof uses
    interval halving with a bound on the travel of every point of the robot (docs/proof.md), not
    sampling. A motion whose clearance exceeds `tolerance` everywhere is never refused; touching
    counts as a collision.

    Args:
        robot: the robot.
        scene: the obstacles.
        start: (nq,) configuration at the start.
        goal: (nq,) configuration at the goal. Its attitude is ignored in the modes `free-flying`
            and `free-floating`, its base position in the mode `free-floating`: they follow from the
            arms' motion.
        mode: `free-flying` (thrusters move the base origin from `start` to `goal`),
            `attitude-held` (also, wheels rotate the base at a constant angular velocity to the
            attitude of `goal`) or `free-floating` (neither: the centre of mass is at rest).
        tolerance: clearance below which the motion may be refused, at least 1e-7 [m].

    Returns:
        The verdict, the least distance and where it is, and the arrival.

    Raises:
        InvalidInput: naming the argument, its value and what is allowed.
    """
    if not isinstance(robot, SpaceRobot):
        raise InvalidInput("robot", robot, "a SpaceRobot")
    if not isinstance(scene, Scene):
        raise InvalidInput("scene", scene, "a Scene")
    first, last = robot.check_configuration("start", start), robot.check_configuration("goal", goal)
    positions = np.stack([first[:3], last[:3]])
    motion = Motion(robot, Mode.parse("mode", mode), first, last, positions)
    prover = Prover(motion, scene, number("tolerance", tolerance, at_least=1e-7))
    offset = np.zeros(3)
    ends = prover.clearances(np.array([0, 1]), np.zeros((2, 3)))
    (links_verdict,) = prover.links.verdicts()
    verdict = prover.certify(0, offset, offset, (float(ends[0]), float(ends[1])))
    if verdict.free and not links_verdict.free:
        verdict, nearest = links_verdict, prover.links.nearest(0, links_verdict.time)
    else:
        nearest = prover.nearest(0, offset, offset, verdict.time)
    proven = prover.least_clearance(np.zeros((2, 3)), ends) if verdict.free else 0.0
    return EdgeProof(
        free=verdict.free,
        least_clearance=verdict.least_clearance,
        link=nearest.link,
        obstacle=nearest.obstacle if nearest.link else None,
        time=verdict.time,
        proven_clearance=proven,
        queries=prover.queries,
        arrival=frozen(motion.configurations()[-1]),
    )
