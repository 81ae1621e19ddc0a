"""Length of a plan without a lattice, and the clearances that its F counts, from its corners."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.verification.motion_samples import Sampler
from ffsr_plan.verification.separation import SampledDistances
from ffsr_plan.verification.urdf_reading import Bodies

if TYPE_CHECKING:
    from ffsr_plan.plans.plan_data import PlanData

_PIECES = 40  # of a path, between the 39 stations and the ends


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

    Args:
        plan: a plan without a lattice.
        bodies: the robot, from its URDF.
        lengths: (m,) length of each edge [m]; edges count alike where nothing has a length.

    Returns:
        (41,) clearances [m].
    """
    steps = lengths if lengths.max() > 0.0 else np.ones_like(lengths)
    whole = np.concatenate([[0.0], np.cumsum(steps)])
    wanted = np.linspace(0.0, whole[-1], _PIECES + 1)
    place = np.interp(wanted, whole, np.arange(len(whole)))
    sampler = Sampler(plan, bodies)
    edge = np.minimum(place.astype(np.int64), sampler.edges - 1)
    distances = SampledDistances(bodies, plan.problem.scene, plan.problem.start[:3])
    return distances.clearances(sampler.at(edge, place - edge))
