"""Where a motion runs straight: its edges in chains along which no direction changes.

A time law decides only when the robot is where. Along a straight run it moves everything in fixed
proportion, so one number x says how far along it is, and every limit is a limit on x. Between two
runs a velocity would have to change at once. The joints cannot do that: where their direction
changes, or their pace against a base that wheels turn, the robot rests. Where the path of the base
alone has a corner, thrusters can, by a pulse.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.dynamics.motion import Motion

_STILL = 1e-12  # what moves less over an edge [m or rad] does not move
_PARALLEL = 1e-7  # of the speed: a smaller change of velocity is rounding, not a corner


class StraightRuns(NamedTuple):
    """r runs of a motion of m edges; edges along which nothing moves belong to none."""

    corners: Array
    """(m + 1,) x at the nodes. Its unit: joints and base turn by a vector of length one, or, where
    they do not move, the base goes one metre."""
    first: IntArray
    """(r,) first edge of each run."""
    last: IntArray
    """(r,) last edge of each run."""
    base: Array
    """(r, 3) displacement of the base origin by thrusters, world axes [m per unit of x]."""
    turn: Array
    """(r, 3) turn of the base by wheels, base axes [rad per unit of x]."""
    joints: Array
    """(r, nd) [rad or m per unit of x]."""

    @property
    def lengths(self) -> Array:
        """(r,) of x."""
        return np.asarray(self.corners[self.last + 1] - self.corners[self.first])

    def rates(self) -> Array:
        """(r, 2 + nd) per unit of x: of the base origin [m], its turn [rad], each joint."""
        norms = [np.linalg.norm(part, axis=1) for part in (self.base, self.turn)]
        return np.column_stack([*norms, np.abs(self.joints)])

    def jumps(self) -> Array:
        """(r - 1, 3) change of the base's velocity from run to run, per unit of x' [m].

        Infinite where something else would have to change its velocity too.
        """
        change = np.diff(self.base, axis=0)
        others = np.diff(np.hstack([self.turn, self.joints]), axis=0)
        change[np.linalg.norm(others, axis=1) > _PARALLEL] = np.inf
        return change

    def locate(self, run: IntArray, x: Array) -> tuple[IntArray, Array, Array]:
        """Edge (N,), time on it in [0, 1] (N,) and x per unit of that time, at x (N,) of runs."""
        edge = np.searchsorted(self.corners, x, side="right") - 1
        edge = np.clip(edge, self.first[run], self.last[run])
        scale = self.corners[edge + 1] - self.corners[edge]
        return edge, np.clip((x - self.corners[edge]) / scale, 0.0, 1.0), scale


def straight_runs(motion: Motion) -> StraightRuns:
    """The straight runs of a motion, as long as they can be."""
    turn = np.zeros(3) if motion.mode.attitude_reacts else motion.turn
    steps = np.hstack([
        motion.base_steps(),
        np.broadcast_to(turn, (motion.edges, 3)),
        np.diff(motion.joint_values, axis=0),
    ])  # fmt: skip
    steps[np.abs(steps) <= _STILL] = 0.0
    scale = np.linalg.norm(steps[:, 3:], axis=1)
    scale = np.where(scale > 0.0, scale, np.linalg.norm(steps[:, :3], axis=1))
    moving = np.flatnonzero(scale > 0.0)
    directions = steps[moving] / scale[moving, None]
    starts: list[int] = []  # indices into `moving`
    for k, direction in enumerate(directions):
        head = directions[starts[-1]] if starts else np.full(len(direction), np.inf)
        if not np.linalg.norm(direction - head) <= _PARALLEL * np.linalg.norm(direction):
            starts.append(k)
    ends = [*(k - 1 for k in starts[1:]), len(moving) - 1] if starts else []
    along = directions[starts]
    return StraightRuns(
        np.concatenate([[0.0], np.cumsum(scale)]), moving[starts], moving[ends],
        along[:, :3], along[:, 3:6], along[:, 6:],
    )  # fmt: skip
