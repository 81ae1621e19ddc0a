"""Terminal output: results, progress, and errors with their exit status."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

import typer
from rich.console import Console

from ffsr_plan.core.errors import FfsrPlanError, PlanningError
from ffsr_plan.search.interruption import CtrlC

INTERRUPTED = 130
"""Exit status after Ctrl-C."""
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
        if CtrlC.raised:  # a library has swallowed it
            raise CtrlC
    except FfsrPlanError as error:
        err_console.print(f"ffsr-plan: {error}", style="red", markup=False)
        raise typer.Exit(1 if isinstance(error, PlanningError) else 2) from None
    except (KeyboardInterrupt, Exception) as error:
        if not isinstance(error, KeyboardInterrupt) and not CtrlC.raised:
            raise
        err_console.print("ffsr-plan: interrupted", style="red")
        raise typer.Exit(INTERRUPTED) from None
