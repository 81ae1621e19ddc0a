"""A lattice with posture axes as arrays for the compiled search."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.rotations import rotate
from ffsr_plan.problem.problem import Problem
from ffsr_plan.scene.scene import Scene
from ffsr_plan.search.postures.cost_kernels import (
    FREE_ATTITUDE_ERROR,
    ClearanceCost,
    Obstacles,
    PostureGrid,
)
from ffsr_plan.search.postures.posture_lattice import PostureLattice


def posture_grid(lattice: PostureLattice) -> PostureGrid:
    """The arrays of a lattice, no edge refused and no distance queried yet.

    The large ones are the lattice's own; the search does not change them.
    """
    problem, base = lattice.problem, lattice.base
    nominal, cap = base.nominal, problem.clearance_cap
    places = nominal.positions[:, None] + base.offsets
    if nominal.mode.floats:  # the centre of mass, at rest
        center = rotate(problem.start[3:7], lattice.centers[0, lattice.origin])
        places = np.broadcast_to(problem.start[:3] + center, places.shape)
    obstacles, spans = _obstacles(problem)
    return PostureGrid(
        obstacles=obstacles,
        spans=spans,
        rows=lattice.rows,
        frames=lattice.frames,
        places=np.array(places, order="C"),
        centers=lattice.centers,
        across=(base.distances * problem.position_weight) ** 2,
        indices=np.array(lattice.indices, order="C"),
        successors=np.array(lattice.successors, order="C"),
        squared_steps=lattice.squared_steps,
        step_rotations=lattice.step_rotations,
        allowed=lattice.allowed,
        refused=np.zeros((0, 5), dtype=np.int64),
        neighbours=_neighbours(base.indices),
        origin=np.array([base.origin, lattice.origin]),
        start=np.array(problem.start[3:7]),
        goal=np.array(problem.goal[3:7]),
        clearance_cost=ClearanceCost(
            weight=problem.delta * problem.length_unit**2,
            cap=np.inf if cap is None else cap,
        ),
        delta_d=problem.delta_d,
        reach_attitude=problem.reach_attitude,
        free_error=FREE_ATTITUDE_ERROR,
        radii=_radii(lattice),
        queries=np.zeros(1, dtype=np.int64),
    )


def layer_scenes(problem: Problem) -> list[Scene]:
    """The obstacles where they are on each layer; one scene for all where nothing moves.

    Args:
        problem: a problem on a lattice.
    """
    scene, m = problem.obstacles, problem.given_lattice.divisions
    pace = problem.pace(m)
    if not scene.moves or pace is None:
        return [scene]
    return [scene.at(time) for time in pace.instants(np.arange(m + 1.0)).tolist()]


def _obstacles(problem: Problem) -> tuple[Obstacles, IntArray]:
    """The trees of all layers, one behind another, and (m + 1, 5, 2) the rows of each."""
    trees = [scene.tree for scene in layer_scenes(problem)]
    parts = [(t.nodes, t.spheres, t.solids, t.planes, t.balls) for t in trees]
    counts = np.array([[len(part) for part in each] for each in parts], dtype=np.int64)
    ends = np.cumsum(counts, axis=0)
    spans = np.stack([ends - counts, ends], axis=2)
    if len(trees) == 1:
        spans = np.tile(spans, (problem.given_lattice.divisions + 1, 1, 1))
    nodes, spheres, solids, planes, balls = map(np.concatenate, zip(*parts, strict=True))
    return Obstacles(
        nodes,
        np.concatenate([tree.children for tree in trees]),
        spheres,
        np.concatenate([tree.solid for tree in trees]),
        solids,
        planes,
        balls,
        np.array(problem.robot.primitives.kinds),
    ), spans


def without_edge(grid: PostureGrid, layer: int, path: IntArray) -> PostureGrid:
    """The same arrays with the edge refused by which a path (m + 1, 2) leaves a layer."""
    edge = np.array([[layer, *path[layer], *path[layer + 1]]], dtype=np.int64)
    return grid._replace(refused=np.vstack([grid.refused, edge]))


def _radii(lattice: PostureLattice) -> Array:
    """(rows, n) largest distance of any point of the shapes from the centre of rotation [m]."""
    frames = lattice.frames
    result = np.zeros(frames.shape[:2])
    if frames.shape[2]:
        for row, own, centers in zip(result, frames, lattice.centers, strict=True):
            places = np.linalg.norm(own[..., 9:12] - centers[:, None], axis=-1)
            row[:] = np.max(places + np.sum(own[..., 12:15], axis=-1), axis=-1)
    return result


def _neighbours(indices: IntArray) -> IntArray:
    """(b, 2 axes) base offsets one step to either side along each axis, -1 where there is none."""
    number = {tuple(index): b for b, index in enumerate(indices.tolist())}
    result = np.full((len(indices), 2 * indices.shape[1]), -1, dtype=np.int64)
    for b, index in enumerate(indices.tolist()):
        for axis in range(indices.shape[1]):
            for side, change in enumerate((-1, 1)):
                beside = list(index)
                beside[axis] += change
                result[b, 2 * axis + side] = number.get(tuple(beside), -1)
    return result
