"""The exact lattice optimum: a shortest path over the layers, edges certified when it uses them.

F is additive over nodes and edges on a lattice whose nodes have one configuration each. Unproven
edges are taken as free; the shortest path is certified; if an edge is refused the search is taken up
again behind it, until a path holds. Since assuming edges free can only shorten the path, the first
one that holds is the optimum (lazy search).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numba import njit

from ffsr_plan.colony.records import History, OnCycle, Search, Trails
from ffsr_plan.errors import PlanningError
from ffsr_plan.inputs import Array, IntArray, States, frozen
from ffsr_plan.roadmap import Roadmap

_REFUSED = -1


@dataclass(frozen=True)
class LatticeOptimum:
    """The exact optimum as a planner; it has no parameters and ignores the seed.

    Of equally short paths, the one whose nodes have the lowest indices from the goal backwards wins,
    always the same one.
    """

    name: ClassVar[str] = "lattice-optimum"

    def search(
        self, roadmap: Roadmap, rng: np.random.Generator, on_cycle: OnCycle | None = None
    ) -> Search:
        """Find the optimum.

        Raises:
            NoPath: proven, with the layer that cannot be reached and the obstacles that close it.
        """
        path = lattice_optimum(roadmap)
        best = np.array([roadmap.objective(path)])
        layers = np.arange(len(path) - 1)
        nothing = np.zeros(len(layers))
        history = History(best, best, best, np.ones(1, dtype=np.int64))
        trails = Trails(layers, path[:-1], path[1:], np.ones_like(layers), nothing, nothing)
        return Search(frozen(path), history, trails)


def lattice_optimum(roadmap: Roadmap) -> IntArray:
    """Nodes (m + 1,) of the path with the least F, all its edges proven free.

    Raises:
        NoPath: there is none.
    """
    m, n, origin = roadmap.lattice.divisions, roadmap.lattice.size, roadmap.lattice.origin
    edge_costs, node_costs = roadmap.edge_costs(), roadmap.node_costs()
    costs = np.full((m + 1, n), np.inf)
    costs[0, origin] = 0.0
    before = np.zeros((m + 1, n), dtype=np.int64)
    first = 0
    while True:
        extend(first, edge_costs, node_costs, roadmap.status, costs, before)
        if not np.isfinite(costs[m, origin]):
            raise roadmap.no_path() or PlanningError("the lattice optimum was lost")
        path = np.empty(m + 1, dtype=np.int64)
        path[m] = origin
        for i in range(m, 0, -1):
            path[i - 1] = before[i, path[i]]
        if roadmap.prove_path(path):
            return path
        refused = roadmap.status[np.arange(m), path[:-1], path[1:]] == _REFUSED
        first = int(np.argmax(refused))


@njit(cache=True, nogil=True)
def extend(
    first: int,
    edge_costs: Array,
    node_costs: Array,
    status: States,
    costs: Array,
    before: IntArray,
) -> None:
    """Shortest ways from the start, layer after layer from `first` on (Bellman).

    Args:
        first: the first layer whose edges are to be looked at; `costs` hold up to it.
        edge_costs: (n, n).
        node_costs: (m + 1, n), infinite where a node may not be entered.
        status: (m, n, n); refused edges are left out.
        costs: (m + 1, n) least cost of reaching each node, updated.
        before: (m + 1, n) the node that the shortest way comes from, updated.
    """
    m, n = len(status), len(edge_costs)
    for i in range(first, m):
        costs[i + 1] = np.inf
        for j in range(n):
            so_far = costs[i, j]
            if so_far == np.inf:
                continue
            for k in range(n):
                total = so_far + edge_costs[j, k]
                if total < costs[i + 1, k] and status[i, j, k] != _REFUSED:
                    costs[i + 1, k] = total
                    before[i + 1, k] = j
        for k in range(n):
            costs[i + 1, k] += node_costs[i + 1, k]
