"""The planners by name, and the default for a lattice or none."""

from __future__ import annotations

from ffsr_plan.core.checks import one_of
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.problem.lattice_settings import Lattice
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.ants.ant_system import AntSystem
from ffsr_plan.search.ants.max_min import MaxMinAntSystem
from ffsr_plan.search.optimum_planner import LatticeOptimum
from ffsr_plan.search.postures.posture_annealing import PostureAnnealing
from ffsr_plan.tree_search.tree_planner import TreePlanner

Planner = AntSystem | MaxMinAntSystem | LatticeOptimum | PostureAnnealing | TreePlanner
PLANNERS: dict[str, type[Planner]] = {
    kind.name: kind
    for kind in (AntSystem, MaxMinAntSystem, LatticeOptimum, PostureAnnealing, TreePlanner)
}


def default_planner(lattice: Lattice | None) -> Planner:
    """`TreePlanner` without a lattice, else `PostureAnnealing` or `MaxMinAntSystem`."""
    if lattice is None:
        return TreePlanner()
    return PostureAnnealing() if lattice.postures else MaxMinAntSystem()


def planner_of(planner: Planner | str | None, problem: Problem) -> Planner:
    """A planner from settings, a name (with default settings), or None for the default.

    Raises:
        InvalidInput: an unknown name, or no planner.
    """
    if planner is None:
        return default_planner(problem.lattice)
    if isinstance(planner, str):
        return PLANNERS[one_of("planner", planner, list(PLANNERS))]()
    if not isinstance(planner, tuple(PLANNERS.values())):
        kinds = ", ".join(f"{kind.__name__}()" for kind in PLANNERS.values())
        raise InvalidInput(
            "planner", planner, f"{kinds}, or one of the names {', '.join(PLANNERS)}"
        )
    return planner
