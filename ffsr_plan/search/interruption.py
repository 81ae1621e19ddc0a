"""Ctrl-C while a plan is made: the first one ends the search, any further one is raised."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable
from types import FrameType, TracebackType
from typing import ClassVar

from ffsr_plan.core.errors import PlanningError
from ffsr_plan.search.records import SearchRequest

RETURN, RAISE = "return", "raise"
"""What `plan` does at Ctrl-C during the search: return the best plan so far, or raise."""
_PENDING_SECONDS = 2.0
_ended = -float("inf")  # when the last search ended that Ctrl-C had ended, by `time.monotonic()`


class CtrlC(KeyboardInterrupt):
    """Ctrl-C on the command line.

    After a plain KeyboardInterrupt that passed through code made from a text, such as that of a
    dataclass, Python ends by SIGINT, whatever exit status is asked for; not after a subclass.

    Attributes:
        raised: whether it was ever raised; a library that is being loaded may turn it into another
            exception.
    """

    raised: ClassVar[bool] = False


def raise_ctrl_c(number: int, frame: FrameType | None) -> None:
    """A handler of SIGINT that raises `CtrlC`."""
    CtrlC.raised = True
    raise CtrlC


class Interruption:
    """Context of one call of `plan`.

    From `begin` on, the first Ctrl-C is remembered in `pressed` and the next one is raised as
    KeyboardInterrupt; before it, all are. One that a library has swallowed is raised at the next
    occasion. After a call in which Ctrl-C was pressed, a call that begins within 2 s raises
    KeyboardInterrupt: a loop over plans ends.

    Only the main thread receives Ctrl-C, and only if the handler of SIGINT is Python's own or
    `raise_ctrl_c`.

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
            raise self._error()

    def received_by(self, request: SearchRequest) -> SearchRequest:
        """A request whose search Ctrl-C ends.

        Args:
            request: the same without.
        """
        return request._replace(stop_requested=lambda: self.pressed, begin=self.begin)

    def _receive(self, number: int, frame: FrameType | None) -> None:
        again, self.pressed = self.pressed, True
        if self._handler is not None and (again or not self._searching):
            self._handler(number, frame)

    def _error(self) -> KeyboardInterrupt:
        return CtrlC() if self._handler is raise_ctrl_c else KeyboardInterrupt()

    def __enter__(self) -> Interruption:
        global _ended
        if threading.current_thread() is not threading.main_thread():
            return self
        if time.monotonic() - _ended < _PENDING_SECONDS:
            _ended = -float("inf")
            raise KeyboardInterrupt("Ctrl-C ended the search before this one")
        installed = signal.getsignal(signal.SIGINT)
        for handler in (signal.default_int_handler, raise_ctrl_c):
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
        if isinstance(error, PlanningError) or (error is None and not self._returns):
            raise self._error() from error  # there is no plan to return, or it is not asked for
        if error is None:
            _ended = time.monotonic()
