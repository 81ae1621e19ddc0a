"""Parts of a configuration by name."""

from __future__ import annotations

from typing import Any, NamedTuple

from ffsr_plan.core.arrays import Array, equal_by_content


@equal_by_content
class Components(NamedTuple):
    """Parts of one configuration, or of N.

    Attributes:
        position: (3,) or (N, 3) base origin in the world [m].
        attitude: (3,) or (N, 3) ZYX angles alpha, beta, gamma of Eq. 2 [rad].
        joints: joint values by name [rad, or m where prismatic]: a float each, or (N,).
    """

    position: Array
    attitude: Array
    joints: dict[str, Any]
