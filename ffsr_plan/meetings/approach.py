"""`Approach`: curves along a motion whose ends have a given pose and twist of a frame.

The control points lie on the motion, in equal steps and at its end in ever smaller ones, so that a
curve at a steady pace comes to rest. To those of a window at the end a displacement is added, a
cubic in the number of the point: with the last point P_m and the last edge P_m - P_(m-1) it gives
the curve its end and its rate there, at which nothing is bent. What the base reacts to is the whole
way of the joints, so their values at the end are found by the Gauss-Newton method, with differences
for slopes and the least change of the joints.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.curves.control_points import ControlPoints, control_points_on
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.meetings.arrival import Arrival, EndState

_DIFFERENCE = 1e-6  # [rad or m] of the joints, for slopes
_SINGULAR = 1e-4  # relative; differences of a reaction are no better
_STEPS = 30
_WORTH = 0.1  # share of an error that is left, above which slopes are found again
_SMALLEST_STEP = 1.0 / 64.0  # of the full one
_TOLERANCE = 3e-12  # [m, rad] at which the search ends; the reaction is good to 1e-11
_ENOUGH = 1e-10  # [m, rad] that is accepted where it gets no better


class Found(NamedTuple):
    """A curve that ends as demanded.

    Attributes:
        curve: the curve.
        end: the state at its end.
    """

    curve: CurvedMotion
    end: EndState


class Approach(NamedTuple):
    """Curves of n pieces that differ in the joint values at their end.

    Attributes:
        arrival: what is demanded of the end.
        pieces: n.
        window: share of the pieces that the approach takes.
        end_speed: of the curve's parameter, on arrival [1/s].
    """

    arrival: Arrival
    pieces: int
    window: float
    end_speed: float

    def parameters(self) -> Array:
        """(n + 1,) of the control points on the motion; the last two are its end."""
        return braking(self.pieces, self.window) * self.arrival.motion.edges

    def found(self) -> Found | None:
        """The curve whose end is nearest to that of the motion; None without convergence."""
        robot = self.arrival.motion.robot
        joints = self.arrival.motion.joint_values[-1]
        missed, slope = self._missed(joints), None
        for _ in range(_STEPS):
            if np.linalg.norm(missed) < _TOLERANCE:
                break
            fresh = slope is None
            if slope is None:
                slope = self._slope(joints, missed)
            step, share = -np.linalg.pinv(slope, _SINGULAR) @ missed, 1.0
            while True:
                tried = np.clip(joints + share * step, robot.lower, robot.upper)
                rest = self._missed(tried)
                better = np.linalg.norm(rest) < np.linalg.norm(missed)
                if better or not fresh or share < _SMALLEST_STEP:
                    break
                share /= 2.0
            if np.linalg.norm(rest) > _WORTH * np.linalg.norm(missed):
                slope = None
            if better:
                joints, missed = tried, rest
            elif fresh:
                break
        if np.linalg.norm(missed) > _ENOUGH:
            return None
        return Found(self._curve(joints), self.arrival.state(joints))

    def _slope(self, joints: Array, missed: Array) -> Array:
        """(k, nd) derivative of what is missed by the joint values at the end."""
        steps = _DIFFERENCE * np.eye(len(joints))
        robot = self.arrival.motion.robot
        steps[joints + _DIFFERENCE > robot.upper] *= -1.0
        changes = np.array([self._missed(joints + step) - missed for step in steps])
        return np.asarray(changes.T / np.diag(steps))

    def _missed(self, joints: Array) -> Array:
        """(3,) or (6,) from the base at the end of a curve to where it should be [rad, m]."""
        motion, wanted = self.arrival.motion, self.arrival.state(joints).configuration
        if not motion.mode.attitude_reacts:
            return _turn(motion.attitudes[-1], wanted[3:7])
        curve = self._curve(joints)
        turn = _turn(curve.attitudes[-1], wanted[3:7])
        if not motion.mode.floats:
            return turn
        last = curve.at(np.array([curve.edges - 1]), np.ones(1))[0]
        return np.concatenate([turn, wanted[:3] - last[:3]])

    def _curve(self, joints: Array) -> CurvedMotion:
        motion = self.arrival.motion
        return CurvedMotion(motion, self._control(joints), joints_bend=True)

    def _control(self, joints: Array) -> ControlPoints:
        """Control points whose curve ends with given joint values (nd,)."""
        end, speed = self.arrival.state(joints), self.end_speed
        control = control_points_on(self.arrival.motion, self.parameters())
        positions = control.positions
        if not self.arrival.motion.mode.floats:
            origin, rate = end.configuration[:3], end.base_velocity / speed
            positions = with_end(positions, self.window, origin, rate)
        rates = end.joint_rates / speed
        joint_values = with_end(control.joint_values, self.window, joints, rates)
        return ControlPoints(positions, joint_values, control.shares)


def braking(pieces: int, window: float) -> Array:
    """Shares of a way in equal steps and, in a window at its end, in ever smaller ones.

    Args:
        pieces: n, number of steps.
        window: share of the steps that become smaller.

    Returns:
        (n + 1,) from 0 to 1; the last two are 1.
    """
    time = np.minimum(np.arange(pieces + 1.0) / (pieces - 1), 1.0)
    late = np.maximum(time - (1.0 - window), 0.0)
    passed = (time - 0.5 * late**2 / window) / (1.0 - 0.5 * window)
    passed[-2:] = 1.0
    return np.asarray(passed)


def with_end(points: Array, window: float, end: Array, rate: Array) -> Array:
    """Control points displaced in a window, so that their curve has a given end and a rate there.

    Args:
        points: (n + 1, k).
        window: share of them that is displaced.
        end: (k,) of the curve.
        rate: (k,) its derivative there by the curve's parameter.

    Returns:
        (n + 1, k).
    """
    pieces = len(points) - 1
    u = np.maximum(np.arange(-pieces, 1.0) / (window * pieces) + 1.0, 0.0)[:, None]
    whole, bow = u**2 * (3.0 - 2.0 * u), u**2 * (u - 1.0)
    points = points + whole * (end - points[-1])
    bows = (rate - (points[-1] - points[-2])) / (bow[-1] - bow[-2])
    moved: Array = points + bow * bows
    moved[-1] = end
    return moved


def _turn(begin: Array, end: Array) -> Array:
    """(3,) rotation from one attitude to another, in the axes of the first [rad]."""
    return rotations.log(rotations.multiply(rotations.inverse(begin), end))
