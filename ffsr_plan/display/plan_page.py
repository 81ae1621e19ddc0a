"""Self-contained HTML page that plays a plan."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.core.cost_estimate import check_memory
from ffsr_plan.core.formatting import proven
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.display.meshcat_objects import CommandLog, MeshcatNode
from ffsr_plan.display.picture_data import MotionFrames, drawn_solid, motion_frames, trail_segments
from ffsr_plan.display.projection import view_axes
from ffsr_plan.display.scene_objects import (
    TIPS,
    TRACK,
    add_ends,
    add_obstacles,
    add_track,
    add_trails,
    set_up,
)
from ffsr_plan.display.web.html_template import html_page
from ffsr_plan.search.records import Trails

if TYPE_CHECKING:
    from ffsr_plan.plans.plan_data import PlanData

_SECONDS = 12.0  # duration of the motion on the page; a plan has no time law of its own
_FRAMES_PER_EDGE = 8
_LARGEST_TURN = 0.5  # [rad] of a joint between two frames; the page interpolates the shorter way
_MOST_FRAMES = 4000
_BYTES_PER_POSE = 4000  # of a link in a frame


def page(plan: PlanData, title: str = "", *, playing: bool = False) -> str:
    """HTML text of a page that shows a plan in three dimensions and needs no network.

    The page has a bar with the clearance along the motion, plays on a click or the space bar, and
    steps with the arrow keys. `#s=0.5` at the end of its address opens it at that path parameter.

    Args:
        plan: the plan.
        title: heading; by default the robot and the mode.
        playing: whether the motion starts by itself.

    Returns:
        The text. Equal plans give equal text.
    """
    import meshcat

    log = CommandLog()
    viewer = meshcat.Visualizer(window=log)
    problem, scene = plan.problem, plan.problem.scene
    samples = plan.edges * frames_per_edge(plan) + 1

    size = {"frames": samples, "joints": problem.robot.nd + 1}
    check_memory("page", size, _BYTES_PER_POSE, "a plan with fewer divisions")
    frames = motion_frames(problem.robot, plan.at(np.linspace(0.0, 1.0, samples)))
    centers, radii = frames.bounding_spheres()
    view = set_up(viewer, problem, centers, radii)
    add_obstacles(viewer["obstacles"], scene, drawn_solid(scene, centers))
    add_ends(viewer, problem.robot, frames.configurations[0], frames.configurations[-1])
    _add_tracks(viewer, plan, frames)
    _animate(viewer, frames)
    query = ObstacleQuery(problem.robot, scene)
    clearances = query.distances_at(frames.placements, np.arange(samples), np.zeros((samples, 3)))
    attitudes = frames.configurations[:, 3:7]
    data = {
        "title": title or f"{problem.robot.name}, {problem.mode}",
        "subtitle": _summary(plan),
        "commands": log.commands,
        "seconds": _SECONDS,
        "clearances": [round(float(c), 5) if np.isfinite(c) else None for c in clearances],
        "rotations": np.degrees(angle_between(attitudes[0], attitudes)).round(3).tolist(),
        "view": view,
        "ants": isinstance(plan.trails, Trails) and bool(len(plan.trails.layer)),
        "playing": playing,
    }
    return html_page("plan", data)


def frames_per_edge(plan: PlanData) -> int:
    """More than the usual number where a joint goes far on an edge."""
    farthest = float(np.max(np.abs(np.diff(plan.motion.joint_values, axis=0)), initial=0.0))
    most = max(_FRAMES_PER_EDGE, _MOST_FRAMES // plan.motion.edges)
    return min(max(_FRAMES_PER_EDGE, int(np.ceil(farthest / _LARGEST_TURN))), most)


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


def _add_tracks(viewer: MeshcatNode, plan: PlanData, frames: MotionFrames) -> None:
    """Ribbons in the plane of the path: ants' trails by pheromone, base origin, arm tips."""
    up = view_axes(plan.problem)[2]
    segments, strength = trail_segments(plan)
    if len(segments):
        add_trails(viewer["trails"], segments, strength, up)
    add_track(viewer["tracks"]["base"], frames.origins[:, 0], 0.035, TRACK, up)
    for name, points in frames.tip_tracks().items():
        add_track(viewer["tracks"][name], points, 0.014, TIPS, up)


def _animate(viewer: MeshcatNode, frames: MotionFrames) -> None:
    """Key frames of all links for meshcat's player."""
    from meshcat.animation import Animation, AnimationClip, AnimationTrack
    from scipy.spatial.transform import Rotation

    count, links = frames.origins.shape[:2]
    times = list(range(count))
    clips = {}
    for link in range(links):
        positions = frames.origins[:, link].tolist()
        attitudes = Rotation.from_matrix(frames.rotations[:, link]).as_quat().tolist()
        tracks = {
            "position": AnimationTrack("position", "vector3", times, positions),
            "quaternion": AnimationTrack("quaternion", "quaternion", times, attitudes),
        }
        path = viewer["robot"][f"joint_{link + 1}"].path
        clips[path] = AnimationClip(tracks, fps=(count - 1) / _SECONDS)
    viewer.set_animation(Animation(clips), play=False)
