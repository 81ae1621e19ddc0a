"""`Motion`: the continuous whole-body motion through a sequence of corners.

Between corners the base origin and the joints move linearly; the attitude follows the mode: it
reacts to the arms (free-flying) or turns steadily from start to goal (attitude-held).
"""

from __future__ import annotations

import copy
from functools import cached_property

import numpy as np

from ffsr_plan import attitude
from ffsr_plan.inputs import Array, IntArray, frozen
from ffsr_plan.problem import Problem
from ffsr_plan.reaction import Reaction


class Motion:
    """Configurations along edges 0 .. m-1, each run from time 0 to 1.

    Attributes:
        positions: (m + 1, 3) base origin at the corners, world [m].
        joint_values: (m + 1, nd) at the corners [rad or m].
        attitudes: (m + 1, 4) base attitude at the corners (xyzw), reaction included.
    """

    def __init__(self, problem: Problem, positions: Array) -> None:
        """The motion of `problem` through base positions (m + 1, 3) of one's choice."""
        self.problem = problem
        divisions = problem.lattice.divisions
        progress = np.arange(divisions + 1) / divisions
        begin = problem.robot.joint_values(problem.start)
        self.positions = frozen(np.array(positions, dtype=np.float64))
        self.joint_values = frozen(begin + progress[:, None] * problem.joint_travel)
        self.attitudes = frozen(self._attitudes(progress))

    @property
    def _reacts(self) -> bool:
        return self.problem.mode == "free-flying"

    @cached_property
    def reaction(self) -> Reaction:
        """The base rotation that the joint path, one straight segment, brings about."""
        return Reaction(self.problem.robot, self.joint_values[[0, -1]])

    def displaced(self, offsets: Array) -> Motion:
        """The same motion with the base displaced by (m + 1, 3) [m] at the corners."""
        twin = copy.copy(self)
        twin.positions = frozen(self.positions + offsets)
        return twin

    def configurations(self) -> Array:
        """(m + 1, nq) configurations at the corners."""
        return self.problem.robot.assemble(self.positions, self.attitudes, self.joint_values)

    def at(self, edge: IntArray, time: Array) -> Array:
        """(N, nq) configurations on `edge` (N,) at `time` (N,) in [0, 1]."""
        t = time[:, None]
        position = (1.0 - t) * self.positions[edge] + t * self.positions[edge + 1]
        joints = (1.0 - t) * self.joint_values[edge] + t * self.joint_values[edge + 1]
        quat = self._attitudes((edge + time) / self.problem.lattice.divisions)
        return self.problem.robot.assemble(position, quat, joints)

    def _attitudes(self, progress: Array) -> Array:
        """(N, 4) at path parameters (N,): nodes differ in translation only, which turns nothing."""
        start, goal = self.problem.start[3:7], self.problem.goal[3:7]
        if not self._reacts:
            return attitude.slerp(start, goal, progress)
        turned = self.reaction.rotation(np.zeros(len(progress), dtype=np.int64), progress)
        return attitude.multiply(start, turned)
