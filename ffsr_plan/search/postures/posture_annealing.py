"""`PostureAnnealing`: the planner for lattices with posture axes."""

from __future__ import annotations

import time
from typing import ClassVar

import numpy as np

from ffsr_plan.core.arrays import IntArray, frozen
from ffsr_plan.core.errors import AttitudeOutOfReach, FfsrPlanError, InvalidInput
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.core.settings import settings
from ffsr_plan.lattice.certificate import Certificate, Counts
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.postures.annealing_settings import AnnealingSettings
from ffsr_plan.search.postures.colony import PostureColony, PosturePath
from ffsr_plan.search.postures.lower_bound import lower_bound
from ffsr_plan.search.postures.path_proof import (
    ATTITUDE_TOLERANCE,
    PathProof,
    check_start,
    corners,
    corrected_proof,
    length_of,
    objective_of,
    prove_path,
    unproven,
)
from ffsr_plan.search.postures.posture_lattice import PostureLattice
from ffsr_plan.search.postures.posture_lattice_arrays import posture_grid
from ffsr_plan.search.records import History, SearchMonitor, SearchRequest, Solution
from ffsr_plan.search.workers import run_on_workers

_PROOF_ATTEMPTS = 25
_SHIFTS_AFTER_REFUSAL = 500  # for each layer, in the annealing that goes on after a refused edge
_TEMPERATURES_AFTER_REFUSAL = 0.05, 1e-3  # [m], of that annealing


@settings
class PostureAnnealing(AnnealingSettings):
    """Ants and annealing for lattices with posture axes; the default planner there.

    Ants find a first path through base offsets and postures; annealing by shifts of whole path
    segments does most of the work. Collisions and goal attitude error are penalised during the
    search, not forbidden. The best path is worked out exactly and proven edge by edge; a refused
    edge is excluded and the annealing goes on. Where a goal attitude is to be reached, a
    Gauss-Newton correction of the joint path closes the remaining error, and is proven again.

    The settings are those of `AnnealingSettings`.
    """

    __doc__ += "\n" + (AnnealingSettings.__doc__ or "").partition("\n\n")[2]
    name: ClassVar[str] = "posture-annealing"
    exact: ClassVar[bool] = False

    def refuse(self, problem: Problem) -> None:
        """Raise `InvalidInput` if the problem's lattice has no posture axes."""
        if not problem.lattice.postures:
            allowed = "max-min-ant-system, ant-system or lattice-optimum without posture axes"
            raise InvalidInput("planner", self.name, allowed)

    def solve(self, problem: Problem, rng: np.random.Generator, request: SearchRequest) -> Solution:
        """Search the problem's lattice and prove the path.

        Args:
            problem: a problem with posture axes.
            rng: source of randomness.
            request: colonies, workers, callback and stopping condition.

        Raises:
            InvalidInput: no posture axes, axes that the robot does not have, or `refine=True`.
            StartInCollision: with link, obstacle and depth.
            AttitudeOutOfReach: the arms were not found to bring about the goal's attitude.
            UnprovenPath: what was found could not be proven free.
            WorkerDied: a worker process ended without a result.
        """
        self.refuse(problem)
        if request.refine:
            raise InvalidInput(
                "refine", True, "False or None on a lattice with posture axes: it is not refined"
            )
        if request.colonies > 1:
            return self._best_of_colonies(problem, rng, request)
        lattice = PostureLattice(problem)
        check_start(problem)
        colony = PostureColony(lattice, posture_grid(lattice), self, rng)
        result = colony.search(request.monitor())
        path, queries, refused = result.path, 0, 0
        shifts = _SHIFTS_AFTER_REFUSAL * problem.lattice.divisions
        for _ in range(_PROOF_ATTEMPTS):
            proof, proven_path = prove_path(lattice, *corners(lattice, path)), path
            queries += proof.prover.queries
            if proof.holds or result.interrupted or request.stop_requested():
                break
            for edge in proof.refused:
                colony.refuse(edge.layer, path)
                refused += 1
            path, _ = colony.annealed(
                path, shifts, *_TEMPERATURES_AFTER_REFUSAL, request.stop_requested
            )
        _check_proof(problem, proof, result.interrupted)
        lattice_objective = objective_of(lattice, proof)
        if problem.reach_attitude:
            proof, spent = corrected_proof(lattice, proof)
            queries += spent
        counts = Counts(len(path) - 1, refused, len(path), queries - len(path))
        return _solution(lattice, proven_path, proof, counts, result, lattice_objective)

    def _best_of_colonies(
        self, problem: Problem, rng: np.random.Generator, request: SearchRequest
    ) -> Solution:
        rngs, job = rng.spawn(request.colonies), (problem, self)
        if request.workers == 1:
            outcomes = _run_colonies(job, rngs, request.monitor())
        else:
            outcomes = run_on_workers(_run_colonies, job, rngs, request)
        solutions = [outcome for outcome in outcomes if isinstance(outcome, Solution)]
        if not solutions:
            raise next(outcome for outcome in outcomes if isinstance(outcome, FfsrPlanError))
        return min(solutions, key=lambda solution: solution.objective)


def _check_proof(problem: Problem, proof: PathProof, cut_short: bool) -> None:
    """Raise `UnprovenPath` or `AttitudeOutOfReach` if the proof does not hold."""
    if proof.refused:
        raise unproven(problem, proof.refused[0], cut_short)
    if proof.attitude_error > ATTITUDE_TOLERANCE:
        wanted = float(angle_between(problem.start[3:7], problem.goal[3:7]))
        raise AttitudeOutOfReach(wanted, proof.attitude_error)


def _solution(
    lattice: PostureLattice,
    path: IntArray,
    proof: PathProof,
    counts: Counts,
    result: PosturePath,
    lattice_objective: float,
) -> Solution:
    """The solution along a proven path; `counts` so far, without the least clearance."""
    problem, before = lattice.problem, proof.prover.queries
    still = np.zeros((len(path), 3))
    least = proof.prover.least_clearance(still, proof.clearances)
    queries = counts.edge_queries + proof.prover.queries - before
    nodes = np.hstack([lattice.base.indices[path[:, 0]], lattice.indices[path[:, 1]]])
    counts = counts._replace(edge_queries=queries)
    return Solution(
        lattice=lattice.base,
        motion=proof.motion,
        nodes=frozen(nodes if nodes.shape[1] > 1 else nodes[:, 0]),
        length=length_of(lattice, proof.motion),
        objective=objective_of(lattice, proof),
        lattice_objective=lattice_objective,
        optimum=min(lower_bound(lattice), lattice_objective),
        clearances=frozen(proof.clearances),
        history=_in_units(result.history, problem.length_unit),
        trails=result.trails,
        certificate=Certificate(*counts, least),
        interrupted=result.interrupted,
    )


def _run_colonies(
    job: tuple[Problem, PostureAnnealing], rngs: list[np.random.Generator], monitor: SearchMonitor
) -> list[Solution | FfsrPlanError]:
    """Colonies one after another."""
    problem, planner = job
    outcomes: list[Solution | FfsrPlanError] = []
    for rng in rngs:
        try:
            request = SearchRequest(
                time_limit=monitor.deadline - time.monotonic(),
                stop_requested=monitor.stop_requested,
            )
            outcomes.append(planner.solve(problem, rng, request))
        except FfsrPlanError as error:
            outcomes.append(error)
        if monitor.stop_requested():
            break  # by Ctrl-C: no more colonies
    return outcomes


def _in_units(history: History, unit: float) -> History:
    """The history of costs [m] in units of length."""
    return history._replace(
        best=frozen(history.best / unit),
        iteration_best=frozen(history.iteration_best / unit),
        mean=frozen(history.mean / unit),
    )
