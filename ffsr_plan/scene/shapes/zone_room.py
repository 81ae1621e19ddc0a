"""Whether a body that is moved without turning fits into zones: a linear programme."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ffsr_plan.core.arrays import Array

_DIRECTIONS = 200  # of the planes around a ball that stand for it


def missing_room(planes: Array, balls: Array, reach: Callable[[Array], Array]) -> float:
    """By how much a body stands out of zones where it fits best; a lower bound.

    A ball counts as planes around it, so that a body which hardly fits into it may seem to fit.

    Args:
        planes: (p, 4) outward normals and offsets of planes around zones [m].
        balls: (b, 4) centres and radii of zones that are balls [m].
        reach: how far the body extends along directions (d, 3), from any origin, (d,) [m].

    Returns:
        The least of the largest distances by which it is outside [m]; negative if it fits.
    """
    from scipy.optimize import linprog

    around = _directions()
    parts = [planes]
    for ball in balls:
        parts.append(np.column_stack([around, around @ ball[:3] + ball[3]]))
    limits = np.vstack(parts)
    if not len(limits):
        return -np.inf
    room = limits[:, 3] - reach(limits[:, :3])
    sides = np.column_stack([limits[:, :3], -np.ones(len(limits))])
    found = linprog([0.0, 0.0, 0.0, 1.0], sides, room, bounds=[(None, None)] * 3 + [(-1e6, None)])
    return float(found.fun) if found.success else -np.inf


def _directions() -> Array:
    """(n, 3) unit vectors, evenly over the sphere, and those along the axes."""
    height = (2.0 * np.arange(_DIRECTIONS) + 1.0) / _DIRECTIONS - 1.0
    turn = np.pi * (1.0 + np.sqrt(5.0)) * np.arange(_DIRECTIONS)
    aside = np.sqrt(1.0 - height**2)
    spiral = np.column_stack([aside * np.cos(turn), aside * np.sin(turn), height])
    return np.vstack([spiral, np.eye(3), -np.eye(3)])
