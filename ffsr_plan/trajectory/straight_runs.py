"""Straight runs of a motion: chains of edges along which no direction changes.

A time law changes only when the robot is where. Along a straight run it moves all coordinates in
fixed proportion, so one number x describes the position, and every limit is a limit on x. Between
two runs a velocity would have to change instantly. Joints cannot do that: if their direction
changes, or their pace relative to a base that wheels rotate, the robot has to rest. If only the
path of the base has a corner, thrusters can pass it with a pulse.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.dynamics.motion import Motion

_SMALLEST_STEP = 1e-12  # [m or rad] smaller steps over an edge count as zero
_HARDLY = 1e-9  # [rad or m] joint steps that, as x, would drown in the rounding of its sum
_PARALLEL = 1e-7  # relative change of direction below which there is no corner


class StraightRuns(NamedTuple):
    """The r straight runs of a motion of m edges; edges without motion belong to none.

    Along a run x grows by one if the joint values and the base's rotation change by a vector of
    length one or, if they hardly change, if the base moves by one metre.

    Attributes:
        corners: (m + 1,) x at the nodes.
        scales: (m,) their differences, edge by edge, which have no rounding error of the sum.
        first: (r,) first edge of each run.
        last: (r,) last edge of each run.
        base: (r, 3) displacement of the base origin by thrusters, world axes [m per unit of x].
        turn: (r, 3) rotation of the base by wheels, base axes [rad per unit of x].
        joints: (r, nd) joint displacements [rad or m per unit of x].
    """

    corners: Array
    scales: Array
    first: IntArray
    last: IntArray
    base: Array
    turn: Array
    joints: Array

    @property
    def lengths(self) -> Array:
        """(r,) length of each run in x."""
        return self.corners[self.last + 1] - self.corners[self.first]

    def rates(self) -> Array:
        """(r, 2 + nd) rates per unit of x: base origin [m], base rotation [rad], each joint."""
        norms = [np.linalg.norm(part, axis=1) for part in (self.base, self.turn)]
        return np.column_stack([*norms, np.abs(self.joints)])

    def jumps(self) -> Array:
        """Change of the base's velocity between consecutive runs.

        Returns:
            (r - 1, 3) per unit of x' [m]; infinite if the velocity of joints or of the base's
            rotation would change too.
        """
        change = np.diff(self.base, axis=0)
        others = np.diff(np.hstack([self.turn, self.joints]), axis=0)
        change[np.linalg.norm(others, axis=1) > _PARALLEL] = np.inf
        return change

    def locate(self, run: IntArray, x: Array) -> tuple[IntArray, Array, Array]:
        """Edges and times on them at positions along runs.

        Args:
            run: (N,) runs.
            x: (N,) positions.

        Returns:
            Edge (N,), time on it in [0, 1] (N,), and x per unit of that time (N,).
        """
        edge = np.searchsorted(self.corners, x, side="right") - 1
        edge = np.clip(edge, self.first[run], self.last[run])
        scale = self.scales[edge]
        return edge, np.clip((x - self.corners[edge]) / scale, 0.0, 1.0), scale


def straight_runs(motion: Motion) -> StraightRuns:
    """The longest straight runs of a motion.

    Args:
        motion: the motion.

    Returns:
        The runs; none if nothing moves.
    """
    rotations = np.zeros((motion.edges, 3)) if motion.mode.attitude_reacts else motion.turns
    joint_steps = np.diff(motion.joint_values, axis=0)
    steps = np.hstack([motion.base_steps(), rotations, joint_steps])
    steps[np.abs(steps) <= _SMALLEST_STEP] = 0.0
    scale = np.linalg.norm(steps[:, 3:], axis=1)
    base = np.linalg.norm(steps[:, :3], axis=1)
    scale = np.where((scale > _HARDLY) | (base == 0.0), scale, base)
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
        corners=np.concatenate([[0.0], np.cumsum(scale)]),
        scales=scale,
        first=moving[starts],
        last=moving[ends],
        base=along[:, :3],
        turn=along[:, 3:6],
        joints=along[:, 6:],
    )
