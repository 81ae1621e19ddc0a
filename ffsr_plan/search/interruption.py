"""Ctrl-C while a plan is made: the first one ends the search, any further one is raised."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from types import FrameType, TracebackType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ffsr_plan.search.records import SearchRequest

RETURN, RAISE = "return", "raise"
"""What `plan` does at Ctrl-C during the search: return the best plan so far, or raise."""
_PENDING_SECONDS = 2.0
_ended = -float("inf")  # when the last search ended that Ctrl-C had ended, by `time.monotonic()`


def end_command(number: int, frame: FrameType | None) -> None:
    """The handler of SIGINT on the command line: end at once, with exit status 130.

    An exception would be raised wherever the program happens to be. A library that is being loaded
    may turn it into another one, drop it, or abort the process.
    """
    cursor = b"\x1b[?25h\r\x1b[K" if sys.__stderr__ and sys.__stderr__.isatty() else b""
    with suppress(OSError):
        os.write(2, cursor + b"ffsr-plan: interrupted\n")
    os._exit(128 + number)


class Interruption:
    """Context of one call of `plan`.

    From `begin` on, the first Ctrl-C is remembered in `pressed` and the next one is raised as
    KeyboardInterrupt; before it, all are. One that a library has swallowed is raised at the next
    occasion. After a call in which Ctrl-C was pressed, a call that begins within 2 s raises
    KeyboardInterrupt: a loop over plans ends.

    Only the main thread receives Ctrl-C, and only if the handler of SIGINT is Python's own or
    `end_command`, which is called where this class would raise.

    Attributes:
        pressed: whether Ctrl-C was pressed.
    """

    def __init__(self, on_interrupt: str) -> None:
        """See the class.

        Args:
            on_interrupt: `RETURN`, or `RAISE` for a KeyboardInterrupt at the first Ctrl-C.
        """
        self.pressed = False
        self._returns, self._searching = on_interrupt == RETURN, False
        self._handler: Callable[[int, FrameType | None], object] | None = None

    def begin(self) -> None:
        """The search begins: from now on there may be a plan to return."""
        self._searching = self._returns
        if self.pressed:
            raise KeyboardInterrupt

    def received_by(self, request: SearchRequest) -> SearchRequest:
        """A request whose search Ctrl-C ends.

        Args:
            request: the same without.
        """
        deadline = request.deadline
        if deadline is not None:
            deadline = deadline.stopped_by(lambda: self.pressed)
        return request._replace(deadline=deadline, begin=self.begin)

    def _receive(self, number: int, frame: FrameType | None) -> None:
        again, self.pressed = self.pressed, True
        if self._handler is not None and (again or not self._searching):
            self._handler(number, frame)

    def __enter__(self) -> Interruption:
        global _ended
        if threading.current_thread() is not threading.main_thread():
            return self
        if time.monotonic() - _ended < _PENDING_SECONDS:
            _ended = -float("inf")
            raise KeyboardInterrupt("Ctrl-C ended the search before this one")
        installed = signal.getsignal(signal.SIGINT)
        for handler in (signal.default_int_handler, end_command):
            if installed is handler:
                self._handler = handler
                signal.signal(signal.SIGINT, self._receive)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        global _ended
        if self._handler is not None:
            signal.signal(signal.SIGINT, self._handler)
        if not self.pressed:
            return
        from ffsr_plan.core.errors import OutOfTime, PlanningError  # with numpy: late on purpose

        if isinstance(error, OutOfTime):
            raise KeyboardInterrupt from None
        if isinstance(error, PlanningError) or (error is None and not self._returns):
            raise KeyboardInterrupt from error  # there is no plan to return, or it is not asked for
        if error is None:
            _ended = time.monotonic()
