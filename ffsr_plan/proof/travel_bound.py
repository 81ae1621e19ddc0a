"""How far any point of the robot can travel: the bound behind every proof that an edge is free.

`TravelBound` bounds, shape by shape and interval by interval, the length of the path that a point
traces in the world while the joints move linearly, the base origin too, and the base turns in
reaction or steadily. All rates are per unit of the edge's time; an interval has length h and middle
m. A point at y from the base origin (base axes) has the world velocity R (omega x y + y') + Dp and
an acceleration of at most A, all along; so it travels no farther than

    T = min { h |velocity(m) + Dp| + A h^2 / 4,  h (|Dp| + Omega rho + v) }

    A = (kappa + Omega^2) rho + 2 Omega v + a

with bounds Omega >= |omega|, kappa >= |omega'|, rho >= |y|, v >= |y'|, a >= |y''|. docs/proof.md
derives them all. Points of a shape travel no farther than the points that it is the hull of; around
these, spheres and capsules keep a constant distance, which cancels in the proof.
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
from ffsr_plan.proof.link_bounds import Links, Reach, ReachBound, tightened
from ffsr_plan.robots.kinematics import turned
from ffsr_plan.robots.robot import SpaceRobot


class Travel(NamedTuple):
    """The bound over K intervals, open to any displacement of the base; P points of g shapes."""

    velocity: Array
    """(K, P, 3) at the middle, about the base origin, world axes [m per unit of edge time]."""
    speed: Array
    """(K, P) the most of its norm over the interval."""
    bend: Array
    """(K, P) what a change of velocity can add over the interval, A h^2 / 4 [m]."""
    slack: Array
    """(K, P) the share of the attitude's error [m]."""
    lengths: Array
    """(K,) h, in units of edge time."""
    first: IntArray
    """(g,) the first of each shape's points, which follow one another."""

    def bounds(self, interval: int | IntArray, base_step: Array) -> Array:
        """T (..., g) [m] on intervals (...) while the base origin covers `base_step` (..., 3).

        Both may have leading axes, which broadcast: many edges share an interval, or each has its
        own. The step is that of a whole edge, in world axes [m].
        """
        length = self.lengths[interval][..., None]
        velocity = self.velocity[interval] + base_step[..., None, :]
        straight = length * np.linalg.norm(velocity, axis=-1) + self.bend[interval]
        base_speed = np.linalg.norm(base_step, axis=-1)[..., None]
        coarse = length * (base_speed + self.speed[interval])
        return self._of_shapes(np.minimum(straight, coarse) + self.slack[interval])

    def within(self, interval: int, length: float, aside: float, base_step: Array) -> Array:
        """T (g,) [m] over a part of an interval that does not have the middle inside.

        Over the part the velocity differs from the middle's by at most A |t - middle|.

        Args:
            interval: the interval.
            length: of the part, in units of edge time.
            aside: distance of the part's middle from the interval's, in the same units.
            base_step: (3,) as for `bounds`.
        """
        velocity = np.linalg.norm(self.velocity[interval] + base_step, axis=-1)
        change = 4.0 / self.lengths[interval] ** 2 * self.bend[interval]
        coarse = np.linalg.norm(base_step) + self.speed[interval]
        fastest = np.minimum(velocity + abs(aside) * change, coarse)
        return self._of_shapes(length * fastest + self.slack[interval])

    def _of_shapes(self, points: Array) -> Array:
        return np.asarray(np.maximum.reduceat(points, self.first, axis=-1))


class Travels(NamedTuple):
    """The bound over the same intervals for two observers."""

    world: Travel
    """In the world."""
    in_base: Travel
    """As seen from the base: to be asked with a base step of zero. Two shapes of one robot keep
    apart where their distances at an interval's ends sum to more than the sum of their bounds."""


class _Turn(NamedTuple):
    """The base's rotation over each of K intervals."""

    rate: Array
    """(K, 3) angular velocity at the middle, base axes [rad]."""
    most: Array
    """(K,) Omega."""
    change: Array
    """(K,) kappa."""


class TravelBound:
    """The bound for one robot, ready for any motion of its joints.

    Attributes:
        points: (P, 3) the points that matter, shape by shape, in the frames of their links [m].
        links: (P,) which link (numbered as in `kinematics`) carries each.
        first: (g,) the first point of each shape.
    """

    def __init__(self, robot: SpaceRobot) -> None:
        model = robot.model
        self._reach = ReachBound(model)
        bodies = list(model.inertias)[1:]
        self._masses = np.array([body.mass for body in bodies])
        self._levers = np.array([body.lever for body in bodies])
        self._inertias = np.array([body.inertia for body in bodies])
        moments = np.maximum(np.linalg.eigvalsh(self._inertias), 0.0)
        self._least, self._most = moments[:, 0], moments[:, 2]
        self._bodies = np.arange(len(bodies))
        points = [_points(g) for g in robot.collision_model.geometryObjects]
        counts = np.array([len(p) for p in points], dtype=np.int64)
        carriers = [g.parentJoint - 1 for g in robot.collision_model.geometryObjects]
        self.first = np.cumsum(counts) - counts
        self.links = np.repeat(np.array(carriers, dtype=np.int64), counts)
        self.points = np.concatenate([np.zeros((0, 3)), *points])

    def reacting(
        self,
        joint_values: Array,
        joint_rates: Array,
        attitudes: Array,
        lengths: Array,
        error: float,
        floats: bool = False,
    ) -> Travels:
        """The base turns so that the angular momentum stays zero.

        Args:
            joint_values: (K, nd) at the middle of each interval [rad or m].
            joint_rates: (K, nd) change over a whole edge [rad or m].
            attitudes: (K, 4) of the base at the middle (xyzw).
            lengths: (K,) of the intervals, in units of edge time: at most 1.
            error: bound on the angle [rad] by which any attitude may be wrong, these and those at
                which clearances are measured.
            floats: whether the centre of mass is at rest (free-floating), so that the base step is
                zero, and not the base origin on a straight line (free-flying).
        """
        links = self._reach.over(joint_values, joint_rates, lengths)
        return self._travels(links, self._reaction(links), attitudes, error, floats)

    def held(
        self,
        joint_values: Array,
        joint_rates: Array,
        attitudes: Array,
        lengths: Array,
        turn: Array,
    ) -> Travels:
        """The base turns at the angular velocity `turn` (K, 3), base axes [rad] per unit of time.

        The other arguments are those of `reacting`.
        """
        links = self._reach.over(joint_values, joint_rates, lengths)
        most = np.sqrt(np.sum(turn**2, axis=-1))
        turning = _Turn(turn, most, np.zeros_like(most))
        return self._travels(links, turning, attitudes, 0.0)

    def _reaction(self, links: Links) -> _Turn:
        """The base's rotation at zero angular momentum.

        I omega + l = 0, with the locked inertia I and the arms' angular momentum l relative to the
        base, both about the centre of mass; their rates of change are bounded term by term.
        """
        masses, half = self._masses, links.half[:, 0]
        share = masses / np.sum(masses)
        centers, velocity, reach = links.reach(self._bodies, self._levers)
        arms = centers - np.sum(share[:, None] * centers, axis=1, keepdims=True)
        rotations = links.poses.rotations
        inertias = rotations @ self._inertias @ np.swapaxes(rotations, -1, -2)
        inertia, momentum = _locked(masses, inertias, arms, velocity, links.velocities.angular)
        rate = np.asarray(-np.linalg.solve(inertia, momentum[..., None])[..., 0], np.float64)

        spread, angular = self._most - self._least, links.angular
        pull = (1.0 - 2.0 * share) * reach.speed + np.sum(share * reach.speed, 1, keepdims=True)
        leverage = masses * (np.linalg.norm(arms, axis=-1) + links.half * pull)
        inertia_change = np.sum(spread * angular + 2.0 * leverage * reach.speed, axis=1)
        momentum_change = np.sum(
            0.5 * spread * angular**2 + self._most * links.angular_change + leverage * reach.bend,
            axis=1,
        )
        least = np.linalg.eigvalsh(inertia)[:, 0] - half * inertia_change
        least = np.maximum(least, np.sum(self._least))
        energy = np.sum(masses * reach.speed**2 + self._most * angular**2, axis=1)
        now = np.linalg.norm(rate, axis=-1)
        most = np.minimum(
            now + half * (momentum_change + inertia_change * now) / least, np.sqrt(energy / least)
        )
        return _Turn(rate, most, (momentum_change + inertia_change * most) / least)

    def _travels(
        self,
        links: Links,
        turn: _Turn,
        attitudes: Array,
        error: float,
        floats: bool = False,
    ) -> Travels:
        """All that T needs but the base's translation."""
        position, relative, reach = links.reach(self.links, self.points)
        length = 2.0 * links.half
        quarter = 0.25 * length**2
        still = np.zeros_like(reach.speed)
        in_base = Travel(
            relative, reach.speed, quarter * reach.bend, still, length[:, 0], self.first
        )
        if floats:
            position, relative, reach = self._from_center(links, position, relative, reach)
        velocity = relative + cross(turn.rate[:, None], position)
        most = turn.most[:, None]
        bend = (
            (turn.change[:, None] + most**2) * reach.distance
            + 2.0 * most * reach.speed
            + reach.bend
        )
        world = Travel(
            velocity @ np.swapaxes(rotations.matrix(attitudes), -1, -2),
            most * reach.distance + reach.speed,
            quarter * bend,
            error * (2.0 * reach.distance + length * np.linalg.norm(velocity, axis=-1)),
            length[:, 0],
            self.first,
        )
        return Travels(world, in_base)

    def _from_center(
        self, links: Links, position: Array, velocity: Array, reach: Reach
    ) -> tuple[Array, Array, Reach]:
        """The same seen from the centre of mass instead of the base origin, still in base axes."""
        share = self._masses / np.sum(self._masses)
        centers, motions, bodies = links.reach(self._bodies, self._levers)
        position = position - np.einsum("b,kbi->ki", share, centers)[:, None]
        velocity = velocity - np.einsum("b,kbi->ki", share, motions)[:, None]
        distance, speed, bend = (
            own + np.sum(share * other, axis=1, keepdims=True)
            for own, other in zip(reach, bodies, strict=True)
        )
        return position, velocity, tightened(position, velocity, links.half, distance, speed, bend)


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


def _points(geometry: pin.GeometryObject) -> Array:
    """(N, 3) points in the frame of the link that carries the shape, whose hull it fills.

    Spheres and capsules lie around theirs at a constant distance.
    """
    shape, placement = geometry.geometry, geometry.placement
    if isinstance(shape, coal.Sphere):
        local = np.zeros((1, 3))
    elif isinstance(shape, coal.Capsule):
        local = np.array([[0.0, 0.0, -shape.halfLength], [0.0, 0.0, shape.halfLength]])
    else:  # boxes and hulls: the corners of the box around them, along their own axes
        shape.computeLocalAABB()
        box = np.array([shape.aabb_local.min_, shape.aabb_local.max_])
        local = np.array(list(product(*box.T)))
    return np.asarray(local @ placement.rotation.T + placement.translation)
