"""`plan(problem)`: from a problem to a certified plan."""

from __future__ import annotations

import time

import numpy as np

from ffsr_plan.colony import AntSystem
from ffsr_plan.colony.records import OnCycle
from ffsr_plan.errors import InvalidInput
from ffsr_plan.inputs import frozen, whole_number
from ffsr_plan.problem import Problem
from ffsr_plan.result import Plan
from ffsr_plan.roadmap import Roadmap

PLANNERS = {planner.name: planner for planner in (AntSystem,)}
"""Planner classes by the name that scenario files and the command line use."""


def plan(
    problem: Problem,
    planner: AntSystem | None = None,
    seed: int | np.random.Generator = 0,
    *,
    on_cycle: OnCycle | None = None,
) -> Plan:
    """Plan a motion in which no link touches an obstacle or another link, proven edge by edge.

    Args:
        problem: what to plan.
        planner: settings of the planner; the paper's `AntSystem()` by default.
        seed: a whole number >= 0, or a generator. The same seed gives the same plan, bit for bit.
        on_cycle: called with a `Cycle` after each cycle of the colony.

    Raises:
        InvalidInput: not a planner or not a seed.
        StartInCollision, GoalInCollision: with link, obstacle and depth.
        NoPath: the lattice holds no free path, with the layer that cannot be passed.
    """
    begin = time.perf_counter()
    planner = AntSystem() if planner is None else planner
    if not isinstance(planner, tuple(PLANNERS.values())):
        raise InvalidInput("planner", planner, f"one of {', '.join(PLANNERS)}, as an object")
    if isinstance(seed, np.random.Generator):
        rng, number = seed, None
    else:
        number = whole_number("seed", seed, at_least=0)
        rng = np.random.default_rng(number)
    roadmap = Roadmap(problem)
    found = planner.search(roadmap, rng, on_cycle)
    indices = roadmap.lattice.indices[found.path]
    axes = indices.shape[1]
    nodes = indices if axes > 1 else indices.sum(axis=1)  # (m + 1,) for one axis, and for none
    nodes.setflags(write=False)
    objective = roadmap.objective(found.path)
    return Plan(
        problem=problem,
        planner=planner,
        seed=number,
        nodes=nodes,
        configurations=frozen(roadmap.lattice.motion(found.path).configurations()),
        length=roadmap.path_length(found.path),
        objective=objective,
        lattice_objective=objective,
        clearances=frozen(roadmap.path_clearances(found.path)),
        history=found.history,
        trails=found.trails,
        certificate=roadmap.certificate(found.path),
        seconds=time.perf_counter() - begin,
    )
