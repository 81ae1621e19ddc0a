"""Judged results as tables: by family, and two planners side by side."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from statistics import median

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.problem_set.best_plans import BestPlans
from ffsr_plan.problem_set.judging.result_files import Judged, JudgedRow
from ffsr_plan.problem_set.set_index import ProblemSet
from ffsr_plan.studies.report.tables import Table

_LATE, _LATER = 1.05, 0.02  # share and seconds by which planners may miss their time limit
Key = tuple[str, int]
"""Name of a problem and seed."""


def first_time(row: JudgedRow) -> float:
    """Seconds after which there was a path; infinite where the result was refused.

    Args:
        row: a judged row.
    """
    if not row.accepted:
        return math.inf
    return row.curve[0][0] if row.curve else row.seconds


def in_time(row: JudgedRow) -> bool:
    """Whether a row solves its problem within the problem's time.

    Args:
        row: a judged row.
    """
    return first_time(row) <= _LATE * row.time_limit + _LATER


def by_key(judged: Judged) -> dict[Key, JudgedRow]:
    """Rows by problem and seed.

    Args:
        judged: of a planner.
    """
    return {(row.problem, row.seed): row for row in judged.rows}


def ratios(rows: Iterable[JudgedRow], best: BestPlans) -> list[float]:
    """F relative to that of the best plan known, of rows that have both.

    Args:
        rows: judged rows.
        best: the best plans.
    """
    return [each for row in rows if (each := ratio(row, best)) is not None]


def ratio(row: JudgedRow, best: BestPlans) -> float | None:
    """F of a row relative to that of the best plan known; None without one of both.

    Args:
        row: a judged row.
        best: the best plans.
    """
    known = best.get(row.problem)
    if row.objective is None or known is None or not known.objective:
        return None
    return row.objective / known.objective


def gaps(rows: Iterable[JudgedRow], best: BestPlans) -> list[float]:
    """(F - bound) / bound of rows that have both.

    Args:
        rows: judged rows.
        best: gives the bounds.
    """
    found = []
    for row in rows:
        known = best.get(row.problem)
        if row.objective is not None and known is not None and known.bound > 0.0:
            found.append(row.objective / known.bound - 1.0)
    return found


def family_table(judged: Judged, problems: ProblemSet, best: BestPlans) -> Table:
    """One planner by family: what it solves, how fast, how well.

    Args:
        judged: its rows.
        problems: the set.
        best: the best plans.
    """
    headings = (
        "family", "limit [s]", "solved in time", "solved", "refused", "no path",
        "first path [s]", "F / best", "F above bound", "clear [m]",
    )  # fmt: skip
    groups: dict[str, list[JudgedRow]] = {}
    for row in judged.rows:
        groups.setdefault(row.family, []).append(row)
    order = [name for name in problems.families if name in groups]
    rows = [_family(name, groups[name], best) for name in order]
    if len(order) > 1:
        rows.append(_family("all", list(judged.rows), best))
    return Table(f"{judged.planner}, by family; medians", headings, tuple(rows), 1)


def _family(name: str, rows: Sequence[JudgedRow], best: BestPlans) -> tuple[str, ...]:
    accepted = [row for row in rows if row.accepted]
    missed = [row for row in rows if not row.accepted]
    refused = sum(map(was_judged, missed))
    limits = sorted({row.time_limit for row in rows})
    return (
        name,
        " to ".join(f"{each:g}" for each in dict.fromkeys((limits[0], limits[-1]))),
        f"{sum(map(in_time, rows))} of {len(rows)}",
        f"{len(accepted)}",
        f"{refused}",
        f"{len(missed) - refused}",
        _number(map(first_time, accepted), ".2f"),
        _number(ratios(accepted, best), ".3f"),
        _number(gaps(accepted, best), ".1%"),
        _number((row.clearance for row in accepted if row.clearance is not None), ".3f"),
    )


def was_judged(row: JudgedRow) -> bool:
    """Whether there was a trajectory, and not an error of the planner.

    Args:
        row: a judged row.
    """
    if row.accepted:
        return True
    return not row.reason.partition(":")[0].isidentifier() and row.reason != "no trajectory"


def compared(first: Judged, second: Judged, problems: ProblemSet) -> Table:
    """Two planners on the problems and seeds that both have.

    Args:
        first: rows of one.
        second: rows of the other.
        problems: the set.

    Raises:
        InvalidInput: results of different versions of the set, or no problem in common.
    """
    if first.set_version != second.set_version:
        allowed = f"results for version {first.set_version} of the set"
        raise InvalidInput("set_version", second.set_version, allowed)
    one, other = by_key(first), by_key(second)
    common = [key for key in one if key in other]
    if not common:
        raise InvalidInput("results", second.planner, "results with a problem and seed in common")
    a, b = first.planner, second.planner
    a, b = (a, b) if a != b else (f"{a} (A)", f"{b} (B)")
    headings = (
        "family", "tasks", "A in time", "B in time", "only A", "only B", "F of B / A",
        "F lower: A, B", "first path B / A",
    )  # fmt: skip
    rows = []
    for family in [*problems.families, "all"]:
        keys = [key for key in common if family in (one[key].family, "all")]
        if keys:
            rows.append(_compared(family, [(one[key], other[key]) for key in keys]))
    return Table(f"A: {a}; B: {b}; medians of ratios", headings, tuple(rows), 1)


def _compared(family: str, pairs: Sequence[tuple[JudgedRow, JudgedRow]]) -> tuple[str, ...]:
    both = [(a, b) for a, b in pairs if a.accepted and b.accepted]
    costs = [b.objective / a.objective for a, b in both if a.objective and b.objective is not None]
    times = [first_time(b) / max(first_time(a), 1e-4) for a, b in both]
    lower = sum(each > 1.0 + 1e-6 for each in costs), sum(each < 1.0 - 1e-6 for each in costs)
    return (
        family,
        f"{len(pairs)}",
        f"{sum(in_time(a) for a, _ in pairs)}",
        f"{sum(in_time(b) for _, b in pairs)}",
        f"{sum(in_time(a) and not in_time(b) for a, b in pairs)}",
        f"{sum(in_time(b) and not in_time(a) for a, b in pairs)}",
        _number(costs, ".3f"),
        f"{lower[0]}, {lower[1]}",
        _number(times, ".2f"),
    )


def reasons(judged: Sequence[Judged], most: int = 12) -> Table:
    """Why results were refused, each with an example.

    Args:
        judged: rows of planners.
        most: number of lines.
    """
    counts: dict[tuple[str, str], tuple[int, str]] = {}
    for each in judged:
        for row in each.rows:
            if not row.accepted:
                kind = _kind(row.reason)
                count, example = counts.get(
                    (each.planner, kind), (0, f"{row.problem}: {row.reason}")
                )
                counts[each.planner, kind] = count + 1, example
    ordered = sorted(counts.items(), key=lambda item: -item[1][0])[:most]
    rows = [
        (planner, kind, textwrap.shorten(example, 160, placeholder=" ..."), f"{count}")
        for (planner, kind), (count, example) in ordered
    ]
    return Table("Not solved", ("planner", "why", "example", "tasks"), tuple(rows), 3)


def _kind(reason: str) -> str:
    """The reason without its numbers and names."""
    for start in ("in contact", "not proven", "joints", "base origin", "base attitude", "the base"):
        if reason.startswith(start):
            return start
    return textwrap.shorten(reason.partition(":")[0], 40, placeholder=" ...")


def _number(values: Iterable[float], form: str) -> str:
    found = list(values)
    return format(median(found), form) if found else ""


def in_common(judged: Sequence[Judged]) -> list[Judged]:
    """The rows of the tasks that all planners have; all rows where there is no such task.

    Args:
        judged: rows of planners.
    """
    common = set.intersection(*(set(by_key(each)) for each in judged)) if judged else set()
    if not common:
        return list(judged)
    return [
        Judged(
            each.planner,
            each.set_version,
            tuple(row for row in each.rows if (row.problem, row.seed) in common),
        )
        for each in judged
    ]


def families_of(judged: Sequence[Judged], titles: Mapping[str, str]) -> list[str]:
    """Families that have rows, in the order of the set.

    Args:
        judged: rows of planners.
        titles: of the families, by name.
    """
    present = {row.family for each in judged for row in each.rows}
    return [name for name in titles if name in present]
