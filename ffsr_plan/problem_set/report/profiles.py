"""Profiles of planners: numbers behind the curves.

Performance profiles follow Dolan and More (2002): the share of tasks that a planner solves within a
factor of the least time, or of the least cost, that any planner needed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.problem_set.best_plans import BestPlans
from ffsr_plan.problem_set.judging.result_files import Judged, JudgedRow
from ffsr_plan.problem_set.report.summary import Key, by_key, first_time


def success_over_time(rows: Sequence[JudgedRow]) -> tuple[list[float], list[float]]:
    """Times at which a further task is solved, and the share that is solved by then.

    Args:
        rows: of a planner, at least one.

    Returns:
        Ascending times [s], and shares from 1 / n to the share of accepted rows.
    """
    times = sorted(time for row in rows if math.isfinite(time := first_time(row)))
    return times, [(k + 1) / len(rows) for k in range(len(times))]


def cost_over_time(rows: Sequence[JudgedRow], best: BestPlans, times: Array) -> Array:
    """Quartiles of F relative to the best known, over all tasks, at some times.

    A task without a path by then counts as infinite, so that no planner gains by solving easy
    problems alone.

    Args:
        rows: of a planner.
        best: the best plans; problems without one are left out.
        times: (n,) [s].

    Returns:
        (n, 3) lower quartile, median and upper quartile, infinite where so many have no path.
    """
    table = []
    for row in rows:
        known = best.get(row.problem)
        if known is None or not known.objective:
            continue
        values = np.full(len(times), np.inf)
        if row.accepted:
            for seconds, cost in row.curve:
                values[times >= seconds] = cost / known.objective
        table.append(values)
    if not table:
        return np.full((len(times), 3), np.inf)
    return np.asarray(np.quantile(np.array(table), (0.25, 0.5, 0.75), axis=0, method="higher")).T


def performance_profile(values: Mapping[str, Mapping[Key, float]]) -> dict[str, list[float]]:
    """Ratios to the least value of any planner, by planner.

    Args:
        values: by planner, by task; infinite where it is not solved. Tasks that a planner lacks
            are left out for all.

    Returns:
        By planner, ascending ratios of all tasks that any planner solved, infinite ones included.
    """
    common = set.intersection(*(set(each) for each in values.values())) if values else set()
    least = {key: min(each[key] for each in values.values()) for key in common}
    solved = [key for key in sorted(common) if math.isfinite(least[key])]
    return {
        name: sorted(each[key] / max(least[key], 1e-12) for key in solved)
        for name, each in values.items()
    }


def times_and_costs(
    judged: Sequence[Judged],
) -> tuple[dict[str, dict[Key, float]], dict[str, dict[Key, float]]]:
    """Times to the first path and F, by planner and task; infinite where it is not solved.

    Args:
        judged: rows of planners.
    """
    times: dict[str, dict[Key, float]] = {}
    costs: dict[str, dict[Key, float]] = {}
    for each in judged:
        rows = by_key(each)
        times[each.planner] = {key: max(first_time(row), 1e-3) for key, row in rows.items()}
        costs[each.planner] = {
            key: math.inf if row.objective is None else row.objective for key, row in rows.items()
        }
    return times, costs
