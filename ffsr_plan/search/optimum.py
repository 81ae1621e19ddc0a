"""The exact lattice optimum: a shortest path over the layers, edges certified when it uses them.

F is additive over nodes and edges on a lattice whose nodes have one configuration each. Unproven
edges are taken as free, nodes not yet evaluated as clear as their neighbours allow; the shortest
path is looked at, and where it turns out worse than thought the search is taken up again behind it,
until a path holds. Since both assumptions can only shorten a path, the first one that holds is the
optimum (lazy search).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ffsr_plan.core.arrays import IntArray, frozen
from ffsr_plan.core.errors import PlanningError
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.lattice.shortest_path import lazy_shortest_path
from ffsr_plan.search.records import History, Search, Trails, Watch


@dataclass(frozen=True)
class LatticeOptimum:
    """The exact optimum as a planner; it has no parameters and ignores the seed.

    Of equally short paths, the one whose nodes have the lowest indices from the goal backwards
    wins, always the same one.
    """

    name: ClassVar[str] = "lattice-optimum"

    def search(
        self, roadmap: Roadmap, rng: np.random.Generator, watch: Watch | None = None
    ) -> Search:
        """Find the optimum.

        Raises:
            NoPath: proven, with the layer that cannot be reached and the obstacles that close it.
        """
        path = lattice_optimum(roadmap)
        best = np.array([roadmap.objective(path)])
        nowhere, nothing = np.zeros(0, dtype=np.int64), np.zeros(0)
        history = History(best, best, best, np.ones(1, dtype=np.int64))
        trails = Trails(nowhere, nowhere, nowhere, nowhere, nothing, nothing)  # no ant walked
        return Search(frozen(path), history, trails)


def lattice_optimum(roadmap: Roadmap) -> IntArray:
    """Nodes (m + 1,) of the path with the least F, all its edges proven free.

    Raises:
        NoPath: there is none.
    """
    node_costs = roadmap.optimistic_node_costs()

    def objection(path: IntArray) -> int | None:
        news = roadmap.learn(path)
        if len(news):
            node_costs[news] = roadmap.optimistic_node_costs(news)
            return int(news[0]) - 1
        if roadmap.prove_path(path):
            return None
        return int(roadmap.refused_layers(path)[0])

    edge_costs = roadmap.edge_costs()[None]
    path = lazy_shortest_path(
        edge_costs, node_costs, roadmap.status, roadmap.lattice.origin, objection
    )
    if path is None:
        raise roadmap.no_path() or PlanningError("the lattice optimum was lost")
    return path
