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
from ffsr_plan.lattice.shortest_path import LazyShortestPath


def lattice_optimum(roadmap: Roadmap) -> IntArray:
    """Nodes (m + 1,) of the path with the least F, all its edges proven free.

    Raises:
        NoPath: there is none.
    """
    node_costs = roadmap.optimistic_node_costs()
    search = LazyShortestPath(
        roadmap.edge_costs()[None], node_costs, roadmap.status, roadmap.lattice.origin
    )
    path = search.path()
    while path is not None:
        changed = roadmap.nodes.learn(path)
        if len(changed):
            node_costs[changed] = roadmap.optimistic_costs_of_layers(changed)
            path = search.path(int(changed[0]) - 1)
        elif roadmap.prove_path(path):
            return path
        else:
            path = search.path(int(roadmap.refused_layers(path)[0]))
    raise roadmap.no_path() or InternalError("no shortest path, but the roadmap has a path")
