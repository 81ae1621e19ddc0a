"""The exact lattice optimum: a shortest path over the layers, edges certified on demand.

F is additive over nodes and edges on a lattice whose nodes have one configuration each. Unproven
edges are assumed free, and nodes not yet evaluated are assumed to have the largest clearance that
their neighbours allow. The nodes and edges of the shortest path are then evaluated; where one is
worse than assumed, the search resumes from its layer. Both assumptions can only shorten a path, so
the first path that holds is the optimum (lazy search), and the cost of each one before is a lower
bound on it.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import IntArray
from ffsr_plan.core.errors import InternalError, OutOfTime
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.lattice.shortest_path import LazyShortestPath
from ffsr_plan.problem.objective import objective, path_length
from ffsr_plan.problem.problem import Problem


class OptimumSearch:
    """A search for the lattice optimum that knows a lower bound at any time.

    Attributes:
        bound: F that no path of the lattice falls below [length units].
    """

    def __init__(self, roadmap: Roadmap) -> None:
        self._roadmap = roadmap
        self.bound = straight_bound(roadmap.problem)

    def path(self) -> IntArray:
        """Nodes (m + 1,) of the path with the least F, all its edges proven free.

        Raises:
            NoPath: there is none.
            OutOfTime: at the roadmap's deadline; `bound` holds.
        """
        roadmap = self._roadmap
        node_costs = roadmap.optimistic_node_costs()
        search = LazyShortestPath(
            roadmap.edge_costs()[None],
            node_costs,
            roadmap.status,
            roadmap.lattice.origin,
            roadmap.deadline,
        )
        path = search.path()
        while path is not None:
            self.bound = max(self.bound, search.least_cost)
            changed = roadmap.nodes.learn(path)
            if len(changed):
                node_costs[changed] = roadmap.optimistic_costs_of_layers(changed)
                path = search.path(int(changed[0]) - 1)
            elif roadmap.prove_path(path):
                return path
            else:
                path = search.path(int(roadmap.refused_layers(path)[0]))
        raise roadmap.no_path() or InternalError("no shortest path, but the roadmap has a path")


def lattice_optimum(roadmap: Roadmap) -> IntArray:
    """Nodes (m + 1,) of the path with the least F, all its edges proven free.

    Raises:
        NoPath: there is none.
        OutOfTime: at the roadmap's deadline.
    """
    return OptimumSearch(roadmap).path()


def optimum_or_bound(roadmap: Roadmap) -> tuple[float, bool]:
    """F of the lattice optimum, and true; at the deadline a lower bound on it, and false."""
    search = OptimumSearch(roadmap)
    try:
        return roadmap.objective(search.path()), True
    except OutOfTime:
        return search.bound, False


def straight_bound(problem: Problem) -> float:
    """F of the straight path far from all obstacles, which no path of a lattice falls below.

    Args:
        problem: gives the lattice and the costs.

    Returns:
        The bound [length units].
    """
    corners = problem.given_lattice.divisions + 1
    length = path_length(problem, np.zeros((corners, 3)))
    return objective(problem, length, np.full(corners, np.inf))
