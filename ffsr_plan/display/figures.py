"""Matplotlib figures of a plan: path, clearance along the motion, convergence."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import ffsr_plan.display.figure_style as figure_style
from ffsr_plan.core.checks import one_of, whole_number
from ffsr_plan.core.formatting import proven
from ffsr_plan.core.text_files import write_files
from ffsr_plan.display.body_drawing import chosen_rows, draw_bodies, draw_debris, write_times
from ffsr_plan.display.figure_style import Named, Style, axes_or_new, figure_bytes, fit_height
from ffsr_plan.display.path_drawing import (
    draw_named_zones,
    draw_obstacles,
    draw_silhouettes,
    mark_ends,
    name_directions,
)
from ffsr_plan.display.scenes.body_tracks import body_tracks
from ffsr_plan.display.scenes.debris_track import debris_track
from ffsr_plan.display.scenes.picture_data import drawn_solid, motion_frames, trail_segments
from ffsr_plan.display.scenes.plan_samples import sample_plan, times_of
from ffsr_plan.display.scenes.projection import VIEWS, view_axes
from ffsr_plan.display.scenes.timed_clearances import clearances
from ffsr_plan.display.scenes.zone_outlines import ZONE
from ffsr_plan.display.spatial_figure import spatial_figure
from ffsr_plan.search.records import Trails

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ffsr_plan.core.arrays import Array
    from ffsr_plan.display.scenes.plan_samples import PlanSamples
    from ffsr_plan.plans.plan_data import PlanData
    from ffsr_plan.problem.problem import Problem

_ANTS, _TREES = "ants' trails, darker with more pheromone", "trees from start (dark) and goal"
_SAMPLES = 401  # of the base's track
_OF_PATH = {
    "path": (figure_style.PATH, "base origin"),
    "start": (figure_style.START, "start"),
    "goal": (figure_style.GOAL, "goal"),
    "robot": (figure_style.ROBOT, ""),
    "obstacles": (figure_style.OBSTACLE, "obstacles near the motion"),
    "bodies": (figure_style.MOVING, figure_style.MOVING_LABEL),
    "zones": (figure_style.ZONE, ZONE),
    "trails": (figure_style.TRAILS, _ANTS),
}
_OF_CLEARANCE = {
    "clearance": (figure_style.PATH, "along the motion"),
    "nodes": (figure_style.ROBOT, "nodes"),
    "contact": (figure_style.CONTACT, "contact"),
}
_OF_CONVERGENCE = {
    "mean": (figure_style.OBSTACLE, "mean of the cycle"),
    "cycle": (figure_style.START, "best of the cycle"),
    "best": (figure_style.PATH, "best so far"),
    "optimum": (figure_style.GOAL, "lattice optimum"),
    "paths": (figure_style.ROBOT, "different paths"),
}


def path_figure(
    plan: PlanData,
    silhouettes: int = 9,
    ax: Axes | None = None,
    *,
    view: str = "path",
    colours: Named = None,
    labels: Named = None,
) -> Figure:
    """Path among the obstacles.

    Bodies that move are drawn at up to five of the silhouettes' times, which are written at robot
    and bodies: what looks like a collision of different times is none.

    Args:
        plan: the plan.
        silhouettes: number of robot silhouettes, at equal steps of the path parameter, or of time
            where the problem has a duration.
        ax: matplotlib axes to draw on, with `projection="3d"` for the view `3d`; by default those
            of a new figure.
        view: `path`, seen along the normal y' of the path frame, `side`, along the lateral x', or
            `3d`, in perspective with the axes of the world.
        colours: matplotlib colours of `path`, `start`, `goal`, `robot`, `obstacles`, `bodies`,
            `zones` and `trails`.
        labels: texts in the legend, by the same names.

    Returns:
        The figure of the axes. Trails of the ants are darker where more pheromone was laid.

    Raises:
        InvalidInput: a number, view, name, colour or axes that are not allowed.
    """
    count = whole_number("silhouettes", silhouettes, at_least=2, at_most=100)
    style = Style(_OF_PATH, colours, labels)
    problem, scene = plan.problem, plan.problem.scene
    samples = sample_plan(plan, _SAMPLES)
    track = samples.frames
    rows = np.linspace(0.0, _SAMPLES - 1.0, count).round().astype(int).tolist()
    solid = drawn_solid(scene, track.bounding_spheres()[0])
    if one_of("view", view, (*VIEWS, "3d")) == "3d":
        said = _path_title(plan)
        return spatial_figure(problem, track, rows, solid, style, ax, said, samples.times)
    axes = view_axes(problem)[list(VIEWS[view])]
    own_figure = ax is None
    figure, ax = axes_or_new(ax, 9.0, 4.6)
    draw_obstacles(ax, scene, axes[:2], solid, style)
    _draw_trails(ax, plan, axes[:2], style)
    draw_silhouettes(ax, track, rows, axes, style)
    across = track.origins[:, 0] @ axes[:2].T
    ax.plot(*across.T, color=style.colour("path"), lw=1.8, zorder=6, label=style.label("path"))
    mark_ends(ax, style)
    if samples.times is not None and scene.moves:
        _draw_moving(ax, problem, samples, across, chosen_rows(rows), axes[:2], style)
    if not solid.all():
        _name_faint(ax, style)
    name_directions(ax, problem, view, _leaves_plane(plan))
    draw_named_zones(ax, problem, axes, style)
    ax.set_title(_path_title(plan))
    _add_legend(figure, ax, own_figure, 4 if scene.moves else 5)
    return figure


def _draw_moving(
    ax: Axes,
    problem: Problem,
    samples: PlanSamples,
    across: Array,
    rows: list[int],
    view: Array,
    style: Style,
) -> None:
    """Bodies and debris in frames `rows`, and times at the base origin `across` (N, 2)."""
    times = write_times(ax, across, rows, np.asarray(samples.times))
    draw_bodies(ax, body_tracks(problem.scene, samples.times), rows, view, style, times)
    draw_debris(ax, debris_track(problem.scene, samples.times), rows, view, style)


def clearance_figure(
    plan: PlanData,
    samples_per_edge: int = 20,
    ax: Axes | None = None,
    *,
    colours: Named = None,
    labels: Named = None,
) -> Figure:
    """Least distance between links and obstacles along the motion, over time if it has one.

    Args:
        plan: the plan.
        samples_per_edge: points of the curve for each edge; the nodes are marked.
        ax: matplotlib axes to draw on; by default those of a new figure.
        colours: matplotlib colours of `clearance`, `nodes` and `contact`.
        labels: texts in the legend, by the same names.

    Returns:
        The figure of the axes.

    Raises:
        InvalidInput: a name, colour or axes that are not allowed.
    """
    style = Style(_OF_CLEARANCE, colours, labels)
    m = plan.edges
    s = np.linspace(0.0, 1.0, m * samples_per_edge + 1)
    times, stations = times_of(plan, s), np.arange(m + 1) / m
    frames = motion_frames(plan.problem.robot, plan.at(s))
    found = clearances(frames, plan.problem.obstacles, times)
    nodes_at = times_of(plan, stations)
    figure, ax = axes_or_new(ax, 7.0, 3.2)
    curve, nodes, contact = (style.colour(name) for name in _OF_CLEARANCE)
    along = s if times is None else times
    ax.plot(along, found, color=curve, lw=1.5, label=style.label("clearance"))
    marked = stations if nodes_at is None else nodes_at
    ax.plot(marked, plan.clearances, "o", ms=3.5, color=nodes, label=style.label("nodes"))
    ax.axhline(0.0, color=contact, lw=1.0, label=style.label("contact"))
    ax.set_xlim(0.0, float(along[-1]))
    ax.set_xlabel("path parameter s" if times is None else "time [s]")
    ax.set_ylabel("clearance [m]")
    ax.legend(frameon=False)
    return figure


def convergence_figure(
    plan: PlanData, ax: Axes | None = None, *, colours: Named = None, labels: Named = None
) -> Figure:
    """Best F so far, best and mean F of each cycle, and the number of different paths.

    Args:
        plan: the plan.
        ax: matplotlib axes to draw on; by default those of a new figure.
        colours: matplotlib colours of `mean` and `cycle` (mean and best F of each cycle), `best` (F
            so far), `optimum` and `paths`.
        labels: texts in the legend, by the same names.

    Returns:
        The figure of the axes.

    Raises:
        InvalidInput: a name, colour or axes that are not allowed.
    """
    own = dict(_OF_CONVERGENCE)
    if not plan.optimum_is_exact:
        own["optimum"] = (own["optimum"][0], "lower bound")
    style = Style(own, colours, labels)
    look: dict[str, Any] = {
        name: {"color": style.colour(name), "label": style.label(name)} for name in own
    }
    history = plan.history
    cycles = np.arange(1, len(history.best) + 1)
    figure, ax = axes_or_new(ax, 8.0, 3.8)
    ax.plot(cycles, history.mean, lw=1.2, **look["mean"])
    ax.plot(cycles, history.iteration_best, lw=1.0, **look["cycle"])
    ax.step(cycles, history.best, lw=1.8, where="post", **look["best"])
    ax.axhline(plan.optimum, ls="--", lw=1.0, **look["optimum"])
    ax.set_xlabel("cycle")
    ax.set_ylabel("F")
    other = ax.twinx()
    other.plot(cycles, history.distinct, ":", color=style.colour("paths"), lw=1.0)
    other.set_ylabel("different paths")
    other.set_ylim(bottom=0)
    ax.plot([], [], ":", lw=1.0, **look["paths"])
    ax.legend(frameon=False, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
    if len(cycles) == 1:  # an exact planner has no cycles to converge over
        ax.plot(cycles, history.best, "o", color=style.colour("best"))
        ax.set_xticks([1])
    return figure


def write_figures(plan: PlanData, directory: Path) -> list[Path]:
    """Write the three figures of a plan as PNG.

    Args:
        plan: the plan.
        directory: an existing folder; receives `path.png`, `clearance.png`, `convergence.png`.

    Returns:
        The paths of the files.
    """
    files = {directory / name: picture for name, picture in figure_files(plan).items()}
    write_files("directory", files)
    return list(files)


def figure_files(plan: PlanData) -> dict[str, bytes]:
    """Contents of the files `path.png`, `clearance.png` and `convergence.png` of a plan.

    Args:
        plan: the plan.
    """
    figures = {
        "path.png": path_figure(plan),
        "clearance.png": clearance_figure(plan),
        "convergence.png": convergence_figure(plan),
    }
    return {name: figure_bytes(figure, ".png") for name, figure in figures.items()}


def _name_faint(ax: Axes, style: Style) -> None:
    """Entries in the legend of obstacles that are solid, and of those that are faint."""
    grey = style.colour("obstacles")
    ax.plot([], [], "o", color=grey, label=style.label("obstacles"))
    ax.plot([], [], "o", color=grey, alpha=0.2, label="others")


def _add_legend(figure: Figure, ax: Axes, own_figure: bool, columns: int) -> None:
    """The legend below the axes, and a height that fits if the figure is our own."""
    if own_figure:
        fit_height(figure, ax)
        figure.legend(frameon=False, loc="outside lower center", ncols=columns)
    else:
        ax.legend(frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=columns)


def _path_title(plan: PlanData) -> str:
    return (
        f"L = {plan.length:.2f} m, F = {plan.objective:.1f}, δ = {plan.problem.delta:g}, "
        f"proven clearance {proven(plan.certificate.least_clearance)}"
    )


def _leaves_plane(plan: PlanData) -> bool:
    """Whether the base may leave the plane of the picture."""
    problem = plan.problem
    if problem.lattice is not None:
        return problem.lattice.normal is not None
    across = plan.motion.positions @ view_axes(problem)[2]
    return bool(np.ptp(across) > 1e-9)


def _draw_trails(ax: Axes, plan: PlanData, view: Array, style: Style) -> None:
    """Edges that the ants walked, darker and wider where they are stronger."""
    from matplotlib.collections import LineCollection
    from matplotlib.colors import LinearSegmentedColormap

    segments, strength = trail_segments(plan)
    if not len(segments):
        return
    strongest = style.colour("trails")
    shades = LinearSegmentedColormap.from_list("trails", ["white", strongest])
    trails = LineCollection(list(segments @ view.T), array=strength, cmap=shades, zorder=1)
    trails.set_clim(-0.4, 1.0)
    trails.set_linewidth((0.5 + 1.5 * strength).tolist())
    ax.add_collection(trails)
    label = style.label("trails")
    if not isinstance(plan.trails, Trails) and label == _ANTS:
        label = _TREES
    ax.plot([], [], color=strongest, lw=1.2, label=label)
