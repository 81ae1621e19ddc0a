"""Offsets of the base from a way, and the steps aside that lead from one to another."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.lattice.layered_lattice import LayeredLattice


@dataclass(frozen=True)
class SideSteps:
    """The offsets of each layer.

    Attributes:
        offsets: (n, 3) of the base from the way, world axes [m].
        origin: number of the node without offset.
        heads: (n, W) offset that each step aside from each offset leads to; -1 for none.
        ways: (W, 3) how far each step aside goes, world axes [m].
        distances: (n, n) between offsets [m].
    """

    offsets: Array
    origin: int
    heads: IntArray
    ways: Array
    distances: Array

    @classmethod
    def none(cls) -> SideSteps:
        """One node a layer, on the way."""
        heads: IntArray = np.zeros((1, 1), dtype=np.int64)
        return cls(np.zeros((1, 3)), 0, heads, np.zeros((1, 3)), np.zeros((1, 1)))

    @classmethod
    def of(cls, lattice: LayeredLattice) -> SideSteps:
        """The offsets of a lattice with progress.

        Args:
            lattice: the lattice.
        """
        settings = lattice.problem.given_lattice
        assert settings.progress is not None
        once = range(-settings.progress.aside, settings.progress.aside + 1)
        moves = sorted(
            product(once, repeat=len(settings.axes)), key=lambda m: sum(x * x for x in m)
        )
        number = {tuple(row): k for k, row in enumerate(lattice.indices.tolist())}
        heads = [
            [number.get(tuple(np.add(row, move).tolist()), -1) for move in moves]
            for row in lattice.indices.tolist()
        ]
        spacing = np.array([getattr(settings, name).spacing for name in settings.axes])
        ways = (np.array(moves).reshape(len(moves), -1) * spacing) @ lattice.directions
        return cls(
            np.array(lattice.offsets), lattice.origin, np.array(heads, dtype=np.int64), ways,
            np.array(lattice.distances),
        )  # fmt: skip
