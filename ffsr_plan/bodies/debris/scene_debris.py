"""All clouds of debris of a scene as one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ffsr_plan.bodies.debris.debris_cloud import DebrisCloud
from ffsr_plan.bodies.debris.drifting_tree import DriftingTree, drifting_tree
from ffsr_plan.core.arrays import Array


def tree_of(clouds: Sequence[DebrisCloud], growth: float, middle: float) -> DriftingTree:
    """The spheres of all clouds as one tree.

    Args:
        clouds: at least one.
        growth: what is added to all radii [m].
        middle: see `drifting_tree` [s].
    """
    columns = [(each.centers, each.radii, each.velocities) for each in clouds]
    centers, radii, velocities = map(np.concatenate, zip(*columns, strict=True))
    return drifting_tree(centers, radii + growth, velocities, middle)


def spheres_at(clouds: Sequence[DebrisCloud], growth: float, time: float) -> tuple[Array, Array]:
    """The spheres of all clouds at a time.

    Args:
        clouds: at least one.
        growth: what is added to all radii [m].
        time: [s].

    Returns:
        (N, 3) centres, world [m], and (N,) radii [m].
    """
    centers = [each.centers_at(time) for each in clouds]
    return np.concatenate(centers), np.concatenate([each.radii for each in clouds]) + growth
