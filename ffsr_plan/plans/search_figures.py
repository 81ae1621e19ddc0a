"""What a plan file says of the search: refused where no search gives such figures."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.plans.plan_tables import PlanTable
from ffsr_plan.portfolio.portfolio_planner import Portfolio
from ffsr_plan.problem.lattice_settings import Lattice
from ffsr_plan.problem.problem import Problem

_ROUNDING = 1e-9  # share of F by which sums of the same costs differ
_LEAST_GAIN = 1e-9  # [m] by which a path has to be better to become the best one


def check_search(what: str, table: PlanTable, problem: Problem) -> None:
    """Check history, trails, optimum and counts against the lattice and one another.

    Args:
        what: name of the file in errors.
        table: the plan, each field of which has been checked by itself.
        problem: what was planned.

    Raises:
        InvalidInput: with the path of the field.
    """
    _check_history(what, table, problem)
    if problem.lattice is not None:
        _check_trails(what, table, problem.lattice)
    most = table.lattice_objective
    if table.optimum > most * (1.0 + _ROUNDING):
        allowed = f"at most lattice_objective, {most!r}"
        raise InvalidInput(f"{what}, optimum", table.optimum, allowed)
    lattice = problem.lattice
    if table.optimum_is_exact and (lattice is None or lattice.postures):
        allowed = "false with posture axes and without a lattice"
        raise InvalidInput(f"{what}, optimum_is_exact", True, allowed)
    edges, path = table.certificate.edges_free, len(table.motion.positions) - 1
    if edges < path:
        allowed = f"at least {path}, the edges of the path"
        raise InvalidInput(f"{what}, certificate.edges_free", edges, allowed)


def _check_history(what: str, table: PlanTable, problem: Problem) -> None:
    """Raise `InvalidInput` for a course that no search takes.

    The best F never rises. On a lattice without posture axes it is that of a proven path, none of
    which costs less than the plan's; with them it counts what is yet to be proven.
    """
    history = table.history
    best, cycle = history.best, history.iteration_best
    with np.errstate(invalid="ignore"):  # infinity, which stands for no path yet, from infinity
        rises = np.flatnonzero(np.diff(best) > 0.0)
    if len(rises):
        k = int(rises[0]) + 1
        allowed = f"at most that of the cycle before, {float(best[k - 1])!r}"
        raise InvalidInput(f"{what}, history.best.{k}", float(best[k]), allowed)
    slack = _LEAST_GAIN / problem.length_unit
    for k in np.flatnonzero(best > cycle * (1.0 + _ROUNDING) + slack)[:1]:
        allowed = f"at most history.iteration_best, {float(cycle[k])!r}"
        raise InvalidInput(f"{what}, history.best.{k}", float(best[k]), allowed)
    postures = problem.lattice is not None and bool(problem.lattice.postures)
    least = 0.0 if postures else table.lattice_objective
    for k in np.flatnonzero(best < least * (1.0 - _ROUNDING))[:1]:
        allowed = f"at least lattice_objective, {least!r}"
        raise InvalidInput(f"{what}, history.best.{k}", float(best[k]), allowed)
    own = "ants" if problem.lattice is not None else "ways"
    planner = table.planner
    if isinstance(planner, Portfolio):
        planner = planner.part(problem)
    most = getattr(planner, own, 1)
    for k in np.flatnonzero(history.distinct > most)[:1]:
        allowed = f"at most {most}, the {own} of the planner"
        raise InvalidInput(f"{what}, history.distinct.{k}", int(history.distinct[k]), allowed)


def _check_trails(what: str, table: PlanTable, lattice: Lattice) -> None:
    """Raise `InvalidInput` for edges that the lattice does not have, or that are there twice."""
    trails = table.trails
    offsets = int(np.prod([2 * getattr(lattice, n).half_count + 1 for n in lattice.axes]))
    for end, most in (("layer", lattice.divisions), ("tail", offsets), ("head", offsets)):
        walked = getattr(trails, end)
        outside = walked[walked >= most]
        if len(outside):
            raise InvalidInput(f"{what}, trails.{end}", int(outside[0]), f"0 to {most - 1}")
    edges = np.column_stack([trails.layer, trails.tail, trails.head])
    once, counts = np.unique(edges, axis=0, return_counts=True)
    for edge in once[counts > 1][:1]:
        allowed = "each edge (layer, tail, head) once"
        raise InvalidInput(f"{what}, trails", tuple(edge.tolist()), allowed)
