"""What can go wrong, as exceptions that say what to do about it."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

_NAMED = 12  # obstacles in a message


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


class InternalError(FfsrPlanError):
    """A broken invariant of the package itself."""

    def __init__(self, reason: str) -> None:
        super().__init__(f"internal error: {reason}; please report it")


class IntegrationError(FfsrPlanError):
    """A numerical integration did not converge."""


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
        hint = "" if isinstance(obstacle, int) else "; an SRDF can exempt links that may touch"
        super().__init__(
            f"{self.where} in collision: link '{link}' is {depth:.4g} m inside {other}{hint}"
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
        numbers = [str(o) for o in obstacles if isinstance(o, int)]
        spheres = ", ".join(numbers[:_NAMED])
        if len(numbers) > _NAMED:
            spheres += f" and {len(numbers) - _NAMED} more"
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


class AttitudeOutOfReach(PlanningError):  # noqa: N818 - so are the names of its kinds
    """The arms were not found to turn the base to the attitude that the goal demands.

    Attributes:
        wanted: angle from the start's to the goal's attitude [rad].
        missed: angle from the attitude reached to the goal's [rad].
        turned: how much of the way to the goal's attitude the arms were found to go [rad].
    """

    def __init__(self, wanted: float, missed: float) -> None:
        self.wanted = wanted
        self.missed = missed
        self.turned = max(0.0, wanted - missed)
        super().__init__(
            f"goal attitude out of reach: the arms were found to turn the base by "
            f"{math.degrees(self.turned):.1f} of {math.degrees(wanted):.1f} degrees; more "
            "divisions, wider or other posture axes, or another seed, may turn it farther"
        )

    def __reduce__(self) -> tuple[type, tuple[float, float]]:
        return type(self), (self.wanted, self.missed)


class PoseOutOfReach(PlanningError):  # noqa: N818
    """No joint values were found that bring a frame to the wanted pose.

    Attributes:
        frame: name of the frame.
        position_missed: distance from the wanted position at the best configuration found [m].
        attitude_missed: angle from the wanted attitude there [rad], or None if any would do.
        configuration: (nq,) the best configuration found: a metre counts as much as a radian.
    """

    def __init__(
        self,
        frame: str,
        position_missed: float,
        attitude_missed: float | None,
        configuration: NDArray[np.float64],
    ) -> None:
        self.frame = frame
        self.position_missed = position_missed
        self.attitude_missed = attitude_missed
        self.configuration = configuration
        turned = ""
        if attitude_missed is not None:
            turned = f" and {attitude_missed:.4g} rad ({math.degrees(attitude_missed):.3g} degrees)"
        super().__init__(
            f"pose out of reach: the best that was found for frame '{frame}' misses it by "
            f"{position_missed:.4g} m{turned}; another base position or attitude may reach it"
        )

    def __reduce__(self) -> tuple[type, tuple[str, float, float | None, NDArray[np.float64]]]:
        return type(self), (
            self.frame, self.position_missed, self.attitude_missed, self.configuration
        )  # fmt: skip


class UnprovenPath(PlanningError):  # noqa: N818
    """What the colony found could not be proven free; that there is no path is not said.

    Attributes:
        layer: the first layer that could not be reached.
        link: name of the link that comes too near.
        obstacle: index of the sphere, or the name of the other link.
        distance: least distance met [m], negative in penetration.
    """

    def __init__(
        self, layer: int, link: str, obstacle: int | str, distance: float, divisions: int
    ) -> None:
        self.layer = layer
        self.link = link
        self.obstacle = obstacle
        self.distance = distance
        self.divisions = divisions
        other = f"obstacle {obstacle}" if isinstance(obstacle, int) else f"link '{obstacle}'"
        super().__init__(
            f"no path was found that could be proven free: on the way to layer {layer} of "
            f"{divisions} link '{link}' comes to {distance:.4g} m from {other}; a finer spacing, "
            "more divisions, more cycles or other posture axes may help"
        )

    def __reduce__(self) -> tuple[type, tuple[int, str, int | str, float, int]]:
        return type(self), (self.layer, self.link, self.obstacle, self.distance, self.divisions)


class WorkerDied(PlanningError):  # noqa: N818 - it says what happened
    """A worker process ended without a result.

    Attributes:
        worker: its number, from 0.
        colonies: the colonies that it was to run.
        status: its exit status, such as `SIGKILL(-9)`.
    """

    def __init__(self, worker: int, colonies: list[int], status: str) -> None:
        self.worker, self.colonies, self.status = worker, colonies, status
        names = ", ".join(map(str, colonies))
        super().__init__(
            f"worker {worker} (colonies {names}) died with exit status {status}; "
            "fewer workers need less memory"
        )

    def __reduce__(self) -> tuple[type, tuple[int, list[int], str]]:
        return type(self), (self.worker, self.colonies, self.status)


def unknown_name(what: str, value: object, names: Iterable[str]) -> InvalidInput:
    """An `InvalidInput` that lists the known names and suggests the nearest one."""
    known = list(names)
    near = difflib.get_close_matches(str(value), known, n=1, cutoff=0.5)
    hint = f" (did you mean '{near[0]}'?)" if near else ""
    return InvalidInput(what, value, f"{', '.join(known) if known else 'nothing'}{hint}")


def _shorten(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 120 else f"{text[:117]}..."
