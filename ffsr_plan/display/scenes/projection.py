"""Orthographic projection of scenes and robots onto the plane of a picture."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple, Protocol

import coal
import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import Array
from ffsr_plan.display.scenes.picture_data import MotionFrames
from ffsr_plan.lattice.layered_lattice import path_frame
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene

STILL = 1e-9  # distance [m] of start and goal below which the base stays on the spot
VIEWS = {"path": (0, 1, 2), "side": (0, 2, 1)}
"""Rows of the view axes that point to the right, upwards and towards the viewer."""
SHAPES = ("visual", "collision")
_LEAST_RADIUS = 0.02  # of drawn spheres and capsules [m], so that points are visible
_CIRCLE = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
_RING = np.column_stack([np.cos(_CIRCLE), np.sin(_CIRCLE)])


class ShownProblem(Protocol):
    """A robot among obstacles: a problem, or any motion that a page plays."""

    @property
    def robot(self) -> SpaceRobot:
        """The robot."""

    @property
    def scene(self) -> Scene:
        """The obstacles as they are."""

    @property
    def obstacles(self) -> Scene:
        """The obstacles as clearances count from them."""

    @property
    def base_displacement(self) -> Array:
        """(3,) from the base's start to its end, world axes [m]; zero where it floats."""


class Outline(NamedTuple):
    """A shape of a robot as it is seen in a picture.

    Attributes:
        polygon: (k, 2) convex outline, to the right and upwards in the picture [m].
        height: of the middle of the shape towards the viewer [m].
        colour: (3,) red, green and blue in [0, 1].
    """

    polygon: Array
    height: float
    colour: tuple[float, float, float]


def view_axes(problem: ShownProblem) -> Array:
    """Directions of the picture in world axes.

    Args:
        problem: gives the path frame. If the base stays on the spot, world axes are used.

    Returns:
        (3, 3) rows: z' to the right, x' upwards in the picture, y' towards the viewer.
    """
    if np.linalg.norm(problem.base_displacement) < STILL:
        return np.eye(3)
    frame = path_frame(problem.base_displacement)
    return np.array([frame[:, 2], frame[:, 0], frame[:, 1]])


def visible_shapes(robot: SpaceRobot, shapes: str = "visual") -> list[pin.GeometryObject]:
    """Shapes of a robot that pictures show.

    Args:
        robot: the robot.
        shapes: `visual` for the visual shapes of all links, meshes included, and the collision
            shapes of links that have no visual ones; `collision` for all collision shapes.
    """
    if shapes == "collision":
        return list(robot.collision_model.geometryObjects)
    visible = list(robot.visual_model.geometryObjects)
    links = {shape.parentFrame for shape in visible}
    return visible + [
        g for g in robot.collision_model.geometryObjects if g.parentFrame not in links
    ]


def outlines(
    shapes: list[pin.GeometryObject], frames: MotionFrames, row: int, axes: Array
) -> list[Outline]:
    """Outlines of shapes at one configuration.

    Args:
        shapes: shapes of the robot, in any order.
        frames: poses of the robot's links.
        row: which configuration of `frames`.
        axes: (3, 3) view axes, see `view_axes`.

    Returns:
        One outline a shape, in the same order.
    """
    drawn = []
    for shape in shapes:
        points, radius = hull_points(shape)
        link = shape.parentJoint - 1
        points = points @ shape.placement.rotation.T + shape.placement.translation
        world = points @ frames.rotations[row, link].T + frames.origins[row, link]
        local = world @ axes.T
        flat = local[:, :2]
        if radius > 0.0:
            flat = (flat[:, None] + max(radius, _LEAST_RADIUS) * _RING).reshape(-1, 2)
        red, green, blue = (float(c) for c in shape.meshColor[:3])
        drawn.append(Outline(convex_outline(flat), float(local[:, 2].mean()), (red, green, blue)))
    return drawn


def hull_points(shape: pin.GeometryObject) -> tuple[Array, float]:
    """Points (k, 3) and a radius [m]: the shape lies in the hull of balls around the points."""
    solid = shape.geometry
    if isinstance(solid, coal.Box):
        return np.array(list(product((-1.0, 1.0), repeat=3))) * solid.halfSide, 0.0
    if isinstance(solid, coal.Sphere):
        return np.zeros((1, 3)), float(solid.radius)
    if isinstance(solid, coal.Capsule):
        return np.array(
            [[0.0, 0.0, z] for z in (-solid.halfLength, solid.halfLength)]
        ), solid.radius
    if isinstance(solid, coal.Cylinder):
        rims = [np.insert(solid.radius * _RING, 2, z, axis=1) for z in (-1.0, 1.0)]
        return np.vstack(rims) * [1.0, 1.0, solid.halfLength], 0.0
    if isinstance(solid, coal.Convex):
        return np.array(solid.points()), 0.0
    return np.array(solid.vertices()) * np.asarray(shape.meshScale), 0.0


def convex_outline(points: Array) -> Array:
    """Corners of the convex hull in the plane, counter-clockwise.

    Args:
        points: (n, 2) [m]; if they lie on one line, the outline is a sliver around it.

    Returns:
        (k, 2) [m].
    """
    from scipy.spatial import ConvexHull, QhullError

    try:
        return points[ConvexHull(points).vertices]
    except QhullError:
        return points[ConvexHull(points, qhull_options="QJ").vertices]
