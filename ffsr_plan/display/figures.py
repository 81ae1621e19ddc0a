"""Matplotlib figures of a plan: path, clearance along the motion, convergence."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.core.formatting import proven
from ffsr_plan.core.text_files import write_files
from ffsr_plan.display.picture_data import drawn_solid, motion_frames, trail_segments
from ffsr_plan.display.projection import outlines, view_axes
from ffsr_plan.search.records import Trails

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ffsr_plan.core.arrays import Array, Flags
    from ffsr_plan.plans.plan_data import PlanData

_START, _GOAL, _PATH, _OBSTACLE, _ROBOT = "#2a7f9e", "#2f8f4e", "#d95f02", "#9aa0a8", "#3b4252"
_TRAILS, _CONTACT = "#7a5fa8", "#b02a30"
_ANTS, _TREES = "ants' trails, darker with more pheromone", "trees from start (dark) and goal"
_NUMBERED = 30  # scenes of at most so many obstacles have their indices written in
_SAMPLES = 401  # of the base's track


def path_figure(plan: PlanData, silhouettes: int = 9, axes: Axes | None = None) -> Figure:
    """Path among the obstacles, seen along the normal y' of the path frame.

    Args:
        plan: the plan.
        silhouettes: number of robot silhouettes, at equal steps of the path parameter.
        axes: matplotlib axes to draw on; by default those of a new figure.

    Returns:
        The figure of the axes. Trails of the ants are darker where more pheromone was laid.
    """
    figure, axes = _axes(axes, 9.0, 4.6)
    view, scene = view_axes(plan.problem)[:2], plan.problem.scene
    track = motion_frames(plan.problem.robot, plan.at(np.linspace(0.0, 1.0, _SAMPLES)))
    solid = drawn_solid(scene, track.bounding_spheres()[0])
    _draw_obstacles(axes, plan, view, solid)
    _draw_trails(axes, plan, view)
    _draw_silhouettes(axes, plan, silhouettes)
    axes.plot(*(track.origins[:, 0] @ view.T).T, color=_PATH, lw=1.8, zorder=6, label="base origin")
    if not solid.all():
        axes.plot([], [], "o", color=_OBSTACLE, label="obstacles near the motion")
        axes.plot([], [], "o", color=_OBSTACLE, alpha=0.2, label="others")
    axes.legend(frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=4)
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.margins(0.03)
    axes.set_xlabel("along the path frame's z' [m]")
    projected = ", projected along the normal y'" if _leaves_plane(plan) else ""
    axes.set_ylabel(f"lateral x' [m]{projected}")
    axes.set_title(
        f"L = {plan.length:.2f} m, F = {plan.objective:.1f}, δ = {plan.problem.delta:g}, "
        f"proven clearance {proven(plan.certificate.least_clearance)}"
    )
    return figure


def clearance_figure(
    plan: PlanData, samples_per_edge: int = 20, axes: Axes | None = None
) -> Figure:
    """Least distance between links and obstacles along the motion.

    Args:
        plan: the plan.
        samples_per_edge: points of the curve for each edge; the nodes are marked.
        axes: matplotlib axes to draw on; by default those of a new figure.

    Returns:
        The figure of the axes.
    """
    from ffsr_plan.collision.distances import ObstacleQuery

    m = plan.edges
    s = np.linspace(0.0, 1.0, m * samples_per_edge + 1)
    query = ObstacleQuery(plan.problem.robot, plan.problem.obstacles)
    figure, axes = _axes(axes, 7.0, 3.2)
    axes.plot(s, query.distances(plan.at(s)), color=_PATH, lw=1.5, label="along the motion")
    axes.plot(np.arange(m + 1) / m, plan.clearances, "o", ms=3.5, color=_ROBOT, label="nodes")
    axes.axhline(0.0, color=_CONTACT, lw=1.0, label="contact")
    axes.set_xlim(0.0, 1.0)
    axes.set_xlabel("path parameter s")
    axes.set_ylabel("clearance [m]")
    axes.legend(frameon=False)
    return figure


def convergence_figure(plan: PlanData, axes: Axes | None = None) -> Figure:
    """Best F so far, best and mean F of each cycle, and the number of different paths.

    Args:
        plan: the plan.
        axes: matplotlib axes to draw on; by default those of a new figure.

    Returns:
        The figure of the axes.
    """
    history = plan.history
    cycles = np.arange(1, len(history.best) + 1)
    figure, axes = _axes(axes, 8.0, 3.8)
    axes.plot(cycles, history.mean, color=_OBSTACLE, lw=1.2, label="mean of the cycle")
    axes.plot(cycles, history.iteration_best, color=_START, lw=1.0, label="best of the cycle")
    axes.step(cycles, history.best, color=_PATH, lw=1.8, where="post", label="best so far")
    name = "lattice optimum" if plan.optimum_is_exact else "lower bound"
    axes.axhline(plan.optimum, color=_GOAL, ls="--", lw=1.0, label=name)
    axes.set_xlabel("cycle")
    axes.set_ylabel("F")
    other = axes.twinx()
    other.plot(cycles, history.distinct, ":", color=_ROBOT, lw=1.0)
    other.set_ylabel("different paths")
    other.set_ylim(bottom=0)
    axes.plot([], [], ":", color=_ROBOT, lw=1.0, label="different paths")
    axes.legend(frameon=False, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)
    if len(cycles) == 1:  # an exact planner has no cycles to converge over
        axes.plot(cycles, history.best, "o", color=_PATH)
        axes.set_xticks([1])
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
    files = {}
    for name, figure in figures.items():
        content = io.BytesIO()
        figure.savefig(content, dpi=150, format="png")
        files[name] = content.getvalue()
    return files


def _leaves_plane(plan: PlanData) -> bool:
    """Whether the base may leave the plane of the picture."""
    problem = plan.problem
    if problem.lattice is not None:
        return problem.lattice.normal is not None
    across = plan.motion.positions @ view_axes(problem)[2]
    return bool(np.ptp(across) > 1e-9)


def _axes(axes: Axes | None, width: float, height: float) -> tuple[Figure, Axes]:
    """The given axes, or those of a new figure of a size in inches."""
    from matplotlib.figure import Figure

    if axes is not None:
        figure = axes.get_figure(root=True)
        assert figure is not None
        return figure, axes
    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.add_subplot()
    axes.spines[["top", "right"]].set_visible(False)
    return figure, axes


def _draw_obstacles(axes: Axes, plan: PlanData, view: Array, solid: Flags) -> None:
    """Circles, those that are not `solid` (N,) faint; with their indices if they are few."""
    from matplotlib.collections import EllipseCollection

    scene, places = plan.problem.scene, plan.problem.scene.centers @ view.T
    for chosen, zorder, alpha in ((solid, 2.0, 1.0), (~solid, 1.0, 0.12)):
        wide = 2.0 * scene.radii[chosen]
        circles = EllipseCollection(
            wide,
            wide,
            np.zeros(len(wide)),
            units="xy",
            offsets=places[chosen],
            offset_transform=axes.transData,
            facecolor=_OBSTACLE,
            edgecolor="#5c6168",
            alpha=alpha,
            zorder=zorder,
        )
        axes.add_collection(circles, autolim=False)
    for side in (-1.0, 1.0):
        axes.update_datalim(places + side * scene.radii[:, None])
    if len(scene) <= _NUMBERED:
        for k, place in enumerate(places):
            axes.annotate(str(k), place, ha="center", va="center", color="white", zorder=3)


def _draw_trails(axes: Axes, plan: PlanData, view: Array) -> None:
    """Edges that the ants walked, darker and wider where they are stronger."""
    from matplotlib.collections import LineCollection

    segments, strength = trail_segments(plan)
    if not len(segments):
        return
    ants = isinstance(plan.trails, Trails)
    trails = LineCollection(list(segments @ view.T), array=strength, cmap="Purples", zorder=1)
    trails.set_clim(-0.4, 1.0)
    trails.set_linewidth((0.5 + 1.5 * strength).tolist())
    axes.add_collection(trails)
    axes.plot([], [], color=_TRAILS, lw=1.2, label=_ANTS if ants else _TREES)


def _draw_silhouettes(axes: Axes, plan: PlanData, count: int) -> None:
    """Collision shapes of the robot at `count` equal steps, in colour at start and goal."""
    from matplotlib.collections import PolyCollection

    robot, view = plan.problem.robot, view_axes(plan.problem)
    shapes = list(robot.collision_model.geometryObjects)
    frames = motion_frames(robot, plan.at(np.linspace(0.0, 1.0, count)))
    for row in range(count):
        at_end = row in (0, count - 1)
        colour = _ROBOT if not at_end else _START if row == 0 else _GOAL
        silhouette = PolyCollection(
            [outline.polygon for outline in outlines(shapes, frames, row, view)],
            facecolor=colour,
            alpha=0.75 if at_end else 0.28,
            edgecolor="none",
            zorder=5 if at_end else 4,
        )
        axes.add_collection(silhouette)
