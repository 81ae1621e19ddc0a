"""Planners for lattices whose nodes have one configuration each: search, optimum, refinement."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import ClassVar, NamedTuple

import numpy as np

from ffsr_plan.core.arrays import frozen
from ffsr_plan.core.errors import FfsrPlanError, InvalidInput, OutOfTime
from ffsr_plan.lattice.certificate import Certificate, Counts, proven_clearance
from ffsr_plan.lattice.optimum import optimum_or_bound
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.problem.memory_estimate import check_lattice
from ffsr_plan.problem.problem import Problem
from ffsr_plan.refinement.refined_path import refined_path
from ffsr_plan.search.progress_solution import solve_with_progress
from ffsr_plan.search.records import SearchMonitor, SearchRequest, SearchResult, Solution
from ffsr_plan.search.workers import in_process, run_apart


class LatticePlanner(ABC):
    """Base class of the planners that search a roadmap.

    Attributes:
        name: the planner's name in scenario and plan files.
        exact: whether the search returns the lattice optimum.
        bytes_per_edge: memory of the search for each edge of the lattice [bytes].
    """

    name: ClassVar[str]
    exact: ClassVar[bool] = False
    bytes_per_edge: ClassVar[float]

    @abstractmethod
    def search(
        self, roadmap: Roadmap, rng: np.random.Generator, monitor: SearchMonitor | None = None
    ) -> SearchResult:
        """Search a roadmap for a path, all of whose edges are proven free.

        Args:
            roadmap: the roadmap; its nodes and edges are evaluated as the search needs them.
            rng: source of randomness.
            monitor: callback and stopping condition.

        Raises:
            NoPath: there is none, with the layer that cannot be passed.
            OutOfTime: none was found by the deadline of the monitor or of the roadmap.
            PlanningError: none was found.
        """

    def refuse(self, problem: Problem) -> None:
        """Raise `InvalidInput` if the planner cannot solve the problem, naming one that can."""
        if problem.lattice is None:
            raise InvalidInput("planner", self.name, "tree-planner, or a problem with a lattice")
        if problem.lattice.progress is not None:
            allowed = "lattice-optimum on a lattice with progress, or a lattice without it"
            raise InvalidInput("planner", self.name, allowed)
        if not problem.given_lattice.postures:
            return
        reason = "this planner searches one configuration a node"
        if problem.mode.attitude_reacts:
            reason = "the attitude at a node depends on the path that leads to it"
        allowed = f"posture-annealing on a lattice with posture axes, where {reason}"
        raise InvalidInput("planner", self.name, allowed)

    def solve(self, problem: Problem, rng: np.random.Generator, request: SearchRequest) -> Solution:
        """Search the problem's lattice, state the optimum, refine the path and certify it.

        Args:
            problem: a problem without posture axes, which `refuse` refuses.
            rng: source of randomness.
            request: colonies, workers, refinement, callback and stopping condition.

        Raises:
            StartInCollision, GoalInCollision: with link, obstacle and depth.
            NoPath: the lattice holds no free path, with the layer that cannot be passed.
            PlanningError: no path was found; `OutOfTime` if none was proven in time.
            WorkerDied: a worker process ended without a result.
        """
        self.refuse(problem)
        if problem.given_lattice.progress is not None:
            return solve_with_progress(problem, request)
        check_lattice(problem, self.bytes_per_edge, getattr(self, "ants", 0))
        roadmap = Roadmap(problem, request.deadline)
        roadmap.deadline.stage = "the search for a path"
        if self.exact:  # it has no path before it ends
            result, counts = self.search(roadmap, rng), roadmap.counts()
            request.begin()
        elif request.colonies == 1:
            result = self.search(roadmap, rng, request.monitor())
            counts = roadmap.counts()
        else:
            result, counts = self._search_by_colonies(roadmap, rng, request)
        lattice, prover = roadmap.lattice, roadmap.prover
        objective = lattice_objective = roadmap.objective(result.path)
        optimum, exact = (objective, True) if self.exact else optimum_or_bound(roadmap)
        offsets, clearances = lattice.offsets[result.path], roadmap.path_clearances(result.path)
        length, cut_short = roadmap.path_length(result.path), not exact
        if request.refine is not False:
            refined, cut = refined_path(
                lattice, prover, offsets, clearances, roadmap.nodes, roadmap.deadline
            )
            cut_short |= cut
            if refined is not None:
                offsets, clearances, length, objective, spent = refined
                counts = counts.plus(spent)
        motion = lattice.nominal.displaced(offsets)
        roadmap.deadline.close()
        moved = motion.positions - lattice.nominal.positions
        least, cut = proven_clearance(prover, moved, clearances)
        return Solution(
            lattice=lattice,
            motion=motion,
            nodes=lattice.indices_along(result.path),
            length=length,
            objective=objective,
            lattice_objective=lattice_objective,
            optimum=min(optimum, lattice_objective),  # equal paths may differ in the last digit
            optimum_is_exact=exact,
            clearances=frozen(clearances),
            history=result.history,
            trails=result.trails,
            certificate=Certificate(*counts, least, problem.robot.unchecked_links),
            interrupted=result.interrupted or cut_short or cut,
        )

    def _search_by_colonies(
        self, roadmap: Roadmap, rng: np.random.Generator, request: SearchRequest
    ) -> tuple[SearchResult, Counts]:
        roadmap.evaluate_all()  # as every worker does, so that all counts are alike
        counts, rngs = roadmap.counts(), rng.spawn(request.colonies)
        if in_process(request):
            outcomes = _run_colonies(roadmap, self, rngs, request.monitor())
        else:
            outcomes = run_apart(_colonies_of_worker, (roadmap.problem, self), rngs, request)
        result = _best(roadmap, outcomes, request.colonies)
        return result, Counts(
            edges_free=sum(o.edges_free for o in outcomes),
            edges_refused=sum(o.edges_refused for o in outcomes),
            node_queries=counts.node_queries,
            edge_queries=counts.edge_queries + sum(o.queries for o in outcomes),
        )


class _Outcome(NamedTuple):
    """The outcome of one colony; `queries` are the Coal queries that its proofs took."""

    result: SearchResult | FfsrPlanError
    edges_free: int
    edges_refused: int
    queries: int


def _colonies_of_worker(
    job: tuple[Problem, LatticePlanner],
    rngs: list[np.random.Generator],
    monitor: SearchMonitor,
) -> list[_Outcome]:
    problem, planner = job
    return _run_colonies(Roadmap(problem, monitor.deadline), planner, rngs, monitor)


def _run_colonies(
    roadmap: Roadmap,
    planner: LatticePlanner,
    rngs: list[np.random.Generator],
    monitor: SearchMonitor,
) -> list[_Outcome]:
    """Colonies one after another, none using proofs of another: all must give the same anywhere."""
    roadmap.evaluate_all()
    outcomes = []
    for rng in rngs:
        own, before = roadmap.without_edge_states(), roadmap.prover.queries
        result: SearchResult | FfsrPlanError
        try:
            result = planner.search(own, rng, monitor)
        except FfsrPlanError as error:
            result = error
        counts, queries = own.counts(), roadmap.prover.queries - before
        outcomes.append(_Outcome(result, counts.edges_free, counts.edges_refused, queries))
        if monitor.expired():
            break  # no more colonies
    return outcomes


def _best(roadmap: Roadmap, outcomes: list[_Outcome], colonies: int) -> SearchResult:
    """The best of all colonies, the first among equals; their error if none has a path."""
    results = [o.result for o in outcomes if isinstance(o.result, SearchResult)]
    if not results:
        raise next(o.result for o in outcomes if isinstance(o.result, FfsrPlanError))
    best = min(results, key=lambda result: roadmap.objective(result.path))
    cut_short = len(outcomes) < colonies or any(isinstance(o.result, OutOfTime) for o in outcomes)
    return best._replace(interrupted=cut_short or any(result.interrupted for result in results))
