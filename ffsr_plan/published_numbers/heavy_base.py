"""Umetani and Yoshida's generalized Jacobian: its formula, and its limit on a heavy base."""

from __future__ import annotations

import numpy as np

from ffsr_plan.published_numbers.air_bearing_robot import START, air_bearing_robot
from ffsr_plan.published_numbers.free_panda import free_panda, loop
from ffsr_plan.published_numbers.models.summed_momentum import fixed_jacobian
from ffsr_plan.published_numbers.models.summed_momentum import generalized_jacobian as by_sums
from ffsr_plan.published_numbers.recomputed_number import FORMULA, RecomputedNumber

_SOURCE = (
    "Y. Umetani, K. Yoshida (1989). Resolved motion rate control of space manipulators with "
    "generalized Jacobian matrix. IEEE Trans. Robotics and Automation 5(3)"
)
_MASSES = (1e5, 1e6, 1e7)  # [kg] of the base


def recomputed() -> list[RecomputedNumber]:
    """The norm of J* of the Panda's hand, and how J* approaches J."""
    from ffsr_plan.dynamics.momentum import generalized_jacobian

    tree, values = free_panda(), loop(0.6, 8)[1]
    robot = tree.robot()
    q = robot.assemble(np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), values)
    found = float(np.linalg.norm(generalized_jacobian(robot, q, "hand")))
    expected = float(np.linalg.norm(by_sums(tree, values, "hand")))
    return [
        RecomputedNumber("norm of J* of the free Panda's hand", "", FORMULA, expected, found, 1e-9,
                         _SOURCE, "robot and configuration are those of the free Panda"),
        RecomputedNumber("slope of log |J* - J| in log base mass, heavy base", "", FORMULA, -1.0,
                         _slope(), 1e-3, _SOURCE, "arm of the air-bearing robot; m (.5 m)^2"),
    ]  # fmt: skip


def _slope() -> float:
    from ffsr_plan.dynamics.momentum import generalized_jacobian

    tree, missing = air_bearing_robot(), []
    for mass in _MASSES:
        robot = tree.on_base(mass, 3 * (0.25 * mass,)).robot()
        q = robot.assemble(np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]), START)
        star = generalized_jacobian(robot, q, "hand")
        missing.append(np.linalg.norm(star - fixed_jacobian(tree, START, "hand")))
    return float(np.polyfit(np.log(_MASSES), np.log(missing), 1)[0])
