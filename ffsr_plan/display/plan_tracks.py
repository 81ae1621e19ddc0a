"""Ants' trails and obstacles close to the motion, for pictures of a plan."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.collision.shape_placements import near_track, shape_placements
from ffsr_plan.core.arrays import Array, Flags
from ffsr_plan.plans.plan_data import PlanData

_SAMPLES_PER_EDGE = 8


def trail_segments(plan: PlanData, most: int = 3000) -> tuple[Array, Array]:
    """Edges that the ants walked, weak ones first.

    Args:
        plan: the plan.
        most: number of edges; the strongest are taken.

    Returns:
        Ends (k, 2, 3) of the edges, base origin in the world [m], and strengths (k,) in [0, 1]:
        half for all the pheromone ever laid on the edge, half for the ants that walked it, on
        logarithmic scales, so that early trails show too.
    """
    lattice, trails = plan.lattice, plan.trails
    if not len(trails.layer):
        return np.zeros((0, 2, 3)), np.zeros(0)
    strength = 0.5 * (_logarithmic(trails.laid) + _logarithmic(trails.ants))
    order = np.argsort(strength, kind="stable")[-most:]
    layer, tail, head = trails.layer[order], trails.tail[order], trails.head[order]
    begin = lattice.nominal.positions[layer] + lattice.offsets[tail]
    end = lattice.nominal.positions[layer + 1] + lattice.offsets[head]
    return np.stack([begin, end], axis=1), strength[order]


def obstacles_near(plan: PlanData, within: float) -> Flags:
    """(N,) the spheres that come closer than `within` [m] to the middle of a shape of the robot.

    Sampled at eight configurations an edge; for pictures of scenes with many obstacles.
    """
    samples = _SAMPLES_PER_EDGE * plan.motion.edges + 1
    q = plan.at(np.linspace(0.0, 1.0, samples))
    positions = shape_placements(plan.problem.robot, q).positions
    return near_track(plan.problem.scene, positions, within)


def _logarithmic(amount: NDArray[Any]) -> Array:
    """Amounts >= 0 on a logarithmic scale from 0 to 1."""
    amount = amount.astype(np.float64)
    scaled = np.log1p(amount / np.min(amount, where=amount > 0.0, initial=np.inf))
    return scaled / max(float(scaled.max()), 1e-12)
