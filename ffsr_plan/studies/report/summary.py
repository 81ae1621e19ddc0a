"""Shares and medians of a study: by planner, and by each value of an axis."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from statistics import median
from typing import Any, NamedTuple

from ffsr_plan.studies.tasks.row import PLAN

Row = dict[str, Any]
MOST_VALUES = 12
"""An axis with more values, such as the seeds of scenes, is repetition, and not compared."""


class Group(NamedTuple):
    """Figures of some rows; None where there are no numbers.

    Attributes:
        tasks: number of rows.
        plans: those with a plan.
        share: of rows with a plan.
        length: median L [m].
        objective: median F.
        gap: median gap to the optimum or its bound [1].
        clearance: median proven clearance [m].
        seconds: median computing time of plans [s].
        slowest: 95 % of plans took no longer [s].
    """

    tasks: int
    plans: int
    share: float
    length: float | None
    objective: float | None
    gap: float | None
    clearance: float | None
    seconds: float | None
    slowest: float | None


COLUMNS = (
    "tasks",
    "plans",
    "success",
    "length [m]",
    "F",
    "gap",
    "clearance [m]",
    "time [s]",
    "95 % of times [s]",
)
"""Headings of a group's figures; those of numbers are medians of plans."""


def group(rows: Sequence[Row]) -> Group:
    """The figures of some rows.

    Args:
        rows: of a study.
    """
    plans = [row for row in rows if row["outcome"] == PLAN]
    times = sorted(numbers(plans, "seconds"))
    return Group(
        len(rows),
        len(plans),
        len(plans) / len(rows) if rows else math.nan,
        _median(numbers(plans, "length")),
        _median(numbers(plans, "objective")),
        _median(numbers(plans, "gap")),
        _median(numbers(plans, "least_clearance")),
        _median(times),
        times[math.ceil(0.95 * len(times)) - 1] if times else None,
    )


def numbers(rows: Iterable[Row], column: str) -> list[float]:
    """The numbers of a column, without rows that have none.

    Args:
        rows: of a study.
        column: its name.
    """
    return [row[column] for row in rows if row[column] is not None]


def by(rows: Iterable[Row], key: Callable[[Row], Any]) -> dict[Any, list[Row]]:
    """Rows in groups, in the order of the groups' first rows.

    Args:
        rows: of a study.
        key: of a row's group.
    """
    found: dict[Any, list[Row]] = {}
    for row in rows:
        found.setdefault(key(row), []).append(row)
    return found


def compared_axes(rows: Sequence[Row], axes: Sequence[str]) -> list[str]:
    """Axes of 2 to 12 values.

    Args:
        rows: of a study.
        axes: names of all its axes.
    """
    return [axis for axis in axes if 2 <= len(values_of(rows, axis)) <= MOST_VALUES]


def values_of(rows: Iterable[Row], axis: str) -> list[Any]:
    """Values of an axis, numbers in their order; rows of problems without the axis are left out.

    Args:
        rows: of a study.
        axis: its name.
    """
    found = list(dict.fromkeys(row[axis] for row in rows if row.get(axis) is not None))
    plain = all(isinstance(each, (int, float)) for each in found)
    return sorted(found) if plain else found


def shown_value(value: object) -> str:
    """A value of an axis in a few characters.

    Args:
        value: of the column of the axis.
    """
    return f"{value:g}" if isinstance(value, float) else str(value)


def failures(rows: Iterable[Row]) -> list[tuple[str, str, str, int, str]]:
    """Planner, outcome, error, their number and an example, of rows without a plan.

    Args:
        rows: of a study.
    """
    failed = [row for row in rows if row["outcome"] != PLAN]
    keys = Counter((row["planner"], row["outcome"], row["error"] or "") for row in failed)
    found = []
    for (planner, outcome, error), count in keys.most_common():
        example = next(
            row["message"] or ""
            for row in failed
            if (row["planner"], row["outcome"], row["error"] or "") == (planner, outcome, error)
        )
        found.append((planner, outcome, error, count, example))
    return found


def cost_ratios(rows: Iterable[Row]) -> dict[str, list[float]]:
    """F of each plan relative to the least that any planner found for the same problem, by planner.

    Args:
        rows: of a study. Problems that no planner solved are left out; a task without a plan
            counts as infinite.
    """
    found: dict[str, list[float]] = {}
    for same in by(rows, lambda row: row["problem"]).values():
        values = [_cost(row) for row in same]
        best = min(values)
        if math.isfinite(best) and best > 0.0:
            for row, value in zip(same, values, strict=True):
                found.setdefault(row["planner"], []).append(value / best)
    return found


def _cost(row: Row) -> float:
    value = row["objective"]
    return math.inf if row["outcome"] != PLAN or value is None else float(value)


def lost_workers(rows: Iterable[Row]) -> int:
    """Number of workers that died while tasks of the study ran.

    Args:
        rows: of a study.
    """
    return len({json.dumps(worker) for row in rows for worker in row["lost_workers"]})


def _median(values: Sequence[float]) -> float | None:
    return median(values) if values else None
