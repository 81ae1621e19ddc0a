"""Tables of a study as headings and cells of text, for the terminal and for pages."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ffsr_plan.studies.report.summary import (
    COLUMNS,
    Group,
    Row,
    by,
    compared_axes,
    failures,
    group,
    shown_value,
    values_of,
)


class Table(NamedTuple):
    """A table.

    Attributes:
        title: of the table.
        headings: of its columns.
        rows: its cells.
        texts: number of columns at the beginning that hold texts; the others hold numbers.
    """

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    texts: int


def study_tables(rows: Sequence[Row], axes: Sequence[str]) -> list[Table]:
    """All tables of a study: by planner, by the values of each axis, and what failed.

    Args:
        rows: of the study.
        axes: names of its axes.
    """
    by_planner = by(rows, lambda row: row["planner"])
    cells = tuple((name, *_cells(group(own))) for name, own in by_planner.items())
    tables = [Table("By planner; figures are medians of plans", ("planner", *COLUMNS), cells, 1)]
    for axis in compared_axes(rows, axes):
        cells = tuple(
            (shown_value(value), name, *_cells(group(chosen)))
            for value in values_of(rows, axis)
            for name, own in by_planner.items()
            if (chosen := [row for row in own if row.get(axis) == value])
        )
        tables.append(Table(f"By {axis}", ("value", "planner", *COLUMNS), cells, 2))
    failed = tuple(
        (planner, outcome, error, _short(example), str(count))
        for planner, outcome, error, count, example in failures(rows)
    )
    if failed:
        headings = ("planner", "outcome", "error", "example", "tasks")
        tables.append(Table("Without a plan", headings, failed, 4))
    return tables


def _cells(found: Group) -> tuple[str, ...]:
    return (
        str(found.tasks),
        str(found.plans),
        f"{found.share:.1%}",
        _number(found.length, "{:.3f}"),
        _number(found.objective, "{:.3f}"),
        _number(found.gap, "{:.2%}"),
        _number(found.clearance, "{:.3f}"),
        _number(found.seconds, "{:.3g}"),
        _number(found.slowest, "{:.3g}"),
    )


def _number(value: float | None, form: str) -> str:
    return "" if value is None else form.format(value)


def _short(text: str) -> str:
    return text if len(text) <= 160 else f"{text[:157]}..."
