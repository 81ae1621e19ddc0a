"""The times that the steps of a command take, with the compilation of kernels counted apart."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from ffsr_plan.core.kernels.compiling_time import Stopwatch


class StepTimes:
    """Times of the steps of a command, in the order in which they begin."""

    def __init__(self) -> None:
        self._whole = Stopwatch()
        self._steps: dict[str, tuple[str, float]] = {}

    @contextmanager
    def step(self, key: str, words: str) -> Iterator[None]:
        """Time the body as a step.

        Args:
            key: its name in JSON.
            words: its name in the table.
        """
        watch = Stopwatch()
        try:
            yield
        finally:
            self._steps[key] = (words, watch.computing)

    def seconds(self) -> dict[str, float]:
        """Times by key [s]: those of the steps, `compiling`, and `total` so far."""
        compiling = self._whole.compiling
        steps = {key: seconds for key, (_, seconds) in self._steps.items()}
        return {**steps, "compiling": compiling, "total": compiling + self._whole.computing}

    def rows(self) -> Iterator[tuple[str, str]]:
        """Names and values for a table; without compilation if there was none."""
        seconds = self.seconds()
        for key, (words, _) in self._steps.items():
            yield words, f"{seconds[key]:.2f} s"
        if seconds["compiling"] > 0.0:
            yield "compiling kernels, once", f"{seconds['compiling']:.2f} s"
        yield "total", f"{seconds['total']:.2f} s"
