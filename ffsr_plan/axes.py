"""Settings of a lattice: how many layers, and along which axes its nodes are offset."""

from __future__ import annotations

from dataclasses import dataclass

from ffsr_plan import paper
from ffsr_plan.errors import InvalidInput
from ffsr_plan.inputs import number, whole_number


@dataclass(frozen=True)
class Axis:
    """Offsets -n h, .., 0, .., n h along one direction: 2 n + 1 of them.

    Attributes:
        half_count: n, at least 1 (the paper's n_ac).
        spacing: h [m], greater than 0.
    """

    half_count: int
    spacing: float

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        set_(self, "half_count", whole_number("half_count", self.half_count, at_least=1))
        set_(self, "spacing", number("spacing", self.spacing, above=0.0, at_most=1e6))


@dataclass(frozen=True)
class Lattice:
    """Layers 0 .. m between start and goal, nodes offset across the direction of travel.

    Attributes:
        divisions: m, at least 2; the paper's 40 by default.
        lateral: offsets along x' of the path frame (the paper's), or None.
        normal: offsets along y' of the path frame, for three-dimensional scenes, or None.
    """

    divisions: int = paper.DIVISIONS
    lateral: Axis | None = None
    normal: Axis | None = None

    def __post_init__(self) -> None:
        m = whole_number("divisions", self.divisions, at_least=2)
        object.__setattr__(self, "divisions", m)
        for name in ("lateral", "normal"):
            axis = getattr(self, name)
            if axis is not None and not isinstance(axis, Axis):
                raise InvalidInput(name, axis, "an Axis(half_count, spacing) or None")

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of the axes in use, in the order of the columns of node indices."""
        return tuple(name for name in ("lateral", "normal") if getattr(self, name) is not None)
