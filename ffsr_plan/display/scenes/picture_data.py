"""Sampled motion, curves, ants' trails and nearby obstacles: the data of pictures of a plan."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.collision.shape_placements import Placements, shape_placements
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, Flags, frozen
from ffsr_plan.plans.plan_data import PlanData
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.obstacle_shapes import placed_axes
from ffsr_plan.search.records import Branches

_SOLID_COUNT = 60  # scenes of at most so many obstacles are drawn solid as a whole
_NO_SEGMENTS = frozen(np.zeros((0, 2, 3))), frozen(np.zeros(0))
_SOLID_DISTANCE = 0.8  # in larger scenes, distance [m] from the robot up to which they are


class MotionFrames(NamedTuple):
    """Configurations of a robot with the kinematics that pictures need, computed once.

    Attributes:
        robot: the robot.
        configurations: (N, nq) base pose in the world [m, quaternion xyzw] and joints.
        rotations: (N, n, 3, 3) link axes to world axes, the base first, then as Pinocchio's joints.
        origins: (N, n, 3) origins of the links in the world [m].
        placements: collision shapes in the world.
    """

    robot: SpaceRobot
    configurations: Array
    rotations: Array
    origins: Array
    placements: Placements

    def bounding_spheres(self) -> tuple[Array, Array]:
        """Spheres around the base origin and around each of the g collision shapes.

        Returns:
            Centres (N, g + 1, 3) in the world [m] and radii (g + 1,) [m], that of the origin zero.
        """
        centers = np.concatenate([self.origins[:, :1], self.placements.positions], axis=1)
        return centers, np.append(0.0, np.linalg.norm(self.robot.primitives.sizes, axis=1))

    def tip_tracks(self) -> dict[str, Array]:
        """Tracks (N, 3) of the tip of each arm in the world [m], by the name of its last joint.

        The tip is the middle of the last collision shape. Arms without one are left out.
        """
        model, shapes = self.robot.model, self.robot.collision_model.geometryObjects
        inner = set(model.parents[2:])
        last = {shape.parentJoint: k for k, shape in enumerate(shapes)}
        tips = [j for j in range(2, model.njoints) if j not in inner and j in last]
        return {str(model.names[j]): self.placements.positions[:, last[j]] for j in tips}


class Curve(NamedTuple):
    """One curve along a motion.

    Attributes:
        name: by which users name it, for example a joint.
        label: in the legend.
        values: (N,) in the unit of its quantity.
    """

    name: str
    label: str
    values: Array


class Quantity(NamedTuple):
    """Curves of one kind that are drawn over each other.

    Attributes:
        name: by which users name it.
        title: what it is.
        unit: of the values and limits.
        curves: at least one.
        limits: positive numbers that the values keep; also negative values, if there are any.
    """

    name: str
    title: str
    unit: str
    curves: list[Curve]
    limits: list[float]

    @property
    def peak(self) -> float:
        """Largest value without its sign."""
        return max(float(np.max(np.abs(curve.values), initial=0.0)) for curve in self.curves)

    @property
    def signed(self) -> bool:
        """Whether a value is negative."""
        return any(float(np.min(curve.values, initial=0.0)) < 0.0 for curve in self.curves)


def motion_frames(robot: SpaceRobot, configurations: Array) -> MotionFrames:
    """Kinematics of a robot at configurations (N, nq)."""
    poses = robot.tree.poses(robot.joint_values(configurations))
    base = rotations.matrix(configurations[:, 3:7])[:, None]
    origins = (base @ poses.origins[..., None])[..., 0] + configurations[:, None, :3]
    placements = shape_placements(robot, configurations)
    return MotionFrames(robot, configurations, base @ poses.rotations, origins, placements)


def trail_segments(plan: PlanData, most: int = 3000) -> tuple[Array, Array]:
    """Edges that the ants walked, weak ones first; without a lattice, edges of the trees.

    Args:
        plan: the plan.
        most: greatest number of edges; the strongest are taken.

    Returns:
        Ends (k, 2, 3) of the edges, base origin in the world [m], and strengths (k,) in [0, 1].
        Half of the strength stands for the pheromone ever laid on the edge, half for the ants that
        walked it. Both scales are logarithmic, so that early trails are visible too. The tree from
        the start is strong, that from the goal is weak.
    """
    lattice, trails = plan.lattice, plan.trails
    if lattice is None or isinstance(trails, Branches):
        return branch_segments(trails, most) if isinstance(trails, Branches) else _NO_SEGMENTS
    if not len(trails.layer):
        return _NO_SEGMENTS
    strength = 0.5 * (_logarithmic(trails.laid) + _logarithmic(trails.ants))
    order = np.argsort(strength, kind="stable")[-most:]
    layer, tail, head = trails.layer[order], trails.tail[order], trails.head[order]
    begin = lattice.nominal.positions[layer] + lattice.offsets[tail]
    end = lattice.nominal.positions[layer + 1] + lattice.offsets[head]
    return np.stack([begin, end], axis=1), strength[order]


def branch_segments(branches: Branches, most: int) -> tuple[Array, Array]:
    """Edges of the trees; of many, some at equal distances in their order.

    Args:
        branches: the edges.
        most: greatest number of them that are taken.

    Returns:
        As `trail_segments`.
    """
    if not len(branches.tree):
        return _NO_SEGMENTS
    chosen = slice(None, None, max(1, -(-len(branches.tree) // most)))
    ends = np.stack([branches.begin[chosen], branches.end[chosen]], axis=1)
    return ends, np.where(branches.tree[chosen] == 0, 0.6, 0.2)


def near_track(scene: Scene, positions: Array, within: float) -> Flags:
    """Spheres and shapes that come close to a track.

    Args:
        scene: the obstacles.
        positions: (..., 3) points of the track [m], at least one.
        within: greatest distance of a point from the surface of a sphere, or of the box around a
            shape [m].

    Returns:
        (N + S,) whether each sphere does, then each shape.
    """
    from scipy.spatial import cKDTree

    points = positions.reshape(-1, 3)
    near = np.zeros(len(scene.radii) + len(scene.shapes), dtype=bool)
    if len(scene.radii):
        distances, _ = cKDTree(points).query(scene.centers)
        near[: len(distances)] = distances < within + scene.radii
    for k, shape in enumerate(scene.shapes, start=len(scene.radii)):
        turn, middle = placed_axes(shape)
        beyond = np.maximum(np.abs((points - middle) @ turn) - shape.half_sides, 0.0)
        near[k] = np.linalg.norm(beyond, axis=1).min() < within + shape.skin
    return near


def drawn_solid(scene: Scene, positions: Array) -> Flags:
    """(N + S,) which spheres and shapes pictures draw solid; others are faint and hide no robot.

    Up to 60 of them are all drawn solid, of more than that those closer than 0.8 m to one of the
    points (..., 3) [m], as a rule the middles of the robot's shapes along the motion.
    """
    count = len(scene.radii) + len(scene.shapes)
    if count <= _SOLID_COUNT:
        return np.ones(count, dtype=bool)
    return near_track(scene, positions, _SOLID_DISTANCE)


def _logarithmic(amount: NDArray[Any]) -> Array:
    """Amounts >= 0 on a logarithmic scale from 0 to 1."""
    amount = amount.astype(np.float64)
    scaled = np.log1p(amount / np.min(amount, where=amount > 0.0, initial=np.inf))
    return scaled / max(float(scaled.max()), 1e-12)
