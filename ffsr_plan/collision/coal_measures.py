"""Coal's distances of the robot's shapes to obstacles.

Coal's depths with round faces are wrong where a cylinder or an ellipsoid is penetrated: by up to
1.5 m, more often at sharp tolerances. Where such an obstacle is penetrated its distance therefore
counts as zero, which is not below the truth: it is blocked, and nothing else is concluded from it.
"""

from __future__ import annotations

from itertools import product

import coal
import numpy as np

from ffsr_plan.collision.shape_placements import Placements
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.meshes.mesh_files import hull
from ffsr_plan.robots.collision_shapes import convex, sharpen
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.robots.shape_arrays import BOX
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.obstacle_shapes import (
    Ball,
    Box,
    Capsule,
    Cylinder,
    Ellipsoid,
    Hull,
    ObstacleShape,
)

_ROUND_FACES = (Cylinder, Ellipsoid)
ITERATION_ERROR = 1e-7
"""[m] for distances that Coal iterates to 1e-8."""
_RELATIVE_ITERATION_ERROR = 4e-9  # for each metre between the centres of the two shapes


def iteration_error(robot: SpaceRobot, scene: Scene) -> float:
    """Bound on the error of distances that Coal iterates [m]; zero where none is.

    Args:
        robot: the robot.
        scene: the obstacles.
    """
    if bool(robot.primitives.exact.all()) and scene.is_closed_form:
        return 0.0
    largest = float(np.max(scene.tree.spheres[:, 3], initial=0.0))
    return ITERATION_ERROR + _RELATIVE_ITERATION_ERROR * largest


def solid_of(shape: ObstacleShape) -> coal.CollisionGeometry:
    """A shape as a Coal solid, in its own axes.

    Args:
        shape: the shape.
    """
    if isinstance(shape, Box):
        return coal.Box(*shape.size)
    if isinstance(shape, Ball):
        return coal.Sphere(shape.radius)
    if isinstance(shape, Capsule):
        return coal.Capsule(shape.radius, shape.length)
    if isinstance(shape, Cylinder):
        return coal.Cylinder(shape.radius, shape.length)
    if isinstance(shape, Ellipsoid):
        return coal.Ellipsoid(*shape.semi_axes)
    assert isinstance(shape, Hull)
    corners, triangles = hull(shape.points, "", shape.name)
    return convex(corners, triangles)


class CoalMeasures:
    """Distances of single pairs of a shape of the robot and an obstacle.

    Obstacles are told by their rows, see `distance_to_obstacle`. It contains scratch data: every
    thread needs its own.

    Attributes:
        spheres_only: whether all obstacles are spheres.
    """

    def __init__(self, robot: SpaceRobot, scene: Scene) -> None:
        """Prepare the measurements.

        Args:
            robot: the robot.
            scene: the obstacles.
        """
        self._tree, self._scene, self._shapes = scene.tree, scene, robot.primitives
        self._solids = [shape.geometry for shape in robot.collision_model.geometryObjects]
        self._ball = coal.Sphere(1.0)
        self._to_ball = [coal.ComputeDistance(solid, self._ball) for solid in self._solids]
        self._to_shape: dict[tuple[int, int], coal.ComputeDistance] = {}
        self._obstacles: dict[int, tuple[coal.CollisionGeometry, coal.Transform3s]] = {}
        self._request = coal.DistanceRequest()
        sharpen(self._request)
        self._result = coal.DistanceResult()
        self._in_shape = coal.Transform3s.Identity(), coal.Transform3s.Identity()
        self._in_world = coal.Transform3s.Identity()
        self.spheres_only = not scene.shapes and not scene.keep_in
        self._corners = [
            self._corners_of(k) for k in range(len(self._solids) * bool(scene.keep_in))
        ]

    def to_spheres(self, shapes: list[int], radii: list[float], centers: Array) -> list[float]:
        """Distances of shapes to spheres whose centres are in the frames of the shapes.

        One ball and one placement serve all pairs.

        Args:
            shapes: (n) shapes of the robot.
            radii: (n) of the spheres [m].
            centers: (n, 3) of the spheres, in the frames of the shapes [m].
        """
        ball, request, result = self._ball, self._request, self._result
        shape_frame, ball_frame = self._in_shape
        distances, present = [], None
        for shape, radius, center in zip(shapes, radii, centers, strict=True):
            if radius != present:
                ball.radius = present = radius
            ball_frame.setTranslation(center)
            result.clear()  # a new one would take longer than the measurement
            distances.append(self._to_ball[shape](shape_frame, ball_frame, request, result))
        return distances

    def reach(self, placed: Placements, directions: Array) -> Array:
        """How far all shapes of the robot extend in a scene with zones.

        Args:
            placed: one placement of the shapes.
            directions: (d, 3) unit vectors, world axes.

        Returns:
            (d,) along each of them, from the world's origin [m].
        """
        found = np.full(len(directions), -np.inf)
        for k, (corners, skin) in enumerate(self._corners):
            points = corners @ placed.rotations[0, k].T + placed.positions[0, k]
            found = np.maximum(found, (points @ directions.T).max(axis=0) + skin)
        return found

    def is_sphere(self, row: int) -> bool:
        """Whether an obstacle is a sphere.

        Args:
            row: of the obstacle.
        """
        if self.spheres_only:
            return True
        tree = self._tree
        return row < len(tree.spheres) and (len(tree.solid) == 0 or int(tree.solid[row]) < 0)

    def distance(
        self, shape: int, row: int, rotation: Array, position: Array
    ) -> tuple[float, Array]:
        """Distance of a shape and any obstacle, and how it changes as the shape is moved.

        Args:
            shape: of the robot.
            row: of the obstacle.
            rotation: (3, 3) of the shape in the world.
            position: (3,) of the shape in the world [m].

        Returns:
            The distance [m], negative by the depth, and (3,) its gradient by the position of the
            shape, world axes.
        """
        tree = self._tree
        if row >= len(tree.spheres):
            return self._in_zone(shape, row, rotation, position)
        if self.is_sphere(row):
            center = (rotation.T @ (tree.spheres[row, :3] - position))[None]
            (found,) = self.to_spheres([shape], [float(tree.spheres[row, 3])], center)
            return found, -rotation @ np.asarray(self._result.normal)
        return self._to_obstacle(shape, int(tree.solid[row]), rotation, position)

    def _to_obstacle(
        self, shape: int, number: int, rotation: Array, position: Array
    ) -> tuple[float, Array]:
        """Distance of a shape of the robot and a shape of the scene, and its gradient."""
        obstacle = self._scene.shapes[number]
        if number not in self._obstacles:
            turn = rotations.matrix(obstacle.attitude)
            placed = coal.Transform3s(turn, np.array(obstacle.position))
            self._obstacles[number] = solid_of(obstacle), placed
        solid, placed = self._obstacles[number]
        if (shape, number) not in self._to_shape:
            self._to_shape[shape, number] = coal.ComputeDistance(self._solids[shape], solid)
        self._in_world.setRotation(rotation)
        self._in_world.setTranslation(position)
        self._result.clear()
        measure = self._to_shape[shape, number]
        found = measure(self._in_world, placed, self._request, self._result)
        if found < 0.0 and isinstance(obstacle, _ROUND_FACES):
            found = 0.0
        return float(found) - self._scene.growth, -np.asarray(self._result.normal)

    def _in_zone(
        self, shape: int, row: int, rotation: Array, position: Array
    ) -> tuple[float, Array]:
        """Distance of a shape to the outside of a zone, and its gradient."""
        tree, place = self._tree, row - len(self._tree.spheres)
        corners, skin = self._corners[shape]
        points = corners @ rotation.T + position
        if place < len(tree.planes):
            plane = tree.planes[place]
            room = plane[3] - points @ plane[:3]
            return float(room.min()) - skin, -plane[:3]
        ball = tree.balls[place - len(tree.planes)]
        away = points - ball[:3]
        reach = np.linalg.norm(away, axis=1)
        far = int(np.argmax(reach))
        gradient = -away[far] / reach[far] if reach[far] > 0.0 else np.zeros(3)
        return float(ball[3] - reach[far]) - skin, gradient

    def _corners_of(self, shape: int) -> tuple[Array, float]:
        """Corners (n, 3) of a shape of the robot in its frame, and its radius around them [m]."""
        solid, size = self._solids[shape], self._shapes.sizes[shape]
        if isinstance(solid, coal.Convex):
            return np.array([solid.point(k) for k in range(solid.num_points)]), 0.0
        if self._shapes.kinds[shape] == BOX:
            return np.array(list(product((-1.0, 1.0), repeat=3))) * size, 0.0
        return np.array([[0.0, 0.0, -size[1]], [0.0, 0.0, size[1]]]), float(size[0])
