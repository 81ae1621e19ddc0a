"""Clearances of a lattice's nodes: exact where evaluated, bounded from above elsewhere.

Nodes of a layer differ by a translation, and a translation by x changes a clearance by x at most.
So every node that was evaluated bounds its neighbours, and an exact search over optimistic bounds
needs to evaluate only the nodes that its candidate paths pass: a fifth of them in common scenes.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray, frozen
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.proof.prover import Prover

_NODES_AT_ONCE = 2000  # that are evaluated before they count as known


class NodeClearances:
    """What is known of the clearance of each node.

    Attributes:
        bounds: (m + 1, n) upper bounds [m], exact where `known`; -inf where a layer lacks a node.
        known: (m + 1, n) the nodes whose clearance has been evaluated, or that do not exist.
        queries: evaluations so far.
    """

    def __init__(self, lattice: LayeredLattice, prover: Prover) -> None:
        self._lattice, self._prover = lattice, prover
        self._distances = np.array(lattice.distances)  # not read-only, as kernels take it
        m, n, origin = lattice.divisions, lattice.size, lattice.origin
        self.bounds: Array = np.full((m + 1, n), np.inf)
        self.known: Flags = np.zeros((m + 1, n), dtype=bool)
        ends = np.array([0, m])
        self.bounds[ends], self.known[ends] = -np.inf, True
        self.queries = 0
        self.bounds[ends, origin] = self._evaluate(ends, np.zeros((2, 3)))
        self._exact: Array | None = None

    def _evaluate(self, layers: IntArray, offsets: Array) -> Array:
        before = self._prover.queries
        try:
            return self._prover.clearances(layers, offsets)
        finally:
            self.queries += self._prover.queries - before  # none in an empty scene

    def learn(self, path: IntArray) -> IntArray:
        """Evaluate the nodes of a path.

        Args:
            path: (m + 1,) nodes, one a layer.

        Returns:
            (k,) inner layers whose bounds have changed.
        """
        from ffsr_plan.lattice.node_bounds_kernel import take_in

        layers = np.flatnonzero(~self.known[np.arange(len(path)), path])
        if not len(layers):
            return layers
        nodes = path[layers]
        exact = self._evaluate(layers, self._lattice.offsets[nodes])
        take_in(layers, nodes, exact, self._distances, self.bounds, self.known)
        return layers

    def exact(self) -> Array:
        """(m + 1, n) clearances of all nodes [m]; NaN where a layer lacks a node."""
        if self._exact is None:
            stride = max(1, _NODES_AT_ONCE // self._lattice.size)
            for first in range(1, self._lattice.divisions, stride):
                end = min(first + stride, self._lattice.divisions)
                layers, nodes = np.nonzero(~self.known[first:end])
                layers += first
                self.bounds[layers, nodes] = self._evaluate(layers, self._lattice.offsets[nodes])
                self.known[layers, nodes] = True
            self._exact = frozen(np.where(self.bounds == -np.inf, np.nan, self.bounds))
        return self._exact
