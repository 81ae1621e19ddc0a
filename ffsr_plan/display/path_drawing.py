"""Obstacles, zones and silhouettes of a robot, drawn flat on axes of matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.display.figure_style import Style
from ffsr_plan.display.scenes.picture_data import MotionFrames
from ffsr_plan.display.scenes.projection import STILL, VIEWS, outlines
from ffsr_plan.display.scenes.shape_outlines import labels, outline_of, points_of_extent
from ffsr_plan.display.scenes.zone_outlines import flat_zone, legend_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ffsr_plan.core.arrays import Array, Flags
    from ffsr_plan.problem.problem import Problem
    from ffsr_plan.scene.scene import Scene
    from ffsr_plan.scene.shapes.keep_in_zones import Zone

NUMBERED = 30  # scenes of at most so many obstacles have their numbers written in
_EDGE, _DASHES = "#5c6168", (0, (5, 3))
_FRAME = 3.0  # sizes of the picture by which tints go beyond it, for what is drawn later


def draw_obstacles(
    ax: Axes, scene: Scene, view: Array, solid: Flags, style: Style, numbers: bool = True
) -> None:
    """Circles and outlines, those not `solid` (N + S,) faint; numbers or names if they are few.

    Args:
        ax: the axes.
        scene: the obstacles.
        view: (2, 3) directions to the right and upwards.
        solid: (N + S,) see `drawn_solid`.
        style: has the colour of `obstacles`.
        numbers: whether to write the numbers or names of few obstacles.
    """
    from matplotlib.collections import EllipseCollection, PolyCollection

    places, count = scene.centers @ view.T, len(scene.radii)
    polygons = [outline_of(shape, view) for shape in scene.shapes]
    for all_chosen, zorder, alpha in ((solid, 2.0, 1.0), (~solid, 1.0, 0.12)):
        chosen = all_chosen[:count]
        wide = 2.0 * scene.radii[chosen]
        circles = EllipseCollection(
            wide,
            wide,
            np.zeros(len(wide)),
            units="xy",
            offsets=places[chosen],
            offset_transform=ax.transData,
            facecolor=style.colour("obstacles"),
            edgecolor=_EDGE,
            alpha=alpha,
            zorder=zorder,
        )
        ax.add_collection(circles, autolim=False)
        bodies = PolyCollection(
            [polygons[k] for k in np.flatnonzero(all_chosen[count:])],
            facecolor=style.colour("obstacles"),
            edgecolor=_EDGE,
            alpha=alpha,
            zorder=zorder,
        )
        ax.add_collection(bodies, autolim=False)
    for side in (-1.0, 1.0):
        ax.update_datalim(places + side * scene.radii[:, None])
    if scene.shapes or scene.keep_in:
        ax.update_datalim(points_of_extent(scene) @ view.T)
    if numbers and count + len(scene.shapes) <= NUMBERED:
        for k, place in enumerate(places):
            ax.annotate(str(k), place, ha="center", va="center", color="white", zorder=3)
        for label in labels(scene):
            _write_name(ax, label.text, view @ label.at)


def _write_name(ax: Axes, text: str, place: Array) -> None:
    """White letters with a dark edge, which can be read on and beside an obstacle."""
    from matplotlib.patheffects import withStroke

    written = ax.annotate(text, tuple(place), ha="center", va="center", color="white", zorder=3)
    written.set_path_effects([withStroke(linewidth=2.0, foreground=_EDGE)])


def draw_zones(
    ax: Axes,
    zones: Sequence[Zone],
    axes: Array,
    height: float,
    *,
    line: str,
    tint: tuple[str, float],
) -> list[Zone]:
    """Dashed lines where keep-in zones end, and a tint on what certainly is outside of them.

    Its limits have to be those of all that is drawn: a plane goes from edge to edge.

    Args:
        ax: the axes.
        zones: the zones.
        axes: (3, 3) view axes.
        height: see `flat_zone`.
        line: colour of the lines.
        tint: colour and opacity of what is outside.

    Returns:
        The zones whose end can be seen within the limits.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    picture = np.array([[left, low], [right, low], [right, high], [left, high]])
    frame = picture + 2.0 * _FRAME * (picture - picture.mean(axis=0))
    drawn = [flat_zone(zone, axes, height, frame) for zone in zones]
    for zone in filter(None, drawn):
        dashes = LineCollection(
            [zone.border], colors=line, linewidths=1.1, linestyles=[_DASHES], zorder=2.5
        )
        ax.add_collection(dashes, autolim=False)
        if zone.certain:
            rings = [np.vstack([ring, ring[:1]]) for ring in (frame, zone.inside[::-1])]
            outside = Path.make_compound_path(*(Path(ring, closed=True) for ring in rings))
            patch = PathPatch(outside, facecolor=tint[0], alpha=tint[1], lw=0, zorder=0.5)
            patch.set_in_layout(False)
            ax.add_artist(patch)
    return [zone for zone in zones if flat_zone(zone, axes, height, picture) is not None]


def draw_named_zones(
    ax: Axes, problem: Problem, axes: Array, style: Style, widest: int = 60
) -> None:
    """The keep-in zones of a problem, with an entry in the legend; see `draw_zones`.

    Args:
        ax: the axes.
        problem: has the zones; a plane not seen edge-on is cut at the height of its start.
        axes: (3, 3) view axes.
        style: has `zones`, and the colour of `obstacles`.
        widest: letters of a line in the legend.
    """
    colour, height = style.colour("zones"), float(problem.start[:3] @ axes[2])
    tint = (style.colour("obstacles"), 0.18)
    seen = draw_zones(ax, problem.scene.keep_in, axes, height, line=colour, tint=tint)
    if seen:
        label = legend_of(seen, style.label("zones"), widest)
        ax.plot([], [], color=colour, lw=1.1, ls=_DASHES, label=label)


def draw_silhouettes(
    ax: Axes, frames: MotionFrames, rows: Sequence[int], view: Array, style: Style
) -> None:
    """Collision shapes of the robot, the first in the colour of `start`, the last of `goal`.

    Args:
        ax: the axes.
        frames: poses of the robot's links.
        rows: which of them.
        view: (3, 3) view axes.
        style: has the colours of `start`, `goal` and `robot`.
    """
    from matplotlib.collections import PolyCollection

    shapes = list(frames.robot.collision_model.geometryObjects)
    for row in rows:
        at_end = row in (rows[0], rows[-1])
        name = "robot" if not at_end else "start" if row == rows[0] else "goal"
        silhouette = PolyCollection(
            [outline.polygon for outline in outlines(shapes, frames, row, view)],
            facecolor=style.colour(name),
            alpha=0.75 if at_end else 0.28,
            edgecolor="none",
            zorder=5 if at_end else 4,
        )
        ax.add_collection(silhouette)


def mark_ends(ax: Axes, style: Style) -> None:
    """Entries of start and goal in the legend."""
    for name in ("start", "goal"):
        ax.plot([], [], "s", ms=7, alpha=0.75, color=style.colour(name), label=style.label(name))


def name_directions(ax: Axes, problem: Problem, view: str, leaves_plane: bool) -> None:
    """Equal scales, and the names of the directions of a view.

    Args:
        ax: the axes.
        problem: gives the path frame; if the base stays on the spot, axes of the world are named.
        view: a name in `VIEWS`.
        leaves_plane: whether the base may leave the plane of the picture.
    """
    ax.set_aspect("equal")
    ax.autoscale_view()
    ax.margins(0.03)
    still = np.linalg.norm(problem.base_displacement) < STILL
    names = ("x", "y", "z") if still else ("z'", "x'", "y'")
    right, upwards, viewer = (names[k] for k in VIEWS[view])
    right_words = f"{right} [m]" if still else f"along the path frame's {right} [m]"
    what = "" if still else "lateral " if upwards == "x'" else "normal "
    projected = f", projected along {viewer}" if leaves_plane else ""
    ax.set_xlabel(right_words)
    ax.set_ylabel(f"{what}{upwards} [m]{projected}")
