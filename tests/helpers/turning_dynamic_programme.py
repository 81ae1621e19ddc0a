"""Turning a planar robot by arm motion alone, as a dynamic programme: what the ants are held to.

States are (layer, posture, yaw bin). In the plane the yaw at a node is the sum of the yaws of the
joint steps, so that one run from the start gives the least joint path to every goal attitude at
once. Each state keeps the true yaw of its cheapest representative, not the middle of its bin:
rounding does not add up over the layers.

In what sense it is exact: every value is the length of a path that is really there, ending with
the yaw that it says. It is no less than the true optimum, and may be above it, as of two ways into
one bin only the cheaper one lives on, although the other's yaw, which differs by less than a bin,
might have fitted better in the end. Finer bins say how much that is (`test_turning`).
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from ffsr_plan.search.postures.posture_lattice import PostureLattice

HALF_DEGREE = math.radians(0.5)


class Oracle(NamedTuple):
    """Least joint path from the undisplaced posture back to it, by yaw bin."""

    lengths: np.ndarray
    """(bins,) L [m]; infinite where no path of the lattice leads."""
    yaws: np.ndarray
    """(bins,) yaw reached [rad]."""

    def least(self, yaw, within=HALF_DEGREE):
        """L [m] of the shortest path whose yaw is within `within` of `yaw` [rad]."""
        fits = np.abs(self.yaws - yaw) <= within
        return float(np.min(self.lengths[fits], initial=np.inf))

    @property
    def farthest(self):
        """The largest yaw that the lattice can bring about [rad], either way."""
        return float(np.max(np.abs(self.yaws[np.isfinite(self.lengths)])))


def turning_oracle(problem, bin_width=HALF_DEGREE / 2, most=240 * HALF_DEGREE):
    """The oracle of a planar problem without obstacles, whose nominal joints do not move.

    Args:
        problem: start and goal differ in attitude at most.
        bin_width: of a yaw bin [rad].
        most: yaws beyond this are given up [rad].
    """
    lattice = PostureLattice(problem)
    assert lattice.alike
    assert not len(problem.scene)
    assert problem.delta_d == 0.0
    turns, allowed = lattice.step_rotations[0], lattice.allowed[0]
    assert not np.any(turns[..., :2]), "only for robots that turn in their plane"
    lengths, yaws = _programme(
        2.0 * np.arctan2(turns[..., 2], turns[..., 3]),
        np.sqrt(lattice.squared_steps[0]),
        np.where(allowed[lattice.successors], lattice.successors, -1),
        problem.lattice.divisions,
        lattice.origin,
        bin_width,
        int(most / bin_width),
    )
    return Oracle(lengths, yaws)


@njit(cache=True)
def _programme(yaw_steps, lengths, successors, layers, origin, width, half):
    count, steps = successors.shape
    cost, yaw = np.full((count, 2 * half + 1), np.inf), np.zeros((count, 2 * half + 1))
    cost[origin, half] = 0.0
    for _ in range(layers):
        new_cost, new_yaw = np.full_like(cost, np.inf), np.zeros_like(yaw)
        for p in range(count):
            for k in range(2 * half + 1):
                if cost[p, k] == np.inf:
                    continue
                for step in range(steps):
                    on = successors[p, step]
                    if on < 0:
                        continue
                    turned = yaw[p, k] + yaw_steps[p, step]
                    b = math.floor(turned / width + 0.5) + half
                    total = cost[p, k] + lengths[p, step]
                    if 0 <= b <= 2 * half and total < new_cost[on, b]:
                        new_cost[on, b], new_yaw[on, b] = total, turned
        cost, yaw = new_cost, new_yaw
    return cost[origin], yaw[origin]
