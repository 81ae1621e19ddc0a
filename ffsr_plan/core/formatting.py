"""Numbers and tables as text."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

import numpy as np


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
