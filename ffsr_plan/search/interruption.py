"""Ctrl-C while a plan is made: the first one ends the search, any further one is raised."""

from __future__ import annotations

import signal
import threading
import time
from types import FrameType, TracebackType

from ffsr_plan.core.errors import PlanningError

RETURN, RAISE = "return", "raise"
"""What `plan` does at Ctrl-C during the search: return the best plan so far, or raise."""
_PENDING_SECONDS = 2.0
_ended = -float("inf")  # when the last search ended that Ctrl-C had ended, by `time.monotonic()`


class Interruption:
    """Context of one call of `plan`.

    From `begin` on, the first Ctrl-C is remembered in `pressed` and the next one is raised as
    KeyboardInterrupt; before it, all are. After a call in which Ctrl-C was pressed, a call that
    begins within 2 s raises KeyboardInterrupt: a loop over plans ends.

    Only the main thread receives Ctrl-C, and only if Python's own handler is installed.

    Attributes:
        pressed: whether Ctrl-C was pressed since `begin`.
    """

    def __init__(self, on_interrupt: str) -> None:
        """See the class.

        Args:
            on_interrupt: `RETURN`, or `RAISE` to leave Ctrl-C as it is.
        """
        self.pressed = False
        self._installed = False
        on_main_thread = threading.current_thread() is threading.main_thread()
        self._returns = on_interrupt == RETURN and on_main_thread
        self._on_main_thread = on_main_thread

    def begin(self) -> None:
        """The search begins: from now on there may be a plan to return."""
        handler = signal.getsignal(signal.SIGINT)
        if self._returns and handler is signal.default_int_handler:
            self._installed = True
            signal.signal(signal.SIGINT, self._receive)

    def is_pressed(self) -> bool:
        """Whether Ctrl-C was pressed since `begin`."""
        return self.pressed

    def _receive(self, number: int, frame: FrameType | None) -> None:
        if self.pressed:
            signal.default_int_handler(number, frame)
        self.pressed = True

    def __enter__(self) -> Interruption:
        global _ended
        if self._on_main_thread and time.monotonic() - _ended < _PENDING_SECONDS:
            _ended = -float("inf")
            raise KeyboardInterrupt("Ctrl-C ended the search before this one")
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        global _ended
        if self._installed:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        if self.pressed and error is None:
            _ended = time.monotonic()
        if self.pressed and isinstance(error, PlanningError):  # there is no plan to return
            raise KeyboardInterrupt from error
