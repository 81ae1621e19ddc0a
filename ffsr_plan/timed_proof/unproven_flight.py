"""Errors of flights past bodies that move."""
# ruff: noqa: N818 - the names are part of the public contract

from __future__ import annotations

from dataclasses import dataclass

from ffsr_plan.core.contacts import Contact, encounter
from ffsr_plan.core.errors import PlanningError


@dataclass(eq=False, repr=False)
class UnprovenFlight(PlanningError):
    """No flight could be proven free past bodies that move, at none of the times that were tried.

    Attributes:
        contact: what came too close on the first flight that was tried; its depth is negative
            apart.
        time: when, counted from the start of that flight [s].
        tries: number of flights that were tried.
        arrivals: the earliest and the latest arrival among them [s].
    """

    contact: Contact
    time: float
    tries: int
    arrivals: tuple[float, float]

    def message(self) -> str:
        """Link, body and time of the first refusal, and what may help."""
        link, obstacle, depth, source = self.contact
        early, late = self.arrivals
        when = f"at {early:.4g} s" if early == late else f"from {early:.4g} to {late:.4g} s"
        return (
            f"no flight could be proven free past bodies that move: of {self.tries} that arrive "
            f"{when}, on the first link '{link}' {encounter(-depth, obstacle, source)} at "
            f"{self.time:.4g} s; what may help: other limits, another duration, or a plan with "
            "more clearance, by min_clearance or a larger delta"
        )
