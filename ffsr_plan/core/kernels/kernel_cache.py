"""Where the machine code of kernels is kept: in the user's cache directory, by content.

Numba by itself writes beside the modules, where an uninstallation leaves it, and does not notice a
change of another module that a kernel calls or takes a constant from. Here a folder is named after
a digest of a module's source and of all modules of the package that it imports. Nothing that is
loaded can be stale, and equal sources share their code, wherever they are installed.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from ffsr_plan.core.kernels.compiling_time import loading

_PACKAGE = Path(__file__).resolve().parents[2]
_IMPORT = re.compile(
    rf"^(?:from|import) ({_PACKAGE.name}\b[\w.]*)(?: import (?:\(([^)]*)\)|(.*)))?", re.MULTILINE
)


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
                with loading():
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


def can_be_kept() -> bool:
    """Whether machine code can be written to the folder, which is made if need be."""
    try:
        place = folder()
        place.mkdir(parents=True, exist_ok=True)
    except (OSError, RuntimeError):  # a RuntimeError if the user has no home directory
        return False
    return os.access(place, os.W_OK | os.X_OK)


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
