"""How far from the base, how fast and how bent the robot's links move, seen from the base.

Bounds over intervals of an edge, from the base outwards: each is the smaller of what the parent's
bounds give and of the value in the middle of the interval plus what can be added until its ends.
docs/proof.md, section 4, derives them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.rotations import cross
from ffsr_plan.robots.kinematics import Poses, Tree, Velocities, turned


class Reach(NamedTuple):
    """Bounds over each of K intervals on what moves relative to the base; n links or points."""

    distance: Array
    """(K, n) from the base origin [m]."""
    speed: Array
    """(K, n) [m]."""
    bend: Array
    """(K, n) acceleration [m]."""


class Links(NamedTuple):
    """The links over each of K intervals, relative to the base."""

    poses: Poses
    velocities: Velocities
    half: Array
    """(K, 1) half the length of the interval."""
    origins: Reach
    angular: Array
    """(K, n) bound on the angular speed [rad]."""
    angular_change: Array
    """(K, n) bound on the angular acceleration [rad]."""

    def reach(self, links: IntArray, places: Array) -> tuple[Array, Array, Reach]:
        """Points at `places` (N, 3) of `links` (N,): where, how fast (K, N, 3), and bounds."""
        arms = turned(self.poses.rotations[:, links], places)
        position = self.poses.origins[:, links] + arms
        velocity = self.velocities.linear[:, links] + cross(self.velocities.angular[:, links], arms)
        length = np.linalg.norm(places, axis=-1)
        angular = self.angular[:, links]
        bend = self.origins.bend[:, links] + (self.angular_change[:, links] + angular**2) * length
        distance = self.origins.distance[:, links] + length
        speed = self.origins.speed[:, links] + angular * length
        return position, velocity, tightened(position, velocity, self.half, distance, speed, bend)


class ReachBound:
    """The bounds for one robot, ready for any motion of its joints."""

    def __init__(self, model: pin.Model) -> None:
        self._tree = Tree(model)

    def over(self, joint_values: Array, joint_rates: Array, lengths: Array) -> Links:
        """All links over intervals around joint values (K, nd), at rates (K, nd), lengths (K,)."""
        tree, half = self._tree, 0.5 * lengths[:, None]
        poses = tree.poses(joint_values)
        velocities = tree.velocities(poses, joint_rates)
        rates = np.concatenate([np.zeros_like(half), np.abs(joint_rates)], axis=1)
        turns, slides = rates * ~tree.prismatic, rates * tree.prismatic
        # a convex function of the joint value: largest at one of the interval's ends
        offsets = np.maximum(
            *(
                np.linalg.norm(tree.offsets(joint_values + end * half * joint_rates), axis=-1)
                for end in (-1.0, 1.0)
            )
        )
        angular_now = np.linalg.norm(velocities.angular, axis=-1)
        axes = turned(poses.rotations, tree.axes)
        across_now = np.linalg.norm(cross(velocities.angular[:, tree.parents], axes), axis=-1)
        angular, angular_change = np.zeros((2, *rates.shape))
        distance, speed, bend = np.zeros((3, *rates.shape))
        for j in tree.levels:
            p = tree.parents[j]
            turning, offset = angular[:, p], offsets[:, j]
            # |w_p x s_j|: what the parent's rotation has across the joint's axis
            across = np.minimum(turning, across_now[:, j] + half * angular_change[:, p])
            angular_change[:, j] = angular_change[:, p] + across * turns[:, j]
            angular[:, j] = np.minimum(
                turning + turns[:, j], angular_now[:, j] + half * angular_change[:, j]
            )
            distance[:, j], speed[:, j], bend[:, j] = tightened(
                poses.origins[:, j],
                velocities.linear[:, j],
                half,
                distance[:, p] + offset,
                speed[:, p] + turning * offset + slides[:, j],
                bend[:, p]
                + (angular_change[:, p] + turning**2) * offset
                + 2.0 * across * slides[:, j],
            )
        reach = Reach(distance, speed, bend)
        return Links(poses, velocities, half, reach, angular, angular_change)


def tightened(
    position: Array, velocity: Array, half: Array, distance: Array, speed: Array, bend: Array
) -> Reach:
    """Of the bounds along the arm and those from the values at the middle, the smaller each."""
    speed = np.minimum(speed, np.linalg.norm(velocity, axis=-1) + half * bend)
    distance = np.minimum(distance, np.linalg.norm(position, axis=-1) + half * speed)
    return Reach(distance, speed, bend)
