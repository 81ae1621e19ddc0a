"""Lattice with posture axes: its nodes are base offsets times postures.

A node is (layer i, base offset b, posture p). Joints at (i, p) are the nominal ones of the layer
plus what the posture axes displace them by. From one layer to the next, a posture changes by at
most one step along each axis; base offsets change as they like.
"""

from __future__ import annotations

import math
from functools import cached_property
from itertools import product

import numpy as np

from ffsr_plan.collision.distances import SelfQuery
from ffsr_plan.collision.shape_placements import shape_placements
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array, Flags, IntArray, frozen
from ffsr_plan.core.cost_estimate import check_memory, check_work
from ffsr_plan.core.kernels.compilation import notify_after
from ffsr_plan.core.rotations import IDENTITY
from ffsr_plan.dynamics.momentum import centers_of_mass
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.problem.problem import Problem
from ffsr_plan.time_limit.deadline import Deadline

_BYTES_PER_STEP = 50  # rotation and squared length of a joint step, and its number
_BYTES_PER_PHEROMONE = 8  # of a joint step on a layer
_BYTES_PER_SHAPE = 120  # placement of a shape at a node
_BYTES_PER_PLACED_SHAPE = 450  # while the shapes at the nodes of one layer are placed
_BYTES_PER_OFFSET_EDGE = 30  # pheromone, ants and what they lay
_TOLERANCE = 1e-8  # [rad] of the reaction to a joint step; what is returned is integrated anew
_STEPS_AT_ONCE = 256  # joint steps whose reaction is integrated between two looks at the clock
_JOINT_STEP = 0.15  # [rad or m] that one substep of the base reaction suffices for
_POINTS = 13  # of a substep
_BYTES_PER_SUBSTEP = 150
_SECONDS_PER_POINT = 2e-7  # for each joint, base reaction at one point
_SECONDS_PER_PAIR = 4e-6  # distance of two links


class PostureLattice:
    """All nodes of a lattice with posture axes.

    Attributes:
        problem: what the lattice was built from.
        deadline: after which whatever takes long raises `OutOfTime`.
        base: base offsets and the nominal motion, as on a lattice without posture axes.
        indices: (n, axes) index of each posture along each axis, 0 = not displaced.
        origin: the posture without displacement.
        joint_values: (m + 1, n, nd) [rad or m].
        successors: (n, k) the postures within one step, -1 where there is none.
    """

    def __init__(self, problem: Problem, deadline: Deadline | None = None) -> None:
        """Build the lattice.

        Args:
            problem: a problem with posture axes.
            deadline: for this and for all arrays below; none by default.

        Raises:
            InvalidInput: it would take too much memory or computing time.
        """
        self.problem, self.deadline = problem, deadline or Deadline()
        _check_size(problem)
        self.base = LayeredLattice(problem)
        axes = problem.lattice.postures
        grids = np.meshgrid(*(np.array(a.indices) for a in axes), indexing="ij")
        self.indices: IntArray = frozen(np.stack([g.ravel() for g in grids], axis=1))
        self.origin = int(np.flatnonzero(~self.indices.any(axis=1))[0])
        nominal = self.base.nominal.joint_values
        values = np.repeat(nominal[:, None], len(self.indices), axis=1)
        directions = displacements(problem, nominal)
        for k, (axis, index) in enumerate(zip(axes, self.indices.T, strict=True)):
            values += directions[:, None, k] * axis.factors(index)[:, None]
        self.joint_values: Array = frozen(values)
        self.successors: IntArray = frozen(self._neighbours())

    @property
    def size(self) -> int:
        """n, the number of postures."""
        return len(self.indices)

    @cached_property
    def alike(self) -> bool:
        """Whether the postures of all layers are the same, so that one layer speaks for all."""
        return bool(np.allclose(self.joint_values, self.joint_values[:1], rtol=0.0, atol=1e-12))

    @cached_property
    def rows(self) -> IntArray:
        """(m + 1,) row that stands for each layer in the arrays below: 0 where all are alike."""
        count = len(self.joint_values)
        return np.zeros(count, dtype=np.int64) if self.alike else np.arange(count)

    @cached_property
    def allowed(self) -> Flags:
        """(rows, n) postures within the joints' limits whose links keep clear of each other."""
        robot, values = self.problem.robot, self._distinct_values
        inside: Flags = np.all((values >= robot.lower) & (values <= robot.upper), axis=2)
        query, apart = SelfQuery(robot, self.deadline), inside.copy()
        if not query.empty:
            for i, p in zip(*np.nonzero(inside), strict=True):
                q = robot.assemble(np.zeros(3), IDENTITY, values[i, p])
                apart[i, p] = query.distance(q) > 0.0
        return apart

    @cached_property
    def step_rotations(self) -> Array:
        """(rows, n, k, 4) rotation of the base over each joint step (xyzw), in its own axes.

        The last of several rows, that of the goal's layer, is left out.
        """
        layers = 1 if self.alike else len(self.joint_values) - 1
        n, k = self.successors.shape
        nominal = self.base.nominal
        still = IDENTITY if nominal.mode.attitude_reacts else rotations.exp(nominal.turn)
        result = np.tile(still, (layers, n, k, 1))
        if not (nominal.mode.attitude_reacts and self.problem.robot.nd):
            return result
        exists = np.tile(self.successors >= 0, (layers, 1, 1))
        if self.alike:  # step k - 1 - step goes back and undoes the rotation
            exists &= np.arange(k) > k // 2
        chosen = np.flatnonzero(exists)
        words = f"the base's reaction to {len(chosen)} joint steps, before the search"
        with notify_after(5.0, words):
            for first in range(0, len(chosen), _STEPS_AT_ONCE):
                self.deadline.check()
                some = chosen[first : first + _STEPS_AT_ONCE]
                i, p, step = np.unravel_index(some, exists.shape)
                begin, on = self.joint_values[i, p], self.successors[p, step]
                steps = self.joint_values[i + 1, on] - begin
                reaction = Reaction(self.problem.robot, begin, steps, _TOLERANCE, inside=False)
                turned = reaction.increments
                result[i, p, step] = turned
                if self.alike:
                    result[i, on, k - 1 - step] = rotations.inverse(turned)
        return result

    @cached_property
    def squared_steps(self) -> Array:
        """(rows, n, k) squared length of each joint step beyond the nominal one, in Eq. 6 [m^2].

        The last of several rows, that of the goal's layer, is left out.
        """
        problem = self.problem
        slides = problem.robot.prismatic
        weights = np.where(slides, problem.position_weight, problem.rotation_weight)
        displaced = self.joint_values - self.base.nominal.joint_values[:, None]
        result = np.empty((1 if self.alike else len(displaced) - 1, *self.successors.shape))
        for i, row in enumerate(result):
            self.deadline.check()
            steps = displaced[i + 1, np.maximum(self.successors, 0)] - displaced[i, :, None]
            np.sum((steps * weights) ** 2, axis=2, out=row)
        return result

    @cached_property
    def frames(self) -> Array:
        """(rows, n, g, 15) collision shapes relative to the base, as of `Placements.frames`."""
        robot, values = self.problem.robot, self._distinct_values
        result = np.empty((*values.shape[:2], len(robot.primitives.kinds), 15))
        for row, own in zip(result, values, strict=True):
            self.deadline.check()
            row[:] = shape_placements(robot, robot.assemble(np.zeros(3), IDENTITY, own)).frames
        return result

    @cached_property
    def centers(self) -> Array:
        """(rows, n, 3) centre of mass from the base origin [m]; zero where thrusters act."""
        robot, values = self.problem.robot, self._distinct_values
        result = np.zeros((*values.shape[:2], 3))
        if self.base.nominal.mode.floats:
            for row, own in zip(result, values, strict=True):
                self.deadline.check()
                row[:] = centers_of_mass(robot, own)
        return result

    @property
    def _distinct_values(self) -> Array:
        return self.joint_values[:1] if self.alike else self.joint_values

    def _neighbours(self) -> IntArray:
        axes = self.problem.lattice.postures
        number = {tuple(index): p for p, index in enumerate(self.indices.tolist())}
        steps = list(product((-1, 0, 1), repeat=len(axes)))
        rows = []
        for index in self.indices.tolist():
            self.deadline.check()
            beside = (tuple(a + b for a, b in zip(index, s, strict=True)) for s in steps)
            rows.append([number.get(each, -1) for each in beside])
        return np.array(rows, dtype=np.int64)


def _check_size(problem: Problem) -> None:
    """Raise `InvalidInput` if the arrays of the search, or their making, would take too much."""
    robot, settings = problem.robot, problem.lattice
    layers, shapes = settings.divisions + 1, int(robot.collision_model.ngeoms)
    postures = math.prod(len(axis.indices) for axis in settings.postures)
    offsets = math.prod(2 * getattr(settings, name).half_count + 1 for name in settings.axes)
    around = 3 ** len(settings.postures)
    reacts = problem.mode.attitude_reacts and robot.nd > 0
    substeps = math.ceil(_largest_step(problem) / _JOINT_STEP) if reacts else 0
    moves = bool(np.any(problem.joint_displacement))  # otherwise one layer speaks for all
    advice = "fewer divisions, fewer posture axes, or a smaller half_count or number of levels"
    counts = {"layers": layers, "postures": postures, "steps from a posture": around}
    share = 1.0 if moves else 1.0 / layers  # of the layers that have arrays of their own
    node = 24 * robot.nd + 8 * offsets + share * (_BYTES_PER_SHAPE * shapes + 40)
    each = _BYTES_PER_PHEROMONE + share * _BYTES_PER_STEP + node / around
    fixed = _BYTES_PER_OFFSET_EDGE * layers * offsets**2
    fixed += postures * (_BYTES_PER_PLACED_SHAPE * shapes + 24 * around * (1 + robot.nd))
    at_once = min(_STEPS_AT_ONCE, share * layers * postures * around)
    fixed += (24 * robot.nd + _BYTES_PER_SUBSTEP * substeps) * at_once
    check_memory("lattice postures", counts, each, advice, fixed)
    counts |= {"layers": layers if moves else 1, "points": _POINTS * substeps}
    check_work("lattice postures", counts, _SECONDS_PER_POINT * max(robot.nd, 1), advice)
    counts = {"layers": layers if moves else 1, "postures": postures}
    counts["pairs of links"] = len(robot.collision_model.collisionPairs)
    check_work("lattice postures", counts, _SECONDS_PER_PAIR, advice)


def _largest_step(problem: Problem) -> float:
    """Largest change of a joint from one layer to the next [rad or m], as a bound."""
    robot, settings = problem.robot, problem.lattice
    begin = robot.joint_values(problem.start)
    most = float(np.max(np.abs(problem.joint_displacement), initial=0.0)) / settings.divisions
    for axis in settings.postures:
        factor = float(np.max(np.abs(axis.factors(np.array([1])))))
        most += factor * float(np.max(np.abs(axis.displacement(robot, begin)), initial=0.0))
    return most


def displacements(problem: Problem, nominal: Array) -> Array:
    """(m + 1, axes, nd) what each posture axis displaces the joints along, on each layer.

    Args:
        problem: gives the axes.
        nominal: (m + 1, nd) joint values without displacement.
    """
    robot, axes = problem.robot, problem.lattice.postures
    return np.stack([axis.displacement(robot, nominal) for axis in axes], axis=1)
