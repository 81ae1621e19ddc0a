"""Page that plays a plan along its path parameter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.core.checks import one_of
from ffsr_plan.core.cost_estimate import check_memory
from ffsr_plan.core.formatting import proven
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.display.motion_page import (
    BYTES_PER_POSE,
    LARGEST_TURN,
    Axis,
    PlayedMotion,
    motion_page,
)
from ffsr_plan.display.scenes.picture_data import Curve, MotionFrames, Quantity, motion_frames
from ffsr_plan.display.scenes.projection import SHAPES

if TYPE_CHECKING:
    from ffsr_plan.core.arrays import Array, IntArray
    from ffsr_plan.plans.plan_data import PlanData

_AXIS = Axis("s", "", "path parameter s", 1.0, 12.0, 1)  # a plan has no time law of its own
_FRAMES_PER_EDGE = 8
_MOST_FRAMES = 4000
_LEAST_TURN = 1e-9  # [rad or m] below which a joint does not move


def page(plan: PlanData, title: str = "", *, playing: bool = False, shapes: str = "visual") -> str:
    """HTML text of a page that shows a plan in three dimensions and needs no network.

    The page plots clearance, rotation of the base and joints along the motion, plays on a click or
    the space bar, and steps with the arrow keys. `#s=0.5` at the end of its address opens it at
    that path parameter.

    Args:
        plan: the plan.
        title: heading; by default the robot and the mode.
        playing: whether the motion starts by itself.
        shapes: of the robot, `visual` or `collision`.

    Returns:
        The text. Equal plans give equal text.
    """
    problem = plan.problem
    samples = plan.edges * frames_per_edge(plan) + 1
    size = {"frames": samples, "joints": problem.robot.nd + 1}
    check_memory("page", size, BYTES_PER_POSE, "a plan with fewer divisions")
    parameters = np.linspace(0.0, 1.0, samples)
    frames = motion_frames(problem.robot, plan.at(parameters))
    played = PlayedMotion(
        problem=problem,
        frames=frames,
        axis=_AXIS,
        charts=_charts(plan, frames),
        bound="proven at least",
        title=title or f"{problem.robot.name}, {problem.mode}",
        subtitle=_summary(plan),
        plan=plan,
        playing=playing,
        shapes=one_of("shapes", shapes, SHAPES),
    )
    return motion_page(played)


def frames_per_edge(plan: PlanData) -> int:
    """More than the usual number where a joint goes far on an edge."""
    farthest = float(np.max(np.abs(np.diff(plan.motion.joint_values, axis=0)), initial=0.0))
    most = max(_FRAMES_PER_EDGE, _MOST_FRAMES // plan.motion.edges)
    return min(max(_FRAMES_PER_EDGE, int(np.ceil(farthest / LARGEST_TURN))), most)


def _charts(plan: PlanData, frames: MotionFrames) -> list[Quantity]:
    """Clearance, rotation of the base and joints along the motion."""
    count, robot, scene = len(frames.configurations), plan.problem.robot, plan.problem.scene
    charts = []
    if len(scene):
        query = ObstacleQuery(robot, scene)
        found = query.distances_at(frames.placements, np.arange(count), np.zeros((count, 3)))
        curve = Curve("clearance", "clearance", found)
        least = max(plan.certificate.least_clearance, 0.0)
        charts.append(Quantity("clearance", "clearance", "m", [curve], [least]))
    attitudes = frames.configurations[:, 3:7]
    rotation = np.degrees(angle_between(attitudes[0], attitudes))
    curve = Curve("rotation", "angle from the start", rotation)
    charts.append(Quantity("attitude", "rotation of the base", "°", [curve], []))
    joints = plan.motion.joints_at(*_edges_and_times(plan, count))
    prismatic = np.asarray(robot.prismatic, dtype=bool)
    for kind, name, title, unit in (
        (~prismatic, "joints", "joints", "rad"),
        (prismatic, "slides", "sliding joints", "m"),
    ):
        moved = np.flatnonzero(kind & (np.ptp(joints, axis=0) > _LEAST_TURN))
        names = robot.joint_names
        curves = [Curve(names[j], names[j], joints[:, j]) for j in moved]
        if curves:
            charts.append(Quantity(name, title, unit, curves, []))
    return charts


def _edges_and_times(plan: PlanData, count: int) -> tuple[IntArray, Array]:
    """Edges (N,) and times on them (N,) at equal steps of the path parameter."""
    scaled = np.linspace(0.0, 1.0, count) * plan.motion.edges
    edge = np.minimum(scaled.astype(np.int64), plan.motion.edges - 1)
    return edge, scaled - edge


def _summary(plan: PlanData) -> str:
    """Planner and figures of merit in one line."""
    gap = "lattice gap" if plan.optimum_is_exact else "gap to a lower bound"
    unchecked = plan.problem.robot.unchecked_links
    clearance = f"proven clearance {proven(plan.certificate.least_clearance)}"
    return (
        f"{plan.planner.name}: L {plan.length:.3f} m, F {plan.objective:.2f}, "
        f"δ {plan.problem.delta:g}, {gap} {plan.gap:.2%}, "
        + (clearance if len(plan.problem.scene) else "no obstacles")
        + (f", links not checked: {', '.join(unchecked)}" if unchecked else "")
    )
