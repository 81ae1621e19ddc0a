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
    def around(cls, axes: IntArray, half_count: int, spacing: float) -> SideSteps:
        """A grid along axes of the world, with steps aside to all neighbours.

        Args:
            axes: (k,) numbers of the axes.
            half_count: nodes to either side.
            spacing: of the nodes [m].
        """
        once = range(-half_count, half_count + 1)
        indices = np.array(list(product(once, repeat=len(axes))), dtype=np.int64)
        directions = np.eye(3)[axes]
        offsets = spacing * indices @ directions
        distances = np.linalg.norm(offsets[:, None] - offsets, axis=2)
        heads, moves = _steps(indices.reshape(len(offsets), -1), 1)
        return cls(offsets, len(offsets) // 2, heads, spacing * moves @ directions, distances)

    @classmethod
    def of(cls, lattice: LayeredLattice) -> SideSteps:
        """The offsets of a lattice with progress.

        Args:
            lattice: the lattice.
        """
        settings = lattice.problem.given_lattice
        assert settings.progress is not None
        heads, moves = _steps(lattice.indices, settings.progress.aside)
        spacing = np.array([getattr(settings, name).spacing for name in settings.axes])
        ways = (moves * spacing) @ lattice.directions
        return cls(
            np.array(lattice.offsets), lattice.origin, heads, ways, np.array(lattice.distances)
        )  # fmt: skip


def _steps(indices: IntArray, most: int) -> tuple[IntArray, IntArray]:
    """(n, W) node that each step aside leads to, and (W, axes) the steps, the smallest first."""
    once, axes = range(-most, most + 1), indices.shape[1]
    moves = sorted(product(once, repeat=axes), key=lambda m: sum(x * x for x in m))
    number = {tuple(row): k for k, row in enumerate(indices.tolist())}
    heads = [
        [number.get(tuple(np.add(row, move).tolist()), -1) for move in moves]
        for row in indices.tolist()
    ]
    steps: IntArray = np.array(moves, dtype=np.int64).reshape(len(moves), axes)
    return np.array(heads, dtype=np.int64), steps
