"""Terminal output: results, progress, and errors with their exit status."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

import typer
from rich.console import Console

from ffsr_plan.core.errors import FfsrPlanError, PlanningError

T = TypeVar("T")
out_console = Console(highlight=False)
err_console = Console(stderr=True, highlight=False)


def with_progress(label: str, work: Callable[[Callable[[float], object]], T]) -> T:
    """Run `work` with a progress bar on standard error, if that is a terminal.

    Args:
        label: what is being done.
        work: a function of a callback, which it calls with the share that is done, from 0 to 1.

    Returns:
        What `work` returns.
    """
    from rich.progress import Progress

    hidden = not err_console.is_terminal
    with Progress(console=err_console, transient=True, disable=hidden) as progress:
        task = progress.add_task(label, total=1.0)
        return work(lambda share: progress.update(task, completed=share))


@contextmanager
def errors_on_stderr() -> Iterator[None]:
    """Print errors of ffsr-plan on standard error and exit.

    Raises:
        typer.Exit: status 1 without a verified plan, 2 for bad input, 130 after Ctrl-C.
    """
    try:
        yield
    except FfsrPlanError as error:
        err_console.print(f"ffsr-plan: {error}", style="red", markup=False)
        raise typer.Exit(1 if isinstance(error, PlanningError) else 2) from None
    except KeyboardInterrupt:
        err_console.print("ffsr-plan: interrupted", style="red")
        raise typer.Exit(130) from None
