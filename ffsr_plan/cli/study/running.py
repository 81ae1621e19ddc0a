"""The work of `ffsr-plan study`: a run with its progress, and a report."""

from __future__ import annotations

import shlex
import signal
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ffsr_plan.cli.console.output import Output
from ffsr_plan.cli.console.report_tables import as_data, printed
from ffsr_plan.cli.console.terminal import INTERRUPTED, err_console
from ffsr_plan.studies.study import Study
from ffsr_plan.studies.study_result import StudyResult

if TYPE_CHECKING:
    from rich.console import RenderableType


_LEFT_OUT = ("plans", "length [m]", "95 % of times [s]", "example")


def run_and_report(
    file: str,
    out: str | None,
    workers: int,
    scheduler: str | None,
    retry_failed: bool,
    output: Output,
    command: Sequence[str],
) -> bool:
    """Run a study, or go on with it, and show its tables.

    Args:
        file: path of the study file.
        out: directory for rows and plans, or None for one beside the file.
        workers: processes on this computer.
        scheduler: address of a Dask scheduler, or None.
        retry_failed: whether tasks are repeated that ended without a plan.
        output: where tables are shown.
        command: that goes on with the study after Ctrl-C.

    Returns:
        Whether any task ended in a fault.

    Raises:
        typer.Exit: status 130 after Ctrl-C.
        InvalidInput: see `Study.load` and `Study.run`.
    """
    import typer

    study = Study.load(file)
    source = Path(file)
    folder = source.with_name(f"{source.stem}-study") if out is None else out
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        result = study.run(
            folder,
            workers=workers,
            scheduler=scheduler,
            retry_failed=retry_failed,
            progress=not output.quiet,
        )
    except KeyboardInterrupt:
        done = f"{len(StudyResult(folder))} of {len(study)} rows are in {folder}"
        again = f"the same command goes on: {shlex.join(command)}"
        err_console.print(f"ffsr-plan: interrupted; {done}; {again}", style="red", soft_wrap=True)
        raise typer.Exit(INTERRUPTED) from None
    _show(result, [], output, len(result) - len(study))
    return result.faults > 0


def report_study(
    directory: str, out: str | None, csv: str | None, parquet: str | None, output: Output
) -> None:
    """Show the tables of a study, and write its report.

    Args:
        directory: of the study.
        out: directory for page and pictures, or None for one in that of the study.
        csv: path of a CSV table, or None.
        parquet: path of a Parquet table, or None.
        output: where tables are shown.

    Raises:
        InvalidInput: no study, or a file that cannot be written.
    """
    result = StudyResult(directory)
    files = result.write_report(Path(directory) / "report" if out is None else out)
    for path, write in ((csv, result.to_csv), (parquet, result.to_parquet)):
        if path is not None:
            write(path)
            files.append(Path(path))
    _show(result, files, output)


def _show(
    result: StudyResult, files: Sequence[Path], output: Output, others: int | None = None
) -> None:
    from ffsr_plan.studies.report.report_files import sentences
    from ffsr_plan.studies.report.tables import study_tables

    rows = result.rows()
    tables = study_tables(rows, result.axes) if rows else []

    def readable() -> Iterator[RenderableType]:
        yield from (printed(table, _LEFT_OUT) for table in tables)
        yield from sentences(rows)
        if others:
            yield f"{others} of the rows are of points that the study file does not have."
        if files:
            yield f"Written: {', '.join(map(str, files))}"
        else:
            drawn = f"`ffsr-plan study report {shlex.quote(str(result.directory))}` draws them"
            yield f"Rows are in {result.database}; {drawn}."

    def data() -> dict[str, Any]:
        return {
            "study": {
                "directory": str(result.directory),
                "rows": len(rows),
                **({} if others is None else {"rows_of_other_points": others}),
                "plans": result.plans,
                "faults": result.faults,
                "digest": result.digest(),
            },
            "tables": [as_data(table) for table in tables],
            "files": [str(path) for path in files],
        }

    output.show(readable, data)
