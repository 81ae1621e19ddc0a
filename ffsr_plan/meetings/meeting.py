"""`Meeting`: the pose and the twist with which a frame arrives, and when."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from ffsr_plan.core.checks import FARTHEST
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import Number, Numbers, Rule, Text, Vector
from ffsr_plan.core.settings import setting, settings

_FASTEST = 1e3  # [m/s or rad/s]
_LONGEST = 1e9  # [s], as for the duration of a flight


@dataclass(frozen=True)
class LinkNames(Rule):
    """Names of links, as a list or tuple."""

    def check(self, what: str, value: object, others: Mapping[str, Any]) -> tuple[str, ...]:
        """See `Rule.check`."""
        if not isinstance(value, (list, tuple)) or not all(
            isinstance(name, str) and name for name in value
        ):
            raise InvalidInput(what, value, "a list of names of links")
        return tuple(value)


@settings
class Meeting:
    """A frame of the robot arrives with a given pose and twist at a given time; see `Plan.timed`.

    The twist is that of a target which the frame meets without a shock. The flight leaves the plan
    near its end, along a curve that is proven free too, and a goal attitude of the base that the
    problem demands is given up. Jerk cannot be limited.

    With `target` a moving body of the scene is met, and its motion tells where its axes are on
    arrival and how they move: `position`, `attitude`, `velocity` and `angular_velocity` are then
    those of the frame in these axes, and all zero means that it takes part in the body's motion.
    Near its end the links in `links` may touch this body; nothing else may touch anything.

    Attributes:
        frame: name of a link, joint or other frame of the model.
        at: time of arrival, counted from the start of the flight [s].
        velocity: (3,) of the frame's origin on arrival, world or target axes [m/s].
        angular_velocity: (3,) of the frame on arrival, world or target axes [rad/s].
        position: (3,) of the frame's origin on arrival, world or target [m]; None for the plan's.
        attitude: (3,) of the frame on arrival, ZYX angles [rad]; None for the plan's.
        target: name of the moving body that is met; None for none.
        links: names of the links that may touch the target at the end.
        within: distance of the frame from its place on the target within which they may [m].

    Raises:
        InvalidInput: a value that is not finite, or of another type.
    """

    word: ClassVar[str] = "meeting"

    frame: Annotated[str, Text("the name of a frame")]
    at: Annotated[float, Number(above=0.0, at_most=_LONGEST)]
    velocity: Annotated[Vector, Numbers(3, at_most=_FASTEST)] = setting(default=(0.0, 0.0, 0.0))
    angular_velocity: Annotated[Vector, Numbers(3, at_most=_FASTEST)] = setting(
        default=(0.0, 0.0, 0.0)
    )
    position: Annotated[Vector, Numbers(3, at_most=FARTHEST)] | None = setting(default=None)
    attitude: Annotated[Vector, Numbers(3)] | None = setting(default=None)
    target: Annotated[str, Text("the name of a moving body of the scene, or None")] | None = None
    links: Annotated[tuple[str, ...], LinkNames()] = ()
    within: Annotated[float, Number(above=0.0, at_most=FARTHEST)] = 0.05

    def __post_init__(self) -> None:
        if self.links and self.target is None:
            raise InvalidInput("links", list(self.links), "none without a target")
