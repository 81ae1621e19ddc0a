"""Self-contained HTML page that plays a motion, with plots along it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.display.scenes.body_tracks import BodyTrack, body_tracks, key_rows
from ffsr_plan.display.scenes.debris_track import debris_track
from ffsr_plan.display.scenes.meshcat_objects import CommandLog, MeshcatNode
from ffsr_plan.display.scenes.picture_data import (
    MotionFrames,
    Quantity,
    drawn_solid,
    trail_segments,
)
from ffsr_plan.display.scenes.projection import ShownProblem, view_axes
from ffsr_plan.display.scenes.scene_objects import (
    TIPS,
    TRACK,
    add_bodies,
    add_debris,
    add_ends,
    add_obstacles,
    add_track,
    add_trails,
    add_zones,
    set_up,
)
from ffsr_plan.display.scenes.shape_outlines import labels
from ffsr_plan.display.scenes.shown_space import shown_space
from ffsr_plan.display.scenes.timed_clearances import nearest_passes
from ffsr_plan.display.scenes.zone_outlines import name_places
from ffsr_plan.display.web.html_template import html_page
from ffsr_plan.plans.plan_data import PlanData
from ffsr_plan.scene.scene import Scene
from ffsr_plan.search.records import Trails

SPEEDS = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
"""Factors of the time in which a page can play."""
LARGEST_TURN = 0.5  # [rad] of a joint between two frames; the page interpolates the shorter way
BYTES_PER_POSE = 4000  # of a link in a frame
_COLOURS = ("#f0b429", "#5fb3ce", "#6cc27a", "#c08bea", "#f2845c", "#9fb6d9", "#e58ab5", "#b5c94c")
_MOST_NAMES = 30  # obstacles that are named one by one
_DIGITS = 5  # of values in plots
_PATIENCE = 60.0  # [s] in which a motion that has a time is played at first
_NAME_ERROR = 0.02  # [m] by which the name of a moving body may be off


class Axis(NamedTuple):
    """The axis along which a page plays.

    Attributes:
        symbol: its letter, by which the page's address names a position.
        unit: empty for a number.
        title: below the plots.
        end: value at the end of the motion.
        seconds: in which it is played at the speed 1.
        speed: at which it is played at first, one of `SPEEDS`.
    """

    symbol: str
    unit: str
    title: str
    end: float
    seconds: float
    speed: float


def time_axis(duration: float) -> Axis:
    """The axis of a motion that has a time: true time, or if longer than a minute a faster one.

    Args:
        duration: of the motion [s].
    """
    speed = next((s for s in SPEEDS if s >= 1 and duration <= s * _PATIENCE), SPEEDS[-1])
    return Axis("t", "s", "time [s]", duration, duration, speed)


class PlayedMotion(NamedTuple):
    """What a page plays.

    Attributes:
        problem: robot and obstacles.
        frames: poses at equal steps of the axis.
        axis: the axis.
        charts: what is plotted, at the same steps.
        bound: what limits of the charts are called.
        title: heading.
        subtitle: below it.
        plan: whose trails are drawn; None for none.
        playing: whether the motion starts by itself.
        shapes: of the robot, see `visible_shapes`.
        times: (N,) of the frames [s], needed where bodies move.
    """

    problem: ShownProblem
    frames: MotionFrames
    axis: Axis
    charts: Sequence[Quantity]
    bound: str
    title: str
    subtitle: str
    plan: PlanData | None = None
    playing: bool = False
    shapes: str = "visual"
    times: Array | None = None


def motion_page(played: PlayedMotion) -> str:
    """HTML text of a page that shows a motion in three dimensions and needs no network.

    Raises:
        InvalidInput: bodies move, and the frames have no times that their motions know.
    """
    import meshcat

    log = CommandLog()
    viewer = meshcat.Visualizer(window=log)
    problem, frames, plan = played.problem, played.frames, played.plan
    centers, radii = frames.bounding_spheres()
    tracks = body_tracks(problem.scene, played.times)
    debris = debris_track(problem.scene, played.times)
    view = set_up(viewer, problem, centers, radii, tracks, debris)
    solid = drawn_solid(problem.scene, centers)
    add_obstacles(viewer["obstacles"], problem.scene, solid)
    add_bodies(viewer["bodies"], tracks, view_axes(problem)[2])
    add_debris(viewer["bodies"]["debris"], debris)
    add_zones(viewer["zones"], problem.scene, centers, radii)
    start, goal = frames.configurations[[0, -1]]
    add_ends(viewer, problem.robot, start, goal, played.shapes)
    _add_tracks(viewer, problem, frames, plan)
    _animate(viewer, frames, tracks, played.axis.seconds)
    ants = plan is not None and isinstance(plan.trails, Trails) and len(plan.trails.layer) > 0
    data = {
        "title": played.title,
        "subtitle": played.subtitle,
        "commands": log.commands,
        "axis": played.axis._asdict(),
        "charts": [_chart(chart, played.bound) for chart in played.charts],
        "base": np.round(frames.configurations[:, :7], _DIGITS).tolist(),
        "body": _body(problem, frames, centers, radii),
        "names": [
            *obstacle_names(problem.scene),
            *_zone_names(problem.scene, centers, radii),
            *_body_names(tracks),
        ],
        "bodies": nearest_passes(frames, problem.obstacles, tracks, debris),
        "drifts": (np.ptp(debris.times) * debris.velocities).round(4).tolist(),
        "view": view,
        "ants": ants,
        "playing": played.playing,
    }
    return html_page("plan", data)


def _chart(chart: Quantity, bound: str) -> dict[str, Any]:
    """A chart with its colours, as the page's script expects it."""
    curves = [
        {
            "label": curve.label,
            "colour": _COLOURS[k % len(_COLOURS)],
            "values": [float(f"{value:.{_DIGITS}g}") for value in curve.values],
        }
        for k, curve in enumerate(chart.curves)
    ]
    named = {"name": chart.name, "title": chart.title, "unit": chart.unit}
    return {**named, "curves": curves, "limits": chart.limits, "bound": bound}


def _body(
    problem: ShownProblem, frames: MotionFrames, centers: Array, radii: Array
) -> dict[str, Any]:
    """Heading and upper side of the base in its own axes, and the reach of the robot [m].

    The heading is the axis of the base that points most along the path at the start, the upper side
    the one that points most towards the viewer.
    """
    along, _, viewer = view_axes(problem)
    axes = frames.rotations[0, 0]
    heading = _nearest_axis(axes.T @ along)
    up = _nearest_axis((axes.T @ viewer) * (heading == 0.0))
    reach = np.linalg.norm(centers - centers[:, :1], axis=2) + radii
    return {"heading": heading.tolist(), "up": up.tolist(), "size": float(np.max(reach))}


def _nearest_axis(components: Array) -> Array:
    """(3,) the signed axis along which components (3,) are largest."""
    axis = np.zeros(3)
    largest = int(np.argmax(np.abs(components)))
    axis[largest] = 1.0 if components[largest] >= 0.0 else -1.0
    return axis


def obstacle_names(scene: Scene) -> list[dict[str, Any]]:
    """Names of obstacles with their places in the world [m].

    A body of many spheres is named once. Spheres are named one by one, by their numbers where they
    are no body of their own, if they are few. So are shapes without a name; those with one are
    named if these are few.
    """
    names: list[dict[str, Any]] = []
    begin = 0
    few = len(scene.radii) + len(scene.shapes) <= _MOST_NAMES
    for name, count in scene.sources or (("", len(scene.radii)),):
        centers = scene.centers[begin : begin + count]
        if name and count and (count == 1 or not few):
            names.append(_name(name, centers.mean(axis=0)))
        elif few:
            numbered = enumerate(centers, start=begin)
            names += [_name(str(k), c) for k, c in numbered]
        begin += count
    named = [each for each in labels(scene) if few or each.is_name]
    if few or len(named) <= _MOST_NAMES:
        names += [_name(each.text, each.at) for each in named]
    return names


def _zone_names(scene: Scene, centers: Array, radii: Array) -> list[dict[str, Any]]:
    """Names of zones, at a corner of each; the rest as of `add_zones`."""
    places = name_places(scene.keep_in, *shown_space(scene, centers, radii))
    return [_name(name, at) for name, at in places[:_MOST_NAMES]]


def _body_names(tracks: Sequence[BodyTrack]) -> list[dict[str, Any]]:
    """Names of moving bodies with their ways: rows of share of the motion and place [m]."""
    names = []
    for track in tracks[:_MOST_NAMES]:
        middles = track.middles()
        rows = key_rows(middles, _NAME_ERROR)
        way = np.column_stack([rows / (len(middles) - 1), middles[rows]])
        names.append(_name(track.name, middles[0]) | {"way": way.round(4).tolist()})
    return names


def _name(text: str, at: Array) -> dict[str, Any]:
    return {"text": text, "at": at.round(4).tolist()}


def _add_tracks(
    viewer: MeshcatNode, problem: ShownProblem, frames: MotionFrames, plan: PlanData | None
) -> None:
    """Ribbons in the plane of the path: ants' trails by pheromone, base origin, arm tips."""
    up = view_axes(problem)[2]
    if plan is not None:
        segments, strength = trail_segments(plan)
        if len(segments):
            add_trails(viewer["trails"], segments, strength, up)
    add_track(viewer["tracks"]["base"], frames.origins[:, 0], 0.035, TRACK, up)
    for name, points in frames.tip_tracks().items():
        add_track(viewer["tracks"][name], points, 0.014, TIPS, up)


def _animate(
    viewer: MeshcatNode, frames: MotionFrames, tracks: Sequence[BodyTrack], seconds: float
) -> None:
    """Key frames of all links and moving bodies for meshcat's player."""
    from meshcat.animation import Animation, AnimationClip
    from scipy.spatial.transform import Rotation

    count, links = frames.origins.shape[:2]
    fps, clips, every = (count - 1) / seconds, {}, np.arange(count)
    for link in range(links):
        positions = frames.origins[:, link]
        attitudes = Rotation.from_matrix(frames.rotations[:, link]).as_quat()
        keys = _key_frames(positions, every, attitudes, every)
        path = viewer["robot"][f"joint_{link + 1}"].path
        clips[path] = AnimationClip(keys, fps=fps)
    for k, track in enumerate(tracks):
        places, turns = track.positions, track.attitudes
        keys = _key_frames(places, key_rows(places), turns, key_rows(turns))
        clips[viewer["bodies"][str(k)].path] = AnimationClip(keys, fps=fps)
    viewer.set_animation(Animation(clips), play=False)


def _key_frames(
    positions: Array, of_positions: IntArray, attitudes: Array, of_attitudes: IntArray
) -> dict[str, Any]:
    """Tracks of meshcat's player: positions (N, 3) and attitudes (N, 4) in some frames each."""
    from meshcat.animation import AnimationTrack

    return {
        name: AnimationTrack(name, kind, rows.tolist(), values[rows].tolist())
        for name, kind, rows, values in (
            ("position", "vector3", of_positions, positions),
            ("quaternion", "quaternion", of_attitudes, attitudes),
        )
    }
