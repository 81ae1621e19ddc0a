"""What can go wrong, as exceptions that say what to do about it."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class FfsrPlanError(Exception):
    """Root of every error that ffsr-plan raises on purpose."""


class InvalidInput(FfsrPlanError, ValueError):  # noqa: N818 - the name is part of the public contract
    """A value that cannot be used.

    Attributes:
        what: the field or argument, as the user wrote it.
        value: the offending value.
        allowed: what would have been accepted.
    """

    def __init__(self, what: str, value: object, allowed: str) -> None:
        self.what = what
        self.value = value
        self.allowed = allowed
        super().__init__(f"{what}: got {_shorten(value)}; allowed: {allowed}")

    def __reduce__(self) -> tuple[type, tuple[str, object, str]]:
        return type(self), (self.what, self.value, self.allowed)


class PlanningError(FfsrPlanError):
    """The input is well formed, but no plan exists or none was found."""


class _InCollision(PlanningError):  # noqa: N818 - so are the names of its kinds
    """A prescribed configuration touches something.

    Attributes:
        link: name of the link that touches.
        obstacle: index of the sphere in the scene, or the name of the other link.
        depth: penetration depth [m], zero when the two just touch.
    """

    where = "configuration"

    def __init__(self, link: str, obstacle: int | str, depth: float) -> None:
        self.link = link
        self.obstacle = obstacle
        self.depth = depth
        other = f"obstacle {obstacle}" if isinstance(obstacle, int) else f"link '{obstacle}'"
        super().__init__(
            f"{self.where} in collision: link '{link}' is {depth:.4g} m inside {other}"
        )

    def __reduce__(self) -> tuple[type, tuple[str, int | str, float]]:
        return type(self), (self.link, self.obstacle, self.depth)


class StartInCollision(_InCollision):
    """The start configuration touches an obstacle or the robot itself."""

    where = "start"


class GoalInCollision(_InCollision):
    """The goal configuration, at the attitude really reached there, touches something."""

    where = "goal"


class NoPath(PlanningError):  # noqa: N818 - the name is part of the public contract
    """The lattice holds no free path; proven, not guessed.

    Attributes:
        layer: the first layer of which no node can be reached.
        obstacles: what blocks the way there: sphere indices and, for self-collision, link names.
    """

    def __init__(self, layer: int, obstacles: tuple[int | str, ...], divisions: int) -> None:
        self.layer = layer
        self.obstacles = obstacles
        self.divisions = divisions
        spheres = ", ".join(str(o) for o in obstacles if isinstance(o, int))
        links = ", ".join(f"'{o}'" for o in obstacles if isinstance(o, str))
        blame = [
            f"obstacles {spheres}" if spheres else "",
            f"self-collision of {links}" if links else "",
        ]
        super().__init__(
            f"no path on this lattice: layer {layer} of {divisions} cannot be passed "
            f"(closed by {' and '.join(filter(None, blame)) or 'the limits of the lattice'}); "
            "a finer spacing, more half_count or more divisions may open a way"
        )

    def __reduce__(self) -> tuple[type, tuple[int, tuple[int | str, ...], int]]:
        return type(self), (self.layer, self.obstacles, self.divisions)


def unknown_name(what: str, value: object, names: Iterable[str]) -> InvalidInput:
    """An `InvalidInput` that lists the known names and suggests the nearest one."""
    known = list(names)
    near = difflib.get_close_matches(str(value), known, n=1, cutoff=0.5)
    hint = f" (did you mean '{near[0]}'?)" if near else ""
    return InvalidInput(what, value, f"{', '.join(known) if known else 'nothing'}{hint}")


def _shorten(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 120 else f"{text[:117]}..."
