"""Obstacles and silhouettes of a robot, drawn flat on axes of matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.display.figure_style import Style
from ffsr_plan.display.scenes.picture_data import MotionFrames
from ffsr_plan.display.scenes.projection import STILL, VIEWS, outlines

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ffsr_plan.core.arrays import Array, Flags
    from ffsr_plan.problem.problem import Problem
    from ffsr_plan.scene.scene import Scene

NUMBERED = 30  # scenes of at most so many obstacles have their numbers written in


def draw_obstacles(
    ax: Axes, scene: Scene, view: Array, solid: Flags, style: Style, numbers: bool = True
) -> None:
    """Circles, those that are not `solid` (N,) faint; with their numbers if they are few.

    Args:
        ax: the axes.
        scene: the obstacles.
        view: (2, 3) directions to the right and upwards.
        solid: (N,) see `drawn_solid`.
        style: has the colour of `obstacles`.
        numbers: whether to write the numbers of few obstacles.
    """
    from matplotlib.collections import EllipseCollection

    places = scene.centers @ view.T
    for chosen, zorder, alpha in ((solid, 2.0, 1.0), (~solid, 1.0, 0.12)):
        wide = 2.0 * scene.radii[chosen]
        circles = EllipseCollection(
            wide,
            wide,
            np.zeros(len(wide)),
            units="xy",
            offsets=places[chosen],
            offset_transform=ax.transData,
            facecolor=style.colour("obstacles"),
            edgecolor="#5c6168",
            alpha=alpha,
            zorder=zorder,
        )
        ax.add_collection(circles, autolim=False)
    for side in (-1.0, 1.0):
        ax.update_datalim(places + side * scene.radii[:, None])
    if numbers and len(scene) <= NUMBERED:
        for k, place in enumerate(places):
            ax.annotate(str(k), place, ha="center", va="center", color="white", zorder=3)


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
