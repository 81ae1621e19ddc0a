"""Text files that are written whole or not at all."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from ffsr_plan.core.errors import InvalidInput


def write_whole(what: str, path: Path, text: str) -> None:
    """Write `path`, in place of what was there; an unfinished file never takes its place.

    Raises:
        InvalidInput: a file that cannot be written, named `what`.
    """
    try:
        partial = path.with_name(path.name + ".part")
        try:
            partial.write_text(text, encoding="utf-8", newline="")
            partial.replace(path)
        except OSError:
            with suppress(OSError):
                partial.unlink()
            raise
    except (OSError, ValueError) as error:  # an empty name is a ValueError
        raise InvalidInput(what, str(path), f"a file that can be written ({error})") from None
