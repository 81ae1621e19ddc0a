"""Tables of studies and of the problem set for the terminal, and as JSON has them."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Any

from ffsr_plan.studies.report.tables import Table

if TYPE_CHECKING:
    from rich.console import RenderableType

_MANY = 8  # columns that are set with more room than they need


def printed(table: Table, left_out: Collection[str] = ()) -> RenderableType:
    """A table for the terminal, in which titles are wrapped before names and numbers are cut.

    Args:
        table: the table.
        left_out: headings of columns that are not shown, so that the others fit.
    """
    from rich.box import SIMPLE_HEAD
    from rich.table import Table as Printed
    from rich.text import Text

    shown = [k for k, heading in enumerate(table.headings) if heading not in left_out]
    many = len(shown) > _MANY
    made = Printed(
        title=table.title,
        title_justify="left",
        box=SIMPLE_HEAD,
        padding=(0, 0 if many else 1, 0, 0),
        pad_edge=False,
        show_edge=False,
    )
    for k in shown:
        heading = table.headings[k]
        side: Any = "left" if k < table.texts else "right"
        widest = max((len(cells[k]) for cells in table.rows), default=0)
        least = max(map(len, heading.split()), default=0)
        if k == 0 or k >= table.texts:  # headings and titles are wrapped, between words
            least = max(least, widest)
        most = least if many and k >= table.texts else None
        made.add_column(
            Text(heading), justify=side, overflow="fold", min_width=least, max_width=most
        )
    for cells in table.rows:
        made.add_row(*(Text(cells[k]) for k in shown))
    return made


def as_data(table: Table) -> dict[str, Any]:
    """A table as JSON has it.

    Args:
        table: the table.
    """
    rows = [dict(zip(table.headings, cells, strict=True)) for cells in table.rows]
    return {"title": table.title, "rows": rows}
