"""A problem with its lattice left out: the whole space, in which all paths of the lattice lie."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.problem.problem import Problem

_FLAT = 1e-9  # [m] by which nodes may leave a plane, by rounding, and the window stays flat


def without_lattice(problem: Problem) -> Problem:
    """The problem without its lattice.

    Where thrusters move the base, the window is the default one, larger where the nodes of the
    lattice lie outside.

    Args:
        problem: a problem with a lattice.

    Returns:
        The same problem without; this one does not change.
    """
    if problem.mode.floats:
        return replace(problem, lattice=None)
    lattice, window = LayeredLattice(problem), problem.base_window
    along = lattice.nominal.positions
    low = along.min(axis=0) + lattice.offsets.min(axis=0)
    high = along.max(axis=0) + lattice.offsets.max(axis=0)
    wide = np.stack([_lower(window[0], low), -_lower(-window[1], -high)])
    return replace(problem, lattice=None, window=wide)


def _lower(own: Array, nodes: Array) -> Array:
    """(3,) the lower of two coordinates each, those of nodes only where they are notably lower."""
    return np.where(nodes < own - _FLAT, nodes, own)
