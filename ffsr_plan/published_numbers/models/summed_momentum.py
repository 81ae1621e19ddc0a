"""Base rotation and generalized Jacobian by sums over the bodies, apart from the package.

Poses and velocities are passed from body to body, and angular momentum is the sum of what each
body contributes. This shares no code with `dynamics`, and so stands in for a second program where a
publication has the model of a robot, but not the number.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.published_numbers.models.rigid_trees import RigidTree

_GAUSS = 0.5 - np.sqrt(3.0) / 6.0  # first of two Gauss points in [0, 1]


class BodyState(NamedTuple):
    """Pose and velocity of a body while the base rests.

    Attributes:
        rotation: (3, 3) from body to base axes.
        place: (3,) origin, base frame [m].
        turn: (3,) angular velocity, base axes [rad].
        drift: (3,) velocity of the origin, base axes [m].
    """

    rotation: Array
    place: Array
    turn: Array
    drift: Array


def body_states(tree: RigidTree, values: Array, rates: Array) -> dict[str, BodyState]:
    """States of all bodies by name, the base at rest.

    Args:
        tree: the robot.
        values: (nd,) joint values in the order of the bodies [rad].
        rates: (nd,) their derivatives by any parameter [rad].
    """
    zero = np.zeros(3)
    states, joint = {tree.bodies[0].name: BodyState(np.eye(3), zero, zero, zero)}, 0
    for body in tree.bodies[1:]:
        parent = states[body.parent]
        rotation = parent.rotation @ np.asarray(body.rotation)
        arm = parent.rotation @ np.asarray(body.place)
        turn = parent.turn
        if body.moves:
            cos, sin = np.cos(values[joint]), np.sin(values[joint])
            rotation = rotation @ np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
            turn = turn + rotation[:, 2] * rates[joint]
            joint += 1
        drift = parent.drift + np.cross(parent.turn, arm)
        states[body.name] = BodyState(rotation, parent.place + arm, turn, drift)
    return states


def base_turn(tree: RigidTree, values: Array, rates: Array) -> tuple[Array, Array]:
    """Velocities of the base at which the robot has no momentum.

    Args:
        tree: the robot.
        values: (nd,) joint values [rad].
        rates: (nd,) their derivatives by any parameter [rad].

    Returns:
        (3,) angular velocity of the base, and (3,) velocity of its origin where nothing moves the
        centre of mass, both in base axes [rad, m].
    """
    states = body_states(tree, values, rates)
    centers, drifts, masses = [], [], np.array([body.mass for body in tree.bodies])
    inertia, momentum = np.zeros((3, 3)), np.zeros(3)
    for body in tree.bodies:
        state = states[body.name]
        lever = state.rotation @ np.asarray(body.center)
        own = state.rotation @ body.tensor @ state.rotation.T
        inertia += own
        momentum += own @ state.turn
        centers.append(state.place + lever)
        drifts.append(state.drift + np.cross(state.turn, lever))
    center, drift = masses @ np.array(centers) / tree.mass, masses @ np.array(drifts) / tree.mass
    for mass, place, moved in zip(masses, centers, drifts, strict=True):
        arm = place - center
        inertia += mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        momentum += mass * np.cross(arm, moved - drift)
    turn = -np.linalg.solve(inertia, momentum)
    velocity: Array = -drift - np.cross(turn, center)
    return np.asarray(turn, dtype=np.float64), velocity


def generalized_jacobian(tree: RigidTree, values: Array, frame: str) -> Array:
    """(6, nd) Jacobian J* of a body's frame, base axes: linear rows [m], then angular [rad].

    Args:
        tree: the robot, free-floating.
        values: (nd,) joint values [rad].
        frame: name of the body.
    """
    columns = []
    for rates in np.eye(len(values)):
        state = body_states(tree, values, rates)[frame]
        turn, drift = base_turn(tree, values, rates)
        velocity = drift + np.cross(turn, state.place) + state.drift
        columns.append(np.concatenate([velocity, turn + state.turn]))
    return np.array(columns).T


def fixed_jacobian(tree: RigidTree, values: Array, frame: str) -> Array:
    """(6, nd) ordinary Jacobian J of a body's frame on a base at rest; axes as for J*."""
    states = [body_states(tree, values, rates)[frame] for rates in np.eye(len(values))]
    return np.array([np.concatenate([state.drift, state.turn]) for state in states]).T


def base_rotation(
    tree: RigidTree, path: Callable[[float], tuple[Array, Array]], steps: int
) -> Array:
    """(3, 3) rotation of the base along a joint path, by a Magnus method of fourth order.

    Args:
        tree: the robot.
        path: joint values (nd,) and their derivatives (nd,) at a time from 0 to 1 [rad].
        steps: number of steps.
    """
    from scipy.spatial.transform import Rotation

    whole, step = Rotation.identity(), 1.0 / steps
    for k in range(steps):
        first, second = (
            base_turn(tree, *path((k + share) * step))[0] for share in (_GAUSS, 1.0 - _GAUSS)
        )
        turn = 0.5 * step * (first + second)
        turn += np.sqrt(3.0) / 12.0 * step**2 * np.cross(first, second)
        whole = whole * Rotation.from_rotvec(turn)
    return np.asarray(whole.as_matrix())


def straight(begin: Array, end: Array) -> Callable[[float], tuple[Array, Array]]:
    """The straight joint path between (nd,) joint values [rad], for `base_rotation`."""
    return lambda time: (begin + time * (end - begin), end - begin)
