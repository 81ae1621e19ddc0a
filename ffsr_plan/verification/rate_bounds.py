"""Bounds on how fast points of the robot can move, edge by edge, whatever its configuration.

Rates are per edge. On an edge of a plan the joints move at known, constant rates, on a piece of a
flight at rates with known bounds; a point of a link is never farther from a joint's origin than the
offsets along the chain add up to. The angular velocity
of a reacting base is w = -I^-1 h, with the inertia I about the centre of mass and the momentum h of
the joints. With I w = -h at two times less than d apart, and |dI| <= i d, |dh| <= g d,

    |w'| <= (|w| + g d / l) / (1 - i d / l)

where l is the smallest principal inertia at the first time.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.verification.momentum_map import MomentumMap
from ffsr_plan.verification.urdf_reading import Bodies


class Levers(NamedTuple):
    """Where points are along the chains of joints.

    Attributes:
        arms: (p, nd) largest distance of a point from each joint's origin, 1 for prismatic joints,
            0 for joints that do not move it [m].
        reach: (p,) largest distance from the base origin [m].
    """

    arms: Array
    reach: Array


class RateBounds:
    """Bounds on the speeds of shapes, and on the angular velocity of the base.

    Attributes:
        shapes: (m, s) speed of any point of each shape, relative to the base [m].
        reach: (s,) largest distance of any point of a shape from the base origin [m].
    """

    def __init__(
        self,
        bodies: Bodies,
        names: tuple[str, ...],
        joint_values: Array,
        sizes: Array | None = None,
        bends: Array | None = None,
    ) -> None:
        """Bounds for joint values (m + 1, nd) at the corners.

        Args:
            bodies: the robot, from its URDF.
            names: (nd) names of the joints.
            joint_values: (m + 1, nd) at the corners [rad or m].
            sizes: (m, nd) bounds on the joints' rates; None for straight lines between the corners.
            bends: (m, nd) bounds on the rates of change of these; None for zero.
        """
        steps = np.abs(np.diff(joint_values, axis=0))
        self._sizes = steps if sizes is None else sizes
        self._bends = np.zeros(steps.shape) if bends is None else bends
        beyond = 0.0 if sizes is None else np.max(sizes, axis=0)
        self._tree = _Tree(bodies, names, np.max(np.abs(joint_values), axis=0) + beyond)
        levers = self._tree.levers(
            [
                (shape.link, (shape.placement @ np.append(np.mean(shape.points, axis=0), 1.0))[:3])
                for shape in bodies.shapes
            ],
            np.array([_radius(shape.points) + shape.swell for shape in bodies.shapes]),
        )
        self.shapes: Array = self._sizes @ levers.arms.T
        self.reach = levers.reach
        self._levers = levers
        self._of_bodies(bodies)

    def of_pairs(self, pairs: IntArray) -> Array:
        """(m, p) speed at which the shapes of pairs (p, 2) can approach each other [m].

        Joints that move both shapes alike do not count; the others move one of them.
        """
        arms = self._levers.arms
        first, second = arms[pairs[:, 0]], arms[pairs[:, 1]]
        only_one = (first > 0.0) != (second > 0.0)
        return np.asarray(self._sizes @ np.where(only_one, first + second, 0.0).T)

    def afloat(self) -> tuple[Array, Array]:
        """`shapes` and `reach` where the centre of mass, not the base origin, stays at rest."""
        return self.shapes + self._center_speed[:, None], self.reach + self._center_reach

    def turn(self, momentum: MomentumMap, rates: Array, edge: IntArray, apart: Array) -> Array:
        """Bound on the angular velocity of a reacting base near some samples.

        Args:
            momentum: at the samples (N).
            rates: (N, nd) of the joints there [rad or m per edge].
            edge: (N,) the edges that they are on.
            apart: (N,) how far from them in time the bound is to hold [edges].

        Returns:
            (N,) [rad per edge].
        """
        omega = np.einsum("nij,nj->ni", momentum.reactions, rates)
        size, inertia = np.linalg.norm(omega, axis=1), momentum.least_inertia
        left = 1.0 - self._inertia_rate[edge] * apart / inertia
        near = (size + self._momentum_rate[edge] * apart / inertia) / np.where(left > 0, left, 1.0)
        return np.minimum(np.where(left > 0.0, near, np.inf), self._fastest_turn[edge])

    def _of_bodies(self, bodies: Bodies) -> None:
        """Bounds on momentum and inertia, and on their change."""
        inertials = list(bodies.inertials.items())
        centers = [(link, np.zeros(3) if i.origin is None else i.origin[:3, 3])
                   for link, i in inertials]  # fmt: skip
        levers = self._tree.levers(centers, np.zeros(len(inertials)))
        mass = np.array([float(i.mass) for _, i in inertials])
        principal = np.array([np.linalg.eigvalsh(i.inertia) for _, i in inertials])
        least, most = np.maximum(principal[:, 0], 0.0), principal[:, 2]
        share = mass / mass.sum()
        speeds = self._sizes @ levers.arms.T  # (m, bodies)
        self._center_speed, self._center_reach = speeds @ share, float(levers.reach @ share)
        distance = levers.reach + self._center_reach  # from the centre of mass
        turns, turn_changes = self._tree.turns([link for link, _ in inertials], self._sizes)
        speed_changes = self._tree.speed_changes(
            [link for link, _ in inertials], self._sizes, levers.arms
        )
        momentum = turns @ most + speeds @ (mass * distance)
        with np.errstate(divide="ignore", invalid="ignore"):
            self._fastest_turn: Array = np.where(momentum > 0.0, momentum / least.sum(), 0.0)
        self._momentum_rate: Array = (
            turns**2 @ (most - least) + turn_changes @ most + speed_changes @ (mass * distance)
        )
        more, _ = self._tree.turns([link for link, _ in inertials], self._bends)
        self._momentum_rate += more @ most + (self._bends @ levers.arms.T) @ (mass * distance)
        self._inertia_rate: Array = turns @ (most - least) + 2.0 * speeds @ (mass * distance)


class _Tree:
    """The chains of moving joints from the base to each link."""

    def __init__(self, bodies: Bodies, names: tuple[str, ...], extents: Array) -> None:
        self._names = names
        self._chains: dict[str, list[int]] = {bodies.root: []}
        self._far: dict[str, float] = {bodies.root: 0.0}  # of a link's origin from the base's
        self._slides = np.zeros(len(names), dtype=np.bool_)
        self._origins = np.zeros(len(names))
        for joint in bodies.joints:
            far = self._far[joint.parent] + float(np.linalg.norm(joint.origin[:3, 3]))
            chain = self._chains[joint.parent]
            if joint.moves:
                k = names.index(joint.name)
                chain, self._slides[k] = [*chain, k], joint.slides
                far += float(extents[k]) if joint.slides else 0.0
                self._origins[k] = far
            self._far[joint.child], self._chains[joint.child] = far, chain

    def levers(self, points: list[tuple[str, Array]], radii: Array) -> Levers:
        """Levers of balls about points of links, in the links' frames."""
        arms = np.zeros((len(points), len(self._names)))
        reach = np.zeros(len(points))
        for p, ((link, point), radius) in enumerate(zip(points, radii, strict=True)):
            chain = self._chains[link]
            reach[p] = self._far[link] + float(np.linalg.norm(point)) + radius
            arms[p, chain] = np.where(self._slides[chain], 1.0, reach[p] - self._origins[chain])
        return Levers(arms, reach)

    def turns(self, links: list[str], sizes: Array) -> tuple[Array, Array]:
        """(m, b) angular velocity of links relative to the base, and its rate of change."""
        turns, changes = np.zeros((2, len(sizes), len(links)))
        for b, link in enumerate(links):
            before = np.zeros(len(sizes))
            for k in self._chains[link]:
                if not self._slides[k]:
                    changes[:, b] += sizes[:, k] * before
                    before = before + sizes[:, k]
            turns[:, b] = before
        return turns, changes

    def speed_changes(self, links: list[str], sizes: Array, arms: Array) -> Array:
        """(m, b) rate of change of the velocity of a point of each link, relative to the base.

        A joint adds to the velocity its rate times its axis, or times the cross product of its axis
        with the lever. The axis turns with the joints before it; the lever changes by them, which
        turn it, and by the joint and those after it, which move the point.
        """
        changes = np.zeros((len(sizes), len(links)))
        for b, link in enumerate(links):
            chain = self._chains[link]
            speeds = sizes[:, chain] * arms[b, chain]
            after = np.cumsum(speeds[:, ::-1], axis=1)[:, ::-1]  # this joint and those after it
            before = np.zeros(len(sizes))
            for n, k in enumerate(chain):
                lever = arms[b, k]
                if self._slides[k]:
                    changes[:, b] += sizes[:, k] * before
                else:
                    changes[:, b] += sizes[:, k] * (2.0 * before * lever + after[:, n])
                    before = before + sizes[:, k]
        return changes


def _radius(points: Array) -> float:
    return float(np.linalg.norm(points - np.mean(points, axis=0), axis=1).max())
