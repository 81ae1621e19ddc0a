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


def with_spinner(label: str, work: Callable[[], T]) -> T:
    """Run `work` with a spinner and a label on standard error.

    Args:
        label: what is being done.
        work: a function without arguments.

    Returns:
        What `work` returns.
    """
    with err_console.status(label):
        return work()


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
