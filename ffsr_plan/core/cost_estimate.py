"""Estimates of memory and work, made from counts before either is spent.

Whoever is about to make large arrays states their sizes here. The estimates are of the right order,
within a factor of two or three of what is measured (tests/problem/test_memory_estimate.py).
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from ffsr_plan.core.errors import InvalidInput

MOST_BYTES = 2e9
"""Memory [bytes] that one task may take."""
MOST_SECONDS = 3600.0
"""Computing time [s] that may be spent before a search begins."""
_PREFIXES = ("", "k", "M", "G", "T", "P", "E")


def check_memory(
    what: str, counts: Mapping[str, int], bytes_each: float, advice: str, fixed: float = 0.0
) -> None:
    """Raise `InvalidInput` if arrays would take more memory than `MOST_BYTES`.

    Args:
        what: the field or file that decides the counts, for the message.
        counts: the counts by name, whose product is the number of elements.
        bytes_each: memory of an element, all arrays of that shape together [bytes].
        advice: what would help, for the message.
        fixed: memory that something else takes at the same time [bytes].
    """
    total = _number(counts) * bytes_each + fixed
    if not total <= MOST_BYTES:
        allowed = f"at most {_in_bytes(MOST_BYTES)} of memory: {advice}"
        raise InvalidInput(what, Estimate(f"{product(counts)}: {_in_bytes(total)}"), allowed)


def check_work(what: str, counts: Mapping[str, int], seconds_each: float, advice: str) -> None:
    """Raise `InvalidInput` if work that nothing can cut short would take more than `MOST_SECONDS`.

    Args:
        what: the field that decides the counts, for the message.
        counts: the counts by name, whose product is the number of steps.
        seconds_each: computing time of a step [s].
        advice: what would help, for the message.
    """
    total = _number(counts) * seconds_each
    if not total <= MOST_SECONDS:
        found = Estimate(f"{product(counts)}: {total / 3600.0:.2g} hours")
        raise InvalidInput(what, found, f"at most {MOST_SECONDS / 3600.0:g} hour: {advice}")


class Estimate(str):
    """A text that errors show without quotes."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


def product(counts: Mapping[str, int]) -> str:
    """The counts with their names, as factors: `layers 41 x nodes 11`."""
    return " x ".join(f"{name} {_shown(int(count))}" for name, count in counts.items())


def _number(counts: Mapping[str, int]) -> float:
    return math.prod(float(count) for count in counts.values())


def _shown(count: int) -> str:
    return str(count) if count < 10**12 else f"{float(count):.3g}"


def _in_bytes(amount: float) -> str:
    """An amount of memory with a prefix: `80 GB`."""
    for prefix in _PREFIXES:
        if amount < 1000.0 or prefix == _PREFIXES[-1]:
            return f"{amount:.3g} {prefix}B"
        amount /= 1000.0
    raise AssertionError
