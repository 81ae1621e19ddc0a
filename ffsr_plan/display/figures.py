"""Figures for papers and reports, with matplotlib: path, clearance along it, convergence."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import coal
import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.formatting import proven
from ffsr_plan.display.plan_tracks import obstacles_near, trail_segments
from ffsr_plan.lattice.layered_lattice import path_frame
from ffsr_plan.robots.robot import SpaceRobot

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ffsr_plan.plans.plan_data import PlanData

_START, _GOAL, _PATH, _OBSTACLE = "#2a7f9e", "#2f8f4e", "#d95f02", "#9aa0a8"


def path_figure(plan: PlanData, silhouettes: int = 9) -> Figure:
    """The path among the obstacles, seen along the normal y' of the path frame.

    Robot silhouettes at equal steps of the motion, ants' trails by the pheromone left on them.
    """
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.patches import Circle

    problem, view = plan.problem, _view(plan)
    figure, axes = _new_figure(9.0, 4.6)
    near = obstacles_near(plan, 0.8 if len(problem.scene) > 60 else np.inf)
    for k, (center, radius) in enumerate(
        zip(problem.scene.centers @ view.T, problem.scene.radii, strict=True)
    ):
        drawn = {"zorder": 2} if near[k] else {"zorder": 1, "alpha": 0.12}
        axes.add_patch(Circle(center, radius, facecolor=_OBSTACLE, edgecolor="#5c6168", **drawn))
        if len(problem.scene) <= 30:
            axes.annotate(str(k), center, ha="center", va="center", color="white", zorder=3)
    segments, strength = _trails(plan, view)
    if len(segments):
        trails = LineCollection(list(segments), array=strength, cmap="BuPu", zorder=1)
        trails.set_clim(-0.2, 1.0)
        trails.set_linewidth((0.5 + 1.5 * strength).tolist())
        axes.add_collection(trails)
        axes.plot([], [], color="#7a5fa8", lw=1.2, label="ants' trails, dark where most was laid")
    for s in np.linspace(0.0, 1.0, silhouettes):
        colour = _START if s == 0.0 else _GOAL if s == 1.0 else "#3b4252"
        ends = s in (0.0, 1.0)
        outline = PolyCollection(
            _silhouette(problem.robot, plan.at(s), view),
            facecolor=colour,
            alpha=0.75 if ends else 0.28,
            edgecolor="none",
            zorder=5 if ends else 4,
        )
        axes.add_collection(outline)
    track = plan.at(np.linspace(0.0, 1.0, 401))[:, :3] @ view.T
    axes.plot(*track.T, color=_PATH, lw=1.8, zorder=6, label="base origin")
    if not near.all():
        axes.plot([], [], "o", color=_OBSTACLE, label="obstacles near the motion")
        axes.plot([], [], "o", color=_OBSTACLE, alpha=0.2, label="others")
    axes.legend(frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=4)
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.margins(0.03)
    axes.set_xlabel("along the path frame's z' [m]")
    seen = ", projected along the normal y'" if problem.lattice.normal is not None else ""
    axes.set_ylabel(f"lateral x' [m]{seen}")
    axes.set_title(
        f"L = {plan.length:.2f} m, F = {plan.objective:.1f}, δ = {problem.delta:g}, "
        f"proven clearance {proven(plan.certificate.least_clearance)}"
    )
    return figure


def clearance_figure(plan: PlanData, samples_per_edge: int = 20) -> Figure:
    """Least link-to-sphere distance along the motion, nodes marked."""
    from ffsr_plan.collision.distances import ObstacleQuery

    m = plan.problem.lattice.divisions
    s = np.linspace(0.0, 1.0, m * samples_per_edge + 1)
    query = ObstacleQuery(plan.problem.robot, plan.problem.scene)
    figure, axes = _new_figure(7.0, 3.2)
    axes.plot(s, query.distances(plan.at(s)), color=_PATH, lw=1.5, label="along the motion")
    axes.plot(np.arange(m + 1) / m, plan.clearances, "o", ms=3.5, color="#3b4252", label="nodes")
    axes.axhline(0.0, color="#b02a30", lw=1.0, label="contact")
    axes.set_xlim(0.0, 1.0)
    axes.set_xlabel("path parameter s")
    axes.set_ylabel("clearance [m]")
    axes.legend(frameon=False)
    return figure


def convergence_figure(plan: PlanData) -> Figure:
    """Best F so far, best and mean F of each cycle, and the number of different paths."""
    history = plan.history
    cycles = np.arange(1, len(history.best) + 1)
    figure, axes = _new_figure(8.0, 3.8)
    axes.plot(cycles, history.mean, color=_OBSTACLE, lw=1.2, label="mean of the cycle")
    axes.plot(cycles, history.iteration_best, color=_START, lw=1.0, label="best of the cycle")
    axes.step(cycles, history.best, color=_PATH, lw=1.8, where="post", label="best so far")
    name = "lattice optimum" if plan.optimum_is_exact else "lower bound"
    axes.axhline(plan.optimum, color="#2f8f4e", ls="--", lw=1.0, label=name)
    axes.set_xlabel("cycle")
    axes.set_ylabel("F")
    other = axes.twinx()
    other.plot(cycles, history.distinct, ":", color="#3b4252", lw=1.0)
    other.set_ylabel("different paths")
    other.set_ylim(bottom=0)
    axes.plot([], [], ":", color="#3b4252", lw=1.0, label="different paths")
    figure.legend(
        *axes.get_legend_handles_labels(), loc="outside upper center", ncols=3, frameon=False
    )
    if len(cycles) == 1:  # an exact planner has no cycles to converge over
        axes.plot(cycles, history.best, "o", color=_PATH)
        axes.set_xticks([1])
    return figure


def write_figures(plan: PlanData, directory: Path) -> list[Path]:
    """Write path.png, clearance.png and convergence.png; return their paths."""
    written = []
    for name, draw in (
        ("path", path_figure),
        ("clearance", clearance_figure),
        ("convergence", convergence_figure),
    ):
        target = directory / f"{name}.png"
        draw(plan).savefig(target, dpi=150)
        written.append(target)
    return written


def _new_figure(width: float, height: float) -> tuple[Figure, Axes]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.add_subplot()
    axes.spines[["top", "right"]].set_visible(False)
    return figure, axes


def _view(plan: PlanData) -> Array:
    """(2, 3) projection onto z' and x' of the path frame; onto the world's x and y on the spot."""
    travel = plan.problem.base_displacement
    if float(np.linalg.norm(travel)) < 1e-9:
        return np.eye(3)[:2]
    frame = path_frame(travel)
    return np.array([frame[:, 2], frame[:, 0]])


def _silhouette(robot: SpaceRobot, q: Array, view: Array) -> list[Array]:
    """Projected outlines of the collision shapes."""
    data = robot.model.createData()
    geometry_data = robot.collision_model.createData()
    pin.updateGeometryPlacements(robot.model, data, robot.collision_model, geometry_data, q)
    turn = np.linspace(0.0, 2.0 * np.pi, 40)
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    polygons: list[Array] = []
    for shape, at in zip(robot.collision_model.geometryObjects, geometry_data.oMg, strict=True):
        solid: Any = shape.geometry
        if isinstance(solid, coal.Convex):
            corners = np.array(solid.points())
        elif isinstance(solid, coal.Box):
            corners = np.array(list(product((-1.0, 1.0), repeat=3))) * solid.halfSide
        else:
            half = solid.halfLength if isinstance(solid, coal.Capsule) else 0.0
            corners = np.array([[0.0, 0.0, -half], [0.0, 0.0, half]])
        seen = (corners @ at.rotation.T + at.translation) @ view.T
        if isinstance(solid, (coal.Sphere, coal.Capsule)):
            seen = (seen[:, None] + max(solid.radius, 0.02) * circle).reshape(-1, 2)
        polygons.append(_hull(seen))
    return polygons


def _hull(points: Array) -> Array:
    """Convex hull in the plane, counter-clockwise (Andrew's monotone chain)."""
    order = points[np.lexsort((points[:, 1], points[:, 0]))]

    def chain(sequence: Array) -> list[Array]:
        kept: list[Array] = []
        for p in sequence:
            while len(kept) > 1:
                (ax, ay), (bx, by) = kept[-1] - kept[-2], p - kept[-1]
                if ax * by - ay * bx > 1e-12:
                    break
                kept.pop()
            kept.append(p)
        return kept[:-1]

    return np.array(chain(order) + chain(order[::-1]))


def _trails(plan: PlanData, view: Array) -> tuple[Array, Array]:
    """Segments (k, 2, 2) of the ants' trails in the plane of view, faint first, and strengths."""
    segments, strength = trail_segments(plan)
    return segments @ view.T, strength
