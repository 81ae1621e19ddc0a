"""What a command puts on standard output: tables, one JSON object, or nothing."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ffsr_plan.cli.console.terminal import out_console
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.kernels import announcement

if TYPE_CHECKING:
    from rich.console import RenderableType


class Output:
    """Standard output of one command.

    Attributes:
        quiet: whether to write nothing, progress and notices included.
    """

    def __init__(self, quiet: bool, as_json: bool) -> None:
        """See the class.

        Args:
            quiet: `--quiet` was given.
            as_json: `--json` was given.

        Raises:
            InvalidInput: both.
        """
        if quiet and as_json:
            raise InvalidInput("--quiet", True, "either --quiet or --json")
        if quiet:
            announcement.withhold()
        self.quiet, self._as_json = quiet, as_json

    def show(
        self,
        readable: Callable[[], Iterable[RenderableType]],
        data: Callable[[], Mapping[str, Any]],
    ) -> None:
        """Write the results; of both functions at most the one that is wanted is called.

        Args:
            readable: makes tables and sentences.
            data: makes what is written as one JSON object, see `plain`.
        """
        if self._as_json:
            text = json.dumps(plain(data()), indent=2, ensure_ascii=True, allow_nan=False)
            out_console.file.write(text + "\n")
        elif not self.quiet:
            for part in readable():
                out_console.print(part)


def plain(value: Any) -> Any:  # noqa: ANN401 - what JSON holds
    """A value as JSON has it: arrays as lists, numbers that are infinite or NaN as null.

    Args:
        value: numbers, texts, None, arrays, and sequences and mappings of these.
    """
    if isinstance(value, Mapping):
        return {str(key): plain(each) for key, each in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
