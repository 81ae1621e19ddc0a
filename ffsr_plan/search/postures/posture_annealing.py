"""`PostureAnnealing`: the planner for lattices with posture axes."""

from __future__ import annotations

from contextlib import nullcontext
from typing import ClassVar

import numpy as np

from ffsr_plan.core.arrays import IntArray, frozen
from ffsr_plan.core.errors import AttitudeOutOfReach, FfsrPlanError, InvalidInput, OutOfTime
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.core.settings import settings
from ffsr_plan.lattice.certificate import Certificate
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.postures.colony import AnnealingSettings, PostureColony, PosturePath
from ffsr_plan.search.postures.early_proofs import EarlyProofs
from ffsr_plan.search.postures.lower_bound import lower_bound
from ffsr_plan.search.postures.path_proof import (
    CORRECTABLE,
    PathProof,
    check_start,
    corners,
    corrected_proof,
    least_clearance,
    length_of,
    objective_of,
    prove_path,
    unproven,
)
from ffsr_plan.search.postures.posture_lattice import PostureLattice
from ffsr_plan.search.postures.posture_lattice_arrays import posture_grid
from ffsr_plan.search.records import History, SearchMonitor, SearchRequest, Solution
from ffsr_plan.search.workers import in_process, run_apart
from ffsr_plan.time_limit.deadline import Deadline

_PROOF_ATTEMPTS = 25
_SHIFTS_AFTER_REFUSAL = 500  # for each layer, in the annealing that goes on after a refused edge
_TEMPERATURES_AFTER_REFUSAL = 0.05, 1e-3  # [m], of that annealing
_LESS_FREE_ERROR = 0.25  # of an error that could not be corrected: what costs nothing from then on


@settings
class PostureAnnealing(AnnealingSettings):
    """Ants and annealing for lattices with posture axes; the default planner there.

    Ants find a first path through base offsets and postures; annealing by shifts of whole path
    segments does most of the work. Collisions and goal attitude error are penalised during the
    search, not forbidden. The best path is worked out exactly and proven edge by edge; a refused
    edge is excluded and the annealing goes on. Where a goal attitude is to be reached, a
    Gauss-Newton correction of the joint path closes the remaining error, and is proven again. If
    that fails, the annealing goes on, and errors of the goal attitude cost more.

    The settings are those of `AnnealingSettings`.
    """

    __doc__ += "\n" + (AnnealingSettings.__doc__ or "").partition("\n\n")[2]
    name: ClassVar[str] = "posture-annealing"
    exact: ClassVar[bool] = False

    def refuse(self, problem: Problem) -> None:
        """Raise `InvalidInput` if the problem's lattice has no posture axes."""
        if problem.lattice is None:
            raise InvalidInput("planner", self.name, "tree-planner, or a problem with a lattice")
        if not problem.given_lattice.postures:
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
            OutOfTime: no path was proven in time.
            AttitudeOutOfReach: the arms were not found to bring about the goal's attitude; with
                the `Solution` that misses it least.
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
        lattice = _lattice(problem, request.deadline or Deadline())
        request.begin()
        colony, deadline = _colony(lattice, self, rng), lattice.deadline
        early, proofs = EarlyProofs(lattice, colony, deadline), _Proofs(lattice, colony)
        monitor = SearchMonitor(request.on_cycle, deadline, early.reserve, early.offer)
        result = colony.search(monitor)
        path, cut_short = result.path, result.interrupted
        if cut_short and (missing := colony.shortcomings(path)):
            deadline.stage = f"the search, whose best path so far {missing}"
        try:
            for _ in range(0 if early.has(path) else _PROOF_ATTEMPTS):
                first = proofs.is_empty and early.best is None
                with deadline.without_stop() if first else nullcontext():  # so that there is a plan
                    proof = prove_path(lattice, *corners(lattice, path))
                    corrected, spent = corrected_proof(lattice, proof)
                proofs.take(path, proof, corrected, proof.prover.queries + spent)
                cut_short |= not corrected.holds and monitor.expired()
                if corrected.holds or cut_short:
                    break
                shifts = _SHIFTS_AFTER_REFUSAL * problem.given_lattice.divisions
                temperatures = _TEMPERATURES_AFTER_REFUSAL
                path, _ = colony.annealed(path, shifts, *temperatures, monitor.expired)
        except OutOfTime:
            cut_short = True
            if proofs.is_empty and early.best is None:
                raise
        if not proofs.hold and early.best is not None:
            proofs.take(*early.best)
        deadline.close()
        return proofs.solution(result._replace(interrupted=cut_short))

    def _best_of_colonies(
        self, problem: Problem, rng: np.random.Generator, request: SearchRequest
    ) -> Solution:
        rngs, job = rng.spawn(request.colonies), (problem, self)
        if in_process(request):
            outcomes = _run_colonies(job, rngs, request.monitor())
        else:
            outcomes = run_apart(_run_colonies, job, rngs, request)
        solutions = [outcome for outcome in outcomes if isinstance(outcome, Solution)]
        if not solutions:
            errors = [outcome for outcome in outcomes if isinstance(outcome, FfsrPlanError)]
            missed = [error for error in errors if isinstance(error, AttitudeOutOfReach)]
            raise min(missed, key=lambda error: error.missed) if missed else errors[0]
        best = min(solutions, key=lambda solution: solution.objective)
        cut_short = len(outcomes) < request.colonies
        cut_short |= any(isinstance(outcome, OutOfTime) for outcome in outcomes)
        cut_short |= any(solution.interrupted for solution in solutions)
        return best._replace(interrupted=cut_short)


def _lattice(problem: Problem, deadline: Deadline) -> PostureLattice:
    """The lattice, after a check of the start."""
    lattice = PostureLattice(problem, deadline)
    check_start(problem)
    return lattice


def _colony(
    lattice: PostureLattice, chosen: AnnealingSettings, rng: np.random.Generator
) -> PostureColony:
    colony = PostureColony(lattice, posture_grid(lattice), chosen, rng)
    lattice.deadline.stage = "the search for a path"
    return colony


class _Proofs:
    """Proofs of the paths that a colony finds, one after another, and the best one so far.

    A refused edge is excluded from the colony's lattice. A path that is free and cannot be
    corrected to the goal attitude makes the colony look for one that misses it by less.
    """

    def __init__(self, lattice: PostureLattice, colony: PostureColony) -> None:
        self._lattice, self._colony = lattice, colony
        self._refused = self._queries = 0
        self._last: PathProof | None = None
        self._best: tuple[IntArray, PathProof, float] | None = None
        # path, proof of its motion, F on the lattice; of the least goal attitude error
        self._least: tuple[float, int] | None = None  # of the best path, where it is known already

    def take(
        self,
        path: IntArray,
        proof: PathProof,
        corrected: PathProof,
        queries: int,
        least: tuple[float, int] | None = None,
    ) -> None:
        """Take note of a path (m + 1, 2).

        Args:
            path: the path.
            proof: of it.
            corrected: of its correction, or the same as `proof`.
            queries: Coal queries of both.
            least: what `least_clearance` gives for `corrected`, if it is known already.
        """
        self._last = proof
        self._queries += queries
        for edge in proof.refused:
            self._colony.refuse(edge.layer, path)
            self._refused += 1
        if proof.refused:
            return
        if not corrected.holds and proof.attitude_error <= CORRECTABLE:
            self._colony.demand(_LESS_FREE_ERROR * proof.attitude_error)
        if self._best is None or corrected.attitude_error < self._best[1].attitude_error:
            self._best = path, corrected, objective_of(self._lattice, proof)
            self._least = least

    @property
    def is_empty(self) -> bool:
        """Whether no path has been taken."""
        return self._last is None

    @property
    def hold(self) -> bool:
        """Whether a path was proven free that meets the goal attitude."""
        return self._best is not None and self._best[1].holds

    def solution(self, result: PosturePath) -> Solution:
        """The best path.

        Args:
            result: what the colony found first.

        Raises:
            UnprovenPath: no path was proven free.
            AttitudeOutOfReach: none that was proven free meets the goal attitude; with the best.
        """
        problem = self._lattice.problem
        if self._best is None:
            assert self._last is not None
            raise unproven(problem, self._last.refused[0], result.interrupted)
        path, proof, on_lattice = self._best
        m = len(path) - 1
        try:
            least, queries = self._least or least_clearance(proof)
        except OutOfTime:
            least, queries = 0.0, 0
            result = result._replace(interrupted=True)
        queries += self._queries
        nodes = m + 1 if np.isfinite(proof.clearances).all() else 0  # none in an empty scene
        certificate = Certificate(
            m, self._refused, nodes, queries - nodes, least, problem.robot.unchecked_links
        )
        solution = _solution(self._lattice, path, proof, certificate, result, on_lattice)
        if not proof.holds:
            wanted = float(angle_between(problem.start[3:7], problem.goal[3:7]))
            raise AttitudeOutOfReach(wanted, proof.attitude_error, solution)
        return solution


def _solution(
    lattice: PostureLattice,
    path: IntArray,
    proof: PathProof,
    certificate: Certificate,
    result: PosturePath,
    lattice_objective: float,
) -> Solution:
    """The solution along a proven path."""
    nodes = np.hstack([lattice.base.indices[path[:, 0]], lattice.indices[path[:, 1]]])
    return Solution(
        lattice=lattice.base,
        motion=proof.motion,
        nodes=frozen(nodes if nodes.shape[1] > 1 else nodes[:, 0]),
        length=length_of(lattice, proof.motion),
        objective=objective_of(lattice, proof),
        lattice_objective=lattice_objective,
        optimum=min(lower_bound(lattice), lattice_objective),
        optimum_is_exact=False,
        clearances=frozen(proof.clearances),
        history=_in_units(result.history, lattice.problem.length_unit),
        trails=result.trails,
        certificate=certificate,
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
            request = SearchRequest(deadline=monitor.deadline)
            outcomes.append(planner.solve(problem, rng, request))
        except FfsrPlanError as error:
            outcomes.append(error)
        if monitor.expired():
            break  # no more colonies
    return outcomes


def _in_units(history: History, unit: float) -> History:
    """The history of costs [m] in units of length."""
    return history._replace(
        best=frozen(history.best / unit),
        iteration_best=frozen(history.iteration_best / unit),
        mean=frozen(history.mean / unit),
    )
