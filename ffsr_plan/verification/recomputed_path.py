"""What a plan says of its path besides L and F: on a lattice, the nodes and F before refinement.

A refined plan lies beside the nodes that it names, within the lattice's window. Its path on the
lattice has the same attitudes and joint values, so that F of that path can be computed too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.verification.motion_samples import Sampler
from ffsr_plan.verification.recomputed_objective import (
    AGREEMENT,
    length_of,
    objective_of,
    tolerances,
)
from ffsr_plan.verification.separation import SampledDistances
from ffsr_plan.verification.urdf_reading import Bodies

if TYPE_CHECKING:
    from ffsr_plan.plans.plan_data import PlanData

_INNER = 39  # stations at which F counts the clearance without a lattice
_OFF_THE_AXES = 1e-9  # [m], and relative to the distance travelled


class LatticePath:
    """The nodes of a plan, placed by the settings of its lattice alone.

    Attributes:
        positions: (m + 1, 3) base origins of the nodes; empty where the robot floats [m].
        joint_values: (m + 1, nd) of the nodes [rad or m].
        moved: whether the plan's base leaves its nodes.
        bent: whether the plan's joints leave its nodes.
    """

    def __init__(self, plan: PlanData) -> None:
        """Place the nodes of a plan."""
        problem, lattice = plan.problem, plan.problem.given_lattice
        m = lattice.divisions
        progress = np.arange(m + 1)[:, None] / m
        nodes = plan.nodes.reshape(m + 1, -1)
        self._axes = _directions(plan)
        spacing = np.array([getattr(lattice, name).spacing for name in lattice.axes])
        self._window = spacing * [getattr(lattice, name).half_count for name in lattice.axes]
        travel = problem.goal[:3] - problem.start[:3]
        self._straight = problem.start[:3] + progress * travel
        offsets = nodes[:, : len(spacing)] * spacing
        self.positions: Array = self._straight + offsets @ self._axes
        first, last = plan.motion.joint_values[[0, -1]]
        self.joint_values: Array = first + progress * (last - first)
        self.joint_values += _displacements(plan, nodes[:, len(spacing) :], self.joint_values)
        self._plan, self._allowed = plan, _OFF_THE_AXES * max(1.0, float(np.linalg.norm(travel)))
        apart = 0.0 if problem.mode.floats else np.abs(plan.motion.positions - self.positions).max()
        self.moved = bool(apart > self._allowed)
        bend = np.max(np.abs(plan.motion.joint_values - self.joint_values), initial=0.0)
        self.bent = bool(bend > AGREEMENT)

    def problems(self, bodies: Bodies, nodes: Array) -> list[str]:
        """What contradicts the nodes, the objective on the lattice, or the optimum.

        Args:
            bodies: the robot, from its URDF.
            nodes: (m + 1,) clearances measured at the plan's own nodes [m].
        """
        plan, problem = self._plan, self._plan.problem
        found = []
        if np.any(plan.nodes.reshape(len(nodes), -1)[[0, -1]]):
            found.append("the nodes do not begin and end without an offset")
        if self.moved and problem.given_lattice.postures:
            found.append("the base positions are not those of the nodes")
        if self.moved and not self._in_window():
            found.append("the base leaves the window of the lattice")
        if self.bent and not (problem.given_lattice.postures and problem.reach_attitude):
            found.append("the joint values are not those of the nodes")
        rises = plan.objective > plan.lattice_objective * (1.0 + AGREEMENT)
        if rises and problem.delta == 0.0 and not self.bent:
            found.append(
                f"F is {plan.objective:.12g}, above F on the lattice, {plan.lattice_objective:.12g}"
            )
        on_lattice = self._lattice_objective(bodies, nodes)
        if on_lattice is not None:
            least, value, share = on_lattice
            if least <= 0.0:
                found.append("a node of the lattice path is in collision")
            elif abs(value - plan.lattice_objective) > share * max(value, 1e-12):
                stated = plan.lattice_objective
                found.append(f"F on the lattice is {value:.12g}, not {stated:.12g}")
        own = plan.planner.exact and plan.optimum_is_exact
        if own and abs(plan.optimum - plan.lattice_objective) > AGREEMENT * plan.optimum:
            found.append("the optimum is not F of the exact planner's own path")
        if plan.optimum < self._least() * (1.0 - AGREEMENT):
            found.append(f"the optimum is below F of any path, {self._least():.12g}")
        return found

    def _in_window(self) -> bool:
        """Whether the base stays in the lattice's layers and within its window."""
        offsets = self._plan.motion.positions - self._straight
        along = offsets @ self._axes.T
        off = np.abs(offsets - along @ self._axes).max()
        beyond = np.max(np.abs(along) - self._window, initial=0.0)
        return bool(max(off, beyond) <= self._allowed)

    def _lattice_objective(self, bodies: Bodies, nodes: Array) -> tuple[float, float, float] | None:
        """Least clearance, F and its relative tolerance on the lattice; None if bent off it."""
        problem = self._plan.problem
        if self.bent:
            return None
        if self.moved:
            sampler = Sampler(self._plan, bodies)
            order = np.arange(sampler.edges + 1)
            edge = np.minimum(order, sampler.edges - 1)
            samples = sampler.at(edge, (order - edge).astype(np.float64))
            samples = samples._replace(base_places=self.positions - problem.start[:3])
            distances = SampledDistances(bodies, problem.obstacles, problem.start[:3])
            nodes = distances.clearances(samples)
        value = objective_of(problem, length_of(problem, self.positions, self.joint_values), nodes)
        return float(nodes.min()), value, tolerances(problem, bodies, nodes, value)[1]

    def _least(self) -> float:
        """F of the straight path past obstacles that are far away, below which no path falls."""
        problem = self._plan.problem
        m, cap = problem.given_lattice.divisions, problem.clearance_cap
        progress = np.arange(m + 1)[:, None] / m
        first, last = self._plan.motion.joint_values[[0, -1]]
        straight = length_of(problem, self._straight, first + progress * (last - first))
        far = np.full(m + 1, np.inf if cap is None else cap)
        return objective_of(problem, straight, far)


def path_of(plan: PlanData) -> LatticePath | FreePath | ProgressPath:
    """The path of a plan, on its lattice or without one."""
    lattice = plan.problem.lattice
    if lattice is not None and lattice.progress is not None:
        return ProgressPath(plan)
    return FreePath(plan) if lattice is None else LatticePath(plan)


def _directions(plan: PlanData) -> Array:
    """(axes, 3) unit vectors of the base axes: lateral, then normal; world axes."""
    problem, names = plan.problem, plan.problem.given_lattice.axes
    if not names:
        return np.zeros((0, 3))
    x, y, z = problem.goal[:3] - problem.start[:3]
    flat = float(np.hypot(x, y))
    far = float(np.hypot(flat, z))
    # the lateral axis is horizontal, to the right of the way; the normal one perpendicular to both
    level = np.array([-y / flat, x / flat, 0.0]) if flat > 1e-9 * far else np.array([1.0, 0.0, 0.0])
    way = np.array([x, y, z]) / far
    normal = np.cross(way, level)
    normal /= np.linalg.norm(normal)
    axes = {"lateral": np.cross(normal, way), "normal": normal}
    return np.array([axes[name] for name in names])


def _displacements(plan: PlanData, indices: IntArray, nominal: Array) -> Array:
    """(m + 1, nd) displacement of the joints by posture axes at indices (m + 1, axes)."""
    robot = plan.problem.robot
    total = np.zeros_like(nominal)
    for axis, index in zip(plan.problem.given_lattice.postures, indices.T, strict=False):
        target = getattr(axis, "towards", None)
        if isinstance(target, str):
            for name, value in robot.postures[target].items():
                k = robot.joint_names.index(name)
                total[:, k] += index / axis.levels * (value - nominal[:, k])  # type: ignore[union-attr]
        else:
            for name, value in axis.joints:  # type: ignore[union-attr]
                total[:, robot.joint_names.index(name)] += index * axis.spacing * value  # type: ignore[union-attr]
    return total


class FreePath:
    """The path of a plan without a lattice.

    Attributes:
        moved: False, as there is no lattice to move it off.
        bent: False, for the same reason.
    """

    moved = bent = False

    def __init__(self, plan: PlanData) -> None:
        """Take a plan."""
        self._plan, self._counted = plan, _INNER + 2

    def problems(self, bodies: Bodies, nodes: Array) -> list[str]:
        """What contradicts the window, the objective or the lower bound.

        Args:
            bodies: the robot, from its URDF.
            nodes: (m + 1,) clearances measured at the plan's own nodes [m].
        """
        plan, found = self._plan, []
        low, high = plan.problem.base_window
        places = plan.motion.positions
        outside = np.any(places < low - AGREEMENT) or np.any(places > high + AGREEMENT)
        if outside and not plan.problem.mode.floats:
            found.append("the base leaves the window")
        if plan.lattice_objective != plan.objective:
            found.append(f"F is stated as {plan.objective:.12g} and {plan.lattice_objective:.12g}")
        if plan.optimum > plan.objective * (1.0 + AGREEMENT):
            found.append(f"the lower bound is {plan.optimum:.12g}, above F, {plan.objective:.12g}")
        if plan.optimum < self._least() * (1.0 - AGREEMENT):
            found.append(f"the lower bound is below F of any path, {self._least():.12g}")
        return found

    def _least(self) -> float:
        """F of the straight way past obstacles that are far away, below which no path falls."""
        problem, motion = self._plan.problem, self._plan.motion
        robot, change = problem.robot, motion.joint_values[-1] - motion.joint_values[0]
        turns = np.round(change / (2.0 * np.pi))
        change = np.where(np.isinf(robot.upper), change - 2.0 * np.pi * turns, change)
        weights = np.where(robot.prismatic, problem.position_weight, problem.rotation_weight)
        square = float(np.sum((change * weights) ** 2))
        if problem.mode.has_thrusters:
            way = (problem.goal[:3] - problem.start[:3]) * problem.position_weight
            square += float(way @ way)
        if problem.mode.has_wheels:
            ends = [np.linalg.norm(problem.start[3:7] + k * problem.goal[3:7]) for k in (-1, 1)]
            angle = 4.0 * np.arctan2(min(ends), max(ends))
            square += float((angle * problem.rotation_weight) ** 2)
        cap = np.inf if problem.clearance_cap is None else problem.clearance_cap
        return objective_of(problem, float(np.sqrt(square)), np.full(self._counted, cap))


class ProgressPath(FreePath):
    """The path of a plan on a lattice whose nodes have progress: waits and steps back too."""

    def __init__(self, plan: PlanData) -> None:
        """Take a plan."""
        super().__init__(plan)
        self._counted = len(plan.nodes)

    def problems(self, bodies: Bodies, nodes: Array) -> list[str]:
        """What contradicts the nodes, their steps, the objective or the optimum.

        Args:
            bodies: the robot, from its URDF.
            nodes: (m + 1,) clearances measured at the plan's own nodes [m].
        """
        plan, problem, lattice = self._plan, self._plan.problem, self._plan.problem.given_lattice
        progress = lattice.progress
        assert progress is not None
        indices = plan.nodes.reshape(len(plan.nodes), -1)
        aside, along = indices[:, :-1], indices[:, -1]
        spacing = np.array([getattr(lattice, name).spacing for name in lattice.axes])
        share = along[:, None] / progress.steps
        travel = problem.goal[:3] - problem.start[:3]
        places = problem.start[:3] + share * travel + (aside * spacing) @ _directions(plan)
        first, last = plan.motion.joint_values[[0, -1]]
        joints = first + np.minimum(np.maximum(share, 0.0), 1.0) * (last - first)
        allowed, found = _OFF_THE_AXES * max(1.0, float(np.linalg.norm(travel))), []
        if np.abs(plan.motion.positions - places).max() > allowed:
            found.append("the base positions are not those of the nodes")
        if np.max(np.abs(plan.motion.joint_values - joints), initial=0.0) > AGREEMENT:
            found.append("the joint values are not those of the nodes")
        if np.any(aside[[0, -1]]) or along[0] != 0 or along[-1] != progress.steps:
            found.append("the nodes do not begin at the start and end at the goal")
        steps = np.abs(np.diff(indices, axis=0))
        too_far = np.any(steps[:, -1] > progress.most) or np.any(steps[:, :-1] > progress.aside)
        if (
            too_far
            or along.min() < -progress.before
            or along.max() > progress.steps + progress.beyond
        ):
            found.append("the nodes are farther from one another or beyond than the lattice allows")
        if not plan.lattice_objective == plan.objective == plan.optimum:
            found.append(f"F is {plan.objective:.12g}, and not that of the lattice or its optimum")
        if plan.optimum < self._least() * (1.0 - AGREEMENT):
            found.append(f"the optimum is below F of any path, {self._least():.12g}")
        return found
