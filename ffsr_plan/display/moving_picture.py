"""Animated GIF of a plan, drawn by matplotlib."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.core.checks import one_of, whole_number
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.cost_estimate import check_memory
from ffsr_plan.core.formatting import proven
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.core.text_files import write_files
from ffsr_plan.display.scenes.picture_data import (
    MotionFrames,
    drawn_solid,
    motion_frames,
    trail_segments,
)
from ffsr_plan.display.scenes.projection import VIEWS, Outline, outlines, view_axes, visible_shapes
from ffsr_plan.display.scenes.scene_objects import TIPS, TRACK, glow

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from PIL import Image

    from ffsr_plan.core.arrays import Array
    from ffsr_plan.plans.plan_data import PlanData

_BACKGROUND, _TEXT, _STRONG = "#070a12", "#9aa5b8", "#eceff4"
_OBSTACLE, _CLEARANCE, _CONTACT = "#aeb4bf", "#5fb3ce", "#b02a30"
_START, _GOAL, _ATTITUDE = "#4fb3d9", "#58c27d", "#f0b429"
_DASHES, _DOTS = (0, (4, 3)), (0, (1, 2))
_PANEL = 170  # height of the panel below the scene [px]
_BYTES_PER_PIXEL = 6  # of a frame: in colours, and as it is written
_MARGIN = 0.3  # around what is shown [m]
_ASPECTS = (0.25, 0.58)  # least and greatest height of the scene, in widths
_FRAME_TIME, _LAST_TIME = 80, 1400  # duration of a frame, and of the last one [ms]


class _Scene(NamedTuple):
    """What all frames of a moving picture have in common.

    Attributes:
        plan: the plan.
        frames: kinematics of the robot, one row for each frame.
        axes: (3, 3) directions of the picture in world axes.
        robot: outlines of the robot in each frame, those in front last.
        clearances: (N,) least link-to-obstacle distance in each frame [m].
    """

    plan: PlanData
    frames: MotionFrames
    axes: Array
    robot: list[list[Outline]]
    clearances: Array


def write_gif(
    plan: PlanData, path: str | Path, *, frames: int = 60, width: int = 720, view: str = "path"
) -> None:
    """Write a plan as an animated GIF that repeats for ever.

    It shows the robot, its obstacles, the ants' trails and the tracks of base and arm tips. A panel
    below holds a close-up with the rotation of the base, and the clearance. If all obstacles lie in
    the plane of the motion, a ring around each of them marks the proven clearance: no point of the
    robot ever enters it.

    Args:
        plan: the plan.
        path: file to write, `.gif`; an existing one is replaced.
        frames: number of pictures, at equal steps of the path parameter.
        width: of the picture [px].
        view: `path`, seen along the normal y' of the path frame, or `side`, along the lateral x'.

    Raises:
        InvalidInput: an argument that is not allowed, or a file that cannot be written.
    """
    from PIL.Image import Dither

    target = checked_path("path", path, ".gif")
    count = whole_number("frames", frames, at_least=2, at_most=600)
    pixels = whole_number("width", width, at_least=300, at_most=4000)
    size = {"frames": count, "pixels": pixels * round(_ASPECTS[1] * pixels + _PANEL)}
    check_memory("frames", size, _BYTES_PER_PIXEL, "fewer frames or a smaller width")
    rows = list(VIEWS[one_of("view", view, tuple(VIEWS))])
    pictures = _pictures(_scene(plan, count, view_axes(plan.problem)[rows]), pixels)
    palette = _palette(pictures, plan)
    first, *rest = [picture.quantize(palette=palette, dither=Dither.NONE) for picture in pictures]
    durations = [_FRAME_TIME] * (count - 1) + [_LAST_TIME]
    content = io.BytesIO()
    first.save(content, format="GIF", save_all=True, append_images=rest, duration=durations, loop=0)
    write_files("path", {target: content.getvalue()})


def _scene(plan: PlanData, count: int, axes: Array) -> _Scene:
    """Everything that `count` frames show, seen along the view axes (3, 3)."""
    robot = plan.problem.robot
    frames = motion_frames(robot, plan.at(np.linspace(0.0, 1.0, count)))
    shapes, rows = visible_shapes(robot), np.arange(count)
    drawn = [
        sorted(outlines(shapes, frames, row, axes), key=lambda outline: outline.height)
        for row in range(count)
    ]
    query = ObstacleQuery(robot, plan.problem.obstacles)
    clearances = query.distances_at(frames.placements, rows, np.zeros((count, 3)))
    return _Scene(plan, frames, axes, drawn, clearances)


def _palette(pictures: list[Image.Image], plan: PlanData) -> Image.Image:
    """One palette for all pictures, so that the file stores static parts only once."""
    from matplotlib.colors import to_rgb
    from PIL import Image

    named = (_BACKGROUND, _TEXT, _STRONG, _CLEARANCE, _CONTACT, _START, _GOAL, _ATTITUDE)
    colours = [to_rgb(colour) for colour in named] + [TRACK, TIPS]
    colours += [tuple(shape.meshColor[:3]) for shape in visible_shapes(plan.problem.robot)]
    fixed = np.unique(np.round(255.0 * np.array(colours)).astype(int), axis=0)[:64]
    width, height = pictures[0].size
    chosen = pictures[:: max(1, len(pictures) // 6)]
    sheet = Image.new("RGB", (width, height * len(chosen)))
    for k, picture in enumerate(chosen):
        sheet.paste(picture, (0, k * height))
    common = sheet.quantize(190, method=Image.Quantize.MEDIANCUT).getpalette() or []
    palette = Image.new("P", (1, 1))
    palette.putpalette((fixed.ravel().tolist() + common)[: 3 * 256])
    return palette


def _pictures(scene: _Scene, width: int) -> list[Image.Image]:
    """All frames. Static parts are drawn once, the robot in each frame."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL import Image

    figure, main, close_up, curve = _figure(scene, width)
    canvas: Any = FigureCanvasAgg(figure)  # its methods have no types
    _draw_surroundings(main, scene)
    _draw_clearance_curve(curve, scene)
    canvas.draw()
    background = canvas.copy_from_bbox(figure.bbox)
    pictures = []
    for row in range(len(scene.robot)):
        canvas.restore_region(background)
        artists = [
            *_track_artists(main, scene, row),
            _robot_artist(main, scene, row),
            *_close_up_artists(close_up, scene, row),
            *_figure_artists(curve, scene, row),
        ]
        for artist in artists:
            figure.draw_artist(artist)
            artist.remove()
        pictures.append(Image.fromarray(np.array(canvas.buffer_rgba())).convert("RGB"))
    return pictures


def _figure(scene: _Scene, width: int) -> tuple[Figure, Axes, Axes, Axes]:
    """A figure with axes for the scene, the close-up and the clearance curve."""
    from matplotlib.figure import Figure

    low, high = _extent(scene)
    size = high - low
    aspect = float(np.clip(size[1] / size[0], *_ASPECTS))
    height = round(width * aspect)
    total = height + _PANEL
    figure = Figure(figsize=(width / 100, total / 100), dpi=100, facecolor=_BACKGROUND)
    main = figure.add_axes((0.0, _PANEL / total, 1.0, height / total))
    close_up = figure.add_axes((0.0, 0.0, _PANEL / width, _PANEL / total))
    left = (_PANEL + 20) / width
    curve = figure.add_axes((left, 14 / total, 0.97 - left, (_PANEL - 50) / total))
    half = 0.5 * max(size[0], size[1] / aspect) * np.array([1.0, aspect])
    middle = 0.5 * (low + high)
    main.set(xlim=(middle[0] - half[0], middle[0] + half[0]))
    main.set(ylim=(middle[1] - half[1], middle[1] + half[1]))
    low, high = _robot_bounds(scene)
    middle, half_side = 0.5 * (low + high), 0.55 * max(high - low)
    close_up.set(xlim=(middle[0] - half_side, middle[0] + half_side))
    close_up.set(ylim=(middle[1] - half_side, middle[1] + half_side))
    for axes in (main, close_up, curve):
        axes.set_axis_off()
    title = f"{scene.plan.problem.robot.name}, {scene.plan.problem.mode}"
    figure.text(10 / width, 1.0 - 20 / total, title, color=_TEXT, fontsize=9)
    return figure, main, close_up, curve


def _extent(scene: _Scene) -> tuple[Array, Array]:
    """Lower left and upper right corner (2,) of what is shown [m]."""
    obstacles, view = scene.plan.problem.scene, scene.axes[:2]
    solid = drawn_solid(obstacles, scene.frames.bounding_spheres()[0])
    points = [outline.polygon for robot in scene.robot for outline in robot]
    for sign in (-1.0, 1.0):
        points.append(obstacles.centers[solid] @ view.T + sign * obstacles.radii[solid, None])
    cloud = np.vstack(points)
    return cloud.min(axis=0) - _MARGIN, cloud.max(axis=0) + _MARGIN


def _base_track(scene: _Scene) -> Array:
    """(N, 2) base origin in the picture [m]."""
    return scene.frames.origins[:, 0] @ scene.axes[:2].T


def _robot_bounds(scene: _Scene) -> tuple[Array, Array]:
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


def _draw_surroundings(axes: Axes, scene: _Scene) -> None:
    """Trails, obstacles, the path of the base, and the robot at start and goal."""
    from matplotlib.collections import LineCollection, PolyCollection

    segments, strength = trail_segments(scene.plan)
    if len(segments):
        colours = np.column_stack([glow(strength), 0.25 + 0.35 * strength**2])
        lines = list(segments @ scene.axes[:2].T)
        trails = LineCollection(lines, colors=colours, linewidths=0.5 + strength, zorder=1)
        axes.add_collection(trails, autolim=False)
    _draw_obstacles(axes, scene)
    axes.plot(*_base_track(scene).T, color=TRACK, lw=0.9, ls=_DASHES, zorder=3)
    for row, colour in ((0, _START), (-1, _GOAL)):
        polygons = [outline.polygon for outline in scene.robot[row]]
        axes.add_collection(PolyCollection(polygons, facecolor=colour, alpha=0.3, zorder=3))


def _draw_obstacles(axes: Axes, scene: _Scene) -> None:
    """Shaded spheres; faint discs for those that are not solid; rings of proven clearance."""
    from matplotlib.patches import Circle

    obstacles = scene.plan.problem.scene
    solid = drawn_solid(obstacles, scene.frames.bounding_spheres()[0])
    local = obstacles.centers @ scene.axes.T
    least, ball = scene.plan.certificate.least_clearance, _shaded_ball()
    heights = np.append(local[:, 2], scene.frames.origins[:, 0] @ scene.axes[2])
    ringed = np.isfinite(least) and np.ptp(heights) < 1e-6
    for k in np.argsort(local[:, 2], kind="stable"):
        (x, y), radius = local[k, :2], float(obstacles.radii[k])
        if not solid[k]:
            axes.add_patch(Circle((x, y), radius, color=_OBSTACLE, alpha=0.08, zorder=1.5, lw=0))
            continue
        box = (x - radius, x + radius, y - radius, y + radius)
        axes.imshow(ball, extent=box, zorder=2, interpolation="bilinear", aspect="auto")
        if ringed:
            ring = Circle((x, y), radius + least, fill=False, color=_CLEARANCE, zorder=2)
            ring.set(alpha=0.55, linewidth=0.9, linestyle=_DASHES)
            axes.add_patch(ring)


def _shaded_ball(pixels: int = 96) -> Array:
    """(pixels, pixels, 4) picture of a grey ball, lit from the upper left."""
    from matplotlib.colors import to_rgb

    x, y = np.meshgrid(*2 * [np.linspace(-1.0, 1.0, pixels)])
    y = -y
    inside = x**2 + y**2 <= 1.0
    z = np.sqrt(np.clip(1.0 - x**2 - y**2, 0.0, None))
    light = np.clip((-0.45 * x + 0.55 * y + 0.7 * z) / np.sqrt(0.45**2 + 0.55**2 + 0.7**2), 0, 1)
    ball = np.zeros((pixels, pixels, 4))
    ball[..., :3] = (0.16 + 0.84 * light)[..., None] * to_rgb(_OBSTACLE)
    ball[..., 3] = inside
    return ball


def _track_artists(axes: Axes, scene: _Scene, row: int) -> list[Artist]:
    """Tracks of the arm tips and of the base up to a frame."""
    artists: list[Artist] = []
    for points in scene.frames.tip_tracks().values():
        track = points[: row + 1] @ scene.axes[:2].T
        artists += axes.plot(*track.T, color=TIPS, lw=1.0, alpha=0.8)
    return artists + axes.plot(*_base_track(scene)[: row + 1].T, color=TRACK, lw=1.8)


def _robot_artist(axes: Axes, scene: _Scene, row: int, center: Array | None = None) -> Artist:
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


def _close_up_artists(axes: Axes, scene: _Scene, row: int) -> list[Artist]:
    """The robot about its base, heading of the base at the start and now, angle between them."""
    from matplotlib.patches import Wedge

    radius = 0.97 * axes.get_xlim()[1]
    headings = scene.frames.rotations[:, 0] @ _heading_axis(scene) @ scene.axes[:2].T
    angles = np.degrees(np.unwrap(np.arctan2(headings[:, 1], headings[:, 0])))
    begin, now = float(angles[0]), float(angles[row])
    wedge = Wedge((0.0, 0.0), radius, min(begin, now), max(begin, now), color=_ATTITUDE)
    wedge.set(alpha=0.4, linewidth=0)
    axes.add_patch(wedge)
    artists: list[Artist] = [wedge]
    for angle, colour, style in ((begin, _TEXT, _DOTS), (now, _ATTITUDE, "-")):
        tip = radius * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
        artists += axes.plot([0.0, tip[0]], [0.0, tip[1]], color=colour, lw=1.4, ls=style)
    return [*artists, _robot_artist(axes, scene, row, _base_track(scene)[row])]


def _heading_axis(scene: _Scene) -> Array:
    """(3,) the axis of the base that points most to the right at the start."""
    components = scene.axes[0] @ scene.frames.rotations[0, 0]
    chosen = int(np.argmax(np.abs(components)))
    heading = np.zeros(3)
    heading[chosen] = np.sign(components[chosen])
    return heading


def _draw_clearance_curve(axes: Axes, scene: _Scene) -> None:
    """Clearance along the motion, the proven clearance and contact."""
    clearances = scene.clearances
    axes.set(xlim=(0, len(clearances) - 1), ylim=(0.0, 1.0))
    if not np.isfinite(clearances).all():
        return
    axes.set_ylim(-0.03 * clearances.max(), 1.1 * max(float(clearances.max()), 1e-9))
    axes.axhline(0.0, color=_CONTACT, lw=1.0)
    least = scene.plan.certificate.least_clearance
    axes.axhline(least, color=_CLEARANCE, lw=0.9, ls=_DASHES)
    axes.plot(clearances, color=_CLEARANCE, lw=1.4)


def _figure_artists(axes: Axes, scene: _Scene, row: int) -> list[Artist]:
    """The current point of the clearance curve, and above it the figures of the frame."""
    attitudes = scene.frames.configurations[:, 3:7]
    rotation = float(np.degrees(angle_between(attitudes[0], attitudes[row])))
    clearance = float(scene.clearances[row])
    words = [(0.0, f"base rotated {rotation:.1f}° by the arms", _ATTITUDE)]
    if not scene.plan.problem.mode.attitude_reacts:
        words = [(0.0, f"base rotated {rotation:.1f}°", _ATTITUDE)]
    artists: list[Artist] = []
    if np.isfinite(clearance):
        least = proven(scene.plan.certificate.least_clearance)
        words.append((0.46, f"clearance {clearance:.2f} m", _STRONG))
        words.append((0.74, f"proven ≥ {least}", _CLEARANCE))
        artists += axes.plot([row], [clearance], "o", color=_STRONG, ms=5, clip_on=False)
    for x, text, colour in words:
        artists.append(axes.text(x, 1.13, text, color=colour, fontsize=9, transform=axes.transAxes))
    return artists
