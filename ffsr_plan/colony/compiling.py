"""A word to the user while the search kernels are compiled, once after an installation."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Timer
from typing import Any


@contextmanager
def first_call(kernel: Callable[..., Any]) -> Iterator[None]:
    """Around a call of a compiled function: say so if this is the first and takes its time.

    Kernels that were compiled before come from the disk in no time, and nothing is said.
    """
    if getattr(kernel, "signatures", True):
        yield
        return
    notice = Timer(
        1.5,
        lambda: print(
            "ffsr-plan: compiling the search kernels, once after an installation (about 10 s)",
            file=sys.stderr,
            flush=True,
        ),
    )
    notice.daemon = True
    notice.start()
    try:
        yield
    finally:
        notice.cancel()
