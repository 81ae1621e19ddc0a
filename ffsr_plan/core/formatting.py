"""Numbers as text."""

from __future__ import annotations

import numpy as np


def proven(clearance: float) -> str:
    """A lower bound [m] in three digits, rounded down, as lower bounds must be."""
    if not 0.0 < clearance < np.inf:
        return f"{clearance:g} m"
    digits = 2 - int(np.floor(np.log10(clearance)))
    scale = 10.0**digits
    return f"{np.floor(clearance * scale) / scale:.{max(digits, 0)}f} m"
