"""Files of a report: the page, and its pictures one by one."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import counted
from ffsr_plan.core.text_files import write_files
from ffsr_plan.studies.report.figures import study_figures
from ffsr_plan.studies.report.page import page
from ffsr_plan.studies.report.summary import Row, lost_workers
from ffsr_plan.studies.report.tables import study_tables
from ffsr_plan.studies.tasks.row import PLAN

_DOTS_PER_INCH = 200


def write_report(title: str, rows: Sequence[Row], axes: Sequence[str], folder: Path) -> list[Path]:
    """Write the report of a study: all files or none.

    Args:
        title: of the study.
        rows: of the study, at least one.
        axes: names of its axes.
        folder: for the files.

    Returns:
        Paths of the files.

    Raises:
        InvalidInput: a file that cannot be written.
    """
    figures = study_figures(rows, axes)
    contents: dict[Path, str | bytes] = {
        folder / "report.html": page(title, sentences(rows), study_tables(rows, axes), figures)
    }
    for name, figure in figures.items():
        for kind, metadata in (("png", {}), ("pdf", {"CreationDate": None})):
            data = io.BytesIO()
            figure.savefig(data, format=kind, dpi=_DOTS_PER_INCH, metadata=metadata)
            contents[folder / f"{name}.{kind}"] = data.getvalue()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        allowed = f"a folder that can be written ({error.strerror})"
        raise InvalidInput("directory", str(folder), allowed) from None
    write_files("report", contents)
    return list(contents)


def sentences(rows: Sequence[Row]) -> list[str]:
    """What a report says above its tables.

    Args:
        rows: of a study.
    """
    plans = sum(row["outcome"] == PLAN for row in rows)
    spent = _duration(sum(row["wall"] or 0.0 for row in rows))
    workers = len({row["worker"] for row in rows if row["worker"]})
    processes = "1 worker process" if workers == 1 else f"{workers} worker processes"
    versions = ", ".join(sorted({row["version"] for row in rows}))
    found = [
        f"{counted(len(rows), 'task')}, {counted(plans, 'plan')}; {spent} of {processes}; "
        f"ffsr-plan {versions}."
    ]
    if lost := lost_workers(rows):
        found.append(f"{counted(lost, 'worker')} died; what they were doing was done again.")
    if cut := sum(bool(row["interrupted"]) for row in rows):
        found.append(f"{counted(cut, 'plan')} ended by the time limit, with the best path by then.")
    return found


def _duration(seconds: float) -> str:
    """A time in the unit that fits."""
    if seconds < 120.0:
        return f"{seconds:.3g} s"
    return f"{seconds / 60:.3g} minutes" if seconds < 7200.0 else f"{seconds / 3600:.3g} hours"
