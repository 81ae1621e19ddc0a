"""Reading and atomic writing of text files."""

from __future__ import annotations

import io
from contextlib import suppress
from pathlib import Path

from ffsr_plan.core.errors import InvalidInput

_LARGEST_FILE = 256_000_000  # [bytes] of a text; what is made of it takes several times as much


def read_text(what: str, path: Path, encoding: str = "utf-8") -> str:
    """Read a text file.

    Args:
        what: name of the argument in error messages.
        path: the file.
        encoding: `utf-8`, or `utf-8-sig` to skip a byte order mark.

    Returns:
        Its text, line ends as newlines.

    Raises:
        InvalidInput: a file that cannot be read, is not UTF-8 or has more than 256 MB.
    """
    try:
        content = bytearray()
        with path.open("rb") as file:
            while part := file.read(2**20):  # in parts: a device may have no end
                content += part
                if len(content) > _LARGEST_FILE:
                    raise ValueError("more than 256 MB")
        with io.TextIOWrapper(io.BytesIO(content), encoding=encoding) as text:
            return text.read()
    except (OSError, ValueError) as error:  # a UnicodeDecodeError is a ValueError
        reason = getattr(error, "strerror", None) or error  # without the path once more
        raise InvalidInput(what, str(path), f"a readable UTF-8 file ({reason})") from None


def write_text(what: str, path: Path, text: str) -> None:
    """Write a text file as UTF-8, line ends unchanged.

    The text goes to a temporary file first, which then replaces `path`: an interruption leaves the
    previous file as it was.

    Args:
        what: name of the argument in error messages.
        path: the file, replaced if it exists.
        text: all of its text.

    Raises:
        InvalidInput: a file that cannot be written.
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
