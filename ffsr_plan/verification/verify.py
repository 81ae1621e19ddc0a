"""Independent verification of a plan: distances of its own all along it, momentum by bodies.

No code here calls the planner's clearance, momentum, length or objective code. The motion `plan.at`
is sampled as it is; velocities are finite differences of link poses. The plan's wheel momentum,
`plan.wheel_momentum`, is compared with these. Samples are halved until nothing can be hidden
between them (`sweep`); the bound on the base's rotation behind that rests on the conservation of
momentum, which is checked at three stations on every edge, and at every sample.

Bodies that move are where their motions have them, by code of its own (`moving_bodies`), at the
times that the problem's duration and ramp give to places on the path.

If a cylinder or mesh is replaced by another solid (`SpaceRobot.replacements`), all distances are to
that solid, as in the plan, and the verification checks that it contains the original: the cylinder
of the URDF, or the corners of the mesh's hull that the plan stores. So the true robot is at least
as clear.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.bodies.pose_function import PoseFunction
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import whole_number
from ffsr_plan.core.contacts import encounter
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.verification.momentum_residual import momentum_residual, wheel_momentum_error
from ffsr_plan.verification.motion_samples import Sampler
from ffsr_plan.verification.recomputed_objective import AGREEMENT, Recomputed, recompute
from ffsr_plan.verification.recomputed_path import FreePath, LatticePath, path_of
from ffsr_plan.verification.sweep import CONFIRMED, OnProgress, Place, Swept, sweep
from ffsr_plan.verification.urdf_reading import Bodies

if TYPE_CHECKING:
    from ffsr_plan.plans.plan_data import PlanData
    from ffsr_plan.problem.problem import Problem
    from ffsr_plan.robots.robot import SpaceRobot

MOMENTUM_LIMIT = 1e-9
"""Allowed relative error of angular momentum."""
GOAL_LIMIT = 1e-6
"""Allowed error of a demanded goal attitude [rad]."""
SAMPLES = 50
"""Even samples on each edge by default; more are added where they are needed."""
_MOST_EVEN_SAMPLES = 10_000_000  # on all edges together, to limit the time


@dataclass(frozen=True)
class Report:
    """Result of `plan.verify()`.

    Attributes:
        ok: whether there are no problems.
        problems: one sentence for each violated condition.
        not_checked: one sentence for each part of the plan that was not checked.
        unchecked: links that have a mass or a visual shape but no collision shape: nothing is known
            about obstacles in their way.
        least_clearance: least distance of a link to an obstacle or to the outside of a zone, over
            all samples [m]; where they overlap, a lower bound.
        clearance_bound: lower bound on that distance all along the motion, between the samples too,
            from bounds on the travel of all points [m].
        least_self_separation: least distance of links that must not touch, over all samples [m].
        momentum_residual: largest norm of the angular momentum about the centre of mass, relative
            to the sum of the bodies' own terms; None if wheels hold the attitude.
        center_drift: largest distance of the centre of mass from its initial position over all
            samples [m]; None if thrusters move it.
        wheel_momentum_error: largest error of the plan's wheel momentum, relative in the same way;
            None in modes without wheels.
        clearance_error: largest error of the plan's node clearances [m].
        objective_error: relative error of the plan's F.
        samples: number of configurations whose distances were computed.
        largest_step: longest way of any point between two samples [m].
        largest_gap: the same for samples between which a contact may be hidden; 0 where there are
            none. Such a plan is not ok.
        nearest_body: the moving body from which the least clearance was measured, in words; None
            where that is an obstacle at rest, or none.
        nearest_time: when the least clearance was measured [s]; None without obstacles, or without
            a duration.
    """

    ok: bool
    problems: tuple[str, ...]
    not_checked: tuple[str, ...]
    unchecked: tuple[str, ...]
    least_clearance: float
    clearance_bound: float
    least_self_separation: float
    momentum_residual: float | None
    center_drift: float | None
    wheel_momentum_error: float | None
    clearance_error: float
    objective_error: float
    samples: int
    largest_step: float
    largest_gap: float
    nearest_body: str | None
    nearest_time: float | None


def verify(plan: PlanData, samples: int = SAMPLES, on_progress: OnProgress | None = None) -> Report:
    """Verify a plan from its configurations and its motion alone.

    Args:
        plan: the plan.
        samples: least number of equal time steps on each edge; where links are closer to obstacles
            or to each other than they can move in such a step, it is halved.
        on_progress: called with the share of the motion that is done, from 0 to 1.

    Returns:
        The measured values, the problems found, and what was not checked.

    Raises:
        InvalidInput: `samples` is not allowed, or a function of a body's motion tells no pose.
        IntegrationError: a tumble of a body that cannot be integrated accurately.
    """
    samples, problem = _checked(plan, samples, on_progress), plan.problem
    bodies = Bodies(problem.robot.urdf, problem.robot.srdf, problem.robot.replacements)
    swept = sweep(Sampler(plan, bodies), bodies, samples, on_progress)
    held = problem.mode.has_wheels
    residual = None if held else momentum_residual(plan, bodies)
    wheel_error = wheel_momentum_error(plan, bodies) if held else None
    drift = swept.drift if problem.mode.floats else None
    with np.errstate(over="ignore", invalid="ignore"):  # absurd weights give infinite lengths
        costs, path = recompute(plan, bodies, swept.nodes), path_of(plan)
        contradictions = path.problems(bodies, swept.nodes) if swept.finite else []
    problems = (
        *_bad_input(plan, bodies),
        *collisions(plan.certificate.least_clearance, swept, timed=problem.duration is not None),
        *other_motion(swept),
        *other_bodies(problem, swept),
        *_broken_momentum(residual, wheel_error, drift),
        *_ends_and_limits(plan),
        *_other_costs(plan, costs),
        *contradictions,
    )
    places = swept.clearance, swept.separation
    least, gap = (place.value if place else np.inf for place in places)
    errors = (residual, drift, wheel_error, costs.clearance_error, costs.objective_error)
    if not swept.finite or any(v is not None and np.isnan(v) for v in (least, gap, *errors)):
        problems += ("some of the figures are not numbers",)
    return Report(
        ok=not problems,
        problems=problems,
        not_checked=tuple(_not_checked(plan, path, bodies)),
        unchecked=bodies.unchecked,
        least_clearance=least,
        clearance_bound=float(swept.clearance_bound),
        least_self_separation=gap,
        momentum_residual=residual,
        center_drift=drift,
        wheel_momentum_error=wheel_error,
        clearance_error=costs.clearance_error,
        objective_error=costs.objective_error,
        samples=swept.samples,
        largest_step=float(swept.largest_step),
        largest_gap=max((place.value for place in swept.hidden if place), default=0.0),
        nearest_body=(swept.clearance.body or None) if swept.clearance else None,
        nearest_time=_time_of(problem, swept),
    )


def _checked(plan: PlanData, samples: int, on_progress: OnProgress | None) -> int:
    """The number of samples, after a check of the arguments."""
    if on_progress is not None and not callable(on_progress):
        raise InvalidInput("on_progress", on_progress, "a function, or None")
    most = max(1, _MOST_EVEN_SAMPLES // plan.edges)
    return whole_number("samples", samples, at_least=1, at_most=most)


def _time_of(problem: Problem, swept: Swept) -> float | None:
    """When the least clearance was measured [s]."""
    if swept.clearance is None or problem.duration is None:
        return None
    return swept.clearance.time


def _not_checked(plan: PlanData, path: LatticePath | FreePath, bodies: Bodies) -> Iterator[str]:
    """What the verification takes as the plan has it."""
    if plan.optimum_is_exact:
        yield "that the optimum is the least F on the lattice (`LatticeOptimum` computes it anew)"
    else:
        yield "that the lower bound on F holds"
    yield "how it was found: planner, seed, tolerance, history, trails, counts of edges and queries"
    yield "whether the search was interrupted, and its seconds"
    if plan.problem.scene.excess > 0.0:
        yield "that the spheres cover what they stand for, and by how much they exceed it"
    yield from functions_not_checked(plan.problem)
    if path.bent:
        yield "F on the lattice, from which the joints were moved to reach the goal's attitude"
    elif path.moved:
        yield "that the path on the lattice is free between its nodes: the refined one was checked"
    yield from shapes_not_checked(plan.problem.robot, bodies)


def functions_not_checked(problem: Problem) -> Iterator[str]:
    """What the verification takes as functions of bodies' motions state it.

    Args:
        problem: gives the bodies.
    """
    for body in problem.scene.bodies:
        if isinstance(body.motion, PoseFunction):
            yield f"that {body.word} '{body.name}' is no faster than stated between two samples"


def shapes_not_checked(robot: SpaceRobot, bodies: Bodies) -> Iterator[str]:
    """What the verification takes as it is of a robot's shapes.

    Args:
        robot: the robot.
        bodies: the same, from its URDF.
    """
    if robot.meshes:
        yield "that the hulls of meshes are those of their files, which the plan does not need"
    if robot.disabled_pairs:
        pairs = ", ".join(f"{a} and {b}" for a, b in robot.disabled_pairs)
        yield f"pairs of links that the SRDF exempts: {pairs}"
    if bodies.unchecked:
        yield f"links without a shape for collisions: {', '.join(bodies.unchecked)}"


def _bad_input(plan: PlanData, bodies: Bodies) -> list[str]:
    problems = []
    if not np.all(np.isfinite(plan.configurations)):
        problems.append("some configurations are not numbers")
    for link in bodies.uncovered(plan.problem.robot.meshes):
        problems.append(f"a shape of link '{link}' is not contained in its replacement")
    return problems


def collisions(
    proven: float, swept: Swept, motion: str = "plan", part: str = "edge", *, timed: bool = False
) -> list[str]:
    """What is wrong with distances along a motion.

    Args:
        proven: clearance that the motion claims [m].
        swept: the distances found.
        motion: what it is, in words.
        part: what one of its edges is, in words.
        timed: whether the places have times.
    """

    def where(place: Place) -> str:
        return f"on {part} {place.edge}" + (f" at {place.time:.6g} s" if timed else "")

    problems, least = [], np.inf
    if (nearest := swept.clearance) is not None:
        least = nearest.value
        if least <= 0.0:
            what = encounter(least, None, swept.obstacle)
            problems.append(f"link '{nearest.names[0]}' {what} {where(nearest)}")
    if (pair := swept.separation) is not None and pair.value <= 0.0:
        problems.append(f"two links touch {where(pair)}: '{pair.names[0]}' and '{pair.names[1]}'")
    if proven > least + AGREEMENT:
        measured = f"{least:.6g} m" if least > 0.0 else "none"
        stated = f"the {motion}'s proven clearance is {proven:.6g} m"
        problems.append(f"{stated}, but {measured} was measured")
    elif np.isinf(proven) != np.isinf(least) or proven > swept.clearance_bound + CONFIRMED:
        problems.append(f"the {motion}'s proven clearance of {proven:.6g} m is not confirmed")
    for place, other in zip(swept.hidden, ("an obstacle", "another link"), strict=True):
        if place is not None:
            other = f"link '{place.names[1]}'" if len(place.names) > 1 else place.body or other
            problems.append(
                f"link '{place.names[0]}' may touch {other} {where(place)} between two "
                f"samples {place.value:.2g} m apart"
            )
    return problems


def other_motion(swept: Swept) -> list[str]:
    """Where the motion is not what bounds on its travel rest on."""
    problems = []
    if swept.deviation > AGREEMENT:
        problems.append(
            f"joints or base leave the straight line between two nodes by {swept.deviation:.3g}"
        )
    if swept.excess_turn > AGREEMENT:
        problems.append(
            f"the base turns by {swept.excess_turn:.3g} rad more between two samples than it can"
        )
    return problems


def other_bodies(problem: Problem, swept: Swept) -> Iterator[str]:
    """Bodies that move farther than the bounds on their travel say, which functions may do.

    Args:
        problem: gives the bodies.
        swept: what was found along a motion.
    """
    still = len(problem.scene.at_rest)
    for k, excess in enumerate(swept.excess_ways):
        if excess > AGREEMENT:
            name = problem.scene.source_of(still + k)
            yield f"{name} moves by {excess:.3g} m or rad more between two samples than it can"


def _broken_momentum(
    residual: float | None, wheel_error: float | None, drift: float | None
) -> list[str]:
    problems = []
    if residual is not None and residual > MOMENTUM_LIMIT:
        problems.append(f"angular momentum is not conserved: residual {residual:.3g}")
    if wheel_error is not None and wheel_error > MOMENTUM_LIMIT:
        problems.append(f"the wheels must store another momentum: error {wheel_error:.3g}")
    if drift is not None and drift > AGREEMENT:
        problems.append(f"the centre of mass moves by {drift:.3g} m without thrusters")
    return problems


def _other_costs(plan: PlanData, costs: Recomputed) -> list[str]:
    problems = []
    if costs.clearance_error > costs.clearance_tolerance:
        problems.append(f"node clearances differ by {costs.clearance_error:.3g} m")
    if abs(costs.length - plan.length) > AGREEMENT * max(costs.length, 1.0):
        problems.append(f"the length is {costs.length:.12g} m, not {plan.length:.12g} m")
    if costs.objective_error > costs.objective_tolerance:
        problems.append(f"F is {costs.objective:.12g}, not {plan.objective:.12g}")
    return problems


def other_ends(problem: Problem, first: Array, last: Array) -> list[str]:
    """Where a motion does not lead from the start to the goal.

    Args:
        problem: gives start and goal.
        first: (nq,) configuration at its begin.
        last: (nq,) at its end.
    """
    problems = []
    if np.abs(first - problem.start).max() > AGREEMENT:
        problems.append("the motion does not begin at the start")
    reached = last[7:] - problem.goal[7:]
    if problem.mode.has_thrusters:
        reached = np.append(reached, last[:3] - problem.goal[:3])
    if np.max(np.abs(reached), initial=0.0) > AGREEMENT:
        problems.append("the motion does not end at the goal")
    if problem.mode.has_wheels:
        overlap = abs(float(last[3:7] @ problem.goal[3:7]))
        if overlap < 1.0 - AGREEMENT:
            problems.append("the motion does not end at the goal's attitude")
    if problem.reach_attitude:
        chord = min(np.linalg.norm(last[3:7] - sign * problem.goal[3:7]) for sign in (1.0, -1.0))
        if (missed := 4.0 * np.arcsin(0.5 * chord)) > GOAL_LIMIT:
            problems.append(f"the goal's attitude is missed by {missed:.3g} rad")
    return problems


def _ends_and_limits(plan: PlanData) -> list[str]:
    problems = other_ends(plan.problem, plan.configurations[0], plan.configurations[-1])
    robot = plan.problem.robot
    values = robot.joint_values(plan.configurations)
    corners = plan.at(np.arange(len(plan.configurations)) / plan.edges)
    if np.abs(corners - plan.configurations).max() > AGREEMENT:
        problems.append("the motion does not pass through the plan's configurations")
    if np.any((values < robot.lower - AGREEMENT) | (values > robot.upper + AGREEMENT)):
        problems.append("a joint leaves its limits")
    return problems


__all__ = ["Report", "verify"]
