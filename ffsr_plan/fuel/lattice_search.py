"""The path of a lattice that needs the least change of velocity, edges proven when they are needed.

As in the search for the lattice optimum of F (`lattice.optimum`), unproven edges are assumed free.
The edges of the best path are then proven; where one is refused, the search is repeated. The
assumption can only make a path better, so the first path that holds is the best, and each one
before is a lower bound on it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import IntArray
from ffsr_plan.core.errors import InternalError, OutOfTime
from ffsr_plan.fuel.pair_programme import PairProgramme
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.lattice.shortest_path import LazyShortestPath
from ffsr_plan.time_limit.deadline import Deadline


class LeastChange(NamedTuple):
    """A path of a lattice, all its edges proven free, and what no path falls below.

    Attributes:
        nodes: (m + 1,) nodes.
        change: its change of velocity for a flight of unit duration [m].
        bound: change that no path of the lattice falls below [m]; `change` where it is the least.
        rounds: how often the best path at the edges known so far was looked for.
    """

    nodes: IntArray
    change: float
    bound: float
    rounds: int


def programme_of(lattice: LayeredLattice, deadline: Deadline | None = None) -> PairProgramme:
    """The pair programme on a lattice without posture axes, whose base is moved by thrusters."""
    problem = lattice.problem
    settings = problem.given_lattice
    spacing = np.array([getattr(settings, name).spacing for name in settings.axes])
    length = float(np.linalg.norm(problem.base_displacement))
    return PairProgramme(lattice.indices, spacing, length, lattice.divisions, deadline)


def least_change_path(roadmap: Roadmap) -> LeastChange:
    """The path of a roadmap that needs the least change of velocity.

    Args:
        roadmap: the roadmap; all its nodes are evaluated, and edges as they are needed.

    Returns:
        The path. At the roadmap's deadline, the best one that was proven by then, with the bound
        that was reached.

    Raises:
        NoPath: there is none.
        OutOfTime: at the roadmap's deadline, if none was proven by then.
    """
    programme = programme_of(roadmap.lattice, roadmap.deadline)
    best, bound = _proven_nearby(roadmap, programme), programme.straight
    try:
        while bound < best.change:
            found = programme.optimum(roadmap.admissible, roadmap.status, bound, best.change)
            assert found.nodes is not None  # `best` is one
            bound = max(bound, min(found.change, best.change))
            best = best._replace(rounds=best.rounds + 1)
            if found.change < best.change and roadmap.prove_path(found.nodes):
                best = best._replace(nodes=found.nodes, change=found.change)
    except OutOfTime:
        pass  # what has been proven is returned with its bound
    return best._replace(bound=min(bound, best.change))


def _proven_nearby(roadmap: Roadmap, programme: PairProgramme) -> LeastChange:
    """A proven path by a local search from the path of least squared steps.

    Raises:
        NoPath: there is none.
        OutOfTime: at the roadmap's deadline.
    """
    allowed = roadmap.admissible
    search = LazyShortestPath(  # squares make slopes even, as a small change of velocity does
        roadmap.lattice.distances[None] ** 2,
        np.where(allowed, 0.0, np.inf),
        roadmap.status,
        roadmap.lattice.origin,
        roadmap.deadline,
    )
    while (start := search.path()) is not None:
        found = programme.improved(start, allowed, roadmap.status)
        assert found.nodes is not None
        if roadmap.prove_path(found.nodes):
            return LeastChange(found.nodes, found.change, programme.straight, 0)
    raise roadmap.no_path() or InternalError("no path of least change, but the roadmap has a path")
