"""Length L and objective F of a path (Eqs. 6 and 8), and F of the whole motion.

F contains the clearances at the nodes. Between two nodes a path may pass an obstacle closely at no
cost. In F of the whole motion the sum is over the edges, each with its least clearance. Where the
clearance hardly changes over an edge, both sums are alike.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.problem.problem import Problem


def path_length(problem: Problem, offsets: Array, displaced: Array | None = None) -> float:
    """Length of Eq. 6: sum of sqrt(delta_d^2 + |offset change|^2) over the edges.

    Args:
        problem: gives delta_d and the weights of a metre and a radian.
        offsets: (m + 1, 3) displacement from the nominal base position on each layer [m].
        displaced: (m + 1, nd) displacement from the nominal joint values, if any [rad or m].

    Returns:
        L [m].
    """
    across = np.sum((np.diff(offsets, axis=0) * problem.position_weight) ** 2, axis=1)
    if displaced is not None:
        slides = problem.robot.prismatic
        weights = np.where(slides, problem.position_weight, problem.rotation_weight)
        across = across + np.sum((np.diff(displaced, axis=0) * weights) ** 2, axis=1)
    return float(np.sum(np.sqrt(problem.delta_d**2 + across)))


def nearness(problem: Problem, clearances: Array) -> Array:
    """Clearance term of Eq. 8: delta / d_imin, with d in `length_unit`s.

    Args:
        problem: gives delta, the length unit and the cap.
        clearances: array of any shape [m]; larger ones count as `clearance_cap`.

    Returns:
        Array of the same shape [length units], infinite where the clearance is not above zero.
    """
    d = np.asarray(clearances, dtype=np.float64)
    if problem.clearance_cap is not None:
        d = np.minimum(d, problem.clearance_cap)
    if problem.delta == 0.0:
        return np.where(d > 0.0, 0.0, np.inf)
    with np.errstate(divide="ignore"):
        return np.where(d > 0.0, problem.delta * problem.length_unit / d, np.inf)


def objective(problem: Problem, length: float, clearances: Array) -> float:
    """Objective of Eq. 8: L + delta sum over layers 1 .. m-1 of 1 / d_imin.

    Args:
        problem: gives delta, the length unit and the cap.
        length: L [m].
        clearances: (m + 1,) clearances at the nodes [m].

    Returns:
        F [length units].
    """
    return length / problem.length_unit + float(np.sum(nearness(problem, clearances[1:-1])))


def motion_objective(problem: Problem, length: float, clearances: Array) -> float:
    """F of the whole motion: L + delta sum over all edges of 1 / (least clearance on the edge).

    Args:
        problem: gives delta, the length unit and the cap.
        length: L [m].
        clearances: (m,) least clearances on the edges [m].

    Returns:
        The value [length units], infinite if a clearance is not above zero.
    """
    return length / problem.length_unit + float(np.sum(nearness(problem, clearances)))
