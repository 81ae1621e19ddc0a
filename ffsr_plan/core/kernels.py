"""A word to the user while compiled functions are made, once after an installation."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Timer
from typing import Any

_PATIENCE = 1.5  # seconds; what was compiled before comes from the disk sooner, and nothing is said


def call(kernel: Callable[..., Any], *arguments: object) -> Any:  # noqa: ANN401 - as the kernel
    """Call a compiled function; if this is its first call and takes its time, say why."""
    if getattr(kernel, "overloads", True):
        return kernel(*arguments)
    with said_after(_PATIENCE, "compiling, once after an installation (some ten seconds in all)"):
        return kernel(*arguments)


@contextmanager
def said_after(seconds: float, words: str) -> Iterator[None]:
    """Say on standard error what takes so long, if it does."""
    notice = Timer(seconds, lambda: print(f"ffsr-plan: {words}", file=sys.stderr, flush=True))
    notice.daemon = True
    notice.start()
    try:
        yield
    finally:
        notice.cancel()
