"""Local searches for joint values at which a frame meets its pose at the end of the motion."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.goal_poses.pose_error import (
    PoseTarget,
    end_configuration,
    end_of_path,
    pose_error,
    pose_jacobian,
)

POSE_TOLERANCE = 1e-8
"""Norm of the pose error [m and rad] below which a pose counts as met."""
DESCENTS = 16
"""Descents from different joint values of which the first starts at those of the start."""
COARSE, FINE = (1e-2, 80), (1e-15, 200)
"""Relative change of the squared error at which a descent ends, and its most evaluations."""
_TURN_ROUNDING = 1e-9  # of a turn
_BEYOND_HALF_TURN = np.pi + 0.5
# [rad] to which descents may rotate a continuous joint: half a turn itself lies well inside


class Descent:
    """Damped least squares over the changes of the joint values (nd,) from start to end."""

    def __init__(self, target: PoseTarget) -> None:
        robot = target.robot
        self._target, self._begin = target, robot.joint_values(target.start)
        continuous = np.isinf(robot.upper)
        self._low = np.where(continuous, -_BEYOND_HALF_TURN, robot.lower - self._begin)
        self._high = np.where(continuous, _BEYOND_HALF_TURN, robot.upper - self._begin)
        self._free = self._high - self._low > 1e-9  # the others are fixed by their limits
        self._turning = ~robot.prismatic
        self._latest: tuple[bytes, Array] | None = None  # a change and its end

    @property
    def no_change(self) -> Array:
        """(nd,) zeros: the joint values of the start."""
        return np.zeros_like(self._begin)

    def random_change(self, rng: np.random.Generator) -> Array:
        """(nd,) uniform within the limits, revolute joints by at most half a turn."""
        # more than half a turn only makes the path longer
        most = np.where(self._target.robot.prismatic, np.inf, np.pi)
        return rng.uniform(np.maximum(self._low, -most), np.minimum(self._high, most))

    def run(self, first: Array, effort: tuple[float, int]) -> Array:
        """(nd,) local minimum of the squared pose error near a first change (nd,)."""
        from scipy.optimize import least_squares

        low, high, free = self._low, self._high, self._free
        if not free.any():
            return np.clip(first, low, high)
        margin = 1e-6 * (high - low)  # the solver needs an interior point
        result = least_squares(
            lambda values: self._error_of_path(self._whole(values)),
            np.clip(first, low + margin, high - margin)[free],
            lambda values: self._jacobian(self._whole(values))[:, free],
            (low[free], high[free]),
            xtol=1e-14,
            ftol=effort[0],
            gtol=1e-14,
            max_nfev=effort[1],
        )
        return self._whole(result.x)

    def turns(self, change: Array) -> Array:
        """(nd,) whole turns by which a revolute joint may change less, within its limits."""
        whole = 2.0 * np.pi
        turns = np.where(self._turning, np.rint(change / whole), 0.0)
        least = np.ceil((change - self._high) / whole - _TURN_ROUNDING)
        most = np.floor((change - self._low) / whole + _TURN_ROUNDING)
        return np.asarray(np.clip(turns, np.minimum(least, 0.0), np.maximum(most, 0.0)))

    def solutions(self, change: Array) -> list[Array]:
        """The changes (nd,) of `change`, with and without needless turns, that meet the pose.

        Those without turns come first. A whole turn leaves all links where they are, but not a base
        that reacts to it; then the pose is approached again from the change without the turns.
        """
        if np.linalg.norm(self._error_of_path(change)) >= POSE_TOLERANCE:
            return []
        changes, turns = [change], self.turns(change)
        if turns.any():
            less = np.clip(change - 2.0 * np.pi * turns, self._low, self._high)
            reacts = self._target.mode.attitude_reacts
            changes.insert(0, self.run(less, COARSE) if reacts else less)
        return [each for each in changes if np.linalg.norm(self.error(each)) < POSE_TOLERANCE]

    def end(self, change: Array) -> Array:
        """(nq,) end configuration of a change (nd,), base reaction included."""
        return end_configuration(self._target, self._begin + change)

    def error(self, change: Array) -> Array:
        """(3,) or (6,) pose error there; see `pose_error`."""
        return pose_error(self._target, self.end(change))

    def _error_of_path(self, change: Array) -> Array:
        """Like `error`, but smooth where a continuous joint goes beyond half a turn."""
        return pose_error(self._target, self._end_of_path(change))

    def _end_of_path(self, change: Array) -> Array:
        """(nq,) end of the path; error and Jacobian ask for the same one after the other."""
        key = change.tobytes()
        if self._latest is None or self._latest[0] != key:
            self._latest = key, end_of_path(self._target, self._begin, change)
        return self._latest[1]

    def _whole(self, values: Array) -> Array:
        change: Array = np.clip(0.0, self._low, self._high)
        change[self._free] = values
        return change

    def _jacobian(self, change: Array) -> Array:
        return pose_jacobian(self._target, self._begin, change, self._end_of_path(change))


def descents(descent: Descent) -> list[tuple[float, Array]]:
    """Error and change (nd,) at the end of each descent, always from the same first changes."""
    rng = np.random.default_rng(0)
    firsts = [descent.no_change, *(descent.random_change(rng) for _ in range(DESCENTS - 1))]
    changes = [descent.run(first, COARSE) for first in firsts]
    return [(float(np.linalg.norm(descent.error(change))), change) for change in changes]
