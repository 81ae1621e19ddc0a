"""A dynamic programme over base offsets, postures and yaw, for planar robots.

States are (layer, base offset, posture, yaw bin). Steps and nodes have the costs of the colony, by
the same functions; a collision is forbidden here. As in
`tests/helpers/turning_dynamic_programme.py`, each state keeps the true yaw of its cheapest path, so
that rounding does not add up over the layers, and its clearance is computed at that yaw: one
distance query for each state that is reached.

The value is the cost of the path that is returned. It is no less than the optimum of the lattice
and may exceed it: of two paths into one bin only the cheaper one is kept, although the other,
whose yaw differs by less than a bin, may cost less at the goal.

States are dropped if the goal costs more from there than a known path, that of a coarser run. The
remaining cost is bounded from below by the cost to go of the base origin alone, which lies inside
the robot at any attitude.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from ffsr_plan.robots.shape_arrays import ROUND
from ffsr_plan.search.postures.ant_tour_kernels import cost_to_go
from ffsr_plan.search.postures.colony import AnnealingSettings
from ffsr_plan.search.postures.cost_kernels import (
    FREE_ATTITUDE_ERROR,
    angle_to,
    clearance_at,
    compose,
    edge_length,
    is_free,
    is_refused,
    new_workspace,
    node_cost,
)
from ffsr_plan.search.postures.lower_bound import origin_is_inside
from ffsr_plan.search.postures.posture_lattice_arrays import posture_grid

REACHABLE = math.radians(20.0)
ATTITUDE_WEIGHT = AnnealingSettings().attitude_weights[1]  # [m] of cost a radian


class Way(NamedTuple):
    """Result of the programme.

    Attributes:
        path: (m + 1, 2) base offset and posture on each layer of the cheapest path.
        cost: of the path [m]; infinite if there is none.
        queries: number of distances from the robot to the obstacles.
    """

    path: np.ndarray
    cost: float
    queries: int


def cheapest_way(lattice, bins, reach=REACHABLE, ceiling=np.inf, grid=None):
    """The cheapest path from start to goal with the yaw in bins.

    Args:
        lattice: of a robot that rotates in its plane.
        bins: an odd number.
        reach: the bins divide the yaws from -reach to reach [rad]; paths beyond are dropped.
        ceiling: cost of a known path [m]; only paths that cost no more are returned.
        grid: the result of `posture_grid`, if it exists already.

    Returns:
        The cheapest path, its cost and the number of queries.
    """
    grid = posture_grid(lattice) if grid is None else grid
    step_rotations = grid.step_rotations
    assert not np.any(step_rotations[..., :2]), "only for robots that turn in their plane"
    assert bins % 2 == 1
    ahead = least_to_go(lattice, grid)
    m, count, offsets = len(grid.rows) - 1, len(grid.successors), len(grid.across)
    before = np.full((m + 1, count, bins, offsets), -1, dtype=np.int32)
    path = np.empty((m + 1, 2), dtype=np.int64)
    yaw_steps = 2.0 * np.arctan2(step_rotations[..., 2], step_rotations[..., 3])
    width = 2.0 * reach / bins
    cost, queries = _programme(
        grid, yaw_steps, ahead, width, ATTITUDE_WEIGHT, ceiling + 1e-9, before, path
    )
    return Way(path, cost, queries)


def coarse_to_fine(lattice, bins, reach=REACHABLE, grid=None):
    """The same with each number of `bins` in turn, bounded by the least cost so far."""
    best, queries = Way(np.empty((0, 2)), np.inf, 0), 0
    for number in bins:
        way = cheapest_way(lattice, number, reach, best.cost, grid)
        queries += way.queries
        best = way if way.cost < best.cost else best
    return best._replace(queries=queries)


def least_to_go(lattice, grid):
    """(m + 1, b, n) lower bound on the cost [m] from a node to the goal, at any attitude."""
    point = np.zeros((*grid.frames.shape[:2], 1, 15))
    point[..., [0, 4, 8]] = 1.0
    inside = origin_is_inside(lattice)
    shrunk = grid._replace(
        obstacles=grid.obstacles._replace(
            kinds=np.array([ROUND] if inside else [], dtype=np.int64)
        ),
        frames=point,
        centers=np.zeros_like(grid.centers),
    )
    return cost_to_go(shrunk, np.tile(grid.start, (len(grid.rows), 1)))


@njit  # not cached on disk: the cache would not see changes of the colony's kernels
def _programme(grid, yaw_steps, ahead, width, weight, ceiling, before, path):
    m, count, bins, offsets = len(before) - 1, *before.shape[1:]
    steps, half = grid.successors.shape[1], bins // 2
    workspace, quat, delta_d = new_workspace(), np.empty(4), grid.delta_d
    free = is_free(grid)
    shape = count, bins, offsets
    cost, yaw = np.full(shape, np.inf), np.zeros(shape)
    new_cost, new_yaw = cost.copy(), yaw.copy()
    lengths = np.empty((steps, offsets, offsets))
    cost[grid.origin[1], half, grid.origin[0]] = 0.0
    queries = 0
    for i in range(m):
        new_cost[:] = np.inf
        row, row_on = grid.rows[i], grid.rows[i + 1]
        for p in range(count):
            if not np.any(cost[p] < np.inf):
                continue
            for step in range(steps):
                for b in range(offsets):
                    for b_on in range(offsets):
                        lengths[step, b, b_on] = edge_length(
                            delta_d, grid.across[b, b_on], grid.squared_steps[row, p, step]
                        )
            for k in range(bins):
                for b in range(offsets):
                    so_far = cost[p, k, b]
                    if so_far == np.inf:
                        continue
                    for step in range(steps):
                        on = grid.successors[p, step]
                        if on < 0 or not grid.allowed[row_on, on]:
                            continue
                        turned = yaw[p, k, b] + yaw_steps[row, p, step]
                        k_on = math.floor(turned / width + 0.5) + half
                        if k_on < 0 or k_on >= bins:
                            continue
                        for b_on in range(offsets):
                            total = so_far + lengths[step, b, b_on]
                            if total < new_cost[on, k_on, b_on] and not (
                                len(grid.refused) and is_refused(grid.refused, i, b, p, b_on, on)
                            ):
                                new_cost[on, k_on, b_on] = total
                                new_yaw[on, k_on, b_on] = turned
                                before[i + 1, on, k_on, b_on] = (p * bins + k) * offsets + b
        for p in range(count):
            for k in range(bins):
                for b in range(offsets):
                    arrival = new_cost[p, k, b]
                    new_cost[p, k, b] = np.inf
                    least = arrival + ahead[i + 1, b, p]
                    if least == np.inf or least > ceiling:
                        continue
                    queries += 1
                    _turned(grid, new_yaw[p, k, b], quat)
                    clearance = np.inf
                    if not free:
                        clearance = clearance_at(
                            grid.obstacles, grid.frames[row_on, p], grid.places[i + 1, b],
                            grid.centers[row_on, p], quat, workspace,
                        )  # fmt: skip
                    if clearance > 0.0:
                        own = node_cost(grid.clearance_cost, clearance, i + 1 < m)
                        new_cost[p, k, b] = arrival + own
        cost, new_cost = new_cost, cost
        yaw, new_yaw = new_yaw, yaw
    best, end = np.inf, -1
    b, p = grid.origin
    for k in range(bins):
        total = cost[p, k, b]
        if grid.reach_attitude and total < np.inf:
            _turned(grid, yaw[p, k, b], quat)
            total += weight * max(0.0, angle_to(quat, grid.goal) - FREE_ATTITUDE_ERROR)
        if total < best and total <= ceiling:
            best, end = total, (p * bins + k) * offsets + b
    if best < np.inf:
        for i in range(m, -1, -1):
            b, k, p = end % offsets, end // offsets % bins, end // (offsets * bins)
            path[i, 0], path[i, 1] = b, p
            end = before[i, p, k, b]
    return best, queries


@njit
def _turned(grid, yaw, quat):
    """Write the attitude of a base rotated in its plane by `yaw` since the start to `quat`."""
    compose(grid.start, np.array([0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)]), quat)
