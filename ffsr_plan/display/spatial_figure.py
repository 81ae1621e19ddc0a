"""Figure of a motion among obstacles in perspective, with the axes of the world.

matplotlib sorts the faces of one collection by their distance, but not those of several. All
solids, and the track, are therefore faces of one collection.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.display.body_drawing import (
    MOST_LABELLED,
    chosen_rows,
    legend_text,
    shades,
    timed_labels,
)
from ffsr_plan.display.path_drawing import NUMBERED, mark_ends
from ffsr_plan.display.scenes.body_tracks import BodyTrack, body_tracks, points_near
from ffsr_plan.display.scenes.debris_track import DebrisTrack, debris_track
from ffsr_plan.display.scenes.projection import hull_points, view_axes
from ffsr_plan.display.scenes.shape_outlines import (
    labels,
    mesh_of,
    points_of_extent,
    unit_normals,
)
from ffsr_plan.display.scenes.zone_outlines import dashed, legend_of, lines_of

if TYPE_CHECKING:
    import pinocchio as pin
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ffsr_plan.core.arrays import Array, Flags
    from ffsr_plan.display.figure_style import Style
    from ffsr_plan.display.scenes.picture_data import MotionFrames
    from ffsr_plan.problem.problem import Problem
    from ffsr_plan.scene.scene import Scene
    from ffsr_plan.scene.shapes.keep_in_zones import Zone
    from ffsr_plan.scene.shapes.obstacle_shapes import ObstacleShape

_TURN, _ELEVATION = 68.0, 28.0  # of the viewer from the direction of the path, from the plane [deg]
_LIGHT = np.array([-0.45, -0.55, 0.70]) / np.linalg.norm([-0.45, -0.55, 0.70])  # towards it
_DARKEST = 0.42  # brightness of faces that turn away from the light
_TALLEST = 0.85  # half of the height in the picture at which it is as large as it may be
_TRACK_WIDTH = 0.006  # of the largest extent
_LONGEST = 0.15  # side of a face, in extents of its shape


class _Faces(NamedTuple):
    """Faces of solids.

    Attributes:
        polygons: corners (k, 3) of each [m].
        colours: red, green, blue and opacity of each.
    """

    polygons: list[Array]
    colours: list[Array]

    def add(self, polygons: Array, colour: str, alpha: float) -> None:
        """Add faces (n, k, 3) of one colour and opacity in light, counter-clockwise outside."""
        from matplotlib.colors import to_rgb

        lit = np.clip(unit_normals(polygons) @ _LIGHT, 0.0, 1.0)
        light = (_DARKEST + (1.0 - _DARKEST) * lit)[:, None]
        self.polygons.extend(polygons)
        self.colours.extend(np.hstack([light * to_rgb(colour), np.full_like(light, alpha)]))

    def add_at_rest(self, scene: Scene, solid: Flags, colour: str) -> None:
        """Add the spheres and shapes of a scene that are `solid` (N + S,)."""
        ball, count = _ball(10), len(scene.radii)
        for each in np.flatnonzero(solid[:count]):
            self.add(scene.centers[each] + scene.radii[each] * ball, colour, 1.0)
        for each in np.flatnonzero(solid[count:]):
            self.add(_shape(scene.shapes[each]), colour, 1.0)

    def add_bodies(self, tracks: Sequence[BodyTrack], rows: Sequence[int], colour: str) -> None:
        """Add bodies that move as they are in some frames, from light to dark."""
        from matplotlib.colors import to_hex

        for row, shade in zip(rows, shades(colour, len(rows)), strict=True):
            for shape in (shape for track in tracks for shape in track.shapes(row)):
                self.add(_shape(shape), to_hex(shade), 0.8)

    def add_debris(
        self, debris: DebrisTrack, rows: Sequence[int], limits: tuple[Array, Array], colour: str
    ) -> None:
        """Add debris between limits (3,) as it is in some frames, from light to dark."""
        from matplotlib.colors import to_hex

        for row, shade in zip(rows, shades(colour, len(rows)), strict=True):
            centers = debris.centers(row)
            near = np.all((centers > limits[0]) & (centers < limits[1]), axis=1)
            for center, radius in zip(centers[near], debris.radii[near], strict=True):
                self.add(center + radius * _ball(6), to_hex(shade), 0.8)

    def add_bright(self, polygons: Array, colour: str) -> None:
        """Add faces (n, k, 3) of one colour that light does not change."""
        from matplotlib.colors import to_rgba

        self.polygons.extend(polygons)
        self.colours.extend([np.array(to_rgba(colour))] * len(polygons))


def spatial_figure(
    problem: Problem,
    frames: MotionFrames,
    rows: Sequence[int],
    solid: Flags,
    style: Style,
    ax: Axes | None = None,
    title: str = "",
    times: Array | None = None,
) -> Figure:
    """Obstacles, the robot at several times and the track of its base in perspective.

    Args:
        problem: what is shown.
        frames: poses of the robot's links along the motion.
        rows: of the poses at which the robot is drawn.
        solid: (N + S,) spheres and shapes that are drawn; others would hide the robot.
        style: has `path`, `start`, `goal`, `robot`, `obstacles`, `bodies` and `zones`.
        ax: axes to draw on, with `projection="3d"`; by default those of a new figure.
        title: of the figure.
        times: (N,) of the poses [s]; what moves is drawn at up to five of those of the rows.

    Raises:
        InvalidInput: axes that are not in 3-D, or something moves and there are no times.
    """
    bodies, debris = body_tracks(problem.scene, times), debris_track(problem.scene, times)
    figure, ax3 = _axes_in_space(ax)
    faces, scene = _Faces([], []), problem.scene
    faces.add_at_rest(scene, solid, style.colour("obstacles"))
    for row in rows:
        at_end = row in (rows[0], rows[-1])
        name = "robot" if not at_end else "start" if row == rows[0] else "goal"
        faces.add(_robot(frames, row), style.colour(name), 0.9 if at_end else 0.35)
    cloud = np.vstack([*faces.polygons, frames.origins[:, 0], points_of_extent(scene)])
    cloud = np.vstack([cloud, points_near(bodies, cloud, np.eye(3))])
    faces.add_bodies(bodies, chosen_rows(rows), style.colour("bodies"))
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    faces.add_debris(debris, chosen_rows(rows), (low, high), style.colour("bodies"))
    track = frames.origins[:, 0]
    faces.add_bright(_tube(track, _TRACK_WIDTH * float(np.max(high - low))), style.colour("path"))
    _draw(ax3, faces)
    ax3.plot([], [], color=style.colour("path"), lw=2.0, label=style.label("path"))
    mark_ends(ax3, style)
    if len(scene.radii) + len(scene.shapes) <= NUMBERED:
        for k, center in enumerate(scene.centers):
            x, y, z = center + np.array([0.0, 0.0, 1.25 * scene.radii[k]])
            ax3.text(x, y, z, str(k), ha="center", fontsize=8)
        for label in labels(scene):
            x, y, z = *label.at[:2], label.top + 0.02 * float(np.max(high - low))
            ax3.text(x, y, z, label.text, ha="center", fontsize=8)
    if scene.moves:
        _write_times(ax3, debris.times, bodies, frames, chosen_rows(rows), (low, high), style)
    _set_view(ax3, problem, low, high)
    _draw_zones(ax3, scene.keep_in, low, high, style)
    columns = 4 if scene.keep_in or scene.moves else 3
    ax3.legend(frameon=False, loc="upper center", bbox_to_anchor=(0.5, 0.02), ncols=columns)
    ax3.set_title(title)
    return figure


def _write_times(
    ax: Any,  # noqa: ANN401 - axes in 3-D have no types
    times: Array,
    bodies: Sequence[BodyTrack],
    frames: MotionFrames,
    rows: Sequence[int],
    limits: tuple[Array, Array],
    style: Style,
) -> None:
    """Times of the robot, and in their colour those of few bodies, and an entry in the legend."""
    legend = legend_text(style, times[list(rows)])
    ax.plot([], [], "s", ms=7, color=style.colour("bodies"), label=legend)
    size = float(np.max(limits[1] - limits[0]))
    box = {"boxstyle": "round,pad=0.1", "fc": "white", "ec": "none", "alpha": 0.7}
    origins = frames.origins[:, 0]
    written = [(f"{times[row]:.3g} s", origins[row], "black") for row in rows]
    for track in bodies if len(bodies) <= MOST_LABELLED else ():
        labelled = timed_labels(track, rows, np.eye(3), size)
        written += [(*label, style.colour("bodies")) for label in labelled]
    look: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": 8, "zorder": 1e7}
    for text, place, colour in written:
        if np.all((place >= limits[0]) & (place <= limits[1])):
            ax.text(*place, text, color=colour, bbox=box, **look)


def _draw_zones(
    ax: Any,  # noqa: ANN401 - axes in 3-D have no types
    zones: Sequence[Zone],
    low: Array,
    high: Array,
    style: Style,
) -> None:
    """Dashed lines of zones: those on the far side behind all solids, the others before them."""
    from mpl_toolkits.mplot3d.art3d import Line3D

    rise, turn = np.radians(ax.elev), np.radians(ax.azim)
    viewer = np.array([np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise)])
    colour = style.colour("zones")
    for zone in zones:
        found = lines_of(zone, low, high)
        behind = found.outward @ viewer < -1e-9
        for chosen, zorder in ((behind, 0.0), (~behind, 1e6)):
            dashes = dashed(found.segments[chosen], float(np.max(high - low)))
            gaps = np.full((len(dashes), 1, 3), np.nan)
            x, y, z = np.concatenate([dashes, gaps], axis=1).reshape(-1, 3).T
            ax.add_line(Line3D(x, y, z, color=colour, lw=0.9, zorder=zorder, clip_on=False))
    if zones:
        label = legend_of(zones, style.label("zones"), 40)
        ax.plot([], [], color=colour, lw=0.9, ls=(0, (5, 3)), label=label)


def _shape(shape: ObstacleShape) -> Array:
    """(n, 3, 3) triangles of a shape, the long ones cut: faces are sorted by their middles."""
    triangles = mesh_of(shape, 12).triangles
    longest = _LONGEST * float(np.max(np.ptp(triangles.reshape(-1, 3), axis=0)))
    for _ in range(6):
        sides = np.linalg.norm(triangles - np.roll(triangles, -1, axis=1), axis=2)
        long = sides.max(axis=1) > longest
        if not long.any():
            break
        cut, side = triangles[long], np.argmax(sides[long], axis=1)
        row = np.arange(len(cut))
        a, b, c = (cut[row, (side + k) % 3] for k in range(3))
        middle = 0.5 * (a + b)
        halves = [np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)]
        triangles = np.concatenate([triangles[~long], *halves])
    return triangles


def _axes_in_space(ax: Axes | None) -> tuple[Figure, Any]:
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D

    if ax is not None:
        figure = ax.get_figure(root=True) if isinstance(ax, Axes3D) else None
        if figure is None:
            raise InvalidInput("ax", ax, 'axes with projection="3d" for the view 3d')
        return figure, ax
    figure = Figure(figsize=(9.0, 5.2), layout="constrained")
    return figure, figure.add_subplot(projection="3d")


def _draw(ax: Any, faces: _Faces) -> None:  # noqa: ANN401 - axes in 3-D have no types
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    colours = np.array(faces.colours)
    edges = colours * np.where(colours[:, 3:] < 1.0, [1.0, 1.0, 1.0, 0.0], 1.0)  # closes seams
    solids = Poly3DCollection(
        faces.polygons, facecolors=colours, edgecolors=edges, linewidths=0.3, clip_on=False
    )
    ax.add_collection3d(solids)


def _set_view(ax: Any, problem: Problem, low: Array, high: Array) -> None:  # noqa: ANN401
    """Limits, equal scales, and a viewer for whom the path runs from left to right."""
    middle, half = 0.5 * (low + high), 0.5 * np.maximum(high - low, 0.12 * np.max(high - low))
    for k, name in enumerate("xyz"):
        getattr(ax, f"set_{name}lim")(middle[k] - half[k], middle[k] + half[k])
        getattr(ax, f"set_{name}label")(f"{name} [m]")
    along = view_axes(problem)[0]
    turn = np.arctan2(along[1], along[0]) - np.radians(_TURN)
    rise, unit = np.radians(_ELEVATION), half / np.linalg.norm(half)
    depth = abs(np.cos(turn)) * unit[0] + abs(np.sin(turn)) * unit[1]
    tall = np.cos(rise) * unit[2] + np.sin(rise) * depth  # half of the height in the picture
    ax.set_box_aspect(half, zoom=min(1.4, _TALLEST / tall))
    ax.view_init(elev=_ELEVATION, azim=np.degrees(turn))
    for name, size in zip("xyz", half, strict=True):
        if size < 0.25 * np.max(half):
            getattr(ax, f"{name}axis").set_major_locator(_few_ticks())


def _few_ticks() -> Any:  # noqa: ANN401
    from matplotlib.ticker import MaxNLocator

    return MaxNLocator(2)


def _robot(frames: MotionFrames, row: int) -> Array:
    """(n, 3, 3) triangles of the collision shapes in the world at one pose."""
    triangles = []
    for shape in frames.robot.collision_model.geometryObjects:
        link = shape.parentJoint - 1
        local = shape_triangles(shape)
        world = local @ frames.rotations[row, link].T + frames.origins[row, link]
        triangles.append(world)
    return np.concatenate(triangles)


def shape_triangles(shape: pin.GeometryObject) -> Array:
    """(k, 3, 3) triangles of the convex hull of a shape, in axes of its link [m]."""
    from scipy.spatial import ConvexHull

    points, radius = hull_points(shape)
    if radius > 0.0:
        directions = np.unique(np.round(_ball(6).reshape(-1, 3), 9), axis=0)
        points = (points[:, None] + radius * directions).reshape(-1, 3)
    hull = ConvexHull(points, qhull_options="QJ")
    corners = points[hull.simplices]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.sum(normal * hull.equations[:, :3], axis=1) < 0.0
    corners[inward] = corners[inward][:, ::-1]  # shading asks for the outer side
    return corners @ shape.placement.rotation.T + shape.placement.translation


def _ball(rings: int) -> Array:
    """(k, 4, 3) faces of a unit sphere with `rings` parallels of latitude."""
    rise = np.linspace(-np.pi / 2.0, np.pi / 2.0, rings + 1)
    turn = np.linspace(0.0, 2.0 * np.pi, 2 * rings + 1)
    flat = np.cos(rise)[:, None]
    grid = np.stack(
        [flat * np.cos(turn), flat * np.sin(turn), np.sin(rise)[:, None] + 0.0 * turn], axis=-1
    )
    corners = (grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1])
    return np.stack(corners, axis=2).reshape(-1, 4, 3)


def _tube(points: Array, width: float) -> Array:
    """(n, 4, 3) two crossed bands along each step of a track (N, 3), so that all viewers see it."""
    steps = np.diff(points, axis=0)
    moves = np.linalg.norm(steps, axis=1) > 0.0
    begin, steps = points[:-1][moves], steps[moves]
    bands, side = [], np.eye(3)[np.argmin(np.abs(steps), axis=1)]
    for _ in range(2):
        side = np.cross(steps, side)
        side *= 0.5 * width / np.linalg.norm(side, axis=1, keepdims=True)
        end = begin + steps
        bands.append(np.stack([begin - side, end - side, end + side, begin + side], axis=1))
    return np.concatenate(bands)
