"""The colony where the attitude at a node depends on the way there.

Ants are guided by the cost to go at the nominal attitude, and lay pheromone on changes of the base
offset and on posture steps, layer by layer. What they find is improved by shifting whole segments
of a path; a longer annealing of such shifts ends the search. Every path is costed at the attitude
that it really leads to.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.core.kernels import call
from ffsr_plan.core.rotations import rotate, slerp
from ffsr_plan.search.postures.annealing_kernels import anneal, blank_course
from ffsr_plan.search.postures.cost_kernels import Ground, Obstacles, path_cost
from ffsr_plan.search.postures.posture_lattice import PostureLattice
from ffsr_plan.search.postures.walk_kernels import cost_to_go, deposit, walk
from ffsr_plan.search.records import Cycle, History, Watch

_KEEN = 0.15  # metres of detour that an ant takes e times less often
_PERSISTENCE, _LEAST = 0.9, 0.02
_SHIFTS = 200  # tried on the best ant of a cycle
_PATIENCE = 30  # cycles without improvement that end the walking
_ANNEALING = 3000  # shifts for each layer in an annealing, where the arms have to turn the base,
_PASSING = 1000  # and where they need not loop
_COLD = 1e-3
_HEATS = ((1.0, 0.03), (1.0, _COLD), (0.3, _COLD))
"""Temperatures [m] between which the annealings that end the search cool. Whether and how often the
arms loop is settled hot, where the first one stays; the cooler ones polish."""
_MISSED = np.array([5.0, 100.0])  # metres of cost for a radian of attitude missed, early and late


class Found(NamedTuple):
    """What the colony found."""

    path: IntArray
    """(m + 1, 2) base offset and posture on each layer."""
    cost: float
    """In metres, with penalties if something collides or the goal attitude is missed."""
    history: History
    """Costs per cycle [m]."""
    walked: IntArray
    """(m, b, b) ants on each change of the base offset, all cycles together."""
    interrupted: bool


def ground_of(lattice: PostureLattice) -> Ground:
    """The lattice as the ants see it, nothing barred."""
    problem, base = lattice.problem, lattice.base
    robot, tree, nominal = problem.robot, problem.scene.tree, base.nominal
    places = nominal.positions[:, None] + base.offsets
    if nominal.mode.floats:  # the centre of mass, at rest
        center = rotate(problem.start[3:7], lattice.centers[0, lattice.origin])
        places = np.broadcast_to(problem.start[:3] + center, places.shape)
    cap = np.inf if problem.clearance_cap is None else problem.clearance_cap
    near = problem.delta * problem.length_unit**2
    arrays = (
        lattice.frames, places, lattice.centers,
        (base.distances * problem.position_weight) ** 2, lattice.indices, lattice.successors,
        lattice.bends, lattice.turns, lattice.allowed, np.zeros((0, 5), dtype=np.int64),
        _beside(base.indices), np.array([base.origin, lattice.origin]), problem.start[3:7],
        problem.goal[3:7], np.array([near, cap, problem.delta_d, float(problem.reach_attitude)]),
        _reach(lattice),
    )  # fmt: skip
    kinds = np.array(robot.primitives.kinds)
    obstacles = Obstacles(np.array(tree.nodes), tree.children.copy(), tree.spheres.copy(), kinds)
    return Ground(obstacles, *(np.array(a, order="C") for a in arrays))


def search(
    lattice: PostureLattice,
    ground: Ground,
    ants: int,
    cycles: int,
    pheromone: bool,
    rng: np.random.Generator,
    watch: Watch,
) -> Found:
    """Send out the ants, then anneal the best path. Ctrl-C and the time limit end it early."""
    m, count, steps = ground.turns.shape[:3]
    offsets_count = len(ground.across)
    ahead = call(cost_to_go, ground, _nominal(lattice))
    tau = np.ones((m, offsets_count, offsets_count))
    tau_posture = np.ones((m, count, steps))
    best = np.tile(ground.origin, (m + 1, 1))
    best_cost = cost_of(ground, best)
    records: list[tuple[float, float, float, int]] = []
    stale, interrupted = 0, False
    walked = np.zeros((m, offsets_count, offsets_count), dtype=np.int64)
    layers = np.arange(m)
    try:
        for _ in range(cycles):
            paths, costs = [], []
            for _ in range(ants):
                path = np.empty((m + 1, 2), dtype=np.int64)
                if call(walk, ground, rng, ahead, _KEEN, tau, tau_posture, path):
                    paths.append(path)
                    walked[layers, path[:-1, 0], path[1:, 0]] += 1
                    costs.append(cost_of(ground, path))
            if not paths:
                break
            leader = paths[int(np.argmin(costs))]
            improved, cost = _descended(ground, rng, leader)
            stale += 1
            if cost < best_cost - 1e-9:
                best, best_cost, stale = improved, cost, 0
            distinct = len({path.tobytes() for path in paths})
            records.append((best_cost, cost, float(np.mean(costs)), distinct))
            if watch.on_cycle is not None:
                nodes = [path[:, 0] * count + path[:, 1] for path in (best, *paths)]
                counts = np.zeros((m + 1, offsets_count * count), dtype=np.int64)
                np.add.at(counts, (np.arange(m + 1), np.array(nodes[1:])), 1)
                unit = lattice.problem.length_unit
                watch.on_cycle(
                    Cycle(
                        len(records), cycles, best_cost / unit, cost / unit,
                        float(np.mean(costs)) / unit, distinct, nodes[0], counts, tau,
                    )
                )  # fmt: skip
            if pheromone:
                for trail in (tau, tau_posture):
                    np.maximum(_PERSISTENCE * trail, _LEAST, out=trail)
                leader = best if len(records) % 3 == 0 else improved
                call(deposit, ground, 1.0 - _PERSISTENCE, leader, tau, tau_posture)
            if stale >= _PATIENCE:
                break
            if watch.over():
                interrupted = True
                break
        if not interrupted:
            shifts = m * (_ANNEALING if lattice.problem.reach_attitude else _PASSING)
            for heats in _HEATS:
                found, cost = annealed(ground, rng, best, shifts, *heats)
                if cost < best_cost - 1e-9:
                    best, best_cost = found, cost
                records.append((best_cost, cost, cost, 1))
                if watch.over():
                    interrupted = True
                    break
    except KeyboardInterrupt:
        interrupted = True
    return Found(best, best_cost, _history(records), walked, interrupted)


def _descended(ground: Ground, rng: np.random.Generator, path: IntArray) -> tuple[IntArray, float]:
    """A path improved by shifts that lower its cost."""
    found, late = np.empty_like(path), np.full(2, _MISSED[1])
    cost = call(anneal, ground, rng, path, _SHIFTS, 1e-3, 1e-4, late, found)
    return found, float(cost)


def annealed(
    ground: Ground,
    rng: np.random.Generator,
    path: IntArray,
    shifts: int,
    hot: float,
    cold: float = _COLD,
) -> tuple[IntArray, float]:
    """The best path that annealing from `path` comes across, and its cost [m]."""
    found = np.empty_like(path)
    cost = call(anneal, ground, rng, path, shifts, hot, cold, _MISSED, found)
    return found, float(cost)


def cost_of(ground: Ground, path: IntArray) -> float:
    """Cost of a path (m + 1, 2) [m]."""
    return float(call(path_cost, ground, blank_course(path), float(_MISSED[1])))


def bar(ground: Ground, layer: int, path: IntArray) -> Ground:
    """The same ground without one edge of a path."""
    edge = [layer, *path[layer], *path[layer + 1]]
    return ground._replace(barred=np.vstack([ground.barred, np.array([edge], dtype=np.int64)]))


def _reach(lattice: PostureLattice) -> Array:
    """(m + 1, n) how far the shapes reach from what the base turns about [m]."""
    frames = lattice.frames
    if not frames.shape[2]:
        return np.zeros(frames.shape[:2])
    places = np.linalg.norm(frames[..., 9:12] - lattice.centers[:, :, None], axis=-1)
    return np.asarray(np.max(places + np.sum(frames[..., 12:15], axis=-1), axis=-1))


def _nominal(lattice: PostureLattice) -> Array:
    """(m + 1, 4) attitudes that guide the ants; on the way to the goal, if it is to be reached."""
    problem = lattice.problem
    if not problem.reach_attitude:
        return np.array(lattice.base.nominal.attitudes)
    progress = np.linspace(0.0, 1.0, problem.lattice.divisions + 1)
    return slerp(problem.start[3:7], problem.goal[3:7], progress)


def _beside(indices: IntArray) -> IntArray:
    """(b, 2 axes) the base offsets one step to either side along each axis, -1 where none is."""
    number = {tuple(index): b for b, index in enumerate(indices.tolist())}
    result = np.full((len(indices), 2 * indices.shape[1]), -1, dtype=np.int64)
    for b, index in enumerate(indices.tolist()):
        for axis in range(indices.shape[1]):
            for side, change in enumerate((-1, 1)):
                beside = list(index)
                beside[axis] += change
                result[b, 2 * axis + side] = number.get(tuple(beside), -1)
    return result


def _history(records: list[tuple[float, float, float, int]]) -> History:
    table = np.array(records, dtype=np.float64).reshape(-1, 4)
    best, iteration_best, mean, distinct = (frozen(c.copy()) for c in table.T)
    return History(best, iteration_best, mean, frozen(distinct.astype(np.int64)))
