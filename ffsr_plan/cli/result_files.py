"""Result files of commands, and the refusal to replace files without `--force`."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from ffsr_plan.core.errors import InvalidInput

if TYPE_CHECKING:
    from ffsr_plan.planning.certified_plan import Plan

RESULTS = ("plan.json", "plan.html", "path.png", "clearance.png", "convergence.png")
"""Files in the directory of `--out`."""


def write_results(plan: Plan, title: str, target: Path) -> None:
    """Write plan, page and figures into a directory.

    Args:
        plan: the plan.
        title: of the page.
        target: the directory, made if it is not there.

    Raises:
        InvalidInput: the directory cannot be written.
    """
    from ffsr_plan.display.figures import write_figures

    try:
        target.mkdir(parents=True, exist_ok=True)
        plan.save(target / "plan.json")  # first: if anything later fails, the plan is kept
        plan.write_html(target / "plan.html", title)
        write_figures(plan, target)
    except OSError as error:
        raise InvalidInput("--out", str(target), f"a writable directory ({error})") from None


def check_target(target: Path, force: bool) -> Path:
    """Check before planning that results can be written into a directory.

    Args:
        target: the directory; it need not exist.
        force: whether results in it may be replaced.

    Returns:
        The directory.

    Raises:
        InvalidInput: not a writable directory, or results that may not be replaced.
    """
    existing = next(p for p in (target, *target.absolute().parents) if p.exists())
    if not existing.is_dir() or not os.access(existing, os.W_OK):
        raise InvalidInput("--out", str(target), "a directory that can be written")
    present = [name for name in RESULTS if (target / name).exists()]
    if present and not force:
        raise InvalidInput(
            "--out",
            str(target),
            f"a directory without {', '.join(present)}; --force replaces them",
        )
    return target


def check_replacement(what: str, path: Path, force: bool) -> None:
    """Raise `InvalidInput` if a file exists and may not be replaced.

    Args:
        what: the argument, for errors.
        path: of the file.
        force: whether it may be replaced.
    """
    if path.exists() and not force:
        raise InvalidInput(what, str(path), "a file that does not exist yet; --force replaces it")


def unused_path(base: Path) -> Path:
    """This path if nothing is there, otherwise the path with the first free number, from 2."""
    candidate, number = base, 2
    while candidate.exists():
        candidate, number = base.with_name(f"{base.name}-{number}"), number + 1
    return candidate
