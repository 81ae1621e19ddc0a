"""Terminal output: results, progress, and errors with their exit status."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

import click
import typer
from rich.console import Console

from ffsr_plan.core.errors import FfsrPlanError, InternalError, PlanningError

T = TypeVar("T")
out_console = Console(highlight=False, markup=False, emoji=False)
err_console = Console(stderr=True, highlight=False, markup=False, emoji=False)
INTERNAL_ERROR = 70
"""Exit status for what is the program's fault, EX_SOFTWARE of sysexits.h."""


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
        typer.Exit: status 1 without a verified plan, 2 for bad input, 70 for an error of the
            program itself, 130 after Ctrl-C.
    """
    try:
        yield
    except InternalError as error:
        err_console.print(f"ffsr-plan: {error}", style="red")
        raise typer.Exit(INTERNAL_ERROR) from None
    except FfsrPlanError as error:
        err_console.print(f"ffsr-plan: {error}", style="red")
        raise typer.Exit(1 if isinstance(error, PlanningError) else 2) from None
    except KeyboardInterrupt:
        err_console.print("ffsr-plan: interrupted", style="red")
        raise typer.Exit(130) from None
    except (typer.Exit, click.ClickException, BrokenPipeError):  # for Typer
        raise
    except Exception as error:
        err_console.print(f"ffsr-plan: {_unexpected(error)}", style="red")
        raise typer.Exit(INTERNAL_ERROR) from None


def _unexpected(error: Exception) -> InternalError:
    """What nobody has foreseen, in one sentence that says where it happened."""
    frames = list(traceback.extract_tb(error.__traceback__))
    own = [frame for frame in frames if "ffsr_plan" in frame.filename] or frames
    where = f"{Path(own[-1].filename).name}, line {own[-1].lineno}"
    text = " ".join(str(error).split())
    return InternalError(f"{type(error).__name__} in {where}{text and ': '}{text[:300]}")
