"""Page that plays a plan along its path parameter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.core.checks import one_of
from ffsr_plan.core.cost_estimate import check_memory
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.formatting import proven
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.display.motion_page import (
    BYTES_PER_POSE,
    LARGEST_TURN,
    Axis,
    PlayedMotion,
    motion_page,
    time_axis,
)
from ffsr_plan.display.scenes.picture_data import Curve, Quantity
from ffsr_plan.display.scenes.plan_samples import PlanSamples, sample_plan
from ffsr_plan.display.scenes.projection import SHAPES
from ffsr_plan.display.scenes.timed_clearances import clearances

if TYPE_CHECKING:
    from ffsr_plan.core.arrays import Array, IntArray
    from ffsr_plan.plans.plan_data import PlanData

_AXIS = Axis("s", "", "path parameter s", 1.0, 12.0, 1)  # without a duration, no time law
_FRAMES_PER_EDGE = 8
_MOST_FRAMES = 4000
_LEAST_TURN = 1e-9  # [rad or m] below which a joint does not move


def page(plan: PlanData, title: str = "", *, playing: bool = False, shapes: str = "visual") -> str:
    """HTML text of a page that shows a plan in three dimensions and needs no network.

    The page plots clearance, rotation of the base and joints along the motion, plays on a click or
    the space bar, and steps with the arrow keys. `#s=0.5` at the end of its address opens it at
    that path parameter. Where the problem has a duration the page plays in true time instead, with
    all bodies where they are at each time, and `#t=30` opens it at that time [s].

    Args:
        plan: the plan.
        title: heading; by default the robot and the mode.
        playing: whether the motion starts by itself.
        shapes: of the robot, `visual` or `collision`.

    Returns:
        The text. Equal plans give equal text.

    Raises:
        InvalidInput: an argument that is not allowed, or a body that turns too often.
    """
    problem = plan.problem
    count = _frame_count(plan)
    moving = len(problem.scene.moving)
    size = {"frames": count, "joints and bodies": problem.robot.nd + 1 + moving}
    check_memory("page", size, BYTES_PER_POSE, "a plan with fewer divisions")
    samples = sample_plan(plan, count)
    played = PlayedMotion(
        problem=problem,
        frames=samples.frames,
        axis=_AXIS if problem.duration is None else time_axis(problem.duration),
        charts=_charts(plan, samples),
        bound="proven at least",
        title=title or f"{problem.robot.name}, {problem.mode}",
        subtitle=_summary(plan),
        plan=plan,
        playing=playing,
        shapes=one_of("shapes", shapes, SHAPES),
        times=samples.times,
    )
    return motion_page(played)


def frames_per_edge(plan: PlanData) -> int:
    """More than the usual number where a joint goes far on an edge."""
    farthest = float(np.max(np.abs(np.diff(plan.motion.joint_values, axis=0)), initial=0.0))
    most = max(_FRAMES_PER_EDGE, _MOST_FRAMES // plan.motion.edges)
    return min(max(_FRAMES_PER_EDGE, int(np.ceil(farthest / LARGEST_TURN))), most)


def _frame_count(plan: PlanData) -> int:
    """Frames at equal steps, so many that no joint and no body turns far between two of them."""
    steps, problem = plan.edges * frames_per_edge(plan), plan.problem
    if problem.duration is None:
        return steps + 1
    steps = int(np.ceil(steps / (1.0 - problem.ramp)))  # of the edges that are passed fastest
    for body in problem.scene.bodies:
        turn = body.motion.turned(0.0, problem.duration)
        if turn > _MOST_FRAMES * LARGEST_TURN:
            allowed = f"at most {_MOST_FRAMES * LARGEST_TURN:g} rad, which a page can show"
            raise InvalidInput(f"turn of the body '{body.name}'", turn, allowed)
        steps = max(steps, int(np.ceil(turn / LARGEST_TURN)))
    return steps + 1


def _charts(plan: PlanData, samples: PlanSamples) -> list[Quantity]:
    """Clearance, rotation of the base and joints along the motion."""
    frames, robot, scene = samples.frames, plan.problem.robot, plan.problem.obstacles
    charts = []
    if len(scene):
        found = clearances(frames, scene, samples.times)
        curve = Curve("clearance", "clearance", found)
        least = max(plan.certificate.least_clearance, 0.0)
        charts.append(Quantity("clearance", "clearance", "m", [curve], [least]))
    attitudes = frames.configurations[:, 3:7]
    rotation = np.degrees(angle_between(attitudes[0], attitudes))
    curve = Curve("rotation", "angle from the start", rotation)
    charts.append(Quantity("attitude", "rotation of the base", "°", [curve], []))
    joints = plan.motion.joints_at(*_edges_and_times(plan, samples.parameters))
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


def _edges_and_times(plan: PlanData, parameters: Array) -> tuple[IntArray, Array]:
    """Edges (N,) and places on them (N,) at path parameters (N,)."""
    scaled = parameters * plan.motion.edges
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
