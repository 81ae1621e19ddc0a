"""The exact lattice optimum: a shortest path over the layers, edges certified on demand.

F is additive over nodes and edges on a lattice whose nodes have one configuration each. Unproven
edges are assumed free, and nodes not yet evaluated are assumed to have the largest clearance that
their neighbours allow. The nodes and edges of the shortest path are then evaluated; where one is
worse than assumed, the search resumes from its layer. Both assumptions can only shorten a path, so
the first path that holds is the optimum (lazy search).
"""

from __future__ import annotations

from ffsr_plan.core.arrays import IntArray
from ffsr_plan.core.errors import InternalError
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.lattice.shortest_path import lazy_shortest_path


def lattice_optimum(roadmap: Roadmap) -> IntArray:
    """Nodes (m + 1,) of the path with the least F, all its edges proven free.

    Raises:
        NoPath: there is none.
    """
    node_costs = roadmap.optimistic_node_costs()

    def objection(path: IntArray) -> int | None:
        news = roadmap.learn(path)
        if len(news):
            node_costs[news] = roadmap.optimistic_costs_of_layers(news)
            return int(news[0]) - 1
        if roadmap.prove_path(path):
            return None
        return int(roadmap.refused_layers(path)[0])

    edge_costs = roadmap.edge_costs()[None]
    path = lazy_shortest_path(
        edge_costs, node_costs, roadmap.status, roadmap.lattice.origin, objection
    )
    if path is None:
        raise roadmap.no_path() or InternalError("no shortest path, but the roadmap has a path")
    return path
