"""A lattice with progress solved: the optimum, its motion and its certificate."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import frozen
from ffsr_plan.core.errors import InternalError, InvalidInput, NoPath
from ffsr_plan.lattice.certificate import Certificate, proven_clearance
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.problem.advice import against_closed_times
from ffsr_plan.problem.memory_estimate import check_lattice
from ffsr_plan.problem.objective import objective
from ffsr_plan.problem.problem import Problem
from ffsr_plan.progress_lattice.progress_roadmap import ProgressRoadmap
from ffsr_plan.progress_lattice.progress_search import ProgressSearch
from ffsr_plan.progress_lattice.side_steps import SideSteps
from ffsr_plan.progress_lattice.ways import StraightWay
from ffsr_plan.proof.prover import Prover
from ffsr_plan.search.records import History, SearchRequest, Solution, Trails
from ffsr_plan.time_limit.deadline import Deadline


def solve_with_progress(problem: Problem, request: SearchRequest) -> Solution:
    """The optimum of a lattice with progress, certified.

    Args:
        problem: a problem on such a lattice.
        request: deadline; the path is not refined.

    Raises:
        InvalidInput: `refine=True`.
        StartInCollision, GoalInCollision: with link, obstacle and depth.
        NoPath: the lattice holds no free path.
        OutOfTime: at the deadline.
    """
    if request.refine:
        raise InvalidInput("refine", True, "False on a lattice with progress")
    deadline = request.deadline or Deadline()
    deadline.stage = "the search for a path"
    check_lattice(problem)
    lattice, way = LayeredLattice(problem), StraightWay(problem)
    m = lattice.divisions
    roadmap = ProgressRoadmap(problem, way, SideSteps.of(lattice), m, deadline)
    search = ProgressSearch(roadmap, deadline)
    path = search.path()
    if path is None:
        raise NoPath(search.closed_layer, (), m, (), against_closed_times(problem))
    if not roadmap.is_proven(path):
        raise InternalError("a path whose edges are not all proven free")
    request.begin()
    progress, offsets = way.values[path[:, 0]], roadmap.offsets[path[:, 1]]
    motion = way.motion(path[:, 0], offsets)
    prover = Prover(motion, problem.obstacles, problem.tolerance, deadline, problem.pace(m))
    still = np.zeros((m + 1, 3))
    clearances = prover.clearances(np.arange(m + 1), still)
    across = np.sum((np.diff(offsets, axis=0) * problem.position_weight) ** 2, axis=1)
    length = float(np.sum(np.sqrt(way.lengths(path[:, 0]) ** 2 + across)))
    value = objective(problem, length, clearances)
    counts = roadmap.counts()
    deadline.close()
    least, cut = proven_clearance(prover, still, clearances)
    nodes = np.column_stack([lattice.indices[path[:, 1]], progress])
    return Solution(
        lattice=None,
        motion=motion,
        nodes=frozen(nodes if nodes.shape[1] > 1 else nodes[:, 0]),
        length=length,
        objective=value,
        lattice_objective=value,
        optimum=value,
        optimum_is_exact=True,
        clearances=frozen(clearances),
        history=History.of_rows(np.array([[value, value, value, 1.0]])),
        trails=Trails.none(),
        certificate=Certificate(*counts, least, problem.robot.unchecked_links),
        interrupted=cut,
    )
