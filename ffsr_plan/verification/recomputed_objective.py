"""Node clearances, L and F of a plan from its configurations alone (Eqs. 4, 6, 8 and 9)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.scene.shapes.obstacle_shapes import Cylinder, Ellipsoid, Hull, ObstacleShape
from ffsr_plan.verification.motion_samples import Sampler
from ffsr_plan.verification.moving_bodies.scene_bodies import reach_of
from ffsr_plan.verification.separation import SampledDistances
from ffsr_plan.verification.urdf_reading import Bodies

if TYPE_CHECKING:
    from ffsr_plan.plans.plan_data import PlanData
    from ffsr_plan.problem.problem import Problem

AGREEMENT = 1e-9
"""Allowed difference of lengths [m] and, relative, of F."""
HULL_AGREEMENT = 1e-7
"""Allowed difference of distances to a hull, cylinder or ellipsoid [m].

Coal iterates them to 4e-9 m as a rule; beside ellipsoids some are too small by 4e-8 m.
"""
SIZE_AGREEMENT = 1e-10
"""Allowed difference of distances to shapes, for each metre of their size.

Coal's distances to boxes and cylinders are too small by up to 5e-11 of the extents of both bodies
along the line of separation. An allowed difference without regard to sizes would reject correct
plans beside a box of 25 m.
"""
POSE_AGREEMENT = 1e-9
"""Allowed difference of the pose of a body that moves [m] and [rad]."""
_PIECES = 40  # of a path without a lattice, between the 39 stations and the ends


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


def recompute(plan: PlanData, bodies: Bodies, nodes: Array) -> Recomputed:
    """Recompute L and F of a plan, and compare its clearances at the nodes.

    Args:
        plan: the plan.
        bodies: the robot, from its URDF.
        nodes: (m + 1,) clearances measured at the nodes [m].
    """
    problem = plan.problem
    with np.errstate(invalid="ignore"):
        difference = np.where(nodes == plan.clearances, 0.0, np.abs(nodes - plan.clearances))
    if problem.lattice is None:
        lengths = free_lengths(plan)
        length, counted = float(lengths.sum()), station_clearances(plan, bodies, lengths)
    elif problem.lattice.progress is not None:
        length, counted = float(free_lengths(plan).sum()), nodes
    else:
        length = length_of(problem, plan.motion.positions, plan.motion.joint_values)
        counted = nodes
    objective = objective_of(problem, length, counted)
    sharp, share = tolerances(problem, bodies, counted, objective)
    return Recomputed(
        length,
        objective,
        clearance_error=float(difference.max()),
        objective_error=abs(objective - plan.objective) / max(abs(objective), 1e-12),
        clearance_tolerance=sharp,
        objective_tolerance=share,
    )


def tolerances(
    problem: Problem, bodies: Bodies, nodes: Array, objective: float
) -> tuple[float, float]:
    """Allowed difference of a clearance [m] and, relative, of F.

    Args:
        problem: gives the objective.
        bodies: the robot, from its URDF.
        nodes: (m + 1,) clearances at the nodes [m].
        objective: F.
    """
    hulls = any(shape.half is None and len(shape.points) > 2 for shape in bodies.shapes)
    moving = problem.scene.bodies
    shapes = [*problem.scene.shapes, *(shape for body in moving for shape in body.shapes)]
    hulls |= any(isinstance(shape, (Cylinder, Ellipsoid, Hull)) for shape in shapes)
    sharp = HULL_AGREEMENT if hulls else AGREEMENT
    sharp += SIZE_AGREEMENT * max(map(_size_of, shapes), default=0.0)
    sharp += POSE_AGREEMENT * max((1.0 + reach_of(body) for body in moving), default=0.0)
    slope = problem.delta * float(np.sum(problem.length_unit / _capped(problem, nodes)[1:-1] ** 2))
    return sharp, AGREEMENT + slope * (sharp - AGREEMENT) / max(abs(objective), 1e-12)


def _size_of(shape: ObstacleShape) -> float:
    """Diameter of the sphere around the box in which a shape lies [m]."""
    return 2.0 * (float(np.linalg.norm(shape.half_sides)) + shape.skin)


def objective_of(problem: Problem, length: float, nodes: Array) -> float:
    """F of Eq. 8 [length units].

    Args:
        problem: gives the objective.
        length: L [m].
        nodes: (m + 1,) clearances at the nodes [m].
    """
    unit = problem.length_unit
    near = float(np.sum(unit / _capped(problem, nodes)[1:-1])) if problem.delta else 0.0
    return length / unit + problem.delta * near


def _capped(problem: Problem, nodes: Array) -> Array:
    """Clearances as F counts them, at least a nanometre."""
    cap = np.inf if problem.clearance_cap is None else problem.clearance_cap
    return np.clip(nodes, AGREEMENT, cap)


def length_of(problem: Problem, positions: Array, joint_values: Array) -> float:
    """L of Eq. 6 [m].

    Args:
        problem: gives start, goal and weights.
        positions: (m + 1, 3) base origins at the nodes [m].
        joint_values: (m + 1, nd) at the nodes, without jumps at half a turn [rad or m].
    """
    m, robot = problem.given_lattice.divisions, problem.robot
    steps = np.diff(joint_values, axis=0)
    straight = steps.mean(axis=0)  # postures displace nothing at start and goal
    weights = np.where(robot.prismatic, problem.position_weight, problem.rotation_weight)
    floats = problem.mode.floats  # the base's displacement is then not part of L
    along = np.zeros(3) if floats else (problem.goal[:3] - problem.start[:3]) / m
    nominal = np.sum((along * problem.position_weight) ** 2) + np.sum((straight * weights) ** 2)
    if problem.mode.has_wheels:
        ends = [float(np.linalg.norm(problem.start[3:7] + k * problem.goal[3:7])) for k in (-1, 1)]
        angle = 4.0 * np.arctan2(min(ends), max(ends))
        nominal += (angle / m * problem.rotation_weight) ** 2
    across = (np.diff(positions, axis=0) - along) * (0.0 if floats else problem.position_weight)
    detours = (steps - straight) * weights
    return float(np.sum(np.sqrt(nominal + np.sum(across**2, axis=1) + np.sum(detours**2, axis=1))))


def free_lengths(plan: PlanData) -> Array:
    """Length of each edge of a plan.

    Args:
        plan: a plan without a lattice.

    Returns:
        (m,) lengths [m].
    """
    problem, q = plan.problem, plan.configurations
    weights = np.where(
        problem.robot.prismatic, problem.position_weight, problem.rotation_weight
    )  # fmt: skip
    squares = np.sum((np.diff(plan.motion.joint_values, axis=0) * weights) ** 2, axis=1)
    if problem.mode.has_thrusters:
        squares += np.sum((np.diff(q[:, :3], axis=0) * problem.position_weight) ** 2, axis=1)
    if problem.mode.has_wheels:
        nearer = [np.linalg.norm(q[1:, 3:7] + k * q[:-1, 3:7], axis=1) for k in (-1.0, 1.0)]
        angles = 4.0 * np.arctan2(np.minimum(*nearer), np.maximum(*nearer))
        squares += (angles * problem.rotation_weight) ** 2
    return np.asarray(np.sqrt(squares))


def station_clearances(plan: PlanData, bodies: Bodies, lengths: Array) -> Array:
    """Clearances that F counts: at equal steps of length, the ends in front and behind.

    Where bodies move, steps are equal in number of edges.

    Args:
        plan: a plan without a lattice.
        bodies: the robot, from its URDF.
        lengths: (m,) length of each edge [m]; edges count alike where nothing has a length.

    Returns:
        (41,) clearances [m].
    """
    by_length = lengths.max() > 0.0 and not plan.problem.scene.moves
    steps = lengths if by_length else np.ones_like(lengths)
    whole = np.concatenate([[0.0], np.cumsum(steps)])
    wanted = np.linspace(0.0, whole[-1], _PIECES + 1)
    place = np.interp(wanted, whole, np.arange(len(whole)))
    sampler = Sampler(plan, bodies)
    edge = np.minimum(place.astype(np.int64), sampler.edges - 1)
    distances = SampledDistances(bodies, plan.problem.obstacles, plan.problem.start[:3])
    return distances.clearances(sampler.at(edge, place - edge))
