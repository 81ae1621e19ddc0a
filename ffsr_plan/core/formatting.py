"""Numbers and tables as text."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from html import escape

import numpy as np

_MOST_CHARACTERS_OF_A_VALUE = 120
_SIMILAR = 0.55  # share of letters in common from which a name counts as misspelt
_MOST_CHARACTERS = 600  # of a text on one line


def proven(clearance: float) -> str:
    """Format a lower bound on a clearance, rounded down so that it stays a lower bound.

    Args:
        clearance: [m], may be infinite.

    Returns:
        Three significant digits and the unit.
    """
    if not 0.0 < clearance < np.inf:
        return f"{clearance:g} m"
    digits = 2 - int(np.floor(np.log10(clearance)))
    scale = 10.0**digits
    return f"{np.floor(clearance * scale) / scale:.{max(digits, 0)}f} m"


def counted(count: int, noun: str) -> str:
    """A number with its noun, in the plural with s unless the number is one."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def html_table(title: str, rows: Mapping[str, str]) -> str:
    """A small HTML table of names and values, as notebooks show it.

    Args:
        title: caption above the table.
        rows: values by name; both are escaped.
    """
    cells = "".join(
        f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in rows.items()
    )
    return f"<table><caption>{escape(title)}</caption>{cells}</table>"


def shortened(value: object) -> str:
    """A value as Python shows it, cut short; values that cannot be shown by their type."""
    most = _MOST_CHARACTERS_OF_A_VALUE
    if isinstance(value, int) and value.bit_length() > 4 * most:
        return f"a whole number of {value.bit_length()} bits"
    try:
        text = on_one_line(repr(value))
    except Exception:  # a `__repr__` may raise anything, for example for an integer too long
        return f"an object of the class {type(value).__name__}"
    return text if len(text) <= most else f"{text[: most - 3]}..."


def on_one_line(text: str) -> str:
    """A text without line ends and control characters, its middle left out if it is long."""
    shown = "".join(c if c.isprintable() else repr(c)[1:-1] for c in " ".join(text.split()))
    if len(shown) <= _MOST_CHARACTERS:
        return shown
    part = _MOST_CHARACTERS // 2
    return f"{shown[:part]} ... {shown[-part:]}"


def nearest_name(value: object, names: Iterable[str]) -> str | None:
    """The name most similar to a value, whatever the case of the letters; None if none is close.

    Of a word for another thing, such as `diameter`, half of the letters are often those of a name.
    """
    given = str(value)[:_MOST_CHARACTERS_OF_A_VALUE].casefold()
    known = {name.casefold(): name for name in reversed(list(names))}
    similar = difflib.get_close_matches(given, known, n=1, cutoff=_SIMILAR)
    return known[similar[0]] if similar else None
