"""The exact lattice optimum: a shortest path over the layers, edges certified when it uses them.

F is additive over nodes and edges on a lattice whose nodes have one configuration each. Unproven
edges are taken as free, nodes not yet evaluated as clear as their neighbours allow; the shortest
path is looked at, and where it turns out worse than thought the search is taken up again behind it,
until a path holds. Since both assumptions can only shorten a path, the first one that holds is the
optimum (lazy search).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ffsr_plan.colony.records import History, Search, Trails, Watch
from ffsr_plan.compiling import call
from ffsr_plan.errors import PlanningError
from ffsr_plan.inputs import Array, IntArray, States, frozen
from ffsr_plan.roadmap import Roadmap


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


def lazy_shortest_path(
    edge_costs: Array,
    node_costs: Array,
    status: States,
    origin: int,
    objection: Callable[[IntArray], int | None],
) -> IntArray | None:
    """The shortest path over layers whose nodes and edges are looked at when it uses them.

    Args:
        edge_costs: (m, n, n), or (1, n, n) where all layers are alike.
        node_costs: (m + 1, n), infinite where a node may not be entered; optimistic at first.
        status: (m, n, n) what is known of each edge; refused ones are left out.
        origin: the node of layers 0 and m.
        objection: looks at the nodes and edges of a path (m + 1,). Where one turns out worse than
            thought it corrects `node_costs` or `status`, and returns the first layer whose outgoing
            edges have to be gone through again; None if the path holds.

    Returns:
        (m + 1,) nodes, or None if there is no path.
    """
    from ffsr_plan.bellman import extend

    m, n = len(status), status.shape[1]
    costs, before = np.full((m + 1, n), np.inf), np.zeros((m + 1, n), dtype=np.int64)
    costs[0, origin] = 0.0
    first = 0
    while True:
        call(extend, first, edge_costs, node_costs, status, costs, before)
        if not np.isfinite(costs[m, origin]):
            return None
        path = np.empty(m + 1, dtype=np.int64)
        path[m] = origin
        for i in range(m, 0, -1):
            path[i - 1] = before[i, path[i]]
        again = objection(path)
        if again is None:
            return path
        first = again
