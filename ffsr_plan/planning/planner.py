"""`plan(problem)`: from a problem to a certified plan."""

from __future__ import annotations

import math
import time
from dataclasses import replace

import numpy as np

from ffsr_plan.core.arrays import frozen
from ffsr_plan.core.checks import number, truth, whole_number
from ffsr_plan.core.errors import FfsrPlanError, InvalidInput
from ffsr_plan.lattice.refinement import refined
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.planning.plan import Plan
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.ants.ant_system import AntSystem
from ffsr_plan.search.ants.max_min import MaxMinAntSystem
from ffsr_plan.search.optimum import LatticeOptimum, lattice_optimum
from ffsr_plan.search.postures.posture_planner import plan_postures
from ffsr_plan.search.records import OnCycle, Planner, Search, Watch
from ffsr_plan.search.workers import Outcome, run_colonies

PLANNERS: dict[str, type[Planner]] = {
    planner.name: planner for planner in (AntSystem, MaxMinAntSystem, LatticeOptimum)
}
"""Planner classes by the name that scenario files and the command line use."""


def plan(
    problem: Problem,
    planner: Planner | None = None,
    seed: int | np.random.Generator = 0,
    *,
    refine: bool = True,
    colonies: int = 1,
    workers: int = 1,
    time_limit: float | None = None,
    on_cycle: OnCycle | None = None,
) -> Plan:
    """Plan a motion in which no link touches an obstacle or another link, proven edge by edge.

    Ctrl-C and `time_limit` end the search early; the best plan so far is returned, marked as
    `interrupted`.

    Args:
        problem: what to plan.
        planner: settings of the planner; `MaxMinAntSystem()` by default.
        seed: a whole number >= 0, or a generator. The same seed gives the same plan, bit for bit,
            whatever the number of workers.
        refine: whether to move the path off the lattice in the end, to where F is lower.
        colonies: independent colonies; the best path of all is returned.
        workers: processes that they are spread over; with posture axes colonies run one by one.
        time_limit: [s] for the search, from its beginning; setting up the lattice before it, and
            the optimum and the refinement after it, are not cut short.
        on_cycle: called with a `Cycle` after each cycle; for a single colony.

    Raises:
        InvalidInput: an argument that is not allowed.
        StartInCollision, GoalInCollision: with link, obstacle and depth.
        NoPath: the lattice holds no free path, with the layer that cannot be passed.
        PlanningError: no path was found in time, or a worker died.
    """
    begin = time.perf_counter()
    planner = MaxMinAntSystem() if planner is None else planner
    if not isinstance(planner, tuple(PLANNERS.values())):
        raise InvalidInput("planner", planner, f"one of {', '.join(PLANNERS)}, as an object")
    if not isinstance(problem, Problem):
        raise InvalidInput("problem", problem, "a Problem (that of a scenario is scenario.problem)")
    refine = truth("refine", refine)
    if on_cycle is not None and not callable(on_cycle):
        raise InvalidInput("on_cycle", on_cycle, "a function, or None")
    colonies = whole_number("colonies", colonies, at_least=1)
    workers = whole_number("workers", workers, at_least=1)
    seconds = math.inf if time_limit is None else number("time_limit", time_limit, above=0.0)
    if on_cycle is not None and colonies > 1:
        raise InvalidInput("on_cycle", on_cycle, "a callback only where colonies = 1")
    rng, seed_number = _generator(seed)
    if problem.lattice.postures:
        watch = Watch(on_cycle, time.monotonic() + seconds)
        plans = [
            plan_postures(problem, planner, own, seed_number, watch)
            for own in (rng.spawn(colonies) if colonies > 1 else [rng])
        ]
        best = min(plans, key=lambda found: found.objective)
        return replace(best, seconds=time.perf_counter() - begin)
    roadmap = Roadmap(problem)
    if colonies == 1:
        watch = Watch(on_cycle, time.monotonic() + seconds)
        found = planner.search(roadmap, rng, watch)
        proofs = roadmap.proofs()
    else:
        roadmap.evaluate_all()  # as every worker does, so that all counts are alike
        nothing = roadmap.proofs()
        outcomes = run_colonies(roadmap, planner, rng.spawn(colonies), workers, seconds)
        found = _best(roadmap, outcomes)
        proofs = nothing._replace(
            edges_free=sum(o.edges_free for o in outcomes),
            edges_refused=sum(o.edges_refused for o in outcomes),
            edge_queries=nothing.edge_queries + sum(o.queries for o in outcomes),
        )
    objective = roadmap.objective(found.path)
    exact = isinstance(planner, LatticeOptimum)
    optimum = objective if exact else roadmap.objective(lattice_optimum(roadmap))
    indices = roadmap.lattice.indices[found.path]
    axes = indices.shape[1]
    result = Plan(
        problem=problem,
        planner=planner,
        seed=seed_number,
        nodes=frozen(indices if axes > 1 else indices.sum(axis=1)),
        configurations=frozen(roadmap.lattice.motion(found.path).configurations()),
        length=roadmap.path_length(found.path),
        objective=objective,
        lattice_objective=objective,
        optimum=min(optimum, objective),  # equal paths may differ in their last digit
        clearances=frozen(roadmap.path_clearances(found.path)),
        history=found.history,
        trails=found.trails,
        certificate=proofs,
        interrupted=found.interrupted,
        seconds=0.0,
    )
    if refine:
        result = refined(result, roadmap.lattice, roadmap.prover)
    proven = roadmap.prover.least_clearance(
        result.configurations[:, :3] - roadmap.lattice.nominal.positions, result.clearances
    )
    certificate = result.certificate._replace(least_clearance=proven)
    return replace(result, certificate=certificate, seconds=time.perf_counter() - begin)


def _generator(seed: int | np.random.Generator) -> tuple[np.random.Generator, int | None]:
    if isinstance(seed, np.random.Generator):
        return seed, None
    given = whole_number("seed", seed, at_least=0)
    return np.random.default_rng(given), given


def _best(roadmap: Roadmap, outcomes: list[Outcome]) -> Search:
    """The best of all colonies, the first among equals; their error if none has a path."""
    found = [o.result for o in outcomes if isinstance(o.result, Search)]
    if not found:
        raise next(o.result for o in outcomes if isinstance(o.result, FfsrPlanError))
    best = min(found, key=lambda search: roadmap.objective(search.path))
    return best._replace(interrupted=any(search.interrupted for search in found))
