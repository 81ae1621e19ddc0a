"""`Deadline`: when a call of `plan` has to end, asked wherever work takes long."""
# ruff: noqa: N818 - the name is part of the public contract

from __future__ import annotations

import copy
import math
import time
from collections.abc import Callable
from dataclasses import dataclass

from ffsr_plan.core.errors import PlanningError
from ffsr_plan.core.kernels.compiling_time import spent_on_kernels

CLOSING_SHARE, CLOSING_SECONDS = 0.02, 0.01
"""Time for the certificate of a path that is proven, beyond the limit: a share of it, and [s]."""


@dataclass(eq=False, repr=False)
class OutOfTime(PlanningError):
    """The time limit passed before any path was proven free; this does not prove that none exists.

    Attributes:
        time_limit: [s]; infinite where Ctrl-C ended the planning.
        stage: what it ended.
    """

    time_limit: float
    stage: str

    def message(self) -> str:
        """The limit, what it ended, and what may help."""
        if math.isinf(self.time_limit):
            return f"no path was proven free before Ctrl-C ended {self.stage}"
        return (
            f"no path was proven free within the time_limit of {self.time_limit:g} s, which ended "
            f"{self.stage}; what may help: a longer time_limit; fewer divisions or offsets"
        )


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
        self.seconds, self.stage = seconds, "the preparation"
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

    def ignore_stop(self) -> None:
        """Ctrl-C has been noted: from now on only the time limit counts."""
        self._stop_requested = bool

    def close(self) -> None:
        """There is a path to return: its certificate may take a little longer than the limit."""
        now = self.elapsed()
        end = now if self.stopped() else max(self._end, now)
        self._end = end + CLOSING_SHARE * end + CLOSING_SECONDS
        self.ignore_stop()

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
