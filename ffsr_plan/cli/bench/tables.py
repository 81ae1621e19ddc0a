"""Tables of the problem set for the terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from ffsr_plan.cli.console.output import Output
from ffsr_plan.cli.console.report_tables import as_data, printed
from ffsr_plan.problem_set.best_plans import BestPlans
from ffsr_plan.problem_set.set_index import ProblemSet
from ffsr_plan.studies.report.tables import Table

if TYPE_CHECKING:
    from rich.console import RenderableType


def list_problems(family: Sequence[str] | None, output: Output) -> None:
    """Show the families, or the problems of some.

    Args:
        family: names of families; None for a line for each family.
        output: where it is shown.

    Raises:
        InvalidInput: an unknown family.
    """
    problems = ProblemSet()
    best = BestPlans(problems.folder)
    table = _problems(problems, best, family) if family else _families(problems, best)

    def readable() -> Iterator[RenderableType]:
        yield printed(table)

    output.show(readable, lambda: {"set_version": problems.version, "table": as_data(table)})


def _families(problems: ProblemSet, best: BestPlans) -> Table:
    rows = []
    for family, title in problems.families.items():
        names = problems.names(family)
        known = sum((row := best.get(n)) is not None and row.objective is not None for n in names)
        limit = f"{problems.entry(names[0])['time_limit']:g}" if names else ""
        rows.append((family, title, f"{len(names)}", f"{known}", limit))
    headings = ("family", "problems", "number", "with a known plan", "limit [s]")
    return Table(f"Problem set {problems.version}", headings, tuple(rows), 2)


def _problems(problems: ProblemSet, best: BestPlans, family: Sequence[str]) -> Table:
    rows = []
    for name in problems.names(family):
        entry, row = problems.entry(name), best.get(name)
        figures, title = ("", "", "", ""), f"{entry['title']}; no plan known"
        bound = ""
        if row is not None:
            bound = f"{row.bound:.4f}"
            if row.objective is not None:
                title = entry["title"]
                figures = (
                    f"{row.objective:.4f}",
                    f"{row.length:.3f}",
                    f"{row.delta_v:.4f}",
                    "" if row.clearance is None else f"{row.clearance:.3f}",
                )
        rows.append((name, title, *figures, bound))
    headings = ("problem", "title", "F", "L [m]", "delta-v [m/s]", "clear [m]", "bound")
    return Table(f"Problem set {problems.version}, the best plans known", headings, tuple(rows), 2)
