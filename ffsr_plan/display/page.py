"""A plan as one self-contained page, with a play bar."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.formatting import proven
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.display.html_template import filled
from ffsr_plan.display.meshcat_objects import CommandLog
from ffsr_plan.display.plan_tracks import obstacles_near, trail_segments
from ffsr_plan.display.scene_objects import (
    FEW,
    NEAR,
    TIPS,
    TRACK,
    add_ends,
    add_obstacles,
    add_track,
    add_trails,
    set_up,
    view_axes,  # fmt: skip
)
from ffsr_plan.robots.robot import SpaceRobot

if TYPE_CHECKING:
    from ffsr_plan.plans.plan_data import PlanData

SECONDS = 12.0  # how long the motion is shown; a plan has no time law of its own
_FRAMES_PER_EDGE = 8


def page(plan: PlanData, title: str = "") -> str:
    """The HTML text of the page; without a title, robot and mode stand there."""
    import meshcat

    log = CommandLog()
    viewer = meshcat.Visualizer(window=log)
    frames = plan.at(np.linspace(0.0, 1.0, plan.problem.lattice.divisions * _FRAMES_PER_EDGE + 1))
    view = set_up(viewer, plan.problem, plan.configurations)
    scene = plan.problem.scene
    near = obstacles_near(plan, NEAR if len(scene) > FEW else np.inf)
    add_obstacles(viewer["obstacles"], scene, near)
    add_ends(viewer, plan.problem.robot, plan.configurations[0], plan.configurations[-1])
    _add_tracks(viewer, plan, frames)
    _animate(viewer, plan.problem.robot, frames)
    query = ObstacleQuery(plan.problem.robot, plan.problem.scene)
    clearances = query.distances(frames)
    clearance = f"proven clearance {proven(plan.certificate.least_clearance)}"
    gap = "lattice gap" if plan.optimum_is_exact else "gap to a lower bound"
    data = {
        "title": title or f"{plan.problem.robot.name}, {plan.problem.mode}",
        "subtitle": f"{plan.planner.name}: L {plan.length:.3f} m, F {plan.objective:.2f}, "
        f"δ {plan.problem.delta:g}, {gap} {plan.gap:.2%}, "
        + (clearance if len(scene) else "no obstacles"),
        "commands": log.commands,
        "seconds": SECONDS,
        "clearances": [round(float(c), 5) if np.isfinite(c) else None for c in clearances],
        "turns": np.degrees(angle_between(frames[0, 3:7], frames[:, 3:7])).round(3).tolist(),
        "view": view,
        "ants": bool(len(plan.trails.layer)),
    }
    return filled("page.html", data)


def _add_tracks(viewer: Any, plan: PlanData, frames: Array) -> None:  # noqa: ANN401 - meshcat
    """Ribbons in the plane of the path: ants' trails by pheromone, base origin, arm tips."""
    up = view_axes(plan.problem)[2]
    segments, strength = trail_segments(plan)
    if len(segments):
        add_trails(viewer["trails"], segments, strength, up)
    add_track(viewer["tracks"]["base"], frames[:, :3], 0.035, TRACK, up)
    for name, points in _tips(plan.problem.robot, frames).items():
        add_track(viewer["tracks"][name], points, 0.014, TIPS, up)


def _tips(robot: SpaceRobot, frames: Array) -> dict[str, Array]:
    """Tracks of the last shape of each arm."""
    parents = set(robot.model.parents[2:])
    leaves = [j for j in range(2, robot.model.njoints) if j not in parents]
    shapes = {g.parentJoint: g for g in robot.collision_model.geometryObjects}
    data = robot.model.createData()
    tracks: dict[str, list[Array]] = {robot.model.names[j]: [] for j in leaves if j in shapes}
    for q in frames:
        pin.forwardKinematics(robot.model, data, q)
        for j in leaves:
            if j in shapes:
                tracks[robot.model.names[j]].append(
                    data.oMi[j].act(np.array(shapes[j].placement.translation))
                )
    return {name: np.array(points) for name, points in tracks.items()}


def _animate(viewer: Any, robot: SpaceRobot, frames: Array) -> None:  # noqa: ANN401 - meshcat
    from meshcat.animation import Animation, AnimationClip, AnimationTrack

    joints = range(1, robot.model.njoints)
    positions: dict[int, list[list[float]]] = {j: [] for j in joints}
    turns: dict[int, list[list[float]]] = {j: [] for j in joints}
    data = robot.model.createData()
    for q in frames:
        pin.forwardKinematics(robot.model, data, q)
        for j in joints:
            positions[j].append(data.oMi[j].translation.tolist())
            turns[j].append(pin.Quaternion(data.oMi[j].rotation).coeffs().tolist())
    times = list(range(len(frames)))
    clips = {}
    for j in joints:
        tracks = {
            "position": AnimationTrack("position", "vector3", times, positions[j]),
            "quaternion": AnimationTrack("quaternion", "quaternion", times, turns[j]),
        }
        clips[viewer["robot"][f"joint_{j}"].path] = AnimationClip(
            tracks, fps=(len(frames) - 1) / SECONDS
        )
    viewer.set_animation(Animation(clips), play=False)
