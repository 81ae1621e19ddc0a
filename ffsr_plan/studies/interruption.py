"""Ctrl-C while a study runs: what came back is written, then the study ends."""

from __future__ import annotations

import signal
import threading
from types import FrameType, TracebackType


class Interruption:
    """Context of one run of a study. Only the main thread receives Ctrl-C.

    Attributes:
        pressed: whether Ctrl-C was pressed.
        raises: whether Ctrl-C raises KeyboardInterrupt where the program is, rather than being
            noted; true while a task runs in this process.
    """

    def __init__(self) -> None:
        self.pressed, self.raises = False, False
        self._previous: object = None

    def _receive(self, number: int, frame: FrameType | None) -> None:
        self.pressed = True
        if self.raises:
            raise KeyboardInterrupt

    def __enter__(self) -> Interruption:
        if threading.current_thread() is threading.main_thread():
            previous = signal.getsignal(signal.SIGINT)
            if callable(previous):  # by default, SIGINT is ignored in the background of a shell
                self._previous = signal.signal(signal.SIGINT, self._receive)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        if self._previous is not None:
            signal.signal(signal.SIGINT, self._previous)  # type: ignore[arg-type]
