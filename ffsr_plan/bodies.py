"""A second reading of a robot's URDF, for verification alone.

It shares nothing with the planner: yourdfpy parses, and the kinematics, closed-form distances and
velocities here are plain numpy over many configurations at once. Slow, simple, independent.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from itertools import combinations, product
from typing import Any

import numpy as np

from ffsr_plan.inputs import Array


@dataclass(frozen=True, eq=False)
class Shape:
    """A collision shape: a sphere (`half` is None) or a box."""

    link: str
    placement: Array
    """(4, 4) in the link's frame."""
    half: Array | None
    """(3,) half sides of a box [m]."""
    radius: float
    """Of the sphere, or of the sphere around the box [m]."""


class Bodies:
    """Links, joints, masses and shapes of a URDF."""

    def __init__(self, urdf: str) -> None:
        import yourdfpy

        robot = yourdfpy.URDF.load(
            io.BytesIO(urdf.encode()), build_scene_graph=False, load_meshes=False
        ).robot
        self._children: dict[str, list[Any]] = {link.name: [] for link in robot.links}
        for joint in robot.joints:
            self._children[joint.parent].append(joint)
        heads = {joint.child for joint in robot.joints}
        self.root = next(link.name for link in robot.links if link.name not in heads)
        self.inertials = {link.name: link.inertial for link in robot.links if link.inertial}
        self.shapes = [
            _shape(link.name, collision) for link in robot.links for collision in link.collisions
        ]

    def pairs(self) -> list[tuple[Shape, Shape]]:
        """Shapes that must not touch: not of one rigid body, nor of two that a joint links."""
        body, carrier = {self.root: self.root}, {self.root: ""}
        waiting = [self.root]
        while waiting:
            parent = waiting.pop()
            for joint in self._children[parent]:
                rigid = joint.type == "fixed"
                body[joint.child] = body[parent] if rigid else joint.child
                carrier.setdefault(body[joint.child], body[parent])
                waiting.append(joint.child)
        return [
            (a, b)
            for a, b in combinations(self.shapes, 2)
            if body[a.link] != body[b.link]
            and carrier[body[a.link]] != body[b.link]
            and carrier[body[b.link]] != body[a.link]
        ]

    def link_poses(self, base: Array, joints: dict[str, Array]) -> dict[str, Array]:
        """(N, 4, 4) pose of every link in the world.

        Args:
            base: (N, 4, 4) pose of the root link.
            joints: (N,) values of each moving joint by name.
        """
        poses = {self.root: base}
        waiting = [self.root]
        while waiting:
            parent = waiting.pop()
            for joint in self._children[parent]:
                origin = np.eye(4) if joint.origin is None else joint.origin
                pose = poses[parent] @ origin
                if joint.type != "fixed":
                    pose = pose @ _displacement(joint, joints[joint.name])
                poses[joint.child] = pose
                waiting.append(joint.child)
        return poses


def pose(position: Array, quat_xyzw: Array) -> Array:
    """(N, 4, 4) from (N, 3) and (N, 4): columns are the rotated unit vectors."""
    vector, scalar = quat_xyzw[:, :3], quat_xyzw[:, 3]
    result = np.zeros((len(position), 4, 4))
    for k, unit in enumerate(np.eye(3)):
        turned = np.cross(vector, unit)
        result[:, :3, k] = unit + 2.0 * (scalar[:, None] * turned + np.cross(vector, turned))
    result[:, :3, 3] = position
    result[:, 3, 3] = 1.0
    return result


def sphere_distance(shape: Shape, placed: Array, centers: Array, radii: Array) -> Array:
    """(N, K) signed distance of a shape at poses (N, 4, 4) to spheres (K, 3), (K,)."""
    if shape.half is None:
        apart = placed[:, None, :3, 3] - centers[None]
        return np.asarray(np.linalg.norm(apart, axis=2) - shape.radius - radii)
    local = np.einsum("nji,nkj->nki", placed[:, :3, :3], centers[None] - placed[:, None, :3, 3])
    beyond = np.abs(local) - shape.half
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=2)
    return np.asarray(outside + np.minimum(np.max(beyond, axis=2), 0.0) - radii)


def separation(a: Shape, pose_a: Array, b: Shape, pose_b: Array) -> Array:
    """(N,) lower bound on the distance of two shapes, positive exactly when they are apart.

    Boxes by the separating-axis theorem, boxes and spheres in closed form.
    """
    if b.half is None:
        center = pose_b[:, None, :3, 3]
        each = [
            sphere_distance(a, pose_a[n : n + 1], center[n], np.array([b.radius]))[0, 0]
            for n in range(len(pose_a))
        ]
        return np.array(each)
    if a.half is None:
        return separation(b, pose_b, a, pose_a)
    ra, rb = pose_a[:, :3, :3], pose_b[:, :3, :3]
    apart = pose_b[:, :3, 3] - pose_a[:, :3, 3]
    best = np.full(len(apart), -np.inf)
    axes = [ra[:, :, k] for k in range(3)] + [rb[:, :, k] for k in range(3)]
    axes += [np.cross(ra[:, :, i], rb[:, :, j]) for i, j in product(range(3), repeat=2)]
    for axis in axes:
        size = np.linalg.norm(axis, axis=1)
        usable = size > 1e-9  # parallel edges span no axis of their own
        axis = axis / np.where(usable, size, 1.0)[:, None]
        reach = np.abs(np.einsum("ni,nij->nj", axis, ra)) @ a.half
        reach += np.abs(np.einsum("ni,nij->nj", axis, rb)) @ b.half
        gap = np.abs(np.sum(axis * apart, axis=1)) - reach
        best = np.where(usable, np.maximum(best, gap), best)
    return best


def _displacement(joint: Any, value: Array) -> Array:  # noqa: ANN401 - yourdfpy has no types
    result = np.broadcast_to(np.eye(4), (len(value), 4, 4)).copy()
    axis = np.array([1.0, 0.0, 0.0]) if joint.axis is None else np.asarray(joint.axis, float)
    axis = axis / np.linalg.norm(axis)
    if joint.type == "prismatic":
        result[:, :3, 3] = value[:, None] * axis
        return result
    x, y, z = axis
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    sine, cosine = np.sin(value)[:, None, None], np.cos(value)[:, None, None]
    result[:, :3, :3] = np.eye(3) + sine * skew + (1.0 - cosine) * (skew @ skew)  # Rodrigues
    return result


def _shape(link: str, collision: Any) -> Shape:  # noqa: ANN401 - yourdfpy has no types
    placement = np.eye(4) if collision.origin is None else np.asarray(collision.origin, float)
    if collision.geometry.box is not None:
        half = 0.5 * np.asarray(collision.geometry.box.size, float)
        return Shape(link, placement, half, float(np.linalg.norm(half)))
    return Shape(link, placement, None, float(collision.geometry.sphere.radius))
