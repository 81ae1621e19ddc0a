"""From a problem with posture axes to a certified plan.

The colony's best path is worked out exactly and proven edge by edge; a refused edge is barred, and
the search goes on from there. Where a goal attitude is to be reached, a small bend of the proven
path closes what is missing, and is proven again.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.core.errors import AttitudeOutOfReach, InvalidInput, StartInCollision, UnprovenPath
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.lattice.roadmap import Certificate
from ffsr_plan.planning.plan import Plan
from ffsr_plan.problem.objective import objective, path_length
from ffsr_plan.problem.problem import Problem
from ffsr_plan.proof.prover import Prover
from ffsr_plan.search.ants.max_min import MaxMinAntSystem
from ffsr_plan.search.postures.attitude_correction import corrected
from ffsr_plan.search.postures.lower_bound import lower_bound
from ffsr_plan.search.postures.posture_lattice import PostureLattice, displacements
from ffsr_plan.search.records import Planner, Trails, Watch

REACHED = math.radians(1.0)
"""Error of the goal attitude that a plan may be left with where the last bend is not possible."""
_ATTEMPTS = 25
_BENDS = 6  # attempts at the last bend, each holding what the one before could not prove
_COOL = 0.05  # temperature [m] at which the search goes on behind a refused edge


class _Candidate(NamedTuple):
    """A path worked out exactly."""

    motion: Motion
    prover: Prover
    clearances: Array
    refused: list[tuple[int, str, int | str, float]]
    """Edges that could not be proven: layer, link, what it is near to, distance [m]."""
    missed: float
    """Error of the goal attitude [rad]; 0 where none is demanded."""

    @property
    def holds(self) -> bool:
        return not self.refused and self.missed <= REACHED


def plan_postures(
    problem: Problem, planner: Planner, rng: np.random.Generator, seed: int | None, watch: Watch
) -> Plan:
    """Plan on a lattice with posture axes.

    Raises:
        InvalidInput: a planner that cannot do that, or axes that the robot does not have.
        StartInCollision: with link, obstacle and depth.
        AttitudeOutOfReach: the arms cannot turn the base to the goal's attitude.
        UnprovenPath: what was found could not be proven free.
    """
    if not isinstance(planner, MaxMinAntSystem):
        reason = "posture axes are searched by the colony alone"
        if problem.mode.attitude_reacts:
            reason = (
                "with posture axes the attitude at a node depends on the way there, so that no "
                "search over nodes alone is exact"
            )
        raise InvalidInput("planner", planner.name, f"{MaxMinAntSystem.name}: {reason}")
    from ffsr_plan.search.postures import colony

    lattice = PostureLattice(problem)
    _check_start(problem)
    ground = colony.ground_of(lattice)
    found = colony.search(
        lattice, ground, planner.ants, planner.cycles, planner.pheromone, rng, watch
    )
    path, queries, barred = found.path, 0, 0
    for _ in range(_ATTEMPTS):
        candidate = _worked_out(lattice, path)
        queries += candidate.prover.queries
        if candidate.holds or found.interrupted:
            break
        for layer, *_ in candidate.refused:
            ground = colony.bar(ground, layer, path)
            barred += 1
        shifts = 500 * problem.lattice.divisions
        path, _ = colony.annealed(ground, rng, path, shifts, _COOL)
    _raise_unless_it_holds(problem, candidate)
    lattice_objective = _objective(lattice, candidate)
    if problem.reach_attitude:
        candidate, spent = _bent(lattice, candidate)
        queries += spent
    motion, still = candidate.motion, np.zeros((problem.lattice.divisions + 1, 3))
    before = candidate.prover.queries
    least = candidate.prover.least_clearance(still, candidate.clearances)
    queries += candidate.prover.queries - before
    nodes = np.hstack([lattice.base.indices[path[:, 0]], lattice.indices[path[:, 1]]])
    value = _objective(lattice, candidate)
    unit, history = problem.length_unit, found.history
    return Plan(
        problem=problem,
        planner=planner,
        seed=seed,
        nodes=frozen(nodes if nodes.shape[1] > 1 else nodes[:, 0]),
        configurations=frozen(motion.configurations()),
        length=_length(lattice, motion),
        objective=value,
        lattice_objective=lattice_objective,
        optimum=min(lower_bound(lattice), lattice_objective),
        clearances=frozen(candidate.clearances),
        history=history._replace(
            best=frozen(history.best / unit),
            iteration_best=frozen(history.iteration_best / unit),
            mean=frozen(history.mean / unit),
        ),
        trails=_trails(found.walked),
        certificate=Certificate(
            edges_free=len(still) - 1,
            edges_refused=barred,
            node_queries=len(still),
            edge_queries=queries - len(still),
            least_clearance=least,
        ),
        interrupted=found.interrupted,
        seconds=0.0,
    )


def _worked_out(lattice: PostureLattice, path: IntArray) -> _Candidate:
    """The motion along a path (m + 1, 2), with Coal's clearances and what could not be proven."""
    base, joints = lattice.base, lattice.joint_values[np.arange(len(path)), path[:, 1]]
    return _proven(lattice, base.nominal.positions + base.offsets[path[:, 0]], joints)


def _proven(lattice: PostureLattice, positions: Array, joints: Array) -> _Candidate:
    problem = lattice.problem
    motion = Motion(problem.robot, problem.mode, problem.start, problem.goal, positions, joints)
    prover, m = Prover(motion, problem.scene, problem.tolerance), len(positions) - 1
    still = np.zeros(3)
    clearances = prover.clearances(np.arange(m + 1), np.zeros((m + 1, 3)))
    refused: list[tuple[int, str, int | str, float]] = []
    for layer, apart in enumerate(prover.self_verdicts()):
        ends = float(clearances[layer]), float(clearances[layer + 1])
        verdict = prover.certify(layer, still, still, ends)
        if not verdict.free:
            near = prover.nearest(layer, still, still, verdict.time)
        elif not apart.free:
            near = prover.nearest_links(layer, apart.time)
        else:
            continue
        refused.append((layer, near.link, near.other, near.distance))
    missed = 0.0
    if problem.reach_attitude:
        missed = float(angle_between(motion.attitudes[-1], problem.goal[3:7]))
    return _Candidate(motion, prover, clearances, refused, missed)


def _bent(lattice: PostureLattice, candidate: _Candidate) -> tuple[_Candidate, int]:
    """The candidate, its attitude error closed if that can be proven free; queries it took.

    Where the bent path is refused, the corners beside are left as they were, and others bent.
    """
    problem, motion = lattice.problem, candidate.motion
    directions = displacements(problem, lattice.base.nominal.joint_values)
    held = np.zeros(len(motion.positions), dtype=np.bool_)
    queries = 0
    for _ in range(_BENDS):
        joints = corrected(
            problem.robot, problem.start[3:7], problem.goal[3:7], motion.joint_values, directions,
            held,
        )  # fmt: skip
        if joints is None:
            break
        bent = _proven(lattice, motion.positions, joints)
        queries += bent.prover.queries
        if bent.holds and bent.missed < candidate.missed:
            return bent, queries
        for layer, *_ in bent.refused:  # there the path as it was has been proven
            held[max(layer - 1, 0) : layer + 3] = True
    return candidate, queries


def _check_start(problem: Problem) -> None:
    start = problem.start
    motion = Motion(problem.robot, problem.mode, start, start, np.tile(start[:3], (2, 1)))
    prover = Prover(motion, problem.scene, problem.tolerance)
    still = np.zeros(3)
    for near in (prover.nearest(0, still, still, 0.0), prover.nearest_links(0, 0.0)):
        if near.distance <= 0.0:
            raise StartInCollision(near.link, near.other, -near.distance)


def _raise_unless_it_holds(problem: Problem, candidate: _Candidate) -> None:
    if candidate.refused:
        layer, link, other, distance = candidate.refused[0]
        raise UnprovenPath(layer + 1, link, other, distance, problem.lattice.divisions)
    if candidate.missed > REACHED:
        wanted = float(angle_between(problem.start[3:7], problem.goal[3:7]))
        raise AttitudeOutOfReach(wanted, candidate.missed)


def _trails(walked: IntArray) -> Trails:
    """Where the ants moved the base; nothing where it has nowhere to go."""
    if walked.shape[1] == 1:
        walked = np.zeros_like(walked)
    layer, tail, head = np.nonzero(walked)
    ants = walked[layer, tail, head]
    return Trails(layer, tail, head, ants, ants.astype(np.float64), ants.astype(np.float64))


def _displaced(lattice: PostureLattice, motion: Motion) -> tuple[Array, Array]:
    """Offsets of the base (m + 1, 3) and of the joints (m + 1, nd) from the nominal motion."""
    nominal = lattice.base.nominal
    offsets = motion.positions - nominal.positions
    if motion.mode.floats:
        offsets = np.zeros_like(offsets)
    return offsets, motion.joint_values - nominal.joint_values


def _length(lattice: PostureLattice, motion: Motion) -> float:
    return path_length(lattice.problem, *_displaced(lattice, motion))


def _objective(lattice: PostureLattice, candidate: _Candidate) -> float:
    length = _length(lattice, candidate.motion)
    return objective(lattice.problem, length, candidate.clearances)
