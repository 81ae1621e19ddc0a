"""Page that plays a flight in its true time."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.checks import one_of
from ffsr_plan.core.cost_estimate import check_memory
from ffsr_plan.display.flights.flight_samples import FlownProblem, sample_flight
from ffsr_plan.display.flights.quantities import quantities
from ffsr_plan.display.motion_page import (
    BYTES_PER_POSE,
    LARGEST_TURN,
    PlayedMotion,
    motion_page,
    time_axis,
)
from ffsr_plan.display.scenes.projection import SHAPES

_FRAMES, _MOST_FRAMES = 600, 4000


def flight_page(
    flown: FlownProblem, title: str = "", *, playing: bool = False, shapes: str = "visual"
) -> str:
    """HTML text of a page that plays a flight, with plots of its quantities over time.

    `#t=30` at the end of its address opens it at that time [s]. Flights of up to a minute begin in
    true time, longer ones at the least of the speeds at which they take no longer.

    Args:
        flown: the flight and its problem.
        title: heading; by default the robot and the mode.
        playing: whether the motion starts by itself.
        shapes: of the robot, `visual` or `collision`.

    Returns:
        The text. Equal flights give equal text.
    """
    problem, duration = flown.problem, flown.flight.duration
    count = _frame_count(flown)
    size = {"frames": count, "joints": problem.robot.nd + 1}
    check_memory("page", size, BYTES_PER_POSE, "a robot with fewer joints")
    samples = sample_flight(flown, np.linspace(0.0, duration, count))
    played = PlayedMotion(
        problem=problem,
        frames=samples.frames,
        axis=time_axis(duration),
        charts=quantities(flown, samples),
        bound="limit",
        title=title or flown.heading(),
        subtitle=flown.summary(),
        playing=playing,
        shapes=one_of("shapes", shapes, SHAPES),
        times=samples.times,
    )
    return motion_page(played)


def _frame_count(flown: FlownProblem) -> int:
    """The usual number, or more where joints go far: no turn between two frames is too large."""
    joints = flown.flight.at(np.linspace(0.0, flown.flight.duration, _FRAMES)).joints
    farthest = float(np.max(np.abs(np.diff(joints, axis=0)), initial=0.0))
    return min(max(_FRAMES, int(np.ceil(_FRAMES * farthest / LARGEST_TURN))), _MOST_FRAMES)
