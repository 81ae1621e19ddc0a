"""Reading of text files, and writing of files that are whole or not there.

A file is written under a temporary name in its own folder, which then becomes its name. A writer
that is killed leaves the previous file and a temporary one, which a later writer removes.
"""

from __future__ import annotations

import errno
import fcntl
import io
import os
import re
import secrets
import signal
import stat
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import BinaryIO

from ffsr_plan.core.errors import InvalidInput

_LARGEST_FILE = 256_000_000  # [bytes] of a text; what is made of it takes several times as much
_PARTIAL = re.compile(r"\.ffsr-plan-[0-9a-f]{16}\.part")
_STALE_AFTER = 60.0  # [s] since a temporary file was last written to
_STREAMS = re.compile(r"/dev/(std(in|out|err)|fd/\d+)|/proc/.*")


def read_text(what: str, path: Path, encoding: str = "utf-8", at_most: int = _LARGEST_FILE) -> str:
    """Read a text file.

    Args:
        what: name of the argument in error messages.
        path: the file.
        encoding: `utf-8`, or `utf-8-sig` to skip a byte order mark.
        at_most: size that is allowed [bytes].

    Returns:
        Its text, line ends as newlines.

    Raises:
        InvalidInput: a file that cannot be read, is not UTF-8, is too large or is a pointer of
            Git LFS.
    """
    try:
        content = bytearray()
        with path.open("rb") as file:
            while part := file.read(2**20):  # in parts: a device may have no end
                content += part
                if len(content) > at_most:
                    raise ValueError(f"more than {at_most // 10**6} MB")
        if is_lfs_pointer(bytes(content[:64])):
            allowed = "the file itself, which `git lfs pull` fetches; this is a pointer of Git LFS"
            raise InvalidInput(what, str(path), allowed)
        with io.TextIOWrapper(io.BytesIO(content), encoding=encoding) as text:
            return text.read()
    except InvalidInput:
        raise
    except (OSError, ValueError) as error:  # a UnicodeDecodeError is a ValueError
        raise InvalidInput(what, str(path), f"a readable UTF-8 file ({reason(error)})") from None


def is_lfs_pointer(content: bytes) -> bool:
    """Whether a file is a pointer that Git LFS leaves in place of a file not yet fetched.

    Args:
        content: bytes of the file.
    """
    return content.startswith(b"version https://git-lfs.github.com/spec/")


def write_text(what: str, path: Path, text: str) -> None:
    """Write a text file as UTF-8, line ends unchanged; see `write_files`.

    Args:
        what: name of the argument in error messages.
        path: the file, replaced if it exists.
        text: all of its text.

    Raises:
        InvalidInput: a file that cannot be written.
    """
    write_files(what, {path: text})


def write_files(what: str, contents: Mapping[Path, str | bytes]) -> None:
    """Write files, all of them or none, each of them whole or not at all.

    All contents are written under temporary names first; then the files are renamed. Ctrl-C takes
    effect when that is done. Two writers of one file never mix: the last one to end wins. A file
    that is replaced keeps its permissions, and a symbolic link keeps pointing to the file that it
    names. A stream such as /dev/stdout is written to directly.

    Args:
        what: name of the argument in error messages.
        contents: by path; texts as UTF-8, line ends unchanged. Existing files are replaced.

    Raises:
        InvalidInput: a file that cannot be written; then none is changed.
    """
    path = next(iter(contents), Path())
    partials: dict[str, str] = {}
    try:
        data = {p: c.encode() if isinstance(c, str) else c for p, c in contents.items()}
        for path in filter(_is_stream, data):
            path.write_bytes(data[path])
        with _ctrl_c_deferred(), _removed_at_the_end(partials), ExitStack() as open_files:
            for path in (p for p in data if not _is_stream(p)):
                target = os.path.realpath(path)
                name = _partial_name(target)
                partials[name] = target
                _write(open_files.enter_context(open(name, "xb")), data[path], target)
            while partials:
                name = next(iter(partials))
                path = Path(partials[name])
                os.replace(name, path)
                del partials[name]
    except (OSError, ValueError) as error:  # an empty name is a ValueError
        allowed = f"a file that can be written ({reason(error)})"
        raise InvalidInput(what, str(path), allowed) from None


@contextmanager
def _removed_at_the_end(names: Mapping[str, str]) -> Iterator[None]:
    """Files that are still among `names` after the body are removed."""
    try:
        yield
    finally:
        for name in names:
            with suppress(OSError):
                os.unlink(name)


def _write(file: BinaryIO, data: bytes, target: str) -> None:
    """Write a temporary file, locked as long as it is open, with the permissions of the target."""
    with suppress(OSError):  # a file system without locks: its temporary files are not removed
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    with suppress(FileNotFoundError):
        before = os.stat(target)
        if stat.S_ISDIR(before.st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if not os.access(target, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        with suppress(PermissionError):  # a file system without permissions
            os.fchmod(file.fileno(), stat.S_IMODE(before.st_mode))
    file.write(data)
    file.flush()


def _is_stream(path: Path) -> bool:
    """Whether a path names a device, a pipe or an open file, which cannot be replaced."""
    if _STREAMS.fullmatch(os.path.abspath(path)):
        return True
    try:
        mode = os.stat(path).st_mode
    except FileNotFoundError:
        return False
    return not stat.S_ISREG(mode) and not stat.S_ISDIR(mode)


def _partial_name(target: str) -> str:
    """A new name in the folder of a file, which is cleared of what killed writers left."""
    folder = os.path.dirname(target)
    _remove_stale(folder)
    return os.path.join(folder, f".ffsr-plan-{secrets.token_hex(8)}.part")


@cache
def _remove_stale(folder: str) -> None:
    """Remove temporary files that no process is writing any more, once per process and folder."""
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            if _PARTIAL.fullmatch(entry.name):
                with suppress(OSError):
                    _remove_if_stale(entry.path)


def _remove_if_stale(name: str) -> None:
    """Remove a temporary file that has no lock and is older than a minute."""
    with open(name, "rb") as file:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)  # OSError: its writer is still there
        if time.time() - os.fstat(file.fileno()).st_mtime > _STALE_AFTER:
            os.unlink(name)


@contextmanager
def _ctrl_c_deferred() -> Iterator[None]:
    """Ctrl-C takes effect after the body."""
    on_main_thread = threading.current_thread() is threading.main_thread()
    previous = signal.getsignal(signal.SIGINT)
    if not on_main_thread or previous is None:  # no handler of Python's
        yield
        return
    received: list[int] = []
    signal.signal(signal.SIGINT, lambda number, _: received.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, previous)
        if received:
            signal.raise_signal(signal.SIGINT)


def reason(error: Exception) -> str:
    """Why a file cannot be read or written, without its path once more."""
    return str(getattr(error, "strerror", None) or error) or type(error).__name__
