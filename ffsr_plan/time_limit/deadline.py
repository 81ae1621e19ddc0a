"""`Deadline`: when a call of `plan` has to end, asked wherever work takes long."""

from __future__ import annotations

import copy
import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from ffsr_plan.core.errors import OutOfTime
from ffsr_plan.core.kernels.compiling_time import spent_on_kernels

CLOSING_SHARE, CLOSING_SECONDS = 0.04, 0.015
"""Time for the certificate of a path that is proven, beyond the limit: a share of it, and [s]."""


class Deadline:
    """The end of a call by its time limit or Ctrl-C. Compiling and loading kernels do not count.

    Whoever works for long calls `check` every few milliseconds; whoever has a result to return
    catches its `OutOfTime`. A deadline belongs to the thread that made it.

    Attributes:
        seconds: the limit [s].
        stage: what is being done, for errors.
    """

    def __init__(
        self,
        seconds: float = math.inf,
        stop_requested: Callable[[], bool] = bool,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """A deadline whose time begins now.

        Args:
            seconds: the limit [s].
            stop_requested: whether Ctrl-C was pressed.
            clock: gives the time [s].
        """
        self.seconds, self.stage = seconds, "the set-up of the lattice"
        self._stop_requested, self._clock = stop_requested, clock
        self._begin, self._kernels = clock(), spent_on_kernels()
        self._end = seconds

    @property
    def is_limited(self) -> bool:
        """Whether there is a time limit."""
        return math.isfinite(self.seconds)

    def elapsed(self) -> float:
        """Time since the beginning [s]."""
        return self._clock() - self._begin - (spent_on_kernels() - self._kernels)

    def remaining(self) -> float:
        """Time until the end [s], negative after it."""
        return self._end - self.elapsed() if math.isfinite(self._end) else math.inf

    def stopped(self) -> bool:
        """Whether Ctrl-C was pressed."""
        return self._stop_requested()

    def passed(self) -> bool:
        """Whether the work has to end now."""
        return self._stop_requested() or self.remaining() <= 0.0

    def check(self) -> None:
        """Raise `OutOfTime` if the work has to end now."""
        if self.passed():
            raise OutOfTime(self.seconds, self.stage)

    def stopped_by(self, stop_requested: Callable[[], bool]) -> Deadline:
        """A deadline with the same begin and end, and another source of Ctrl-C.

        Args:
            stop_requested: whether Ctrl-C was pressed.
        """
        twin = copy.copy(self)
        twin._stop_requested = stop_requested
        return twin

    def part(self, share: float) -> Deadline:
        """A deadline for a share of the time that is left, ended by the same Ctrl-C.

        Args:
            share: greater than 0, at most 1; of no account without a limit.
        """
        twin, left = copy.copy(self), self.remaining()
        if math.isfinite(left):
            twin._end = self.elapsed() + share * left
            twin.seconds = share * self.seconds
        return twin

    @contextmanager
    def without_stop(self) -> Iterator[None]:
        """In the body only the time limit counts; Ctrl-C does so after it."""
        stop_requested, self._stop_requested = self._stop_requested, bool
        try:
            yield
        finally:
            self._stop_requested = stop_requested

    def close(self) -> None:
        """There is a path to return: its certificate may take a little longer than the limit."""
        end = min(self._end, self.elapsed()) if self.stopped() else self._end
        self._end = end + CLOSING_SHARE * end + CLOSING_SECONDS
        self._stop_requested = bool

    def handed_on(self) -> tuple[float, float]:
        """The limit, and the end by `time.monotonic`, which all processes of a computer share."""
        return self.seconds, time.monotonic() + self.remaining()

    @classmethod
    def taken_over(
        cls, limit_and_end: tuple[float, float], stop_requested: Callable[[], bool]
    ) -> Deadline:
        """The deadline of another process, in this one.

        Args:
            limit_and_end: what `handed_on` gave there.
            stop_requested: whether Ctrl-C was pressed.
        """
        seconds, end = limit_and_end
        made = cls(seconds, stop_requested)
        made._end = end - time.monotonic()
        return made
