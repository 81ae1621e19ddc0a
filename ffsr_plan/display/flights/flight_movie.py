"""Moving pictures of a flight in true time, or a stated number of times as fast."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import number, one_of, whole_number
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.cost_estimate import check_memory
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.display import movie_frames as style
from ffsr_plan.display.flights.flight_samples import (
    FlightSamples,
    FlownProblem,
    instants,
    sample_flight,
)
from ffsr_plan.display.flights.quantities import quantities
from ffsr_plan.display.movie_files import MOVIES, check_program, write_movie
from ffsr_plan.display.movie_frames import (
    ASPECTS,
    BYTES_PER_PIXEL,
    PANEL,
    MovingScene,
    PanelCurve,
    Words,
    fixed_colours,
    pictures,
    robot_outlines,
)
from ffsr_plan.display.scenes.projection import SHAPES, VIEWS, view_axes

STEP = 80  # [ms] between two pictures
_MOST_FRAMES = 1200
_PEAK_STEPS = 800  # of time, at which peaks are taken
_PATIENCE = 12.0  # [s] in which a flight is shown by default
_SPEEDS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0)


def write_flight_movie(
    flown: FlownProblem,
    path: str | Path,
    suffixes: tuple[str, ...] = MOVIES,
    *,
    speed: float | None = None,
    width: int = 720,
    view: str = "path",
    shapes: str = "visual",
) -> None:
    """Write a flight as a moving picture; see `FlightPictures.write_movie`.

    Args:
        flown: the flight and its problem.
        path: of the file.
        suffixes: endings that are allowed.
        speed: how many times as fast as the flight; None for one that takes at most 12 s.
        width: of the picture [px].
        view: `path` or `side`.
        shapes: of the robot, `visual` or `collision`.

    Raises:
        InvalidInput: an argument that is not allowed, or a file that cannot be written.
    """
    target = checked_path("path", path, *suffixes)
    check_program(target)
    pixels = whole_number("width", width, at_least=300, at_most=4000)
    rows = list(VIEWS[one_of("view", view, tuple(VIEWS))])
    pace = _speed(flown.flight.duration, speed)
    times = _times(flown.flight.duration, pace)
    size = {"frames": len(times), "pixels": pixels * round(ASPECTS[1] * pixels + PANEL)}
    check_memory("speed", size, BYTES_PER_PIXEL, "a higher speed or a smaller width")
    samples = sample_flight(flown, times)
    scene = _scene(
        flown, samples, view_axes(flown.problem)[rows], pace, one_of("shapes", shapes, SHAPES)
    )
    write_movie(target, pictures(scene, pixels), STEP, fixed_colours(flown.problem, shapes))


def _speed(duration: float, speed: float | None) -> float:
    """The speed, checked, or the least round one at which the flight takes little time."""
    if speed is None:
        return next((s for s in _SPEEDS if duration <= s * _PATIENCE), duration / _PATIENCE)
    value = number("speed", speed, above=0.0)
    least = 1e3 * duration / STEP / _MOST_FRAMES
    if value < least:
        allowed = f"at least {least:.3g}: the movie has {_MOST_FRAMES} pictures at most"
        raise InvalidInput("speed", speed, allowed)
    return value


def _times(duration: float, speed: float) -> Array:
    """(N,) times of the pictures [s]: one for each step, and the end."""
    step = 1e-3 * STEP * speed
    return np.append(np.arange(0.0, duration - 0.5 * step, step), duration)


def _scene(
    flown: FlownProblem, samples: FlightSamples, axes: Array, speed: float, shapes: str = "visual"
) -> MovingScene:
    """Everything that the frames show, seen along the view axes (3, 3)."""
    found = {quantity.name: quantity for quantity in quantities(flown, samples)}
    dense = sample_flight(flown, instants(flown.flight, _PEAK_STEPS))
    peaks = {each.name: f"{each.peak:.3g} {each.unit}" for each in quantities(flown, dense)}
    curves = []
    for name, colour in (("speed", style.CLEARANCE), ("thrust", style.ATTITUDE)):
        if name in found:
            quantity = found[name]
            levels = [(0.0, style.TEXT), *((limit, style.CONTACT) for limit in quantity.limits)]
            label = f"{quantity.title}, up to {peaks[name]}"
            curves.append(PanelCurve(quantity.curves[0].values, levels, colour, label))
    pace = "true time" if speed == 1.0 else f"{speed:g} × true time"
    return MovingScene(
        problem=flown.problem,
        title=f"{flown.heading()}, {pace}",
        frames=samples.frames,
        axes=axes,
        robot=robot_outlines(samples.frames, axes, shapes),
        curves=curves,
        words=_words(flown, samples),
        times=samples.times,
    )


def _words(flown: FlownProblem, samples: FlightSamples) -> list[list[Words]]:
    """Time, rotation of the base and clearance in each frame."""
    by_arms = " by the arms" if flown.problem.mode.attitude_reacts else ""
    degrees = np.degrees(np.linalg.norm(samples.rotation, axis=1))
    end = flown.flight.duration
    digits = 1 if end < 100.0 else 0
    words = []
    for time, angle, clearance in zip(samples.times, degrees, samples.clearances, strict=True):
        clock = f"{time:.{digits}f} of {end:.{digits}f} s"
        row = [
            Words(0.0, clock, style.STRONG),
            Words(0.27, f"base rotated {angle:.1f}°{by_arms}", style.ATTITUDE),
        ]
        if np.isfinite(clearance):
            row.append(Words(0.74, f"clearance {clearance:.2f} m", style.CLEARANCE))
        words.append(row)
    return words
