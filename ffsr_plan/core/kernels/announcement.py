"""The right to announce that kernels are compiled: given once to a process and its workers."""

from __future__ import annotations

import threading
from typing import Protocol


class Token(Protocol):
    """A lock of threads or of processes; whoever acquires it announces, and keeps it."""

    def acquire(self, wait: bool, /) -> bool:
        """Whether the lock was free."""
        ...


_token: Token = threading.Lock()


def is_due() -> bool:
    """Whether to announce now; true at most once."""
    return _token.acquire(False)


def withhold() -> None:
    """Announce nothing from now on."""
    is_due()


def share(token: Token) -> None:
    """Share the right with other processes: called with one lock by them and by their caller.

    Args:
        token: a lock of processes, not acquired.
    """
    global _token
    if not is_due():
        token.acquire(False)
    _token = token
