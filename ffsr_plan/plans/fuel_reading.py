"""What a plan file says of fuel: refused where no search for little fuel gives such figures."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.fuel.least_fuel_planner import STARTS, LeastFuel
from ffsr_plan.plans.plan_tables import PlanTable
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.fuel_figures import FuelFigures, velocity_change

_ROUNDING = 1e-9  # share by which sums of the same lengths differ


def fuel_of(what: str, table: PlanTable, problem: Problem) -> FuelFigures | None:
    """The figures of a plan by `LeastFuel`; None of other plans.

    Args:
        what: name of the file in errors.
        table: the plan, each field of which has been checked by itself.
        problem: what was planned.

    Raises:
        InvalidInput: figures that do not agree with the motion, the planner or one another.
    """
    stated, planner = table.fuel, table.planner
    if not isinstance(planner, LeastFuel):
        if stated is not None:
            raise InvalidInput(f"{what}, fuel", "figures", f"none with {planner.name}")
        return None
    if stated is None:
        raise InvalidInput(f"{what}, fuel", None, f"the figures of {planner.name}")
    figures = FuelFigures(**vars(stated))
    change = velocity_change(np.asarray(table.motion.positions, dtype=np.float64))
    straight = 2.0 * float(np.linalg.norm(problem.base_displacement))
    wanted = {"change": change, "straight": straight, "margin": planner.margin}
    for name, value in wanted.items():
        if abs(getattr(figures, name) - value) > _ROUNDING * max(1.0, value):
            raise InvalidInput(f"{what}, fuel.{name}", getattr(figures, name), repr(value))
    if figures.start not in STARTS:
        raise InvalidInput(f"{what}, fuel.start", figures.start, " or ".join(STARTS))
    bound, found = figures.lattice_bound, figures.lattice_change
    if (bound is None) != (found is None):
        allowed = "a number where lattice_change is one, else null"
        raise InvalidInput(f"{what}, fuel.lattice_bound", bound, allowed)
    if bound is not None and found is not None:
        low, high = straight * (1.0 - _ROUNDING), found * (1.0 + _ROUNDING)
        if not low <= bound <= high:
            allowed = f"from straight, {straight!r}, to lattice_change, {found!r}"
            raise InvalidInput(f"{what}, fuel.lattice_bound", bound, allowed)
    return figures
