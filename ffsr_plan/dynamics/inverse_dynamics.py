"""`States`: positions, velocities, accelerations and forces along a motion with a time law.

A path and its pace, s' and s'', give everything else (`path_dynamics`): velocities, accelerations,
those of a reacting base included, and the forces of thrusters, wheels and joints.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, IntArray, equal_by_content
from ffsr_plan.core.rotations import cross
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.dynamics.path_dynamics import PathDynamics, Prescribed, path_dynamics


@equal_by_content
class States(NamedTuple):
    """Position, velocity, acceleration and forces of a motion at N instants.

    `configurations`, `velocities` and `accelerations` follow Pinocchio: the base velocity is linear
    [m/s], then angular [rad/s], both in base axes, and the base acceleration is the derivative of
    these six numbers. For the base in world axes see `base_velocity` and `base_acceleration`.

    Attributes:
        parameters: (N,) path parameters s in [0, 1], as in `Plan.at`.
        joints: (N, nd) joint values [rad or m], continuous joints without a jump at half a turn.
        configurations: (N, nq) configurations.
        velocities: (N, nv) base velocity (6, base axes), then joint velocities [rad/s or m/s].
        accelerations: (N, nv) derivative of `velocities`.
        thrust: (N, 3) force of the thrusters through the centre of mass, world axes [N].
        wheel_torque: (N, 3) moment of the wheels on the base, base axes [N m]; zero without wheels.
        wheel_momentum: (N, 3) momentum of the wheels, base axes [N m s]; zero without wheels.
        torques: (N, nd) joint torques without friction [N m, or N if prismatic].
    """

    parameters: Array
    joints: Array
    configurations: Array
    velocities: Array
    accelerations: Array
    thrust: Array
    wheel_torque: Array
    wheel_momentum: Array
    torques: Array

    def __repr__(self) -> str:
        count, joints = self.joints.shape
        return f"States({count} instants, {joints} joints)"

    @property
    def base_position(self) -> Array:
        """(N, 3) base origin in the world [m]."""
        return self.configurations[:, :3]

    @property
    def attitudes(self) -> Array:
        """(N, 4) attitude of the base, base axes to world axes (xyzw)."""
        return self.configurations[:, 3:7]

    @property
    def attitude(self) -> Array:
        """(N, 4) the same as `attitudes`."""
        return self.attitudes

    @property
    def joint_positions(self) -> Array:
        """(N, nd) the same as `joints` [rad or m]."""
        return self.joints

    @property
    def joint_velocities(self) -> Array:
        """(N, nd) joint velocities [rad/s or m/s]."""
        return self.velocities[:, 6:]

    @property
    def joint_accelerations(self) -> Array:
        """(N, nd) joint accelerations [rad/s^2 or m/s^2]."""
        return self.accelerations[:, 6:]

    @property
    def base_velocity(self) -> Array:
        """(N, 3) velocity of the base origin, world axes [m/s]."""
        return rotations.rotate(self.attitudes, self.velocities[:, :3])

    @property
    def angular_velocity(self) -> Array:
        """(N, 3) angular velocity of the base, base axes [rad/s]."""
        return self.velocities[:, 3:6]

    @property
    def base_acceleration(self) -> Array:
        """(N, 3) acceleration of the base origin, world axes [m/s^2]."""
        v = self.velocities
        along = self.accelerations[:, :3] + cross(v[:, 3:6], v[:, :3])
        return rotations.rotate(self.attitudes, along)


def states(
    motion: Motion,
    edge: IntArray,
    time: Array,
    pace: Array,
    acceleration: Array,
    push: Array | None = None,
) -> States:
    """The states of a motion at N instants, given its pace.

    Args:
        motion: the motion.
        edge: (N,) edges.
        time: (N,) times sigma on the edges, in [0, 1].
        pace: (N,) sigma' [1/s].
        acceleration: (N,) sigma'' [1/s^2].
        push: (N, 3) further acceleration of the base by thrusters, world axes [m/s^2], or None.

    Returns:
        The states, forces included.
    """
    steps = np.diff(motion.joint_values, axis=0)[edge]
    turns = motion.turns[edge] if motion.mode.has_wheels else np.zeros((len(edge), 3))
    base = _by_time(motion.base_steps()[edge], pace, acceleration)
    if push is not None:
        base[:, 1] += push
    path = Prescribed(
        motion.at(edge, time),
        motion.joints_at(edge, time),
        base,
        _by_time(turns, pace, acceleration),
        _by_time(steps, pace, acceleration),
    )
    dynamics, one = path_dynamics(motion.robot, motion.mode, path), np.ones(len(edge))
    return states_along(path, dynamics, (edge + time) / motion.edges, one, 0.0 * one)


def states_along(
    path: Prescribed, dynamics: PathDynamics, parameters: Array, pace: Array, acceleration: Array
) -> States:
    """The states at N points of a path, given the pace there.

    Args:
        path: the points.
        dynamics: of the path there.
        parameters: (N,) path parameters to state.
        pace: (N,) s' [1/s].
        acceleration: (N,) s'' [1/s^2].

    Returns:
        The states, forces included.
    """
    u, x = acceleration[:, None], pace[:, None] ** 2

    def of(pair: Array) -> Array:
        both: Array = pair[:, 0] * u + pair[:, 1] * x
        return both

    return States(
        parameters,
        path.joints,
        path.configurations,
        dynamics.velocities[:, 0] * pace[:, None],
        of(dynamics.velocities),
        of(dynamics.thrust),
        of(dynamics.wheel_torque),
        -dynamics.wheel_torque[:, 0] * pace[:, None],
        of(dynamics.torques),
    )


def _by_time(steps: Array, pace: Array, acceleration: Array) -> Array:
    """(N, 2, k) first and second derivatives by time, of steps (N, k) per unit of sigma."""
    return np.stack([steps * pace[:, None], steps * acceleration[:, None]], axis=1)


__all__ = ["States", "states", "states_along"]
