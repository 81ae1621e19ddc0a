"""Frames of moving pictures, drawn by matplotlib: scene, close-up and curves.

Static parts are drawn once, the robot and what follows it in each frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ffsr_plan.display.body_drawing import discs
from ffsr_plan.display.movie_obstacles import (
    DASHES,
    MOVING,
    OBSTACLE,
    RINGS,
    draw_shaded,
    ring_of,
    shaded_shape,
)
from ffsr_plan.display.path_drawing import draw_zones
from ffsr_plan.display.scenes.body_tracks import BodyTrack, body_tracks, points_near
from ffsr_plan.display.scenes.debris_track import DebrisTrack, debris_track
from ffsr_plan.display.scenes.picture_data import MotionFrames, drawn_solid
from ffsr_plan.display.scenes.projection import Outline, outlines, visible_shapes
from ffsr_plan.display.scenes.scene_objects import TIPS, TRACK, glow
from ffsr_plan.display.scenes.shape_outlines import points_of_extent
from ffsr_plan.scene.shapes.obstacle_shapes import placed_axes

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from PIL import Image

    from ffsr_plan.core.arrays import Array
    from ffsr_plan.problem.problem import Problem

TEXT, STRONG, CLEARANCE, CONTACT = "#9aa5b8", "#eceff4", RINGS, "#b02a30"
ATTITUDE = "#f0b429"
_BACKGROUND, _START, _GOAL = "#070a12", "#4fb3d9", "#58c27d"
_DOTS = (0, (1, 2))
PANEL = 170  # height of the panel below the scene [px]
ASPECTS = (0.25, 0.58)  # least and greatest height of the scene, in widths
BYTES_PER_PIXEL = 6  # of a frame: in colours, and as it is written
_MARGIN = 0.3  # around what is shown [m]


class PanelCurve(NamedTuple):
    """A curve below the scene.

    Attributes:
        values: (N,) one for each frame; not drawn if one is infinite.
        levels: numbers at which a line is drawn, with their colours.
        colour: of the curve.
        label: above it.
    """

    values: Array
    levels: Sequence[tuple[float, str]]
    colour: str
    label: str = ""


class Words(NamedTuple):
    """Words above the curves in one frame.

    Attributes:
        x: where they begin, in widths of the curves.
        text: the words.
        colour: their colour.
    """

    x: float
    text: str
    colour: str


class MovingScene(NamedTuple):
    """What all frames of a moving picture have in common.

    Attributes:
        problem: robot and obstacles.
        title: in the upper left corner.
        frames: kinematics of the robot, one row for each frame.
        axes: (3, 3) directions of the picture in world axes.
        robot: outlines of the robot in each frame, those in front last.
        curves: below the scene, from top to bottom.
        words: above the curves, in each frame.
        trails: ends (k, 2, 3) [m] and strengths (k,) of trails.
        ring: radius [m] of the rings around the obstacles beyond theirs; None for no rings.
        times: (N,) of the frames [s], needed where bodies move.
    """

    problem: Problem
    title: str
    frames: MotionFrames
    axes: Array
    robot: list[list[Outline]]
    curves: Sequence[PanelCurve]
    words: Sequence[Sequence[Words]]
    trails: tuple[Array, Array] | None = None
    ring: float | None = None
    times: Array | None = None


def robot_outlines(frames: MotionFrames, axes: Array, shapes: str) -> list[list[Outline]]:
    """Outlines of the robot in each frame, those in front last.

    Args:
        frames: poses of the robot's links.
        axes: (3, 3) view axes.
        shapes: which are shown, see `visible_shapes`.
    """
    visible = visible_shapes(frames.robot, shapes)
    return [
        sorted(outlines(visible, frames, row, axes), key=lambda outline: outline.height)
        for row in range(len(frames.configurations))
    ]


def fixed_colours(problem: Problem, shapes: str) -> Array:
    """(n, 3) colours that a palette has to hold, in [0, 1]."""
    from matplotlib.colors import to_rgb

    named = (_BACKGROUND, TEXT, STRONG, CLEARANCE, CONTACT, _START, _GOAL, ATTITUDE, MOVING)
    colours = [to_rgb(colour) for colour in named] + [TRACK, TIPS]
    colours += [tuple(shape.meshColor[:3]) for shape in visible_shapes(problem.robot, shapes)]
    return np.array(colours)


def pictures(scene: MovingScene, width: int) -> list[Image.Image]:
    """All frames of a width [px], bodies being where they are at the time of each.

    Raises:
        InvalidInput: bodies move, and the frames have no times that their motions know.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL import Image

    bodies = body_tracks(scene.problem.scene, scene.times)
    debris = debris_track(scene.problem.scene, scene.times)
    figure, main, close_up, curves = _figure(scene, bodies, width)
    canvas: Any = FigureCanvasAgg(figure)  # its methods have no types
    _draw_surroundings(main, scene)
    for axes, curve in zip(curves, scene.curves, strict=True):
        _draw_curve(axes, curve)
    canvas.draw()
    background = canvas.copy_from_bbox(figure.bbox)
    drawn = []
    for row in range(len(scene.robot)):
        canvas.restore_region(background)
        artists = [
            *_debris_artists(main, scene, debris, row),
            *_body_artists(main, scene, bodies, row),
            *_track_artists(main, scene, row),
            _robot_artist(main, scene, row),
            *_close_up_artists(close_up, scene, row),
            *_curve_artists(curves, scene, row),
        ]
        for artist in artists:
            figure.draw_artist(artist)
            artist.remove()
        drawn.append(Image.fromarray(np.array(canvas.buffer_rgba())).convert("RGB"))
    return drawn


def _figure(
    scene: MovingScene, bodies: list[BodyTrack], width: int
) -> tuple[Figure, Axes, Axes, list[Axes]]:
    """A figure with axes for the scene, the close-up and the curves."""
    from matplotlib.figure import Figure

    low, high = _extent(scene, bodies)
    size = high - low
    aspect = float(np.clip(size[1] / size[0], *ASPECTS))
    height = round(width * aspect)
    total = height + PANEL
    figure = Figure(figsize=(width / 100, total / 100), dpi=100, facecolor=_BACKGROUND)
    main = figure.add_axes((0.0, PANEL / total, 1.0, height / total))
    close_up = figure.add_axes((0.0, 0.0, PANEL / width, PANEL / total))
    left = (PANEL + 20) / width
    curves = _curve_axes(figure, (left, 14 / total, 0.97 - left, (PANEL - 50) / total), scene)
    half = 0.5 * max(size[0], size[1] / aspect) * np.array([1.0, aspect])
    middle = 0.5 * (low + high)
    main.set(xlim=(middle[0] - half[0], middle[0] + half[0]))
    main.set(ylim=(middle[1] - half[1], middle[1] + half[1]))
    low, high = _robot_bounds(scene)
    middle, half_side = 0.5 * (low + high), 0.55 * max(high - low)
    close_up.set(xlim=(middle[0] - half_side, middle[0] + half_side))
    close_up.set(ylim=(middle[1] - half_side, middle[1] + half_side))
    for axes in (main, close_up, *curves):
        axes.set_axis_off()
    figure.text(10 / width, 1.0 - 20 / total, scene.title, color=TEXT, fontsize=9)
    return figure, main, close_up, curves


def _curve_axes(
    figure: Figure, box: tuple[float, float, float, float], scene: MovingScene
) -> list[Axes]:
    """Axes for the curves, one below the other in a box of the figure."""
    left, bottom, width, height = box
    part = height / len(scene.curves)
    below = range(len(scene.curves) - 1, -1, -1)
    full = part if len(scene.curves) == 1 else 0.72 * part  # labels stand between the curves
    return [figure.add_axes((left, bottom + k * part, width, full)) for k in below]


def _extent(scene: MovingScene, bodies: list[BodyTrack]) -> tuple[Array, Array]:
    """Lower left and upper right corner (2,) of what is shown [m]."""
    obstacles, view = scene.problem.scene, scene.axes[:2]
    solid = drawn_solid(obstacles, scene.frames.bounding_spheres()[0])[: len(obstacles.radii)]
    points = [outline.polygon for robot in scene.robot for outline in robot]
    for sign in (-1.0, 1.0):
        points.append(obstacles.centers[solid] @ view.T + sign * obstacles.radii[solid, None])
    points.append(points_of_extent(obstacles) @ view.T)
    cloud = np.vstack(points)
    cloud = np.vstack([cloud, points_near(bodies, cloud, view)])
    return cloud.min(axis=0) - _MARGIN, cloud.max(axis=0) + _MARGIN


def _base_track(scene: MovingScene) -> Array:
    """(N, 2) base origin in the picture [m]."""
    return scene.frames.origins[:, 0] @ scene.axes[:2].T


def _robot_bounds(scene: MovingScene) -> tuple[Array, Array]:
    """Lower left and upper right corner (2,) of the robot relative to its base [m]."""
    centers = _base_track(scene)
    cloud = np.vstack(
        [
            outline.polygon - center
            for robot, center in zip(scene.robot, centers, strict=True)
            for outline in robot
        ]
    )
    return cloud.min(axis=0), cloud.max(axis=0)


def _draw_surroundings(axes: Axes, scene: MovingScene) -> None:
    """Trails, obstacles, zones, the path of the base, and the robot at start and goal."""
    from matplotlib.collections import LineCollection, PolyCollection

    if scene.trails is not None and len(scene.trails[0]):
        segments, strength = scene.trails
        colours = np.column_stack([glow(strength), 0.25 + 0.35 * strength**2])
        lines = list(segments @ scene.axes[:2].T)
        trails = LineCollection(lines, colors=colours, linewidths=0.5 + strength, zorder=1)
        axes.add_collection(trails, autolim=False)
    origins, obstacles = scene.frames.origins[:, 0], scene.problem.scene
    solid = drawn_solid(obstacles, scene.frames.bounding_spheres()[0])
    draw_shaded(axes, obstacles, scene.axes, solid, origins, scene.ring)
    draw_zones(
        axes,
        obstacles.keep_in,
        scene.axes,
        float(origins[0] @ scene.axes[2]),
        line=OBSTACLE,
        tint=(OBSTACLE, 0.12),
    )
    axes.plot(*_base_track(scene).T, color=TRACK, lw=0.9, ls=DASHES, zorder=3)
    for row, colour in ((0, _START), (-1, _GOAL)):
        polygons = [outline.polygon for outline in scene.robot[row]]
        axes.add_collection(PolyCollection(polygons, facecolor=colour, alpha=0.3, zorder=3))


def _body_artists(
    axes: Axes, scene: MovingScene, bodies: list[BodyTrack], row: int
) -> list[Artist]:
    """Moving bodies where they are in a frame, those in front last, with their rings."""
    origins = scene.frames.origins[:, 0]
    ring = ring_of(scene.problem.scene, scene.axes, origins, scene.ring)
    shapes = [shape for track in bodies for shape in track.shapes(row)]
    shapes.sort(key=lambda shape: float(scene.axes[2] @ placed_axes(shape)[1]))
    drawn: list[Artist] = []
    for shape in shapes:
        drawn += shaded_shape(axes, shape, scene.axes, ring, MOVING)
    return drawn


def _debris_artists(axes: Axes, scene: MovingScene, debris: DebrisTrack, row: int) -> list[Artist]:
    """Debris where it is in a frame."""
    if not debris:
        return []
    drawn = discs(axes, debris, row, scene.axes[:2], MOVING, 2.0)
    axes.add_collection(drawn, autolim=False)
    return [drawn]


def _track_artists(axes: Axes, scene: MovingScene, row: int) -> list[Artist]:
    """Tracks of the arm tips and of the base up to a frame."""
    artists: list[Artist] = []
    for points in scene.frames.tip_tracks().values():
        track = points[: row + 1] @ scene.axes[:2].T
        artists += axes.plot(*track.T, color=TIPS, lw=1.0, alpha=0.8)
    return artists + axes.plot(*_base_track(scene)[: row + 1].T, color=TRACK, lw=1.8)


def _robot_artist(axes: Axes, scene: MovingScene, row: int, center: Array | None = None) -> Artist:
    """The robot in its own colours; with a `center` (2,) [m], relative to it."""
    from matplotlib.collections import PolyCollection

    origin = np.zeros(2) if center is None else center
    robot = PolyCollection(
        [outline.polygon - origin for outline in scene.robot[row]],
        facecolors=[outline.colour for outline in scene.robot[row]],
        edgecolors=_BACKGROUND,
        linewidths=0.5,
    )
    axes.add_collection(robot, autolim=False)
    return robot


def _close_up_artists(axes: Axes, scene: MovingScene, row: int) -> list[Artist]:
    """The robot about its base, heading of the base at the start and now, angle between them."""
    from matplotlib.patches import Wedge

    radius = 0.97 * axes.get_xlim()[1]
    headings = scene.frames.rotations[:, 0] @ _heading_axis(scene) @ scene.axes[:2].T
    angles = np.degrees(np.unwrap(np.arctan2(headings[:, 1], headings[:, 0])))
    begin, now = float(angles[0]), float(angles[row])
    wedge = Wedge((0.0, 0.0), radius, min(begin, now), max(begin, now), color=ATTITUDE)
    wedge.set(alpha=0.4, linewidth=0)
    axes.add_patch(wedge)
    artists: list[Artist] = [wedge]
    for angle, colour, style in ((begin, TEXT, _DOTS), (now, ATTITUDE, "-")):
        tip = radius * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
        artists += axes.plot([0.0, tip[0]], [0.0, tip[1]], color=colour, lw=1.4, ls=style)
    return [*artists, _robot_artist(axes, scene, row, _base_track(scene)[row])]


def _heading_axis(scene: MovingScene) -> Array:
    """(3,) the axis of the base that points most to the right at the start."""
    components = scene.axes[0] @ scene.frames.rotations[0, 0]
    chosen = int(np.argmax(np.abs(components)))
    heading = np.zeros(3)
    heading[chosen] = np.sign(components[chosen])
    return heading


def _draw_curve(axes: Axes, curve: PanelCurve) -> None:
    """A curve over the frames with its levels."""
    values = curve.values
    axes.set(xlim=(0, len(values) - 1), ylim=(0.0, 1.0))
    if not np.isfinite(values).all():
        return
    axes.set_ylim(-0.03 * values.max(), 1.1 * max(float(values.max()), 1e-9))
    for level, colour in curve.levels:
        if level <= axes.get_ylim()[1]:
            axes.axhline(level, color=colour, lw=0.9, ls="-" if level == 0.0 else DASHES)
    axes.plot(values, color=curve.colour, lw=1.4)
    axes.text(0.0, 1.08, curve.label, color=TEXT, fontsize=8, transform=axes.transAxes)


def _curve_artists(curves: list[Axes], scene: MovingScene, row: int) -> list[Artist]:
    """The current points of the curves, and above them the words of the frame."""
    artists: list[Artist] = []
    for axes, curve in zip(curves, scene.curves, strict=True):
        if np.isfinite(curve.values).all():
            value = float(curve.values[row])
            artists += axes.plot([row], [value], "o", color=STRONG, ms=5, clip_on=False)
    above = 1.13 if len(curves) == 1 else 1.55
    for words in scene.words[row]:
        text = curves[0].text(words.x, above, words.text, color=words.colour, fontsize=9)
        text.set_transform(curves[0].transAxes)
        artists.append(text)
    return artists
