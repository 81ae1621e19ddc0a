"""Independent verification of a plan: dense samples, closed-form distances, momentum by bodies.

No code here calls the planner's clearance, momentum, length or objective code. The motion `plan.at`
is sampled as it is; velocities are finite differences of link poses. The plan's wheel momentum,
`plan.wheel_momentum`, is compared with these.

If a cylinder or mesh is replaced by another solid (`SpaceRobot.replacements`), all distances are to
that solid, as in the plan, and the verification checks that it contains the original: the cylinder
of the URDF, or the corners of the mesh's hull that the plan stores. So the true robot is at least
as clear.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.core.checks import whole_number
from ffsr_plan.verification.momentum_residual import momentum_residual, wheel_momentum_error
from ffsr_plan.verification.motion_samples import EdgeSamples, sample_edges
from ffsr_plan.verification.recomputed_objective import AGREEMENT, Recomputed, recompute
from ffsr_plan.verification.urdf_reading import Bodies

if TYPE_CHECKING:
    from ffsr_plan.plans.plan_data import PlanData

MOMENTUM_LIMIT = 1e-9
"""Allowed relative error of angular momentum."""
GOAL_LIMIT = 1e-6
"""Allowed error of a demanded goal attitude [rad]."""


@dataclass(frozen=True)
class Report:
    """Result of `plan.verify()`.

    Attributes:
        ok: whether there are no problems.
        problems: one sentence for each violated condition.
        least_clearance: least link-to-sphere distance over all samples [m].
        least_self_separation: least lower bound on the distance of links that must not touch, over
            all samples [m].
        momentum_residual: largest norm of the angular momentum about the centre of mass, relative
            to the sum of the bodies' own terms; None if wheels hold the attitude.
        center_drift: largest distance of the centre of mass from its initial position over all
            samples [m]; None if thrusters move it.
        wheel_momentum_error: largest error of the plan's wheel momentum, relative in the same way;
            None in modes without wheels.
        clearance_error: largest error of the plan's node clearances [m].
        objective_error: relative error of the plan's F.
        samples: number of configurations whose distances were computed.
        largest_step: longest displacement of a shape's centre between two samples [m].
    """

    ok: bool
    problems: tuple[str, ...]
    least_clearance: float
    least_self_separation: float
    momentum_residual: float | None
    center_drift: float | None
    wheel_momentum_error: float | None
    clearance_error: float
    objective_error: float
    samples: int
    largest_step: float


def verify(plan: PlanData, samples: int = 2000) -> Report:
    """Verify a plan from its configurations and its motion alone.

    Args:
        plan: the plan.
        samples: number of distance checks for each edge.

    Returns:
        The measured values and the problems found.

    Raises:
        InvalidInput: `samples` is not a positive integer.
    """
    samples = whole_number("samples", samples, at_least=1)
    problem = plan.problem
    bodies = Bodies(problem.robot.urdf, problem.robot.srdf, problem.robot.replacements)
    edges = sample_edges(plan, bodies, samples)
    held = problem.mode.has_wheels
    residual = None if held else momentum_residual(plan, bodies)
    wheel_error = wheel_momentum_error(plan, bodies) if held else None
    drift = _center_drift(edges) if problem.mode.floats else None
    costs = recompute(plan, bodies)
    problems = (
        *_bad_input(plan, bodies),
        *_collisions(plan, edges),
        *_broken_momentum(residual, wheel_error, drift),
        *_ends_and_limits(plan),
        *_other_costs(plan, costs),
    )
    least, gap = min(e.clearance for e in edges), min(e.separation for e in edges)
    errors = (residual, drift, wheel_error, costs.clearance_error, costs.objective_error)
    if any(value is not None and np.isnan(value) for value in (least, gap, *errors)):
        problems += ("some of the figures are not numbers",)
    return Report(
        ok=not problems,
        problems=problems,
        least_clearance=least,
        least_self_separation=gap,
        momentum_residual=residual,
        center_drift=drift,
        wheel_momentum_error=wheel_error,
        clearance_error=costs.clearance_error,
        objective_error=costs.objective_error,
        samples=sum(len(e.centers_of_mass) for e in edges),
        largest_step=max(e.largest_step for e in edges),
    )


def _center_drift(edges: list[EdgeSamples]) -> float:
    """Largest distance of the centre of mass from its initial position [m]."""
    start = edges[0].centers_of_mass[0]
    return max(float(np.linalg.norm(e.centers_of_mass - start, axis=1).max()) for e in edges)


def _bad_input(plan: PlanData, bodies: Bodies) -> list[str]:
    problems = []
    if not np.all(np.isfinite(plan.configurations)):
        problems.append("some configurations are not numbers")
    for link in bodies.uncovered(plan.problem.robot.meshes):
        problems.append(f"a shape of link '{link}' is not contained in its replacement")
    return problems


def _collisions(plan: PlanData, edges: list[EdgeSamples]) -> list[str]:
    problems = []
    clearances, separations = [e.clearance for e in edges], [e.separation for e in edges]
    least, proven = min(clearances), plan.certificate.least_clearance
    if least <= 0.0:
        problems.append(
            f"a link is {-least:.3g} m inside an obstacle on edge {np.argmin(clearances)}"
        )
    if min(separations) <= 0.0:
        problems.append(f"two links touch on edge {int(np.argmin(separations))}")
    if proven > least + AGREEMENT:
        problems.append(
            f"the plan's proven clearance is {proven:.6g} m, but {least:.6g} m was measured"
        )
    return problems


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


def _ends_and_limits(plan: PlanData) -> list[str]:
    problem, robot = plan.problem, plan.problem.robot
    first, last = plan.configurations[0], plan.configurations[-1]
    values = robot.joint_values(plan.configurations)
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
    corners = plan.at(np.arange(len(plan.configurations)) / problem.lattice.divisions)
    if np.abs(corners - plan.configurations).max() > AGREEMENT:
        problems.append("the motion does not pass through the plan's configurations")
    if np.any((values < robot.lower - AGREEMENT) | (values > robot.upper + AGREEMENT)):
        problems.append("a joint leaves its limits")
    return problems


__all__ = ["Report", "verify"]
