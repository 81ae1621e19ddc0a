"""Reading and atomic writing of text files."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from ffsr_plan.core.errors import InvalidInput


def read_text(what: str, path: Path, encoding: str = "utf-8") -> str:
    """Read a text file.

    Args:
        what: name of the argument in error messages.
        path: the file.
        encoding: `utf-8`, or `utf-8-sig` to skip a byte order mark.

    Returns:
        Its text, line ends as newlines.

    Raises:
        InvalidInput: a file that cannot be read or is not UTF-8.
    """
    try:
        return path.read_text(encoding=encoding)
    except (OSError, ValueError) as error:  # a UnicodeDecodeError is a ValueError
        reason = getattr(error, "strerror", None) or error  # without the path once more
        raise InvalidInput(what, str(path), f"a readable UTF-8 file ({reason})") from None


def is_lfs_pointer(content: bytes) -> bool:
    """Whether a file is a pointer that Git LFS leaves in place of a file not yet fetched.

    Args:
        content: bytes of the file.
    """
    return content.startswith(b"version https://git-lfs.github.com/spec/")


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
