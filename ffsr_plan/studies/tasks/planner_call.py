"""A call of a planner: of this package, or of anybody else."""

from __future__ import annotations

import inspect
from typing import Any, cast

from ffsr_plan.planning.plan_and_refine import plan
from ffsr_plan.plans.planner_registry import PLANNERS, Planner
from ffsr_plan.problem.problem import Problem
from ffsr_plan.studies.tasks.grid import NamedPlanner


def call_planner(
    named: NamedPlanner, problem: Problem, seed: int, time_limit: float | None
) -> object:
    """What a planner returns for a problem.

    A planner that is not of this package is an object with a method `plan`, or a function; both
    are called with the problem and the seed, and with `time_limit` if they have such an argument.

    Args:
        named: the planner.
        problem: the problem.
        seed: a whole number >= 0.
        time_limit: [s], or None.
    """
    planner: Any = named.planner
    if planner is None or isinstance(planner, tuple(PLANNERS.values())):
        own = cast("Planner | None", planner)
        return plan(
            problem,
            own,
            seed,
            refine=named.refine,
            time_limit=time_limit,
            on_interrupt="raise",
        )
    function = getattr(planner, "plan", planner)
    if "time_limit" in inspect.signature(function).parameters:
        return function(problem, seed, time_limit=time_limit)
    return function(problem, seed)
