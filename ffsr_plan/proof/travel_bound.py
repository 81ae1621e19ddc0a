"""The travel bound T: an upper bound on the path length of any point of the robot.

`TravelBound` bounds, for each shape and interval of an edge, the length of the path of its points
in the world while the joints and the base origin move linearly and the base rotates by reaction or
at a constant angular velocity. All rates are per unit of the edge's time; an
interval has length h and middle m. A point at y from the base origin (base axes) has the world
velocity R (omega x y + y') + Dp, and an acceleration of at most A over the interval. So its path is
no longer than

    T = min { h |velocity(m) + Dp| + A h^2 / 4,  h (|Dp| + Omega rho + v) }

    A = (kappa + Omega^2) rho + 2 Omega v + a

with bounds Omega >= |omega|, kappa >= |omega'|, rho >= |y|, v >= |y'|, a >= |y''|. docs/proof.md
derives all of them. No point of a shape has a longer path than the corners of its convex hull.
Spheres and capsules extend around their centre or segment by a constant distance, which cancels in
the proof.
"""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import coal
import numpy as np
import pinocchio as pin

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.rotations import cross
from ffsr_plan.proof.link_bounds import LinkBounds, LinkMotion, tightened
from ffsr_plan.robots.kinematics import turned
from ffsr_plan.robots.robot import SpaceRobot


class IntervalTravel(NamedTuple):
    """The travel bound over K intervals for any displacement of the base; P points of g shapes.

    Attributes:
        velocity: (K, P, 3) at the middle relative to the base origin, world axes [m].
        speed: (K, P) bound on the norm of that velocity over the interval [m].
        curvature: (K, P) length that a change of velocity can add, A h^2 / 4 [m].
        attitude_error: (K, P) length that the error of the attitude can add [m].
        lengths: (K,) h, in units of edge time.
        first: (g,) index of the first point of each shape; a shape's points are consecutive.
    """

    velocity: Array
    speed: Array
    curvature: Array
    attitude_error: Array
    lengths: Array
    first: IntArray

    def bounds(self, interval: int | IntArray, base_step: Array) -> Array:
        """T over whole intervals.

        Args:
            interval: one interval, or intervals (...).
            base_step: (..., 3) displacement of the base origin over a whole edge, world axes [m].
                It broadcasts with `interval`.

        Returns:
            (..., g) bound of each shape [m].
        """
        length = self.lengths[interval][..., None]
        velocity = self.velocity[interval] + base_step[..., None, :]
        straight = length * np.linalg.norm(velocity, axis=-1) + self.curvature[interval]
        base_speed = np.linalg.norm(base_step, axis=-1)[..., None]
        coarse = length * (base_speed + self.speed[interval])
        return self._of_shapes(np.minimum(straight, coarse) + self.attitude_error[interval])

    def within(self, interval: int, length: float, offset: float, base_step: Array) -> Array:
        """T over a part of an interval that does not contain the middle.

        Over the part the velocity differs from that at the middle by at most A |t - middle|.

        Args:
            interval: the interval.
            length: length of the part, in units of edge time.
            offset: distance between the middles of the part and of the interval, same units.
            base_step: (3,) displacement of the base origin over a whole edge, world axes [m].

        Returns:
            (g,) bound of each shape [m].
        """
        velocity = np.linalg.norm(self.velocity[interval] + base_step, axis=-1)
        change = 4.0 / self.lengths[interval] ** 2 * self.curvature[interval]
        coarse = np.linalg.norm(base_step) + self.speed[interval]
        fastest = np.minimum(velocity + abs(offset) * change, coarse)
        return self._of_shapes(length * fastest + self.attitude_error[interval])

    def _of_shapes(self, points: Array) -> Array:
        largest: Array = np.maximum.reduceat(points, self.first, axis=-1)
        return largest


class ObserverTravels(NamedTuple):
    """The travel bound over the same intervals for two observers.

    Attributes:
        world: travel in the world.
        in_base: travel relative to the base, for a base step of zero. Two shapes of one robot do
            not touch if their distances at an interval's ends sum to more than the sum of their
            bounds.
    """

    world: IntervalTravel
    in_base: IntervalTravel


class _BaseRotation(NamedTuple):
    """The base's rotation over each of K intervals.

    Attributes:
        velocity: (K, 3) angular velocity at the middle, base axes [rad].
        speed: (K,) Omega, bound on the angular speed [rad].
        acceleration: (K,) kappa, bound on the angular acceleration [rad].
    """

    velocity: Array
    speed: Array
    acceleration: Array


class TravelBound:
    """The travel bound of one robot, for any motion of its joints.

    Attributes:
        points: (P, 3) points whose hulls contain the shapes, in the frames of their links [m].
        links: (P,) index of the link that carries each point, numbered as in `kinematics`.
        first: (g,) index of the first point of each shape.
    """

    def __init__(self, robot: SpaceRobot) -> None:
        self._tree = robot.tree
        bodies = list(robot.model.inertias)[1:]
        self._masses = np.array([body.mass for body in bodies])
        self._levers = np.array([body.lever for body in bodies])
        self._inertias = np.array([body.inertia for body in bodies])
        moments = np.maximum(np.linalg.eigvalsh(self._inertias), 0.0)
        self._least_moments, self._largest_moments = moments[:, 0], moments[:, 2]
        self._bodies = np.arange(len(bodies))
        points = [hull_points(g) for g in robot.collision_model.geometryObjects]
        counts = np.array([len(p) for p in points], dtype=np.int64)
        carriers = [g.parentJoint - 1 for g in robot.collision_model.geometryObjects]
        self.first = np.cumsum(counts) - counts
        self.links = np.repeat(np.array(carriers, dtype=np.int64), counts)
        self.points = np.concatenate([np.zeros((0, 3)), *points])

    def reacting(
        self, links: LinkMotion, attitudes: Array, error: float, floats: bool = False
    ) -> ObserverTravels:
        """The bound for a base whose rotation keeps the angular momentum at zero.

        Args:
            links: motion of the links over K intervals.
            attitudes: (K, 4) of the base at the middle (xyzw).
            error: bound on the error [rad] of any attitude, of these and of those at which
                clearances are measured.
            floats: whether the centre of mass is at rest (free-floating), so that the base step is
                zero, instead of the base origin moving linearly (free-flying).

        Returns:
            The bound in the world and relative to the base.
        """
        return self._travels(links, self._reaction(links), attitudes, error, floats)

    def held(self, links: LinkMotion, attitudes: Array, angular_velocity: Array) -> ObserverTravels:
        """The bound for a base that rotates at a constant angular velocity.

        Args:
            links: motion of the links over K intervals.
            attitudes: (K, 4) of the base at the middle (xyzw).
            angular_velocity: (K, 3) of the base, base axes [rad per unit of edge time].

        Returns:
            The bound in the world and relative to the base.
        """
        speed = np.sqrt(np.sum(angular_velocity**2, axis=-1))
        rotation = _BaseRotation(angular_velocity, speed, np.zeros_like(speed))
        return self._travels(links, rotation, attitudes, 0.0)

    def _reaction(self, links: LinkMotion) -> _BaseRotation:
        """The base's rotation at zero angular momentum.

        I omega + l = 0, with the locked inertia I and the arms' angular momentum l relative to the
        base, both about the centre of mass; their rates of change are bounded term by term.
        """
        masses, half = self._masses, links.half[:, 0]
        share = masses / np.sum(masses)
        centers, velocity, bodies = links.of_points(self._bodies, self._levers)
        arms = centers - np.sum(share[:, None] * centers, axis=1, keepdims=True)
        link_rotations = links.poses.rotations
        inertias = link_rotations @ self._inertias @ np.swapaxes(link_rotations, -1, -2)
        inertia, momentum = _locked(masses, inertias, arms, velocity, links.velocities.angular)
        rate = np.asarray(-np.linalg.solve(inertia, momentum[..., None])[..., 0], np.float64)

        spread, angular = self._largest_moments - self._least_moments, links.angular_speed
        pull = (1.0 - 2.0 * share) * bodies.speed + np.sum(share * bodies.speed, 1, keepdims=True)
        leverage = masses * (np.linalg.norm(arms, axis=-1) + links.half * pull)
        inertia_change = np.sum(spread * angular + 2.0 * leverage * bodies.speed, axis=1)
        momentum_change = np.sum(
            0.5 * spread * angular**2
            + self._largest_moments * links.angular_acceleration
            + leverage * bodies.acceleration,
            axis=1,
        )
        least = np.linalg.eigvalsh(inertia)[:, 0] - half * inertia_change
        least = np.maximum(least, np.sum(self._least_moments))
        energy = np.sum(masses * bodies.speed**2 + self._largest_moments * angular**2, axis=1)
        now = np.linalg.norm(rate, axis=-1)
        speed = np.minimum(
            now + half * (momentum_change + inertia_change * now) / least, np.sqrt(energy / least)
        )
        return _BaseRotation(rate, speed, (momentum_change + inertia_change * speed) / least)

    def _travels(
        self,
        links: LinkMotion,
        rotation: _BaseRotation,
        attitudes: Array,
        error: float,
        floats: bool = False,
    ) -> ObserverTravels:
        """All terms of T except the base's translation."""
        position, relative, points = links.of_points(self.links, self.points)
        length = 2.0 * links.half
        quarter = 0.25 * length**2
        in_base = IntervalTravel(
            relative,
            points.speed,
            quarter * points.acceleration,
            np.zeros_like(points.speed),
            length[:, 0],
            self.first,
        )
        if floats:
            position, relative, points = self._from_center(links, position, relative, points)
        velocity = relative + cross(rotation.velocity[:, None], position)
        angular = rotation.speed[:, None]
        acceleration = (
            (rotation.acceleration[:, None] + angular**2) * points.distance
            + 2.0 * angular * points.speed
            + points.acceleration
        )
        world = IntervalTravel(
            velocity @ np.swapaxes(rotations.matrix(attitudes), -1, -2),
            angular * points.distance + points.speed,
            quarter * acceleration,
            error * (2.0 * points.distance + length * np.linalg.norm(velocity, axis=-1)),
            length[:, 0],
            self.first,
        )
        return ObserverTravels(world, in_base)

    def _from_center(
        self, links: LinkMotion, position: Array, velocity: Array, points: LinkBounds
    ) -> tuple[Array, Array, LinkBounds]:
        """The motion relative to the centre of mass instead of the base origin, in base axes."""
        share = self._masses / np.sum(self._masses)
        centers, motions, bodies = links.of_points(self._bodies, self._levers)
        position = position - np.einsum("b,kbi->ki", share, centers)[:, None]
        velocity = velocity - np.einsum("b,kbi->ki", share, motions)[:, None]
        bounds = LinkBounds(
            *(
                own + np.sum(share * other, axis=1, keepdims=True)
                for own, other in zip(points, bodies, strict=True)
            )
        )
        return position, velocity, tightened(position, velocity, links.half, bounds)


def hull_points(geometry: pin.GeometryObject) -> Array:
    """Points whose convex hull, widened by a sphere's or capsule's radius, contains the shape.

    Args:
        geometry: a collision shape on its link.

    Returns:
        (N, 3) points in the frame of the link [m].
    """
    shape, placement = geometry.geometry, geometry.placement
    if isinstance(shape, coal.Sphere):
        local = np.zeros((1, 3))
    elif isinstance(shape, coal.Capsule):
        local = np.array([[0.0, 0.0, -shape.halfLength], [0.0, 0.0, shape.halfLength]])
    else:  # boxes and hulls: the corners of the bounding box along their own axes
        shape.computeLocalAABB()
        box = np.array([shape.aabb_local.min_, shape.aabb_local.max_])
        local = np.array(list(product(*box.T)))
    points: Array = local @ placement.rotation.T + placement.translation
    return points


def _locked(
    masses: Array, inertias: Array, arms: Array, velocity: Array, angular: Array
) -> tuple[Array, Array]:
    """Locked inertia (K, 3, 3) about the centre of mass and angular momentum (K, 3) of the arms."""
    weighted = masses[:, None] * arms
    spread = np.swapaxes(weighted, -1, -2) @ arms
    trace = np.trace(spread, axis1=-2, axis2=-1)
    inertia = np.sum(inertias, axis=1) + trace[:, None, None] * np.eye(3) - spread
    momentum = np.sum(turned(inertias, angular) + cross(weighted, velocity), axis=1)
    return inertia, momentum
