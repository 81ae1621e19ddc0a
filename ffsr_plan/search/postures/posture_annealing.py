"""`PostureAnnealing`: the planner for lattices with posture axes."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import numpy as np

from ffsr_plan.core.arrays import IntArray, frozen
from ffsr_plan.core.errors import AttitudeOutOfReach, FfsrPlanError, InvalidInput, UnprovenPath
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.core.settings import settings
from ffsr_plan.lattice.certificate import Certificate
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.postures.annealing_settings import AnnealingSettings
from ffsr_plan.search.postures.colony import PostureColony, PosturePath
from ffsr_plan.search.postures.lower_bound import lower_bound
from ffsr_plan.search.postures.path_proof import (
    ATTITUDE_TOLERANCE,
    PathProof,
    check_start,
    corrected_proof,
    length_of,
    objective_of,
    prove_path,
)
from ffsr_plan.search.postures.posture_grid import posture_grid
from ffsr_plan.search.postures.posture_lattice import PostureLattice
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
        if request.colonies == 1:
            return self.solve_once(problem, rng, request.monitor)
        rngs = rng.spawn(request.colonies)
        job, time_limit = (problem, self), request.time_limit
        if request.workers == 1:
            outcomes = _run_colonies(job, rngs, request.monitor())
        else:
            outcomes = run_on_workers(_run_colonies, job, rngs, request.workers, time_limit)
        solutions = [outcome for outcome in outcomes if isinstance(outcome, Solution)]
        if not solutions:
            raise next(outcome for outcome in outcomes if isinstance(outcome, FfsrPlanError))
        return min(solutions, key=lambda solution: solution.objective)

    def solve_once(
        self,
        problem: Problem,
        rng: np.random.Generator,
        monitor_of: Callable[[], SearchMonitor],
    ) -> Solution:
        """`solve` by one colony; `monitor_of` makes its monitor when the search begins."""
        lattice = PostureLattice(problem)
        check_start(problem)
        colony = PostureColony(lattice, posture_grid(lattice), self, rng)
        result = colony.search(monitor_of())
        path, proof, queries, refused = self._proven(lattice, colony, result)
        lattice_objective = objective_of(lattice, proof)
        if problem.reach_attitude:
            proof, spent = corrected_proof(lattice, proof)
            queries += spent
        before = proof.prover.queries
        still = np.zeros((problem.lattice.divisions + 1, 3))
        least = proof.prover.least_clearance(still, proof.clearances)
        queries += proof.prover.queries - before
        nodes = np.hstack([lattice.base.indices[path[:, 0]], lattice.indices[path[:, 1]]])
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
            certificate=Certificate(
                edges_free=len(still) - 1,
                edges_refused=refused,
                node_queries=len(still),
                edge_queries=queries - len(still),
                least_clearance=least,
            ),
            interrupted=result.interrupted,
        )

    def _proven(
        self, lattice: PostureLattice, colony: PostureColony, result: PosturePath
    ) -> tuple[IntArray, PathProof, int, int]:
        """A proven path, its proof, Coal queries, and edges refused on the way to it."""
        problem, path, queries, refused = lattice.problem, result.path, 0, 0
        shifts = _SHIFTS_AFTER_REFUSAL * problem.lattice.divisions
        for _ in range(_PROOF_ATTEMPTS):
            proof = prove_path(lattice, path)
            proven_path = path
            queries += proof.prover.queries
            if proof.holds or result.interrupted:
                break
            for edge in proof.refused:
                colony.refuse(edge.layer, path)
                refused += 1
            path, _ = colony.annealed(path, shifts, *_TEMPERATURES_AFTER_REFUSAL)
        if proof.refused:
            layer, link, obstacle, distance = proof.refused[0]
            divisions = problem.lattice.divisions
            raise UnprovenPath(layer + 1, link, obstacle, distance, divisions)
        if proof.attitude_error > ATTITUDE_TOLERANCE:
            wanted = float(angle_between(problem.start[3:7], problem.goal[3:7]))
            raise AttitudeOutOfReach(wanted, proof.attitude_error)
        return proven_path, proof, queries, refused


def _run_colonies(
    job: tuple[Problem, PostureAnnealing], rngs: list[np.random.Generator], monitor: SearchMonitor
) -> list[Solution | FfsrPlanError]:
    """Colonies one after another."""
    problem, planner = job
    outcomes: list[Solution | FfsrPlanError] = []
    for rng in rngs:
        try:
            outcomes.append(planner.solve_once(problem, rng, lambda: monitor))
        except FfsrPlanError as error:
            outcomes.append(error)
        last = outcomes[-1]
        if isinstance(last, Solution) and last.interrupted and not monitor.past_deadline():
            break  # by Ctrl-C: no more colonies
    return outcomes


def _in_units(history: History, unit: float) -> History:
    """The history of costs [m] in units of length."""
    return history._replace(
        best=frozen(history.best / unit),
        iteration_best=frozen(history.iteration_best / unit),
        mean=frozen(history.mean / unit),
    )
