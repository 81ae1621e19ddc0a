"""Files that commands write, and what they refuse to replace."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from ffsr_plan.core.errors import InvalidInput

if TYPE_CHECKING:
    from ffsr_plan.planning.plan import Plan

RESULTS = ("plan.json", "plan.html", "path.png", "clearance.png", "convergence.png")


def write_results(found: Plan, title: str, target: Path) -> None:
    """Plan, page and figures into a directory."""
    from ffsr_plan.display.figures import write_figures

    try:
        target.mkdir(parents=True, exist_ok=True)
        found.save(target / "plan.json")  # first: whatever fails later, the plan is kept
        found.write_html(target / "plan.html", title)
        write_figures(found, target)
    except OSError as error:
        raise InvalidInput("--out", str(target), f"a writable directory ({error})") from None


def prepared(target: Path, force: bool) -> Path:
    """Refuse before planning, not after, to overwrite results."""
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


def refuse_to_replace(what: str, path: Path, force: bool) -> None:
    """Raise `InvalidInput` if a file is there that nobody said to replace."""
    if path.exists() and not force:
        raise InvalidInput(what, str(path), "a file that is not there yet; --force replaces it")


def unused(base: Path) -> Path:
    """This path, or one with the first number that is not there yet."""
    candidate, number = base, 2
    while candidate.exists():
        candidate, number = base.with_name(f"{base.name}-{number}"), number + 1
    return candidate
