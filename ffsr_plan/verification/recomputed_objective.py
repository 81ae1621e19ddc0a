"""Node clearances, L and F of a plan from its configurations alone (Eqs. 4, 6, 8 and 9)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.verification.motion_samples import link_poses
from ffsr_plan.verification.solids import sphere_distance
from ffsr_plan.verification.urdf_reading import Bodies

if TYPE_CHECKING:
    from ffsr_plan.plans.plan_data import PlanData
    from ffsr_plan.problem.problem import Problem

AGREEMENT = 1e-9
"""Allowed difference of lengths [m] and, relative, of F."""
HULL_AGREEMENT = 1e-8
"""Allowed difference of distances to a hull [m], the precision of Coal's iterations."""


class Recomputed(NamedTuple):
    """Clearances, length and objective of a plan, and the differences from the plan's values.

    Attributes:
        length: L [m].
        objective: F.
        clearance_error: largest difference of a node clearance [m].
        objective_error: relative difference of F.
        clearance_tolerance: allowed difference of a node clearance [m].
        objective_tolerance: allowed relative difference of F.
    """

    length: float
    objective: float
    clearance_error: float
    objective_error: float
    clearance_tolerance: float
    objective_tolerance: float


def recompute(plan: PlanData, bodies: Bodies) -> Recomputed:
    """Recompute the clearances at the nodes, L and F of a plan.

    Args:
        plan: the plan.
        bodies: the robot, from its URDF.
    """
    problem = plan.problem
    unit, q = problem.length_unit, plan.configurations
    nodes = _node_clearances(plan, bodies)
    with np.errstate(invalid="ignore"):
        difference = np.where(nodes == plan.clearances, 0.0, np.abs(nodes - plan.clearances))
    length = _length(problem, q, plan.motion.joint_values)
    capped = nodes if problem.clearance_cap is None else np.minimum(nodes, problem.clearance_cap)
    objective = length / unit + problem.delta * float(np.sum(unit / capped[1:-1]))
    scale = max(abs(objective), 1e-12)
    hulls = any(shape.half is None and len(shape.points) > 2 for shape in bodies.shapes)
    sharp = HULL_AGREEMENT if hulls else AGREEMENT
    blur = problem.delta * float(np.sum(unit / capped[1:-1] ** 2)) * (sharp - AGREEMENT)
    return Recomputed(
        length,
        objective,
        clearance_error=float(difference.max()),
        objective_error=abs(objective - plan.objective) / scale,
        clearance_tolerance=sharp,
        objective_tolerance=AGREEMENT + blur / scale,
    )


def _node_clearances(plan: PlanData, bodies: Bodies) -> Array:
    """(m + 1,) least distance to an obstacle at each node [m]."""
    scene, q = plan.problem.scene, plan.configurations
    nodes = np.full(plan.problem.lattice.divisions + 1, np.inf)
    if len(scene.radii):
        poses = link_poses(plan, bodies, q)
        for shape in bodies.shapes:
            at = poses[shape.link] @ shape.placement
            each = sphere_distance(shape, at, scene.centers, scene.radii)
            nodes = np.minimum(nodes, each.min(axis=1))
    return nodes


def _length(problem: Problem, q: Array, joint_values: Array) -> float:
    """L [m] of configurations (m + 1, nq), whose continuous joints do not tell whole turns.

    Args:
        problem: the problem.
        q: (m + 1, nq).
        joint_values: (m + 1, nd) of them, with whole turns [rad or m].
    """
    m, robot = problem.lattice.divisions, problem.robot
    steps = np.diff(joint_values, axis=0)
    straight = steps.mean(axis=0)  # postures displace nothing at start and goal
    weights = np.where(robot.prismatic, problem.position_weight, problem.rotation_weight)
    floats = problem.mode.floats  # the base's displacement is then not part of L
    along = np.zeros(3) if floats else (problem.goal[:3] - problem.start[:3]) / m
    nominal = np.sum((along * problem.position_weight) ** 2) + np.sum((straight * weights) ** 2)
    if problem.mode.has_wheels:
        overlap = min(1.0, abs(float(problem.start[3:7] @ problem.goal[3:7])))
        nominal += (2.0 * np.arccos(overlap) / m * problem.rotation_weight) ** 2
    across = (np.diff(q[:, :3], axis=0) - along) * (0.0 if floats else problem.position_weight)
    detours = (steps - straight) * weights
    return float(np.sum(np.sqrt(nominal + np.sum(across**2, axis=1) + np.sum(detours**2, axis=1))))
