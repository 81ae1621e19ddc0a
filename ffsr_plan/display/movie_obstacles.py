"""Shaded obstacles of moving pictures, with rings at the proven clearance."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ffsr_plan.display.scenes.projection import convex_outline
from ffsr_plan.display.scenes.shape_outlines import outline_of, section, shaded_sides
from ffsr_plan.scene.shapes.obstacle_shapes import placed_axes

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

    from ffsr_plan.core.arrays import Array, Flags
    from ffsr_plan.scene.scene import Scene
    from ffsr_plan.scene.shapes.obstacle_shapes import ObstacleShape

RINGS, OBSTACLE, MOVING, DASHES = "#5fb3ce", "#aeb4bf", "#e07bb0", (0, (4, 3))
_LIGHT = np.array([-0.45, 0.55, 0.7]) / np.linalg.norm([-0.45, 0.55, 0.7])  # along the view axes
_SHADE = 0.16  # brightness of what faces away from the light
_EDGE = "#41464f"
_FLAT = 1e-6  # [m] by which obstacles and track may leave the plane of motion


class Ring(NamedTuple):
    """Where rings are drawn.

    Attributes:
        distance: of them from the obstacles [m].
        height: of the plane of motion towards the viewer [m].
    """

    distance: float
    height: float


def draw_shaded(
    axes: Axes, scene: Scene, view: Array, solid: Flags, origins: Array, ring: float | None
) -> None:
    """Shaded spheres and shapes, faint if they are not solid; rings in the plane of motion.

    Args:
        axes: the axes.
        scene: the obstacles.
        view: (3, 3) view axes.
        solid: (N + S,) see `drawn_solid`.
        origins: (n, 3) base origins along the motion [m].
        ring: distance of the rings from the obstacles [m]; None for no rings. They are drawn where
            the track and the middles of all spheres lie in one plane, which they cut.
    """
    local, count = scene.centers @ view.T, len(scene.radii)
    ball = _shaded_ball()
    around = ring_of(scene, view, origins, ring)
    middles = [view[2] @ placed_axes(shape)[1] for shape in scene.shapes]
    for k in np.argsort([*local[:, 2], *middles], kind="stable"):
        if k < count:
            radius = float(scene.radii[k])
            _draw_ball(axes, ball, local[k, :2], radius, bool(solid[k]), around)
        else:
            _draw_shape(axes, scene.shapes[k - count], view, bool(solid[k]), around)


def ring_of(scene: Scene, view: Array, origins: Array, ring: float | None) -> Ring | None:
    """Where rings are drawn, if they are; arguments as of `draw_shaded`."""
    heights = np.append(scene.centers @ view[2], origins @ view[2])
    in_plane = np.ptp(heights) < _FLAT
    return Ring(ring, float(heights[-1])) if ring is not None and in_plane else None


def _draw_ball(
    axes: Axes, ball: Array, center: Array, radius: float, solid: bool, ring: Ring | None
) -> None:
    """A sphere from a picture of one, or a faint disc; with a ring."""
    from matplotlib.patches import Circle

    x, y = center.tolist()
    if not solid:
        axes.add_patch(Circle((x, y), radius, color=OBSTACLE, alpha=0.08, zorder=1.5, lw=0))
        return
    box = (x - radius, x + radius, y - radius, y + radius)
    axes.imshow(ball, extent=box, zorder=2, interpolation="bilinear", aspect="auto")
    if ring is not None:
        circle = Circle((x, y), radius + ring.distance, fill=False, color=RINGS, zorder=2)
        circle.set(alpha=0.55, linewidth=0.9, linestyle=DASHES)
        axes.add_patch(circle)


def _draw_shape(
    axes: Axes, shape: ObstacleShape, view: Array, solid: bool, ring: Ring | None
) -> None:
    """A shaded shape, or a faint outline of it."""
    from matplotlib.patches import Polygon

    if not solid:
        outline = outline_of(shape, view[:2])
        axes.add_patch(Polygon(outline, color=OBSTACLE, alpha=0.08, zorder=1.5, lw=0))
        return
    shaded_shape(axes, shape, view, ring, OBSTACLE)


def shaded_shape(
    axes: Axes, shape: ObstacleShape, view: Array, ring: Ring | None, colour: str
) -> list[Artist]:
    """Draw the sides of a shape that face the viewer; with a ring around its cut by the plane.

    Args:
        axes: the axes.
        shape: the shape.
        view: (3, 3) view axes.
        ring: where the ring is; None for none.
        colour: of the sides in full light.

    Returns:
        What was drawn, in the order in which it was.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb
    from matplotlib.patches import Polygon

    triangles, light = shaded_sides(shape, view, _LIGHT)
    colours = (_SHADE + (1.0 - _SHADE) * light)[:, None] * to_rgb(colour)
    sides = PolyCollection(list(triangles), facecolors=colours, linewidths=0.0, zorder=2)
    sides.set_antialiased(False)  # smooth edges of two neighbours would leave a seam between them
    axes.add_collection(sides, autolim=False)
    edge = Polygon(outline_of(shape, view[:2]), fill=False, color=_EDGE, lw=0.8, zorder=2)
    axes.add_patch(edge)
    drawn: list[Artist] = [sides, edge]
    cut = np.zeros((0, 2)) if ring is None else section(shape, view, ring.height)
    if ring is not None and len(cut):
        turn = np.linspace(0.0, 2.0 * np.pi, 72, endpoint=False)
        circle = ring.distance * np.column_stack([np.cos(turn), np.sin(turn)])
        corners = convex_outline((cut[:, None] + circle).reshape(-1, 2))
        around = Polygon(corners, fill=False, color=RINGS, zorder=2)
        around.set(alpha=0.55, linewidth=0.9, linestyle=DASHES)
        axes.add_patch(around)
        drawn.append(around)
    return drawn


def _shaded_ball(pixels: int = 96) -> Array:
    """(pixels, pixels, 4) picture of a grey ball, lit from the upper left."""
    from matplotlib.colors import to_rgb

    x, y = np.meshgrid(*2 * [np.linspace(-1.0, 1.0, pixels)])
    y = -y
    inside = x**2 + y**2 <= 1.0
    z = np.sqrt(np.clip(1.0 - x**2 - y**2, 0.0, None))
    light = np.clip(_LIGHT[0] * x + _LIGHT[1] * y + _LIGHT[2] * z, 0, 1)
    ball = np.zeros((pixels, pixels, 4))
    ball[..., :3] = (_SHADE + (1.0 - _SHADE) * light)[..., None] * to_rgb(OBSTACLE)
    ball[..., 3] = inside
    return ball
