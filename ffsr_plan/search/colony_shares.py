"""Shares of the colonies for each worker, and the outcomes that came back, whatever ran them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

from ffsr_plan.core.errors import WorkerDied
from ffsr_plan.core.kernels.compiling_time import add_compiled


class Returned(Protocol):
    """The result of a share, which may not be there yet."""

    def done(self) -> bool:
        """Whether it is there."""

    def result(self) -> Any:  # noqa: ANN401 - outcomes of any search
        """The outcomes of the share, and the time spent compiling [s]; or an error."""


def shares_of(colonies: int, workers: int) -> list[list[int]]:
    """Numbers of the colonies of each worker.

    Args:
        colonies: their number.
        workers: their number, at most that of the colonies.
    """
    return [list(range(worker, colonies, workers)) for worker in range(workers)]


def outcomes_of(
    shares: list[list[int]],
    returned: Sequence[Returned],
    died: type[Exception],
    status: Callable[[Any], str],
) -> list[Any]:
    """The outcomes that are there, in the order of their colonies.

    The time that the slowest worker spent compiling is noted; see `add_compiled`.

    Args:
        shares: numbers of the colonies of each worker.
        returned: what each worker made of its share.
        died: the error of a worker that died.
        status: how it ended, from this error.

    Raises:
        WorkerDied: with the worker's number, its colonies and how it ended.
    """
    outcomes: dict[int, Any] = {}
    compiling = 0.0
    for worker, (share, future) in enumerate(zip(shares, returned, strict=True)):
        if not future.done():
            continue
        try:
            own, seconds = future.result()
        except died as error:
            raise WorkerDied(worker, share, status(error)) from None
        outcomes |= zip(share, own, strict=False)  # fewer after Ctrl-C
        compiling = max(compiling, seconds)
    add_compiled(compiling)
    return [outcomes[colony] for colony in sorted(outcomes)]
