"""The time that kernels take before they run, so that it can be told apart from computing."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


class _Account(threading.local):
    """What one thread has compiled; kernels that others compile nest in the outermost one."""

    depth = 0
    begin = 0.0
    seconds = 0.0
    kernels = 0
    loading = False
    loaded = 0.0


_account = _Account()


def count_begin() -> None:
    """A kernel begins to compile on this thread."""
    if _account.depth == 0:
        _account.begin = time.perf_counter()
    _account.depth += 1


def count_end() -> None:
    """The kernel that began last on this thread is compiled."""
    _account.depth -= 1
    _account.kernels += 1
    if _account.depth == 0:
        _account.seconds += time.perf_counter() - _account.begin


def add_compiled(seconds: float) -> None:
    """Count what this thread waited for: kernels that worker processes compiled.

    Args:
        seconds: by which they delayed the result [s].
    """
    _account.seconds += seconds


@contextmanager
def loading() -> Iterator[None]:
    """The body loads what kernels need; inside another such body or while compiling, it is part."""
    if _account.loading or _account.depth:
        yield
        return
    begin, _account.loading = time.perf_counter(), True
    try:
        yield
    finally:
        _account.loading = False
        _account.loaded += time.perf_counter() - begin


def spent_on_kernels() -> float:
    """Time [s] that this thread has spent compiling and loading kernels."""
    return _account.seconds + _account.loaded


class Stopwatch:
    """The time since it was made, on the thread that made it, with compiling counted apart.

    Kernels that are loaded from disk are not compiled.
    """

    def __init__(self) -> None:
        self._begin = time.perf_counter()
        self._seconds, self._kernels = _account.seconds, _account.kernels

    @property
    def compiling(self) -> float:
        """Time spent compiling kernels [s]."""
        return _account.seconds - self._seconds

    @property
    def computing(self) -> float:
        """Time spent on all else [s]."""
        return max(0.0, time.perf_counter() - self._begin - self.compiling)

    @property
    def kernels(self) -> int:
        """Kernels compiled, counted once for each signature; those of workers are not."""
        return _account.kernels - self._kernels


def is_own(dispatcher: Any) -> bool:  # noqa: ANN401 - its type depends on numba's version
    """Whether a numba dispatcher is of a kernel of this package.

    Args:
        dispatcher: of any function, of numba's own too.
    """
    return dispatcher.py_func.__module__.startswith("ffsr_plan.")
