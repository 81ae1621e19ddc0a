"""Result files of commands, and the refusal to replace files without `--force`."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import write_files

if TYPE_CHECKING:
    from ffsr_plan.planning.certified_plan import Plan

RESULTS = ("plan.json", "plan.html", "path.png", "clearance.png", "convergence.png")
"""Files in the directory of `--out`."""


def write_results(plan: Plan, title: str, target: Path, pictures: bool = True) -> list[Path]:
    """Write plan, page and figures into a directory: all files or none, and each of them whole.

    If that fails, the plan alone is written, under a name that is not in use. Without figures,
    those of an earlier plan are removed when the new plan is there.

    Args:
        plan: the plan.
        title: of the page.
        target: the directory, made if it is not there.
        pictures: whether to draw the figures.

    Returns:
        Paths of the files.

    Raises:
        InvalidInput: the directory or a file in it cannot be written.
    """
    from ffsr_plan.display.plan_page import page
    from ffsr_plan.plans.plan_file import to_text

    try:
        target.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InvalidInput("--out", str(target), f"a writable directory ({error})") from None
    try:
        contents: dict[str, str | bytes] = {
            "plan.json": to_text(plan),
            "plan.html": page(plan, title),
        }
        if pictures:
            from ffsr_plan.display.figures import figure_files

            contents |= figure_files(plan)
        write_files("--out", {target / name: content for name, content in contents.items()})
    except Exception:
        with suppress(InvalidInput):
            plan.save(unused_path(target / "plan.json"))
        raise
    for name in set(RESULTS) - contents.keys():
        (target / name).unlink(missing_ok=True)
    return [target / name for name in contents]


def check_target(target: str | Path, force: bool) -> Path:
    """Check before planning that results can be written into a directory.

    Args:
        target: the directory; it need not exist.
        force: whether results in it may be replaced.

    Returns:
        The directory.

    Raises:
        InvalidInput: an empty path, not a writable directory, or results that may not be replaced.
    """
    target = checked_path("--out", target)
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


def check_replacement(what: str, path: str | Path, force: bool) -> None:
    """Raise `InvalidInput` if a file exists and may not be replaced.

    Args:
        what: the argument, for errors.
        path: of the file.
        force: whether it may be replaced.
    """
    if checked_path(what, path).exists() and not force:
        raise InvalidInput(what, str(path), "a file that does not exist yet; --force replaces it")


def unused_path(base: Path) -> Path:
    """This path if nothing is there, otherwise the path with the first free number, from 2."""
    candidate, number = base, 2
    while candidate.exists():
        candidate, number = base.with_name(f"{base.name}-{number}"), number + 1
    return candidate
