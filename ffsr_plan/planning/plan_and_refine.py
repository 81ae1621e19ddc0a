"""`plan` and `refine`: from a problem to a certified plan, and from a plan to a better one."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Literal

import numpy as np

from ffsr_plan.core.checks import number, one_of, truth, whole_number
from ffsr_plan.core.errors import AttitudeOutOfReach, GoalPoseIgnored, InvalidInput
from ffsr_plan.core.kernels.compiling_time import Stopwatch
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.lattice.certificate import Certificate
from ffsr_plan.planning.certified_plan import Plan
from ffsr_plan.plans.planner_registry import Planner, planner_of
from ffsr_plan.portfolio.lattice_left_out import without_lattice
from ffsr_plan.portfolio.portfolio_planner import Portfolio
from ffsr_plan.problem.memory_estimate import check_colonies
from ffsr_plan.problem.problem import Problem
from ffsr_plan.proof.prover import Prover
from ffsr_plan.refinement.refined_path import refined_path
from ffsr_plan.search.interruption import RAISE, RETURN, Interruption
from ffsr_plan.search.records import OnCycle, SearchRequest, Solution
from ffsr_plan.time_limit.deadline import Deadline
from ffsr_plan.tree_search.tree_planner import TreePlanner

if TYPE_CHECKING:
    from distributed import Client

_NOTABLE = 1e-4  # [rad] or [m]
_HOW_TO_REACH_IT = (
    "attitude-held holds both; reach_attitude the attitude, where the lattice has posture axes or "
    "there is none"
)
_MOST_WORKERS = 256  # each is a process of some hundred megabytes


def plan(
    problem: Problem,
    planner: Planner | str | None = None,
    seed: int | np.random.Generator = 0,
    *,
    refine: bool | None = None,
    colonies: int = 1,
    workers: int = 1,
    scheduler: str | Client | None = None,
    time_limit: float | None = None,
    until: Literal["end", "first"] = "end",
    on_cycle: OnCycle | None = None,
    on_interrupt: Literal["return", "raise"] = "return",
) -> Plan:
    """Plan a collision-free motion and certify it.

    Ctrl-C and `time_limit` end whatever is being done, and the best path proven by then is
    returned, `interrupted`. Ctrl-C raises KeyboardInterrupt where there is no plan yet, when it is
    pressed again, and in a call of `plan` that begins within 2 s of such a return: a loop ends.

    Args:
        problem: what to plan.
        planner: settings of the planner, or its name; by default `TreePlanner()` without a
            lattice, `PostureAnnealing()` on one with posture axes, `MaxMinAntSystem()` on others.
            `Portfolio()` runs the trees and the lattice's planner and takes the better path.
        seed: a whole number >= 0, or a generator. The same seed gives the same plan, bit for bit,
            whatever the number of workers.
        refine: whether to move the path off the lattice; by default without posture axes.
        colonies: independent colonies; the best path of all is returned.
        workers: processes that the colonies are spread over.
        scheduler: of Dask workers instead, such as `tcp://10.0.0.1:8786`, or a client of it.
        time_limit: [s] from call to return, but for compiling; few calls are 5 % + 20 ms late.
        until: `first` returns the first path that `TreePlanner` proves free.
        on_cycle: called with a `Cycle` after each cycle, for a single colony; by trees, with a
            `TreeCycle` after each round.
        on_interrupt: what the first Ctrl-C does: `return` the best plan so far, or `raise`.

    Raises:
        InvalidInput: an argument that is not allowed, or a planner that cannot solve the problem.
        StartInCollision, GoalInCollision: with all links and obstacles that touch.
        NoPath: the lattice holds no free path, with the layer that cannot be passed.
        AttitudeOutOfReach: the arms were not found to bring about the goal's attitude; `best` is
            the plan that misses it least.
        PathNotFound: no path was found without a lattice, with what is in the way.
        UnprovenPath: with posture axes, the path found could not be proven free.
        PlanningError: no path was found; `OutOfTime` if none was proven in time.
        WorkerDied: a worker process ended without a result.
    """
    watch, deadline = Stopwatch(), _deadline(time_limit)
    chosen, problem = _planner_for(problem, planner)
    rng, seed_number = _generator(seed)
    request = _request(chosen, refine, colonies, workers, until, on_cycle)
    request = _spread(problem, request, scheduler)._replace(deadline=deadline)
    certified = partial(_certified, problem, chosen, seed_number, watch)
    interruption = Interruption(one_of("on_interrupt", on_interrupt, (RETURN, RAISE)))
    with _best_certified(certified), interruption:
        solution = chosen.solve(problem, rng, interruption.received_by(request))
    made = certified(solution._replace(interrupted=solution.interrupted or interruption.pressed))
    _warn_of_ignored_goal(made)
    return made


@contextmanager
def _best_certified(certified: Callable[[Solution], Plan]) -> Iterator[None]:
    """An error that holds the best solution holds the plan that it makes instead."""
    try:
        yield
    except AttitudeOutOfReach as error:
        if isinstance(error.best, Solution):
            error.best = certified(error.best)
        raise


def refine(plan: Plan) -> Plan:
    """Move a plan to where F of the whole motion is lower; certified like the plan itself.

    F of the whole motion, `Plan.motion_objective`, contains the clearance between the nodes too. F
    of Eq. 8, which contains the clearances at the nodes, may rise where the lattice path passes an
    obstacle closely between two nodes. At delta = 0 both are the length. Offsets stay within the
    lattice's window, in steps of a sixteenth of its spacing. A plan that cannot be improved, such
    as one on a lattice without offsets, is returned as it is.

    Args:
        plan: a plan on a lattice without posture axes.

    Raises:
        InvalidInput: not a plan, or one on a lattice with posture axes, or by `LeastFuel`.
    """
    if not isinstance(plan, Plan):
        raise InvalidInput("plan", plan, "a Plan")
    if plan.fuel is not None:
        allowed = "a plan of another planner: refinement lowers F, and takes more fuel"
        raise InvalidInput("plan", f"a plan by {plan.planner.name}", allowed)
    lattice = plan.problem.lattice
    if lattice is None or plan.lattice is None or lattice.postures:
        raise InvalidInput("plan", lattice, "a plan on a lattice without posture axes")
    nominal = plan.lattice.nominal
    problem, pace = plan.problem, plan.problem.pace(nominal.edges)
    prover = Prover(nominal, problem.obstacles, problem.tolerance, pace=pace)
    offsets = plan.motion.positions - nominal.positions
    refined, _ = refined_path(plan.lattice, prover, offsets, plan.clearances)
    if refined is None:
        return plan
    motion = nominal.displaced(refined.offsets)
    least = prover.least_clearance(motion.positions - nominal.positions, refined.clearances)
    counts = plan.certificate.counts.plus(refined.counts)
    return replace(
        plan,
        motion=motion,
        length=refined.length,
        objective=refined.objective,
        clearances=refined.clearances,
        certificate=Certificate(*counts, least, plan.problem.robot.unchecked_links),
    )


def _request(
    planner: Planner,
    refine: bool | None,
    colonies: int,
    workers: int,
    until: str,
    on_cycle: OnCycle | None,
) -> SearchRequest:
    if on_cycle is not None and not callable(on_cycle):
        raise InvalidInput("on_cycle", on_cycle, "a function, or None")
    count = whole_number("colonies", colonies, at_least=1)
    if planner.exact and count > 1:
        raise InvalidInput("colonies", colonies, f"1 with {planner.name}: it has one result")
    if planner.exact and on_cycle is not None:
        raise InvalidInput("on_cycle", on_cycle, f"None with {planner.name}: it has no cycles")
    if on_cycle is not None and count > 1:
        raise InvalidInput("on_cycle", on_cycle, "a callback only where colonies = 1")
    first = one_of("until", until, ("end", "first")) == "first"
    if first and not isinstance(planner, TreePlanner):
        raise InvalidInput(
            "until", until, f"'end' with {planner.name}, or tree-planner without a lattice"
        )
    return SearchRequest(
        refine=None if refine is None else truth("refine", refine),
        colonies=count,
        workers=whole_number("workers", workers, at_least=1, at_most=_MOST_WORKERS),
        on_cycle=on_cycle,
        first=first,
    )


def _spread(problem: Problem, request: SearchRequest, scheduler: object) -> SearchRequest:
    """The request, after a check of its colonies and of what they are spread over."""
    if scheduler is not None and request.colonies == 1:
        raise InvalidInput(
            "scheduler", scheduler, "None with one colony, which runs in one process"
        )
    if scheduler is not None and request.workers > 1:
        raise InvalidInput("workers", request.workers, "1 with a scheduler, which has its own")
    check_colonies(problem, request.colonies)
    return request._replace(scheduler=scheduler)


def _deadline(time_limit: float | None) -> Deadline:
    return Deadline(math.inf if time_limit is None else number("time_limit", time_limit, above=0.0))


def _planner_for(problem: Problem, planner: Planner | str | None) -> tuple[Planner, Problem]:
    """The planner, after a check that it can solve the problem, and the problem as it sees it.

    For planners on a lattice that is the problem without alternative goals.
    """
    if not isinstance(problem, Problem):
        raise InvalidInput("problem", problem, "a Problem (that of a scenario is scenario.problem)")
    chosen = planner_of(planner, problem)
    chosen.refuse(problem)
    if problem.lattice is not None and not isinstance(chosen, Portfolio):
        problem = problem.ending_at(problem.goal)
    return chosen, problem


def _certified(
    problem: Problem, planner: Planner, seed: int | None, watch: Stopwatch, solution: Solution
) -> Plan:
    """The plan of a solution; `watch` was started when it was asked for."""
    portfolio = isinstance(planner, Portfolio) and problem.lattice is not None
    if portfolio and solution.lattice is None:
        problem = without_lattice(problem)  # the trees of a portfolio found the path
    end = solution.motion.configurations()[-1]
    return Plan(
        problem=problem.ending_at(end),
        planner=planner,
        seed=seed,
        seconds=watch.computing,
        **solution._asdict(),
    )


def _warn_of_ignored_goal(plan: Plan) -> None:
    """Warn where the goal has a base pose, not that of the start, which the mode does not reach."""
    problem, arrival = plan.problem, plan.motion.configurations()[-1]
    start, goal, mode = problem.start, problem.goal, problem.mode
    missed = []
    if mode.attitude_reacts and not problem.reach_attitude:
        angle = angle_between(np.stack([arrival[3:7], start[3:7]]), goal[3:7])
        if angle.min() > _NOTABLE:
            missed.append(f"attitude is not demanded, and missed by {angle[0]:.3g} rad")
    if mode.floats:
        distance = np.linalg.norm(np.stack([arrival[:3], start[:3]]) - goal[:3], axis=1)
        if distance.min() > _NOTABLE:
            missed.append(f"position is not demanded, and missed by {distance[0]:.3g} m")
    if missed:
        text = f"in the mode {mode} the goal's base {', its base '.join(missed)}"
        warnings.warn(f"{text}; {_HOW_TO_REACH_IT}", GoalPoseIgnored, stacklevel=3)


def _generator(seed: int | np.random.Generator) -> tuple[np.random.Generator, int | None]:
    if isinstance(seed, np.random.Generator):
        return seed, None
    given = whole_number("seed", seed, at_least=0)
    return np.random.default_rng(given), given
