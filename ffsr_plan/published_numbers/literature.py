"""`literature`: all numbers from publications, recomputed."""

from __future__ import annotations

from collections.abc import Callable

from ffsr_plan.published_numbers import (
    air_bearing_robot,
    bodies_of_table_1,
    double_bridge,
    dual_arm_satellite,
    ets_vii,
    free_panda,
    heavy_base,
    linkage_travel,
    planar_manipulator,
)
from ffsr_plan.published_numbers.recomputed_number import RecomputedNumber

SOURCES: tuple[Callable[[], list[RecomputedNumber]], ...] = (
    dual_arm_satellite.recomputed,
    free_panda.recomputed,
    planar_manipulator.recomputed,
    heavy_base.recomputed,
    air_bearing_robot.recomputed,
    ets_vii.recomputed,
    linkage_travel.recomputed,
    bodies_of_table_1.recomputed,
    double_bridge.recomputed,
)
"""One function for each publication, in the order of the table."""


def literature() -> tuple[RecomputedNumber, ...]:
    """Numbers from the literature beside those that this package computes.

    Returns:
        All numbers; `ok` of each says whether the two agree within the tolerance.
    """
    return tuple(number for recomputed in SOURCES for number in recomputed())
