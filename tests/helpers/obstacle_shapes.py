"""Random obstacles of every shape, and how far they reach along directions."""

import numpy as np
from scipy.spatial.transform import Rotation

from ffsr_plan.scene.shapes.obstacle_shapes import Ball, Box, Capsule, Cylinder, Ellipsoid, Hull

KINDS = ("box", "ball", "capsule", "cylinder", "ellipsoid", "hull")


def random_shape(rng, kind, low, high):
    """An obstacle of some decimetres, its middle in a box."""
    place, angles = rng.uniform(low, high), rng.uniform(-3.0, 3.0, 3)
    size = rng.uniform(0.1, 0.6, 3)
    if kind == "box":
        return Box(2.0 * size, place, angles)
    if kind == "ball":
        return Ball(size[0], place)
    if kind == "capsule":
        return Capsule(size[0], 2.0 * size[1], place, angles)
    if kind == "cylinder":
        return Cylinder(size[0], 2.0 * size[1], place, angles)
    if kind == "ellipsoid":
        return Ellipsoid(size, place, angles)
    return Hull(rng.normal(size=(20, 3)) * size, place, angles)


def support(shape, directions):
    """(n,) how far a shape reaches along unit directions (n, 3), world [m]."""
    local = Rotation.from_quat(shape.attitude).inv().apply(directions)
    middle = directions @ shape.position
    if isinstance(shape, Box):
        return middle + np.abs(local) @ (0.5 * shape.size)
    if isinstance(shape, Ball):
        return middle + shape.radius
    if isinstance(shape, Capsule):
        return middle + 0.5 * shape.length * np.abs(local[:, 2]) + shape.radius
    if isinstance(shape, Cylinder):
        round_part = shape.radius * np.hypot(local[:, 0], local[:, 1])
        return middle + round_part + 0.5 * shape.length * np.abs(local[:, 2])
    if isinstance(shape, Ellipsoid):
        return middle + np.linalg.norm(local * shape.semi_axes, axis=1)
    return middle + np.max(local @ shape.points.T, axis=1)
