"""What a plan without a lattice says of its place, its lower bound and its objective."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.verification.recomputed_objective import AGREEMENT, objective_of
from ffsr_plan.verification.urdf_reading import Bodies

if TYPE_CHECKING:
    from ffsr_plan.plans.plan_data import PlanData

_INNER = 39  # stations at which F counts the clearance


class FreePath:
    """The path of a plan without a lattice.

    Attributes:
        moved: False, as there is no lattice to move it off.
        bent: False, for the same reason.
    """

    moved = bent = False

    def __init__(self, plan: PlanData) -> None:
        """Take a plan."""
        self._plan = plan

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
        return objective_of(problem, float(np.sqrt(square)), np.full(_INNER + 2, cap))
