"""Progress of a study on standard error: a bar with an estimate of the time that is left."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from ffsr_plan.studies.running import OnProgress, StudyProgress

_ESTIMATE = 600.0  # [s] of the past from which the time that is left is estimated


@contextmanager
def progress_shown(total: int, wanted: bool) -> Iterator[OnProgress]:
    """A function that shows how far a study has come, on a terminal; notices are shown anywhere.

    Args:
        total: number of tasks.
        wanted: whether to show anything.
    """
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    console = Console(stderr=True, highlight=False, markup=False, emoji=False)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    hidden = not (wanted and console.is_terminal)
    with Progress(
        *columns, console=console, transient=True, disable=hidden, speed_estimate_period=_ESTIMATE
    ) as bar:
        task = bar.add_task("plans", total=total)

        begun = False

        def tell(progress: StudyProgress) -> None:
            nonlocal begun
            if not begun:  # rows of earlier runs took no time in this one
                bar.reset(task, completed=progress.done)
                begun = True
            workers = "1 worker" if progress.workers == 1 else f"{progress.workers} workers"
            failed = f", {progress.failed} without a plan" if progress.failed else ""
            bar.update(task, completed=progress.done, description=f"plans, {workers}{failed}")
            if progress.notice and wanted:
                console.print(f"ffsr-plan: {progress.notice}", soft_wrap=True)

        yield tell
