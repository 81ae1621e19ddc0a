"""Matplotlib figure of a flight: path among the obstacles, and quantities over one time axis."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ffsr_plan.core.checks import unknown_name, whole_number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.display import figure_style
from ffsr_plan.display.body_drawing import chosen_rows, draw_bodies, draw_debris, write_times
from ffsr_plan.display.figure_style import SERIES, Named, Style
from ffsr_plan.display.flights.flight_samples import (
    FlightSamples,
    FlownProblem,
    instants,
    sample_flight,
)
from ffsr_plan.display.flights.quantities import QUANTITIES, quantities
from ffsr_plan.display.path_drawing import (
    draw_named_zones,
    draw_obstacles,
    draw_silhouettes,
    mark_ends,
    name_directions,
)
from ffsr_plan.display.scenes.body_tracks import body_tracks
from ffsr_plan.display.scenes.debris_track import debris_track
from ffsr_plan.display.scenes.picture_data import Quantity, drawn_solid
from ffsr_plan.display.scenes.projection import view_axes
from ffsr_plan.display.scenes.shape_outlines import points_of_extent
from ffsr_plan.display.scenes.zone_outlines import ZONE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ffsr_plan.core.arrays import Array

_STEPS = 800  # of time
_WIDTH, _PANEL_HEIGHT = 8.0, 1.25  # [inches]
_SHARE = 0.72  # of the width that axes have beside their legends
_MOST_NAMED = 8  # curves of a panel that the legend names one by one
_LETTERS = 20  # of a line in the legend beside the path
_LETTERS_OF_BODIES = 14  # so that no line is broken at a time
_FAR = 2.5  # peaks above which a limit is not drawn but written
_LINES = ("-", "--", ":")
_MARK = "#c9ccd1"  # of the times of silhouettes


def flight_figure(
    flown: FlownProblem,
    axes: Mapping[str, Axes] | None = None,
    *,
    silhouettes: int = 7,
    colours: Named = None,
    labels: Named = None,
) -> Figure:
    """Path among the obstacles, and speed, thrust, joint rates and attitude over time.

    Args:
        flown: the flight and its problem.
        axes: matplotlib axes by what is to be drawn on them, `path` or a name in `QUANTITIES`;
            by default those of a new figure with the path and all that changes, the clearance only
            where bodies move.
        silhouettes: of the robot, at equal steps of time.
        colours: matplotlib colours by name.
        labels: texts in the legends by name.

    Returns:
        The figure of the axes. Limits are dashed; those far above the peak are written instead.

    Raises:
        InvalidInput: a name that the figure does not have, or a value that is not allowed.
    """
    count = whole_number("silhouettes", silhouettes, at_least=2, at_most=100)
    marks = np.linspace(0.0, flown.flight.duration, count)
    times = np.unique(np.concatenate([instants(flown.flight, _STEPS), marks]))
    samples = sample_flight(flown, times)
    shown = {quantity.name: quantity for quantity in quantities(flown, samples)}
    style = Style(_own_style(shown), colours, labels)
    rows = np.searchsorted(times, marks).tolist()
    if axes is None:
        hidden = () if flown.problem.scene.moves else ("clearance",)
        figure, axes = _new_figure(flown, samples, [n for n in shown if n not in hidden])
    else:
        figure = _figure_of(axes, shown)
    for name, ax in axes.items():
        if name == "path":
            _draw_path(ax, flown, samples, rows, style)
        else:
            _draw_quantity(ax, shown[name], samples, marks, style)
    return figure


def _own_style(shown: Mapping[str, Quantity]) -> dict[str, tuple[str, str]]:
    """Colours and labels of all that the figure can show."""
    own = {
        "path": (figure_style.PATH, "base origin"),
        "start": (figure_style.START, "start"),
        "goal": (figure_style.GOAL, "goal"),
        "robot": (figure_style.ROBOT, ""),
        "obstacles": (figure_style.OBSTACLE, ""),
        "bodies": (figure_style.MOVING, figure_style.MOVING_LABEL),
        "zones": (figure_style.ZONE, ZONE),
        "rests": (figure_style.ROBOT, "rests"),
        "limit": (figure_style.CONTACT, "limit"),
    }
    for quantity in shown.values():
        single = len(quantity.curves) == 1
        for k, curve in enumerate(quantity.curves):
            colour = figure_style.PATH if single else SERIES[k % len(SERIES)]
            own[curve.name] = (colour, "" if single and " " not in curve.name else curve.label)
    return own


def _new_figure(
    flown: FlownProblem, samples: FlightSamples, names: list[str]
) -> tuple[Figure, dict[str, Axes]]:
    """A figure with the path on top and one panel for each name below, times in line."""
    from matplotlib.figure import Figure

    centers, radii = samples.frames.bounding_spheres()
    view = view_axes(flown.problem)[:2]
    solid = drawn_solid(flown.problem.scene, centers)
    scene = flown.problem.scene
    balls = scene.centers[solid[: len(scene.radii)]]
    flat = np.vstack([*centers, balls, points_of_extent(scene)]) @ view.T
    size = np.ptp(flat, axis=0) + 2.0 * max(float(radii.max()), 0.1)
    path_height = float(np.clip(_SHARE * _WIDTH * size[1] / size[0], 1.6, 5.0))
    heights = [path_height + 0.5] + [_PANEL_HEIGHT] * len(names)
    figure = Figure(figsize=(_WIDTH, sum(heights) + 0.9), layout="constrained")
    grid = figure.add_gridspec(len(heights), height_ratios=heights)
    axes = {"path": figure.add_subplot(grid[0])}
    for k, name in enumerate(names, start=1):
        first = axes[names[0]] if k > 1 else None
        axes[name] = figure.add_subplot(grid[k], sharex=first)
    for name in names[:-1]:
        axes[name].tick_params(labelbottom=False)
        axes[name].set_xlabel("")
    for ax in axes.values():
        ax.spines[["top", "right"]].set_visible(False)
    figure.align_ylabels([axes[name] for name in names])
    figure.suptitle(f"{flown.heading()}: {flown.summary()}")
    return figure, axes


def _figure_of(axes: Mapping[str, Axes], shown: Mapping[str, Quantity]) -> Figure:
    """The figure of given axes, after a check of their names."""
    from matplotlib.axes import Axes

    for name, ax in axes.items():
        if name != "path" and name not in shown:
            raise unknown_name("axes", name, ["path", *shown])
        if not isinstance(ax, Axes):
            raise InvalidInput(f"axes.{name}", ax, "axes of a matplotlib figure")
    figure = next(iter(axes.values())).get_figure(root=True) if axes else None
    if figure is None:
        raise InvalidInput("axes", axes, f"axes by name: path, {', '.join(QUANTITIES)}")
    return figure


def _draw_path(
    ax: Axes, flown: FlownProblem, samples: FlightSamples, rows: list[int], style: Style
) -> None:
    """Obstacles, silhouettes with their times, rests and the track of the base origin."""
    problem, frames = flown.problem, samples.frames
    view = view_axes(problem)
    solid = drawn_solid(problem.scene, frames.bounding_spheres()[0])
    draw_obstacles(ax, problem.scene, view[:2], solid, style)
    draw_silhouettes(ax, frames, rows, view, style)
    track = frames.origins[:, 0] @ view[:2].T
    ax.plot(*track.T, color=style.colour("path"), lw=1.8, zorder=6, label=style.label("path"))
    rests = np.asarray(flown.flight.rests)
    if len(rests):
        at_rest = track[np.searchsorted(samples.times, rests).clip(max=len(track) - 1)]
        look: dict[str, Any] = {"ms": 3.5, "zorder": 7, "color": style.colour("rests")}
        ax.plot(*at_rest.T, "o", label=style.label("rests"), **look)
    mark_ends(ax, style)
    bodies = body_tracks(problem.scene, samples.times)
    written = write_times(ax, track, rows, samples.times)
    draw_bodies(ax, bodies, chosen_rows(rows), view[:2], style, written, _LETTERS_OF_BODIES)
    name_directions(ax, problem, "path", leaves_plane=False)
    draw_named_zones(ax, problem, view, style, _LETTERS)
    draw_debris(
        ax,
        debris_track(problem.scene, samples.times),
        chosen_rows(rows),
        view[:2],
        style,
        _LETTERS_OF_BODIES,
    )
    if problem.scene.keep_in or problem.scene.moves:
        ax.set_anchor("W")  # leaves the room to the legend
    ax.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)


def _draw_quantity(
    ax: Axes, quantity: Quantity, samples: FlightSamples, marks: Array, style: Style
) -> None:
    """Curves of one kind over time, their limits, and the times of the silhouettes."""
    many = len(quantity.curves) > _MOST_NAMED
    for mark in marks[1:-1]:
        ax.axvline(mark, color=_MARK, lw=0.6, zorder=0)
    for k, curve in enumerate(quantity.curves):
        ax.plot(
            samples.times,
            curve.values,
            color=style.colour(curve.name),
            ls=_LINES[k // len(SERIES) % len(_LINES)],
            lw=1.0 if many else 1.4,
            label="_" if many else style.label(curve.name),
        )
    _draw_limits(ax, quantity, style)
    if many:
        ax.plot([], [], " ", label=f"{len(quantity.curves)} joints")
    if ax.get_legend_handles_labels()[1]:
        columns = 1 if len(quantity.curves) < 6 else 2
        ax.legend(
            frameon=False,
            loc="upper left",
            bbox_to_anchor=(1.0, 1.05),
            borderaxespad=0.2,
            fontsize=8,
            ncols=columns,
            handlelength=1.4,
            columnspacing=0.8,
            labelspacing=0.3,
        )
    ax.set_xlim(0.0, max(float(samples.times[-1]), ax.dataLim.x1))  # also of a flight drawn before
    ax.set_ylabel(f"{quantity.title}\n[{quantity.unit}]")
    if ax.xaxis.get_tick_params().get("labelbottom", True):
        ax.set_xlabel("time [s]")


def _draw_limits(ax: Axes, quantity: Quantity, style: Style) -> None:
    """Limits as dashed lines; only in the legend where the curves would become flat."""
    look: dict[str, Any] = {"color": style.colour("limit"), "lw": 1.0, "ls": (0, (5, 3))}
    near = [limit for limit in quantity.limits if limit <= _FAR * quantity.peak]
    for limit in near:
        for sign in (1.0, -1.0) if quantity.signed else (1.0,):
            ax.axhline(sign * limit, **look)
    if quantity.limits and style.label("limit") != "_":
        numbers = " to ".join(
            f"{k:.3g}" for k in sorted({min(quantity.limits), max(quantity.limits)})
        )
        ax.plot([], [], label=f"{style.label('limit')} {numbers} {quantity.unit}", **look)
    if not quantity.signed:
        top = max([ax.dataLim.y1, *near])
        ax.set_ylim(0.0, 1.12 * top if top > 0.0 else 1.0)
