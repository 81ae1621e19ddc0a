"""The travel bound once more, by numpy over many intervals at once: a reference for the kernels.

docs/proof.md, sections 3 to 5, has the formulas.
"""

from typing import NamedTuple

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.rotations import cross
from ffsr_plan.robots.kinematics import Poses, Tree, Velocities, turned
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.robots.shape_arrays import hull_points


class ReferenceTravel(NamedTuple):
    """The travel bound over K intervals, the columns of `TRAVEL` one by one.

    Attributes:
        velocity: (K, P, 3) at the middle relative to the base origin, world axes [m].
        speed: (K, P) bound on the norm of that velocity over the interval [m].
        curvature: (K, P) length that a change of velocity can add [m].
        attitude_error: (K, P) length that the error of the attitude can add [m].
        lengths: (K,) of the intervals, in units of edge time.
        first: (g,) index of the first point of each shape.
    """

    velocity: Array
    speed: Array
    curvature: Array
    attitude_error: Array
    lengths: Array
    first: IntArray


class LinkBounds(NamedTuple):
    """Bounds over each of K intervals on the motion of n links or points relative to the base.

    Attributes:
        distance: (K, n) bound on the distance from the base origin [m].
        speed: (K, n) bound on the speed [m].
        acceleration: (K, n) bound on the norm of the acceleration [m].
    """

    distance: Array
    speed: Array
    acceleration: Array


class ReactionTerms(NamedTuple):
    """What makes a base react, over each of K intervals; section 5 of docs/proof.md.

    Attributes:
        inertia: (K, 3, 3) locked inertia at the middle [kg m^2].
        momentum: (K, 3) of the joints' motion at the middle [kg m^2].
        inertia_change: (K,) bound on the norm of the inertia's derivative.
        momentum_change: (K,) bound on the norm of the momentum's derivative.
        least: (K,) lower bound on the inertia's eigenvalues.
        energy: (K,) bound on twice the kinetic energy with the base at rest.
    """

    inertia: Array
    momentum: Array
    inertia_change: Array
    momentum_change: Array
    least: Array
    energy: Array


class LinkMotion(NamedTuple):
    """The motion of all links over each of K intervals, relative to the base.

    Attributes:
        poses: poses at the middle of each interval.
        velocities: velocities at the middle of each interval.
        half: (K, 1) half the length of each interval.
        origins: bounds on the motion of the link origins.
        angular_speed: (K, n) bound on the angular speed [rad].
        angular_acceleration: (K, n) bound on the norm of the angular acceleration [rad].
    """

    poses: Poses
    velocities: Velocities
    half: Array
    origins: LinkBounds
    angular_speed: Array
    angular_acceleration: Array

    def of_points(self, links: IntArray, places: Array) -> tuple[Array, Array, LinkBounds]:
        """The motion of points that are fixed to links.

        Args:
            links: (N,) the link that carries each point.
            places: (N, 3) the points in the frames of their links [m].

        Returns:
            Position (K, N, 3) [m] and velocity (K, N, 3) [m] at the middle of each interval in base
            axes, and the bounds over the interval.
        """
        arms = turned(self.poses.rotations[:, links], places)
        position = self.poses.origins[:, links] + arms
        velocity = self.velocities.linear[:, links] + cross(self.velocities.angular[:, links], arms)
        length = np.linalg.norm(places, axis=-1)
        angular = self.angular_speed[:, links]
        acceleration = (
            self.origins.acceleration[:, links]
            + (self.angular_acceleration[:, links] + angular**2) * length
        )
        distance = self.origins.distance[:, links] + length
        speed = self.origins.speed[:, links] + angular * length
        bounds = LinkBounds(distance, speed, acceleration)
        return position, velocity, tightened(position, velocity, self.half, bounds)


def link_motion(tree: Tree, joint_values: Array, joint_rates: Array, lengths: Array) -> LinkMotion:
    """The motion of all links over intervals with constant joint rates.

    Args:
        tree: the links of the robot.
        joint_values: (K, nd) joint values at the middle of each interval [rad or m].
        joint_rates: (K, nd) change over a whole edge [rad or m].
        lengths: (K,) lengths of the intervals, in units of edge time.

    Returns:
        Poses and velocities at the middles, and bounds over the intervals.
    """
    half = 0.5 * lengths[:, None]
    poses = tree.poses(joint_values)
    velocities = tree.velocities(poses, joint_rates)
    rates = np.concatenate([np.zeros_like(half), np.abs(joint_rates)], axis=1)
    rotation_rates, sliding_rates = rates * ~tree.prismatic, rates * tree.prismatic
    offsets = _largest_offsets(tree, joint_values, half * joint_rates)
    angular_now = np.linalg.norm(velocities.angular, axis=-1)
    axes = turned(poses.rotations, tree.axes)
    across_now = np.linalg.norm(cross(velocities.angular[:, tree.parents], axes), axis=-1)
    angular, angular_change = np.zeros((2, *rates.shape))
    distance, speed, acceleration = np.zeros((3, *rates.shape))
    for j in tree.levels:
        p = tree.parents[j]
        parent_rate, offset = angular[:, p], offsets[:, j]
        # |w_p x s_j|: the component of the parent's angular velocity across the joint's axis
        across = np.minimum(parent_rate, across_now[:, j] + half * angular_change[:, p])
        angular_change[:, j] = angular_change[:, p] + across * rotation_rates[:, j]
        angular[:, j] = np.minimum(
            parent_rate + rotation_rates[:, j], angular_now[:, j] + half * angular_change[:, j]
        )
        bounds = LinkBounds(
            distance[:, p] + offset,
            speed[:, p] + parent_rate * offset + sliding_rates[:, j],
            acceleration[:, p]
            + (angular_change[:, p] + parent_rate**2) * offset
            + 2.0 * across * sliding_rates[:, j],
        )
        distance[:, j], speed[:, j], acceleration[:, j] = tightened(
            poses.origins[:, j], velocities.linear[:, j], half, bounds
        )
    origins = LinkBounds(distance, speed, acceleration)
    return LinkMotion(poses, velocities, half, origins, angular, angular_change)


def tightened(position: Array, velocity: Array, half: Array, bounds: LinkBounds) -> LinkBounds:
    """Bounds on distance and speed, reduced where the values at the middle give smaller ones.

    Args:
        position: (K, n, 3) at the middle of each interval [m].
        velocity: (K, n, 3) at the middle of each interval [m].
        half: (K, 1) half the length of each interval.
        bounds: bounds over each interval.
    """
    acceleration = bounds.acceleration
    speed = np.minimum(bounds.speed, np.linalg.norm(velocity, axis=-1) + half * acceleration)
    distance = np.minimum(bounds.distance, np.linalg.norm(position, axis=-1) + half * speed)
    return LinkBounds(distance, speed, acceleration)


def _largest_offsets(tree: Tree, joint_values: Array, half_steps: Array) -> Array:
    """(K, n) bound on the distance of each link's origin from its parent's [m].

    The distance is a convex function of the joint value, so it is largest at an end.
    """
    ends = [tree.offsets(joint_values + sign * half_steps) for sign in (-1.0, 1.0)]
    return np.maximum(*(np.linalg.norm(offsets, axis=-1) for offsets in ends))


class ObserverTravels(NamedTuple):
    """The travel bound over the same intervals for two observers.

    Attributes:
        world: travel in the world.
        in_base: travel relative to the base, for a base step of zero. Two shapes of one robot do
            not touch if their distances at an interval's ends sum to more than the sum of their
            bounds.
    """

    world: ReferenceTravel
    in_base: ReferenceTravel


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


class ReferenceBound:
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

    def reaction_terms(self, links: LinkMotion) -> ReactionTerms:
        """Locked inertia I and angular momentum l of the joints' motion, both about the centre of
        mass, in base axes; their rates of change are bounded term by term."""
        masses, half = self._masses, links.half[:, 0]
        share = masses / np.sum(masses)
        centers, velocity, bodies = links.of_points(self._bodies, self._levers)
        arms = centers - np.sum(share[:, None] * centers, axis=1, keepdims=True)
        link_rotations = links.poses.rotations
        inertias = link_rotations @ self._inertias @ np.swapaxes(link_rotations, -1, -2)
        inertia, momentum = _locked(masses, inertias, arms, velocity, links.velocities.angular)
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
        return ReactionTerms(inertia, momentum, inertia_change, momentum_change, least, energy)

    def _reaction(self, links: LinkMotion) -> _BaseRotation:
        """The base's rotation at zero angular momentum: I omega + l = 0."""
        half, terms = links.half[:, 0], self.reaction_terms(links)
        momentum, least = terms.momentum, terms.least
        rate = -np.linalg.solve(terms.inertia, momentum[..., None])[..., 0]
        now = np.linalg.norm(rate, axis=-1)
        more = terms.momentum_change + terms.inertia_change * now
        speed = np.minimum(now + half * more / least, np.sqrt(terms.energy / least))
        change = (terms.momentum_change + terms.inertia_change * speed) / least
        return _BaseRotation(rate, speed, change)

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
        in_base = ReferenceTravel(
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
        world = ReferenceTravel(
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
