"""Compiled cost of a path through base offsets and postures, base rotation included.

The attitude at a node is the product of the base rotations over all joint steps before it, so that
a change anywhere changes everything behind it. Costs are in metres: F of Eq. 8 times its unit of
length. Collision and goal attitude error are penalised, not forbidden, so that a search can pass
through paths that it has to leave again.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.collision.nearest_obstacle_kernels import (
    STACK_SIZE,
    distance_to_obstacle,
    nearest_obstacle,
)
from ffsr_plan.core.arrays import Array, Flags, IntArray
from ffsr_plan.core.kernels.compilation import kernel

COLLISION_COST = 3.0  # [m] of cost for a collision
DEPTH_COST = 15.0  # [m] of cost for each metre of its depth
FREE_ATTITUDE_ERROR = math.radians(0.5)
"""Error of the goal attitude that costs nothing at first: the correction behind the search closes
it."""


class Obstacles(NamedTuple):
    """The scene's `ObstacleTree`, and the kinds of the shapes that are held against it.

    Where bodies move there is a tree for each layer, one behind another; see `obstacles_on`.
    """

    nodes: Array
    children: NDArray[np.int32]
    spheres: Array
    solid: NDArray[np.int32]
    solids: Array
    planes: Array
    balls: Array
    kinds: IntArray
    """(g,) of `Primitives`."""


class ClearanceCost(NamedTuple):
    """Constants of the cost of a node.

    Attributes:
        weight: delta times the unit of length squared [m^2].
        cap: clearance beyond which the cost does not fall [m], infinite where there is none.
    """

    weight: float
    cap: float


class PostureGrid(NamedTuple):
    """Lattice data for the compiled search: b base offsets, n postures, k steps, g shapes."""

    obstacles: Obstacles
    spans: IntArray
    """(m + 1, 5, 2) rows of nodes, spheres, solids, planes and balls on each layer: first, end."""
    rows: IntArray
    """(m + 1,) row that stands for each layer in the arrays of postures: 0 where all are alike."""
    frames: Array
    """(rows, n, g, 15) shapes relative to the base."""
    places: Array
    """(m + 1, b, 3) base origin, or where it floats the robot's centre of mass [m]."""
    centers: Array
    """(rows, n, 3) centre of mass, base frame; zero where thrusters hold the base origin."""
    across: Array
    """(b, b) squared length between base offsets, in Eq. 6 [m^2]."""
    indices: IntArray
    """(n, axes) of the postures."""
    successors: IntArray
    """(n, k)."""
    squared_steps: Array
    """(rows, n, k) squared length of joint steps [m^2]."""
    step_rotations: Array
    """(rows, n, k, 4) rotation of the base over joint steps."""
    allowed: Flags
    """(rows, n)."""
    refused: IntArray
    """(r, 5) refused edges: layer, base offsets and postures at both ends."""
    neighbours: IntArray
    """(b, j) base offsets adjacent to each, -1 where there is none."""
    origin: IntArray
    """(2,) base offset and posture of start and goal."""
    start: Array
    """(4,) attitude."""
    goal: Array
    """(4,) attitude; counts where it is to be reached."""
    clearance_cost: ClearanceCost
    delta_d: float
    """[m]."""
    reach_attitude: bool
    """Whether the goal attitude is to be reached."""
    free_error: float
    """Error of the goal attitude that costs nothing [rad]."""
    radii: Array
    """(rows, n) largest distance of any point of the shapes from the centre of rotation [m]."""
    queries: IntArray
    """(1,) configurations whose distance was asked for so far; counted by the kernels."""


class Workspace(NamedTuple):
    """Buffers of a search for the nearest obstacle."""

    frame: Array
    shift: Array
    stack: NDArray[np.int32]
    bounds: Array
    found: IntArray
    """(1,) the nearest obstacle of the search before, its row."""


class CostedPath(NamedTuple):
    """A path with the terms of its cost."""

    nodes: IntArray
    """(m + 1, 2) base offset and posture on each layer."""
    lengths: Array
    """(m,) of the edges [m]."""
    quats: Array
    """(m + 1, 4) attitudes."""
    clearances: Array
    """(m + 1,) at the nodes [m]."""
    costs: Array
    """(m + 1,) of the nodes [m]."""
    least: Array
    """(m + 1,) what the nodes cost at least [m]."""


@kernel
def step_between(indices: IntArray, tail: int, head: int) -> int:
    """Which of a posture's steps leads to another one; -1 if none does."""
    step = 0
    for axis in range(indices.shape[1]):
        change = indices[head, axis] - indices[tail, axis]
        if change < -1 or change > 1:
            return -1
        step = 3 * step + change + 1
    return step


@kernel
def new_workspace() -> Workspace:
    """Workspace to work in, for one thread."""
    stack, bounds = np.empty(STACK_SIZE, np.int32), np.empty(STACK_SIZE)
    return Workspace(np.empty(15), np.zeros(3), stack, bounds, np.zeros(1, np.int64))


@kernel
def is_free(grid: PostureGrid) -> bool:
    """Whether there are no obstacles, or no shapes that could touch them."""
    around = grid.obstacles
    some = len(around.spheres) + len(around.planes) + len(around.balls)
    return some == 0 or len(around.kinds) == 0


@kernel
def obstacles_on(grid: PostureGrid, layer: int) -> Obstacles:
    """The obstacles where they are when the robot is on a layer."""
    every, span = grid.obstacles, grid.spans[layer]
    shaped = len(every.solid) > 0
    return Obstacles(
        every.nodes[span[0, 0] : span[0, 1]],
        every.children[span[0, 0] : span[0, 1]],
        every.spheres[span[1, 0] : span[1, 1]],
        every.solid[span[1, 0] : span[1, 1]] if shaped else every.solid[:0],
        every.solids[span[2, 0] : span[2, 1]],
        every.planes[span[3, 0] : span[3, 1]],
        every.balls[span[4, 0] : span[4, 1]],
        every.kinds,
    )


@kernel
def clearance_at(
    obstacles: Obstacles,
    frames: Array,
    place: Array,
    center: Array,
    quat: Array,
    workspace: Workspace,
) -> float:
    """Least distance [m] to any obstacle at a node and an attitude; for hulls, of their boxes.

    Args:
        obstacles: of the layer.
        frames: (g, 15) of the posture.
        place: (3,) of the base offset.
        center: (3,) of the posture.
        quat: (4,) attitude.
        workspace: buffers.
    """
    x, y, z, w = quat[0], quat[1], quat[2], quat[3]
    r = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    frame, least, nearest = workspace.frame, np.inf, workspace.found[0]
    for g in range(len(frames)):
        own = frames[g]
        for a in range(3):
            for b in range(3):
                frame[3 * a + b] = r[a][0] * own[b] + r[a][1] * own[3 + b] + r[a][2] * own[6 + b]
            frame[9 + a] = place[a] + (
                r[a][0] * (own[9] - center[0])
                + r[a][1] * (own[10] - center[1])
                + r[a][2] * (own[11] - center[2])
            )
            frame[12 + a] = own[12 + a]
        kind, shift = obstacles.kinds[g], workspace.shift
        # an obstacle that was near gives a small distance to start with
        least = min(least, distance_to_obstacle(obstacles, kind, frame, shift, nearest, least))
        least, nearest = nearest_obstacle(
            obstacles, kind, frame, shift, least, nearest, workspace.stack, workspace.bounds
        )
    workspace.found[0] = nearest
    return least


@kernel
def node_cost(constants: ClearanceCost, clearance: float, inner: bool) -> float:
    """Cost [m] of a node: delta / d, or that of a collision."""
    if clearance <= 0.0:
        return COLLISION_COST - DEPTH_COST * clearance
    if not inner:
        return 0.0
    return constants.weight / min(clearance, constants.cap)


@kernel
def edge_length(delta_d: float, across: float, squared_step: float) -> float:
    """d_pq of Eq. 6 [m], posture steps included; the latter two squared."""
    return math.sqrt(delta_d * delta_d + across + squared_step)


@kernel
def compose(p: Array, q: Array, product: Array) -> None:
    """Rotation p q (xyzw)."""
    product[0] = p[3] * q[0] + p[0] * q[3] + p[1] * q[2] - p[2] * q[1]
    product[1] = p[3] * q[1] - p[0] * q[2] + p[1] * q[3] + p[2] * q[0]
    product[2] = p[3] * q[2] + p[0] * q[1] - p[1] * q[0] + p[2] * q[3]
    product[3] = p[3] * q[3] - p[0] * q[0] - p[1] * q[1] - p[2] * q[2]


@kernel
def angle_to(p: Array, q: Array) -> float:
    """Angle [rad] of the rotation from p to q."""
    x = p[3] * q[0] - p[0] * q[3] - p[1] * q[2] + p[2] * q[1]
    y = p[3] * q[1] + p[0] * q[2] - p[1] * q[3] - p[2] * q[0]
    z = p[3] * q[2] - p[0] * q[1] + p[1] * q[0] - p[2] * q[3]
    w = p[3] * q[3] + p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
    return 2.0 * math.atan2(math.sqrt(x * x + y * y + z * z), abs(w))


@kernel
def is_refused(refused: IntArray, layer: int, b: int, p: int, b_on: int, p_on: int) -> bool:
    """Whether an edge has been refused."""
    for k in range(len(refused)):
        r = refused[k]
        if r[0] == layer and r[1] == b and r[2] == p and r[3] == b_on and r[4] == p_on:
            return True
    return False


@kernel
def attitude_cost(
    reach_attitude: bool, quat: Array, goal: Array, free_error: float, weight: float
) -> float:
    """Cost [m] of the attitude at the goal, a radian beyond the free error costing `weight` [m]."""
    if not reach_attitude:
        return 0.0
    return weight * max(0.0, angle_to(quat, goal) - free_error)


@kernel
def take_edges(grid: PostureGrid, path: CostedPath, first: int, last: int) -> bool:
    """Work out the edges first .. last - 1 of a path; whether all of them exist.

    The attitude on layer `first` is given; lengths and later attitudes are filled in.
    """
    nodes, quats, step_rotations, squared_steps = (
        path.nodes,
        path.quats,
        grid.step_rotations,
        grid.squared_steps,
    )
    across, indices, allowed, refused = grid.across, grid.indices, grid.allowed, grid.refused
    delta_d, rows = grid.delta_d, grid.rows
    for i in range(first, last):
        b, p, b_on, p_on = nodes[i, 0], nodes[i, 1], nodes[i + 1, 0], nodes[i + 1, 1]
        step = step_between(indices, p, p_on)
        if step < 0 or not allowed[rows[i + 1], p_on] or is_refused(refused, i, b, p, b_on, p_on):
            return False
        row = rows[i]
        path.lengths[i] = edge_length(delta_d, across[b, b_on], squared_steps[row, p, step])
        compose(quats[i], step_rotations[row, p, step], quats[i + 1])
    return True


@kernel
def visit(
    grid: PostureGrid,
    path: CostedPath,
    first: int,
    last: int,
    total: float,
    limit: float,
    workspace: Workspace,
) -> float:
    """Cost the nodes on the layers first .. last - 1 at their attitudes; fill in clearances.

    Args:
        grid: the lattice.
        path: the path, of which `path.least` has already been counted in for these nodes.
        first: the first layer.
        last: the layer after the last one.
        total: cost so far [m].
        limit: stop where the cost exceeds it [m].
        workspace: buffers.

    Returns:
        The total with the nodes' costs in place of the least ones; infinite beyond the limit.
    """
    frames, places, centers, rows = grid.frames, grid.places, grid.centers, grid.rows
    nodes, quats = path.nodes, path.quats
    free = is_free(grid)
    for i in range(first, last):
        b, p, clearance = nodes[i, 0], nodes[i, 1], np.inf
        if not free:
            grid.queries[0] += 1
            row = rows[i]
            clearance = clearance_at(
                obstacles_on(grid, i), frames[row, p], places[i, b], centers[row, p], quats[i],
                workspace,
            )  # fmt: skip
        path.clearances[i] = clearance
        path.costs[i] = node_cost(grid.clearance_cost, clearance, i + 1 < len(nodes))
        total += path.costs[i] - path.least[i]
        if total > limit:
            return np.inf
    return total


@kernel
def path_cost(grid: PostureGrid, path: CostedPath, weight: float) -> float:
    """Cost [m] of a path, all of whose entries are worked out; infinite if an edge does not exist.

    Args:
        grid: the lattice.
        path: the path; all but its nodes is filled in.
        weight: of a radian by which the goal attitude is missed [m].
    """
    m, workspace = len(path.nodes) - 1, new_workspace()
    path.quats[0] = grid.start
    path.least[:] = 0.0
    if not take_edges(grid, path, 0, m):
        return np.inf
    error_cost = attitude_cost(
        grid.reach_attitude, path.quats[m], grid.goal, grid.free_error, weight
    )
    total = np.sum(path.lengths) + error_cost
    return visit(grid, path, 1, m + 1, total, np.inf, workspace)
