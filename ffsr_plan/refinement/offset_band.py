"""`OffsetBand`: offsets on either side of a path, layer by layer."""

from __future__ import annotations

from itertools import product

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.problem.problem import Problem


class OffsetBand:
    """The w offsets of each layer within a reach of a path.

    Attributes:
        choices: (m + 1, w, axes) offsets in the unit of the path.
        present: (m + 1, w) which of them are allowed; layers 0 and m have the first one only.
        offsets: (m + 1, w, 3) displacement of the base [m].
        lengths: (m, w, w) length of each edge [length units].
    """

    def __init__(
        self,
        problem: Problem,
        path: IntArray,
        rim: IntArray,
        unit: Array,
        step: int,
        reach: IntArray,
    ) -> None:
        """The offsets around a path.

        Args:
            problem: gives lengths.
            path: (m + 1, axes) offsets along the path, in units.
            rim: (axes,) largest offset to either side, in units.
            unit: (axes, 3) displacement of the base by one unit along each axis [m].
            step: distance between two offsets, in units.
            reach: (axes,) offsets to either side of the path.
        """
        self._unit = unit
        around = np.array(list(product(*(range(-r, r + 1) for r in reach))), dtype=np.int64)
        sums = np.ravel_multi_index((around + reach).T, tuple((4 * reach + 1).tolist()))
        self._sums: IntArray = sums[:, None] + sums
        self._sum_count = int(np.prod(4 * reach + 1))
        self.choices: IntArray = path[:, None] + step * around
        self.present: Flags = np.all(np.abs(self.choices) <= rim, axis=2)
        for end in (0, -1):
            self.choices[end], self.present[end] = path[end], False
            self.present[end, 0] = True
        self.offsets: Array = self.choices @ unit
        self.lengths: Array = _lengths(problem, self.offsets)

    def half_way(self, edges: Flags) -> tuple[IntArray, Array, IntArray]:
        """The places half-way on edges.

        Edges of a layer whose offsets have the same sum pass at the same place, so that there are
        few places.

        Args:
            edges: (m, w, w) e edges.

        Returns:
            (p,) layer and (p, 3) displacement of the base [m] of each place; (e,) the place of each
            edge, in the order of `np.nonzero`.
        """
        layer, tail, head = np.nonzero(edges)
        name = layer * self._sum_count + self._sums[tail, head]
        edge_at = np.full(len(edges) * self._sum_count, -1)
        edge_at[name] = np.arange(len(name))
        names = np.flatnonzero(edge_at >= 0)
        one = edge_at[names]  # of the edges that pass there
        edge_at[names] = np.arange(len(names))
        layer, tail, head = layer[one], tail[one], head[one]
        sums = self.choices[layer, tail] + self.choices[layer + 1, head]
        return layer, (sums / 2.0) @ self._unit, edge_at[name]


def _lengths(problem: Problem, offsets: Array) -> Array:
    """(m, w, w) lengths of the edges between offsets (m + 1, w, 3) [length units]."""
    if len(offsets) > 4 and np.all(offsets[1:-1] == offsets[1]):  # the same on all inner layers
        first, inner, last = _lengths(problem, offsets[[0, 1, 2, -1]])
        return np.concatenate(
            [[first], np.broadcast_to(inner, (len(offsets) - 3, *inner.shape)), [last]]
        )
    lengths = np.zeros((len(offsets) - 1, offsets.shape[1], offsets.shape[1]))
    across = np.empty_like(lengths)
    for axis in range(3):
        np.subtract(offsets[1:, None, :, axis], offsets[:-1, :, None, axis], out=across)
        lengths += np.square(across, out=across)
    np.sqrt(lengths, out=lengths)
    lengths *= problem.position_weight
    np.square(lengths, out=lengths)
    lengths += problem.delta_d**2
    np.sqrt(lengths, out=lengths)
    lengths /= problem.length_unit
    return lengths
