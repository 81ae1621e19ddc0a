"""When a path is where: the time of every place on it, from the law of its pace alone.

In units of the duration, the speed of progress rises evenly from zero over a share r, stays at
V = 1 / (1 - r), and falls evenly to zero over the last share r. Its integral is

    s = V u^2 / (2 r)              up to u = r, where s = V r / 2
    s = V (u - r / 2)              between
    s = 1 - V (1 - u)^2 / (2 r)    from u = 1 - r on

and each of the three is solved for u here.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array


def times_at(shares: Array, duration: float, ramp: float) -> Array:
    """Times at which shares of a path have been run.

    Args:
        shares: (N,) from 0 to 1.
        duration: of the whole path [s].
        ramp: r, 0 to 0.5.

    Returns:
        (N,) times [s].
    """
    middle = 1.0 - ramp
    curved = 0.5 * ramp / middle
    rising = np.sqrt(2.0 * ramp * middle * shares)
    falling = 1.0 - np.sqrt(2.0 * ramp * middle * np.maximum(1.0 - shares, 0.0))
    even = middle * shares + 0.5 * ramp
    chosen = [shares < curved, shares > 1.0 - curved]
    return np.asarray(duration * np.select(chosen, [rising, falling], even))
