"""Bounds on link distance, speed and acceleration in the base frame.

The bounds hold over an interval of an edge. They are computed from the base outwards: each is the
smaller of the bound that follows from the parent link and of the value at the middle of the
interval plus the largest change until its ends. docs/proof.md, section 4, derives them. Rates are
per unit of edge time, which has no dimension.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.rotations import cross
from ffsr_plan.robots.kinematics import Poses, Tree, Velocities, turned


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
