"""Moments of inertia in Table 1 of the paper on ant colonies that this package began with."""

from __future__ import annotations

from ffsr_plan.published_numbers.recomputed_number import PUBLISHED, RecomputedNumber

_SOURCE = "Ant Colony Algorithm for FFSR Collision Avoidance Motion Planning, Table 1"
_ROWS = (  # name, length and width [m], mass [kg], printed [kg m^2]
    ("base", 0.5, 0.5, 5.0, 0.20833),
    ("first and second link", 0.4, 0.0, 0.5, 0.00667),
    ("third link", 0.1266, 0.0, 0.2, 0.00027),
)
_MISPRINT = "the right first link is printed .00067, a digit short of its twin on the left"


def recomputed() -> list[RecomputedNumber]:
    """Inertias of homogeneous bodies of the masses and lengths in the table."""
    from ffsr_plan.satellites.bus import box_inertia

    return [
        RecomputedNumber(
            f"Table 1: inertia of the {name}", "kg m^2", PUBLISHED, printed,
            float(box_inertia(mass, (length, width, 0.0))[2]), 5.1e-6, _SOURCE,
            _MISPRINT if name.startswith("first") else "a homogeneous body is assumed",
        )
        for name, length, width, mass, printed in _ROWS
    ]  # fmt: skip
