"""A lower bound on F over a lattice with posture axes, where no exact optimum can be had.

The base origin lies inside the robot at any attitude, if it lies in one of the root link's shapes:
then the clearance of a node is at most the distance of its base origin from the obstacles, and a
shortest path over base offsets alone with these distances costs no more than any path of the
lattice. Where a goal attitude is to be reached, no path is shorter than the joint steps that rotate
the base by that angle, each at the best rate of all steps.
"""

from __future__ import annotations

from itertools import cycle

import numpy as np

from ffsr_plan.collision.clearance import point_distances
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import OutOfTime
from ffsr_plan.core.rotations import IDENTITY, angle_between
from ffsr_plan.lattice.optimum import straight_bound
from ffsr_plan.lattice.shortest_path import LazyShortestPath
from ffsr_plan.problem.objective import nearness
from ffsr_plan.search.postures.posture_lattice import PostureLattice
from ffsr_plan.search.postures.posture_lattice_arrays import layer_scenes


def lower_bound(lattice: PostureLattice) -> float:
    """F that no path of the lattice falls below, in units of length; coarse at the deadline."""
    try:
        return _bound(lattice)
    except OutOfTime:
        return straight_bound(lattice.problem)


def _bound(lattice: PostureLattice) -> float:
    problem, base = lattice.problem, lattice.base
    m, count = problem.given_lattice.divisions, len(base.offsets)
    apart = np.full((m + 1, count), np.inf)
    if origin_is_inside(lattice) and len(problem.obstacles) and not base.nominal.mode.floats:
        places = base.nominal.positions[:, None] + base.offsets
        apart = np.empty((m + 1, count))
        for own, points, scene in zip(apart, places, cycle(layer_scenes(problem)), strict=False):
            lattice.deadline.check()
            own[:] = point_distances(scene, points)
    nodes = nearness(problem, apart)  # at least that of `clearance_cap`
    nodes[[0, -1]] = 0.0
    status = np.zeros((m, count, count), dtype=np.int8)
    edges = base.steps[None] / problem.length_unit
    search = LazyShortestPath(edges, nodes, status, base.origin, lattice.deadline)
    search.path()
    return max(search.least_cost, _rotation_bound(lattice) / problem.length_unit)


def origin_is_inside(lattice: PostureLattice) -> bool:
    """Whether the base origin lies inside a shape of the root link."""
    shapes = lattice.problem.robot.primitives
    for k in np.flatnonzero((shapes.links == 0) & shapes.exact):
        local = np.abs(shapes.rotations[k].T @ -shapes.positions[k])
        size = shapes.sizes[k]
        if shapes.kinds[k] == 1 and np.all(local <= size):
            return True
        beyond = np.array([local[0], local[1], max(local[2] - size[1], 0.0)])
        if shapes.kinds[k] == 0 and np.linalg.norm(beyond) <= size[0]:
            return True
    return False


def _rotation_bound(lattice: PostureLattice) -> float:
    """Least length [m] of joint steps that rotate the base by the angle demanded less 1 degree."""
    problem = lattice.problem
    if not problem.reach_attitude:
        return 0.0
    there, rates = lattice.successors >= 0, 0.0
    for rotated, squared in zip(lattice.step_rotations, lattice.squared_steps, strict=True):
        lattice.deadline.check()
        angles: Array = angle_between(IDENTITY, rotated[there])
        lengths = np.sqrt(problem.delta_d**2 + squared[there])
        each = np.where(lengths > 0.0, angles / np.maximum(lengths, 1e-12), 0.0)
        rates = max(rates, float(np.max(each, initial=0.0)))
    wanted = float(angle_between(problem.start[3:7], problem.goal[3:7])) - np.radians(1.0)
    return max(0.0, wanted / rates) if rates > 0.0 else 0.0
