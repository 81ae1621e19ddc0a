"""Compiled functions: numba imported at the first call, and their machine code kept on disk.

Numba by itself writes machine code beside the modules, where an uninstallation leaves it, and does
not notice a change of another module that a kernel calls or takes a constant from. Here it is kept
in the user's cache directory, in a folder that is named after a digest of a module's source and of
all modules of the package that it imports. Nothing that is loaded can be stale, and equal sources
share their code, wherever they are installed.
"""

from __future__ import annotations

import hashlib
import os
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache, cached_property, update_wrapper
from pathlib import Path
from threading import Timer
from typing import Any, Literal, TypeVar, cast

_Function = TypeVar("_Function", bound=Callable[..., Any])
_NOTICE = "compiling numerical kernels, once after an installation (some ten seconds in all)"
_NOT_KEPT = (
    "compiling numerical kernels (some ten seconds in all), at every start: the cache directory "
    "cannot be written; NUMBA_CACHE_DIR can name another one"
)
_PACKAGE = Path(__file__).resolve().parent.parent
_IMPORT = re.compile(
    rf"^(?:from|import) ({_PACKAGE.name}\b[\w.]*)(?: import (?:\(([^)]*)\)|(.*)))?", re.MULTILINE
)


class Kernel:
    """A function that numba compiles when it is first called.

    The module of a kernel can be imported without numba, whose import takes a second. Kernels call
    one another by their plain names: numba asks a global of unknown type for `_numba_type_`, and a
    kernel returns the type of its dispatcher. The machine code is kept on disk and releases the
    GIL.

    Attributes:
        py_func: the Python function.
        targetoptions: options of the dispatcher; numba reads `inline` and `py_func` of what a
            kernel calls.
    """

    def __init__(self, function: Callable[..., Any], inline: Literal["never", "always"]) -> None:
        self.py_func = function
        self.targetoptions = {"inline": inline}
        update_wrapper(self, function)

    @cached_property
    def dispatcher(self) -> Any:  # noqa: ANN401 - its type depends on numba's version
        """The numba dispatcher, made at the first use."""
        from numba import njit

        inline = self.targetoptions["inline"]
        dispatcher = njit(nogil=True, inline=inline)(self.py_func)
        _install_notice(keep_on_disk(dispatcher))
        return dispatcher

    @property
    def _numba_type_(self) -> object:
        return self.dispatcher._numba_type_

    def __call__(self, *arguments: object) -> Any:  # noqa: ANN401, D102 - as the function
        return self.dispatcher(*arguments)


def kernel(function: _Function) -> _Function:
    """Decorate a function that numba compiles at its first call; see `Kernel`.

    Args:
        function: a function of positional arguments, without Python objects.

    Returns:
        A `Kernel`; for the type checker, a function of the same signature.
    """
    return cast("_Function", Kernel(function, "never"))


def inlined_kernel(function: _Function) -> _Function:
    """Decorate a short function that numba inlines wherever another kernel calls it.

    Args:
        function: as for `kernel`.

    Returns:
        A `Kernel`; for the type checker, a function of the same signature.
    """
    return cast("_Function", Kernel(function, "always"))


def keep_on_disk(dispatcher: Any) -> bool:  # noqa: ANN401 - its type depends on numba's version
    """Have a numba dispatcher load and save its machine code.

    Args:
        dispatcher: the dispatcher of a function, not yet called.

    Returns:
        Whether it does; false if no folder can be written, or the function is not from a file.
    """
    from numba.core import caching

    numba_caching: Any = caching

    class InCacheDirectory(numba_caching.CompileResultCacheImpl):  # type: ignore[misc]
        _locator_classes = (_Locator,)

    class Cache(numba_caching.FunctionCache):  # type: ignore[misc]
        _impl_class = InCacheDirectory

        def load_overload(self, *arguments: object) -> object:
            try:
                return super().load_overload(*arguments)
            except Exception:  # a damaged file raises errors of many types
                with suppress(OSError):
                    self.flush()
                return None

        def save_overload(self, *arguments: object) -> None:
            with suppress(OSError):  # a full disk
                super().save_overload(*arguments)

    try:
        dispatcher._cache = Cache(dispatcher.py_func)
    except RuntimeError:  # numba's, where no locator is of use
        return False
    return True


def folder() -> Path:
    """The folder for all machine code: `NUMBA_CACHE_DIR`, or one in the user's cache directory."""
    import platformdirs
    from numba import config

    chosen = getattr(config, "CACHE_DIR", "")
    if chosen:
        return Path(chosen) / "ffsr-plan"
    return platformdirs.user_cache_path("ffsr-plan", appauthor=False) / "kernels"


class _Locator:
    """Numba's interface for the place of a function's code."""

    def __init__(self, function: Callable[..., Any], file: str) -> None:
        self._line, self._py_file = function.__code__.co_firstlineno, file
        self._digest = digest(file)
        self._path = folder() / f"{Path(file).stem}-{self._digest[:16]}"

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> _Locator | None:
        """The locator, or None if nothing can be kept."""
        try:
            locator = cls(function, file)
            locator.ensure_cache_path()
        except (OSError, RuntimeError):  # a RuntimeError if the user has no home directory
            return None
        return locator

    def ensure_cache_path(self) -> None:
        """Make the folder; `OSError` if it cannot be written."""
        self._path.mkdir(parents=True, exist_ok=True)
        if not os.access(self._path, os.W_OK | os.X_OK):
            raise PermissionError(str(self._path))

    def get_cache_path(self) -> str:
        """Folder of the function's files."""
        return str(self._path)

    def get_source_stamp(self) -> str:
        """What changes with the source."""
        return self._digest

    def get_disambiguator(self) -> str:
        """What tells functions of one name apart."""
        return str(self._line)


@cache
def digest(file: str, package: Path = _PACKAGE) -> str:
    """Digest of a source file and of all files of the package that it imports, all deep.

    Imports within functions do not count: a kernel takes its names from the module.

    Args:
        file: path of the file.
        package: folder of the package.

    Raises:
        OSError: a file that cannot be read.
    """
    texts: dict[str, bytes] = {}
    waiting = [str(Path(file).resolve())]
    while waiting:
        path = waiting.pop()
        if path not in texts:
            texts[path] = Path(path).read_bytes()
            waiting += _imported(texts[path].decode("utf-8"), package)
    whole = hashlib.sha256()
    for text in sorted(texts.values()):
        whole.update(hashlib.sha256(text).digest())
    return whole.hexdigest()


def _imported(source: str, package: Path) -> list[str]:
    """Files of the package from which a module imports names."""
    files = []
    for module, *listed in _IMPORT.findall(source):
        names = re.findall(r"\w+", re.sub(r"#.*| as \w+", "", "".join(listed)))
        for name in (module, *(f"{module}.{each}" for each in names)):
            path = package.parent.joinpath(*name.split("."))
            for found in (path.with_suffix(".py"), path / "__init__.py"):
                if found.is_file():
                    files.append(str(found))
    return files


@cache
def _install_notice(kept: bool) -> None:
    """Write one notice to standard error when a kernel of this package starts to compile.

    Numba reports compilations as events; loading machine code from disk is none.
    """
    from numba.core import event

    notice = _NOTICE if kept else _NOT_KEPT

    class Notice(event.Listener):
        def __init__(self) -> None:
            self.shown = False

        def on_start(self, event: Any) -> None:  # noqa: ANN401
            module = event.data["dispatcher"].py_func.__module__
            if not self.shown and module.startswith("ffsr_plan."):
                self.shown = True
                print(f"ffsr-plan: {notice}", file=sys.stderr, flush=True)

        def on_end(self, event: Any) -> None:  # noqa: ANN401
            pass

    event.register("numba:compile", Notice())  # type: ignore[no-untyped-call]


@contextmanager
def notify_after(seconds: float, text: str) -> Iterator[None]:
    """Write a text to standard error if the body takes longer than some time.

    Args:
        seconds: the time [s].
        text: what takes long.
    """
    notice = Timer(seconds, lambda: print(f"ffsr-plan: {text}", file=sys.stderr, flush=True))
    notice.daemon = True
    notice.start()
    try:
        yield
    finally:
        notice.cancel()
