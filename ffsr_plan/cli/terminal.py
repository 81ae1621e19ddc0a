"""What goes to the terminal: results, errors with their exit status, signs of life."""

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
    """Work, with a label that says what at."""
    with err_console.status(label):
        return work()


@contextmanager
def errors_on_stderr() -> Iterator[None]:
    """Errors of ours end the program: 1 no plan, 2 bad input, 130 interrupted."""
    try:
        yield
    except FfsrPlanError as error:
        err_console.print(f"ffsr-plan: {error}", style="red", markup=False)
        raise typer.Exit(1 if isinstance(error, PlanningError) else 2) from None
    except KeyboardInterrupt:
        err_console.print("ffsr-plan: interrupted", style="red")
        raise typer.Exit(130) from None
