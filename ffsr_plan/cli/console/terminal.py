"""Terminal output: results, progress, and errors with their exit status."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import typer
from rich.console import Console

if TYPE_CHECKING:
    from ffsr_plan.core.errors import InternalError

INTERRUPTED = 130
"""Exit status after Ctrl-C."""
T = TypeVar("T")
out_console = Console(highlight=False, markup=False, emoji=False)
err_console = Console(stderr=True, highlight=False, markup=False, emoji=False)
INTERNAL_ERROR = 70
"""Exit status for what is the program's fault, EX_SOFTWARE of sysexits.h."""


def with_progress(
    label: str, work: Callable[[Callable[[float], object]], T], shown: bool = True
) -> T:
    """Run `work` with a progress bar on standard error, if that is a terminal.

    Args:
        label: what is being done.
        work: a function of a callback, which it calls with the share that is done, from 0 to 1.
        shown: whether progress is wanted.

    Returns:
        What `work` returns.
    """
    from rich.progress import Progress

    hidden = not (shown and err_console.is_terminal)
    with Progress(console=err_console, transient=True, disable=hidden) as progress:
        task = progress.add_task(label, total=1.0)
        return work(lambda share: progress.update(task, completed=share))


@contextmanager
def errors_on_stderr() -> Iterator[None]:
    """Print errors of ffsr-plan on standard error and exit.

    Raises:
        typer.Exit: status 1 without a verified plan, 2 for bad input, 70 for an error of the
            program itself, 130 after Ctrl-C.
    """
    from ffsr_plan.core.errors import FfsrPlanError, InternalError, PlanningError

    try:
        yield
    except InternalError as error:
        err_console.print(f"ffsr-plan: {error}", style="red")
        raise typer.Exit(INTERNAL_ERROR) from None
    except FfsrPlanError as error:
        err_console.print(f"ffsr-plan: {error}", style="red")
        raise typer.Exit(1 if isinstance(error, PlanningError) else 2) from None
    except KeyboardInterrupt:  # where the search has no plan yet
        err_console.print("ffsr-plan: interrupted", style="red")
        raise typer.Exit(INTERRUPTED) from None
    except Exception as error:
        if isinstance(error, (typer.Exit, typer.Abort, typer.BadParameter, BrokenPipeError)):
            raise  # for Typer
        err_console.print(f"ffsr-plan: {_unexpected(error)}", style="red")
        raise typer.Exit(INTERNAL_ERROR) from None


def _unexpected(error: Exception) -> InternalError:
    """What nobody has foreseen, in one sentence that says where it happened."""
    from ffsr_plan.core.errors import InternalError

    frames = list(traceback.extract_tb(error.__traceback__))
    own = [frame for frame in frames if "ffsr_plan" in frame.filename] or frames
    where = f"{Path(own[-1].filename).name}, line {own[-1].lineno}"
    text = " ".join(str(error).split())
    return InternalError(f"{type(error).__name__} in {where}{text and ': '}{text[:300]}")
