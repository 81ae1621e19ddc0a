"""Dynamic singularities: configurations at which the generalized Jacobian J* loses a direction.

Where the base floats, a frame moves at J* theta'. The least singular value of J* is the speed that
it has, in its slowest direction, for joint rates of norm 1; the rates that a speed needs grow as
its inverse. It depends on masses and inertias, and on the joints alone (Papadopoulos and Dubowsky
1993).
"""

from __future__ import annotations

import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import truth, whole_number
from ffsr_plan.core.errors import InvalidInput, NearDynamicSingularity
from ffsr_plan.core.rotations import IDENTITY
from ffsr_plan.dynamics.momentum import generalized_jacobian
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.robots.robot import SpaceRobot

NEAR = 1e-3
"""Least singular value [m, rotations at 1 m per rad] below which a configuration counts as near."""
_SAMPLES = 3  # joint values at which the directions are counted that a frame has at all
_SPREAD = 1.0  # [rad or m] of these
_RANK = 1e-9  # of the largest singular value


def least_singular_value(
    robot: SpaceRobot, q: ArrayLike, frame: str, *, attitude: bool = True
) -> float:
    """Least singular value of the generalized Jacobian J* of a frame, free-floating.

    A frame of a planar robot moves in three directions, and one of an arm with few joints in no
    more than it has joints: directions in which the frame moves at no joint values do not count.

    Args:
        robot: the robot.
        q: (nq,) configuration.
        frame: name of a link, joint or other frame of the model.
        attitude: whether the frame is to be rotated too, at 1 m per rad, or only moved.

    Returns:
        The least singular value [m, rotations at 1 m per rad, for each unit of the joint rates].

    Raises:
        InvalidInput: unknown frame, with the nearest name, or a robot without joints.
    """
    rows = 6 if truth("attitude", attitude) else 3
    jacobian = generalized_jacobian(robot, q, frame)[:rows]
    return _value(jacobian, _directions(robot, frame, rows))


class SlowestPlace(NamedTuple):
    """Where along a plan a frame can move least.

    Attributes:
        value: least singular value of J* there; see `least_singular_value`.
        parameter: s in [0, 1], as in `Plan.at`.
    """

    value: float
    parameter: float


def slowest_place(motion: Motion, frame: str, attitude: bool, samples: int) -> SlowestPlace:
    """The least singular value of J* along a motion, at samples.

    Args:
        motion: in the mode free-floating.
        frame: name of a frame of the model.
        attitude: see `least_singular_value`.
        samples: of each edge, evenly spaced, at least 1.

    Raises:
        InvalidInput: another mode, an unknown frame, a robot without joints, or samples that are
            not allowed.
    """
    if not motion.mode.floats:
        raise InvalidInput("mode", str(motion.mode), "free-floating: J* is of a floating base")
    rows = 6 if truth("attitude", attitude) else 3
    count = motion.edges * whole_number("samples", samples, at_least=1, at_most=10_000)
    scaled = np.linspace(0.0, motion.edges, count + 1)
    edges = np.minimum(scaled.astype(np.int64), motion.edges - 1)
    directions = _directions(motion.robot, frame, rows)
    values = [
        _value(generalized_jacobian(motion.robot, q, frame)[:rows], directions)
        for q in motion.at(edges, scaled - edges)
    ]
    slowest = int(np.argmin(values))
    return SlowestPlace(values[slowest], float(scaled[slowest] / motion.edges))


def warn_if_near(robot: SpaceRobot, q: Array, frame: str, attitude: bool) -> None:
    """Warn of a configuration near a dynamic singularity.

    Args:
        robot: a free-floating robot with joints.
        q: (nq,) configuration.
        frame: name of a frame of the model.
        attitude: whether the frame's attitude is demanded too.
    """
    least = least_singular_value(robot, q, frame, attitude=attitude)
    if least < NEAR:
        text = (
            f"near a dynamic singularity of '{frame}': the least singular value of its generalized "
            f"Jacobian is {least:.2g}, below {NEAR:g}, so that a speed of 1 mm/s may need joint "
            f"rates of {1e-3 / max(least, 1e-12):.2g} rad/s"
        )
        warnings.warn(text, NearDynamicSingularity, stacklevel=3)


def _value(jacobian: Array, directions: int) -> float:
    return float(np.linalg.svd(jacobian, compute_uv=False)[directions - 1])


def _directions(robot: SpaceRobot, frame: str, rows: int) -> int:
    """Number of directions in which a frame moves at generic joint values."""
    if robot.nd == 0:
        raise InvalidInput("robot", robot.name, "a robot with joints")
    rng = np.random.default_rng(0)
    low = np.clip(-_SPREAD, robot.lower, robot.upper)
    high, most = np.clip(_SPREAD, robot.lower, robot.upper), 1
    for _ in range(_SAMPLES):
        q = robot.assemble(np.zeros(3), IDENTITY, rng.uniform(low, high))
        sizes = np.linalg.svd(generalized_jacobian(robot, q, frame)[:rows], compute_uv=False)
        most = max(most, int(np.sum(sizes > _RANK * sizes[0])))
    return most
