"""When flights past bodies that move may arrive: as early as possible, slower, or after a wait."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.problem.problem import Problem

_ENDS, _SPEEDS = 8, 4  # arrivals, and durations for each of them, of which the longest has no wait
_LATEST = 2.0  # times the shortest duration, if that is later than the plan arrives
_SAME = 1e-9  # relative, of times


class FlightTime(NamedTuple):
    """A wait at the start, and the duration of the flight after it [s]."""

    wait: float
    duration: float


def flight_times(problem: Problem, shortest: float, given: float | None) -> Iterator[FlightTime]:
    """Times of flights to try, the earliest arrival first; of one arrival the slowest flight first.

    Args:
        problem: gives the plan's own duration, and until when motions of bodies are known.
        shortest: duration of the fastest flight within limits [s].
        given: time of arrival that is demanded [s]; None for any.

    Raises:
        InvalidInput: the flight takes longer than the motion of a body is known.
    """
    known = problem.scene.known_until
    if (wanted := given or shortest) > known:
        allowed = f"at most {known:.6g} s, up to which the motions of all bodies are known"
        larger = "" if given else "; larger limits make the flight shorter"
        raise InvalidInput("duration of the flight", wanted, allowed + larger)
    own = problem.duration or shortest
    latest = min(max(own, _LATEST * shortest), known)
    ends = [given] if given is not None else np.geomspace(shortest, latest, _ENDS).tolist()
    if given is None and shortest < own < latest:
        ends = sorted([*ends, own])
    for end in ends:
        for duration in np.geomspace(end, shortest, _SPEEDS).tolist():
            if duration < shortest * (1.0 - _SAME):
                continue
            yield FlightTime(max(end - duration, 0.0), duration)
            if end <= shortest * (1.0 + _SAME):
                break
