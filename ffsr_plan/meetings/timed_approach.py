"""`TimedApproach`: an approach flown on time, and the earliest time at which one can be flown."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.errors import IntegrationError, InvalidInput
from ffsr_plan.curves.smooth_curve import SmoothCurve
from ffsr_plan.meetings.approach import Approach, Found
from ffsr_plan.meetings.arrival import Arrival
from ffsr_plan.smooth_flight.curve_flight import CurveFlight, curve_flight
from ffsr_plan.smooth_flight.pace_search import EndSpeeds
from ffsr_plan.trajectory.flight_limits import FlightLimits

_EARLIEST = 0.5  # share of the curve for an approach that brakes all along its second half
_FEWEST, _IN_WINDOW = 32, 10  # pieces of a curve, and of its approach
SPEED = 0.95
"""Of the parameter at the end of a curve, relative to the mean: the pace can rise above it."""
_LONGER, _MOST = 1.5, 40  # steps of a search, and their number
_GOOD = 1.01  # relative, of the earliest time


class TimedApproach(NamedTuple):
    """A curve with its flight, or what prevents the flight.

    Attributes:
        found: the curve; None if none ends as demanded.
        flight: None if the limits forbid to be on time.
    """

    found: Found | None
    flight: CurveFlight | None


def pieces_for(motion_edges: int, window: float, factor: int) -> int:
    """Number of pieces of a curve: a multiple of the motion's edges, with enough for the window.

    Args:
        motion_edges: number of edges of the motion.
        window: share of the curve that leaves the motion.
        factor: by which there are more pieces than are needed.
    """
    fewest = max(_FEWEST, int(np.ceil(_IN_WINDOW / window)))
    return factor * motion_edges * -(-fewest // motion_edges)


def timed_approach(
    arrival: Arrival, limits: FlightLimits, at: float, window: float, factor: int = 1
) -> TimedApproach:
    """An approach flown within limits that arrives at a time.

    Args:
        arrival: what is demanded of the end.
        limits: the limits.
        at: the time [s].
        window: share of the curve that the approach takes.
        factor: by which it has more pieces than it needs.

    Raises:
        InvalidInput: a limit that is needed and not given, or a twist that cannot be.
    """
    pieces = pieces_for(arrival.motion.edges, window, factor)
    speed = SPEED * pieces / at
    try:
        found = Approach(arrival, pieces, window, speed).found()
    except IntegrationError:  # joints that turn many times over, for a very late meeting
        found = None
    if found is None:
        return TimedApproach(None, None)
    arrival.check(found.end, limits)
    try:
        flight = curve_flight(SmoothCurve(found.curve), limits, at, EndSpeeds(0.0, speed))
    except InvalidInput as error:
        if error.what not in ("duration", "end_speed"):
            raise
        return TimedApproach(found, None)
    return TimedApproach(found, flight)


def earliest(arrival: Arrival, limits: FlightLimits, late: float) -> float | None:
    """Earliest time of arrival [s], by one window, to 1 %; None if there is none at all.

    Obstacles are left aside.

    Args:
        arrival: what is demanded of the end.
        limits: the limits.
        late: a time that is too early [s].
    """

    def possible(time: float) -> bool:
        return timed_approach(arrival, limits, time, _EARLIEST).flight is not None

    return first_possible(possible, late)


def first_possible(possible: Callable[[float], bool], late: float) -> float | None:
    """The shortest time [s] in which something is possible, to 1 %; None if there is none at all.

    Args:
        possible: whether it is in a time [s].
        late: a time in which it is not [s].
    """
    early, time = late, late
    for _ in range(_MOST):
        early, time = time, time * _LONGER
        if possible(time):
            break
    else:
        return None
    while time > _GOOD * early:
        middle = float(np.sqrt(early * time))
        if possible(middle):
            time = middle
        else:
            early = middle
    return time
