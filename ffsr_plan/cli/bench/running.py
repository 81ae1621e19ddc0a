"""The work of `ffsr-plan bench`: runs, judgements, comparisons and pages."""

from __future__ import annotations

import signal
import textwrap
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ffsr_plan.cli.console.output import Output
from ffsr_plan.cli.console.report_tables import as_data, printed
from ffsr_plan.cli.console.terminal import INTERRUPTED, err_console
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.checks import whole_number
from ffsr_plan.problem_set.best_plans import BestPlans
from ffsr_plan.problem_set.judging.judged_folder import judge_folder
from ffsr_plan.problem_set.judging.result_files import Judged, JudgedRow, read_judged
from ffsr_plan.problem_set.report.bench_page import write_page
from ffsr_plan.problem_set.report.summary import compared, family_table, reasons, was_judged
from ffsr_plan.problem_set.running.bench_run import run
from ffsr_plan.problem_set.set_index import ProblemSet
from ffsr_plan.studies.report.tables import Table

if TYPE_CHECKING:
    from rich.console import RenderableType


class Wanted(NamedTuple):
    """Options of `bench run`.

    Attributes:
        family: names of families, or None.
        problem: names of problems, or None.
        planner: name of a planner, or None for that of each problem.
        time: limit of a plan [s], or None for that of each problem.
        seed: the first one.
        seeds: their number.
        workers: processes.
        out: directory for results.
    """

    family: Sequence[str] | None
    problem: Sequence[str] | None
    planner: str | None
    time: float | None
    seed: int
    seeds: int
    workers: int
    out: str


def run_and_report(wanted: Wanted, output: Output) -> bool:
    """Run a planner on the problems, and show what was judged.

    Args:
        wanted: the options.
        output: where it is shown.

    Returns:
        Whether all problems are solved.

    Raises:
        typer.Exit: status 130 after Ctrl-C.
        InvalidInput: see `run`.
    """
    import typer

    problems = ProblemSet()
    names = problems.names(wanted.family) if wanted.family or not wanted.problem else []
    for each in wanted.problem or ():
        problems.entry(each)
    names += [each for each in wanted.problem or () if each not in names]
    signal.signal(signal.SIGINT, signal.default_int_handler)
    folder = checked_path("--out", wanted.out)
    first = whole_number("--seed", wanted.seed, at_least=0)
    count = whole_number("--seeds", wanted.seeds, at_least=1)
    try:
        judged = run(
            problems,
            folder,
            names,
            planner=wanted.planner,
            seeds=range(first, first + count),
            time_limit=wanted.time,
            workers=wanted.workers,
            progress=not output.quiet,
        )
    except KeyboardInterrupt:
        err_console.print("ffsr-plan: interrupted; the same command goes on", style="red")
        raise typer.Exit(INTERRUPTED) from None
    _show(judged, problems, folder, output)
    return all(row.accepted for row in judged.rows)


def judge_and_report(directory: str, output: Output) -> bool:
    """Judge results, and show what was judged.

    Args:
        directory: of the results.
        output: where it is shown.

    Returns:
        Whether all are accepted.

    Raises:
        InvalidInput: see `judge_folder`.
    """
    problems, folder = ProblemSet(), checked_path("directory", directory)
    judged = judge_folder(folder, problems)
    _show(judged, problems, folder, output)
    return all(row.accepted for row in judged.rows)


def compare_and_report(first: str, second: str, output: Output) -> None:
    """Show two results side by side.

    Args:
        first: directory of results.
        second: directory of other results.
        output: where it is shown.

    Raises:
        InvalidInput: no judged results, or nothing in common.
    """
    one, other = (read_judged(checked_path("results", each)) for each in (first, second))
    _tables([compared(one, other, ProblemSet())], [], output)


def report_page(directories: Sequence[str], out: str, output: Output) -> None:
    """Write the page.

    Args:
        directories: of judged results.
        out: path of the page.
        output: where its path is shown.

    Raises:
        InvalidInput: no judged results, or a file that cannot be written.
    """
    judged = [read_judged(checked_path("results", each)) for each in directories]
    target = checked_path("--out", out, ".html")
    write_page(target, judged, ProblemSet())
    output.show(lambda: [f"Written: {target}"], lambda: {"files": [str(target)]})


def _show(judged: Judged, problems: ProblemSet, folder: Path, output: Output) -> None:
    tables = [family_table(judged, problems, BestPlans(problems.folder))]
    if not all(row.accepted for row in judged.rows):
        tables.append(reasons([judged]))
    if len(judged.rows) <= 12:
        tables.append(_rows(judged.rows))
    written = f"Results and judgements are in {folder}; `ffsr-plan bench report {folder}` draws."
    _tables(tables, [written], output)


def _rows(rows: Sequence[JudgedRow]) -> Table:
    headings = ("problem", "verdict", "seed", "L [m]", "F", "delta-v [m/s]", "clearance [m]", "[s]")
    cells = tuple(
        (
            row.problem,
            _verdict(row),
            f"{row.seed}",
            *("" if v is None else f"{v:.4f}" for v in
              (row.length, row.objective, row.delta_v, row.clearance)),
            f"{row.seconds:.2f}",
        )
        for row in rows
    )  # fmt: skip
    return Table("By problem", headings, cells, 2)


def _verdict(row: JudgedRow) -> str:
    if row.accepted:
        return "accepted"
    word = "refused" if was_judged(row) else "no path"
    return f"{word}: {textwrap.shorten(row.reason, 120, placeholder=' ...')}"


def _tables(tables: Sequence[Table], sentences: Sequence[str], output: Output) -> None:
    def readable() -> Iterator[RenderableType]:
        yield from map(printed, tables)
        yield from sentences

    output.show(readable, lambda: {"tables": [as_data(table) for table in tables]})
