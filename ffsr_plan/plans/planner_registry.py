"""The planners by name, and the default for a lattice or none."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from ffsr_plan.core.checks import one_of
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.fuel.least_fuel_planner import LeastFuel
from ffsr_plan.portfolio.lattice_planners import (
    LATTICE_PLANNERS,
    OnLattice,
    default_on_lattice,
)
from ffsr_plan.portfolio.portfolio_planner import Portfolio
from ffsr_plan.problem.lattice_settings import Lattice
from ffsr_plan.problem.problem import Problem
from ffsr_plan.tree_search.tree_planner import TreePlanner

Planner = OnLattice | LeastFuel | TreePlanner | Portfolio
PLANNERS: dict[str, type[Planner]] = {
    **LATTICE_PLANNERS,
    LeastFuel.name: LeastFuel,
    TreePlanner.name: TreePlanner,
    Portfolio.name: Portfolio,
}


def default_planner(lattice: Lattice | None) -> Planner:
    """`TreePlanner` without a lattice, else `PostureAnnealing` or `MaxMinAntSystem`."""
    return TreePlanner() if lattice is None else default_on_lattice(lattice)


def planner_table(planner: Planner) -> dict[str, Any]:
    """Name and settings of a planner in plain values, as files hold them."""
    table = {"name": planner.name, **asdict(planner)}
    if isinstance(planner, Portfolio) and planner.lattice is not None:
        table["lattice"] = planner_table(planner.lattice)
    return table


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
