"""`RecomputedNumber`: a number of a publication, and the same number computed with this package."""

from __future__ import annotations

from dataclasses import dataclass

PUBLISHED = "published"
"""The expected number stands in the source."""
FORMULA = "published formula"
"""The source has a formula, and the expected number is its value."""
OWN = "own recomputation"
"""The source has no such number; the expected one is computed here in another way."""


@dataclass(frozen=True)
class RecomputedNumber:
    """A number from the literature beside the one that this package computes.

    Attributes:
        quantity: what the number is.
        unit: its unit; empty for a pure number.
        basis: where the expected number comes from: `published`, `published formula`, or
            `own recomputation` where the source has the model but not the number.
        expected: the number to be reproduced [unit].
        computed: the number that this package computes [unit].
        tolerance: largest difference that counts as agreement [unit].
        source: authors, title, year or repository.
        differs: what differs between the source and the computation here; empty if nothing does.
    """

    quantity: str
    unit: str
    basis: str
    expected: float
    computed: float
    tolerance: float
    source: str
    differs: str = ""

    @property
    def difference(self) -> float:
        """Computed less expected [unit]."""
        return self.computed - self.expected

    @property
    def ok(self) -> bool:
        """Whether the two agree within the tolerance."""
        return abs(self.difference) <= self.tolerance
