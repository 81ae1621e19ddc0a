"""`Departure`: the state in which a flight begins, such as that in which another one ended."""

from __future__ import annotations

from typing import Annotated, ClassVar, Protocol

from numpy.typing import ArrayLike

from ffsr_plan.core.checks import FARTHEST
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.setting_rules import Number, Numbers, Text, Vector
from ffsr_plan.core.settings import setting, settings
from ffsr_plan.dynamics.inverse_dynamics import States
from ffsr_plan.meetings.meeting import LinkNames, Meeting


class Ended(Protocol):
    """A flight, and what it met in the end."""

    @property
    def duration(self) -> float:
        """Duration [s]."""

    @property
    def meeting(self) -> Meeting | None:
        """What it arrived with; None for a rest."""

    def at(self, times: ArrayLike) -> States:
        """States at times (N,) [s]."""


@settings
class Departure:
    """A flight begins in motion, at another configuration than its plan; see `Plan.timed`.

    Such as after a meeting: the robot lets go of a target with whose motion it moves, and leaves.
    The flight joins the plan after its begin, along a curve that is proven free too, and a goal
    attitude of the base that the problem demands is given up. Jerk cannot be limited.

    With `target` a moving body of the scene is left: near the begin the links in `links` may touch
    this body; nothing else may touch anything.

    Attributes:
        configuration: (nq,) at the begin.
        velocity: (nv,) there, as in `States.velocities`: base velocity, linear [m/s] then angular
            [rad/s] in base axes, then joint velocities [rad/s or m/s].
        target: name of the moving body that is left; None for none.
        frame: name of the frame that holds it.
        links: names of the links that may touch the target at the begin.
        within: distance of the frame from its place on the target within which they may [m].

    Raises:
        InvalidInput: a value that is not finite, or of another type; links without target or frame.
    """

    word: ClassVar[str] = "departure"

    configuration: Annotated[Vector, Numbers(-1)]
    velocity: Annotated[Vector, Numbers(-1)]
    target: Annotated[str, Text("the name of a moving body of the scene, or None")] | None = None
    frame: Annotated[str, Text("the name of a frame, or None")] | None = None
    links: Annotated[tuple[str, ...], LinkNames()] = setting(default=())
    within: Annotated[float, Number(above=0.0, at_most=FARTHEST)] = 0.05

    def __post_init__(self) -> None:
        for name in ("target", "frame"):
            if self.links and getattr(self, name) is None:
                raise InvalidInput("links", list(self.links), f"none without a {name}")

    @classmethod
    def from_flight(cls, flight: Ended) -> Departure:
        """The departure from where a flight ended, from the target that it met if it met one.

        Times of the flight that departs count from the end of the one before: its problem has the
        scene `flight.problem.scene.later(flight.duration)`.

        Args:
            flight: the flight before.
        """
        last, met = flight.at([flight.duration]), flight.meeting
        state = last.configurations[0], last.velocities[0]
        if met is None:
            return cls(*state)
        return cls(*state, met.target, met.frame, met.links, met.within)
