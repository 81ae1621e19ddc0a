"""`Meeting`: the pose and the twist with which a frame arrives, and when."""

from __future__ import annotations

from typing import Annotated

from ffsr_plan.core.checks import FARTHEST
from ffsr_plan.core.setting_rules import Number, Numbers, Text, Vector
from ffsr_plan.core.settings import setting, settings

_FASTEST = 1e3  # [m/s or rad/s]
_LONGEST = 1e9  # [s], as for the duration of a flight


@settings
class Meeting:
    """A frame of the robot arrives with a given pose and twist at a given time; see `Plan.timed`.

    The twist is that of a target which the frame meets without a shock. Of the target nothing else
    counts: it is no obstacle. The flight leaves the plan near its end, along a curve that is proven
    free too, and a goal attitude of the base that the problem demands is given up. Jerk cannot be
    limited.

    Attributes:
        frame: name of a link, joint or other frame of the model.
        at: time of arrival, counted from the start of the flight [s].
        velocity: (3,) of the frame's origin on arrival, world axes [m/s].
        angular_velocity: (3,) of the frame on arrival, world axes [rad/s].
        position: (3,) of the frame's origin on arrival, world [m]; None for the plan's.
        attitude: (3,) of the frame on arrival, ZYX angles [rad]; None for the plan's.

    Raises:
        InvalidInput: a value that is not finite, or of another type.
    """

    frame: Annotated[str, Text("the name of a frame")]
    at: Annotated[float, Number(above=0.0, at_most=_LONGEST)]
    velocity: Annotated[Vector, Numbers(3, at_most=_FASTEST)] = setting(default=(0.0, 0.0, 0.0))
    angular_velocity: Annotated[Vector, Numbers(3, at_most=_FASTEST)] = setting(
        default=(0.0, 0.0, 0.0)
    )
    position: Annotated[Vector, Numbers(3, at_most=FARTHEST)] | None = setting(default=None)
    attitude: Annotated[Vector, Numbers(3)] | None = setting(default=None)
