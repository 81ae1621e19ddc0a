"""Planners of OMPL on the problem set, with two assumptions about the attitude of the base.

States are base position, where thrusters move it, and joint values. They carry no attitude, which
depends on the path. So it is assumed: as at the start, which is planning for a base at rest, or
that of a straight motion from the start to the state, which is exact on the first edge alone. What
comes out is judged with the true reaction, like all results.
"""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass, replace
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import InvalidInput, PlanningError
from ffsr_plan.portfolio.lattice_left_out import without_lattice
from ffsr_plan.problem.problem import Problem
from ffsr_plan.problem_set.judging.judgement import judged
from ffsr_plan.trajectory.trajectory import Trajectory
from ffsr_plan.tree_search.kernels.flight import fly
from ffsr_plan.tree_search.search_space import SearchSpace

AT_REST, STRAIGHT = "at-rest", "straight"
PLANNERS = {
    f"ompl-{name.lower()}-{assumed}": (name, assumed)
    for name in ("RRTConnect", "BITstar", "InformedRRTstar")
    for assumed in (AT_REST, STRAIGHT)
}
"""OMPL's planner and the assumed attitude, by the name of the adapter. Its wheel has no AIT*."""
DURATION = 100.0  # [s] of trajectories
_MARGIN = 1e-3  # [m]
_STEP = 0.02  # [m or rad] between two states that are checked on a way


class _States:
    """States of a problem, and whether they are clear at the assumed attitude."""

    def __init__(self, problem: Problem, assumed: str) -> None:
        self.space = SearchSpace(problem, _MARGIN)
        arrays = self.space.arrays
        setup = arrays.setup.copy()
        setup["reacts"] = False
        self._still, self._arrays = arrays._replace(setup=setup), arrays
        self._assumed, self._attitude = assumed, np.array(problem.start[3:7])
        box = arrays.box
        self.free = np.flatnonzero(box[1] > box[0])
        if problem.mode.floats:
            self.free = self.free[self.free > 3]
        self.bounds = box[:, self.free]

    def whole(self, values: Any) -> Array:  # noqa: ANN401 - a state of OMPL
        """(D,) of the searched coordinates of a state."""
        state = self.space.start.copy()
        for k, column in enumerate(self.free):
            state[column] = values[k]
        return state

    def clear(self, values: Any) -> bool:  # noqa: ANN401 - a state of OMPL
        """Whether nothing touches there."""
        state, arrival = self.whole(values), np.empty(4)
        straight = self._arrays if self._assumed == STRAIGHT else self._still
        fly(straight, self.space.start, self._attitude, state, arrival, False)
        return bool(fly(self._still, state, arrival, state, arrival, True) >= 1.0)


@dataclass(frozen=True)
class OmplPlanner:
    """A planner of OMPL.

    Attributes:
        planner: its name there.
        assumed: attitude of the base, `at-rest` or `straight`.
    """

    planner: str
    assumed: str

    @property
    def name(self) -> str:
        """Name of the adapter."""
        return f"ompl-{self.planner.lower()}-{self.assumed}"

    def plan(
        self, problem: Problem, seed: int, time_limit: float | None = None
    ) -> tuple[Trajectory, dict[str, Any]]:
        """The trajectory of a path, and its figures: seconds, curve and judgement.

        Args:
            problem: what to plan; a lattice is left out.
            seed: of OMPL's random numbers.
            time_limit: [s]; 10 s without.

        Raises:
            InvalidInput: bodies that move, or an attitude that wheels turn.
            PlanningError: no path was found in time, or the goal is not free as assumed.
        """
        if problem.scene.moves or problem.held_rotation > 0.0:
            allowed = "a problem in which no body moves and wheels do not turn the base"
            raise InvalidInput("problem", problem, allowed)
        free = problem if problem.lattice is None else without_lattice(problem)
        states = _States(replace(free, reach_attitude=False), self.assumed)
        begin = time.perf_counter()
        path = _path(states, self.planner, seed, 10.0 if time_limit is None else time_limit)
        seconds = time.perf_counter() - begin
        trajectory = _trajectory(problem, path)
        figures = {
            "planning_seconds": seconds,
            "curve": [(seconds, 1.0)],
            "judgement": asdict(judged("", problem, trajectory)),
        }
        return trajectory, figures


def _path(states: _States, planner: str, seed: int, seconds: float) -> Array:
    """(n, D) states of OMPL's path.

    Raises:
        InvalidInput: OMPL is not installed.
        PlanningError: none was found.
    """
    try:
        ob, og, ou = (import_module(f"ompl.{name}") for name in ("base", "geometric", "util"))
    except ImportError:
        raise InvalidInput("planner", planner, "one that is installed: pip install ompl") from None
    ou.setLogLevel(ou.LogLevel.LOG_ERROR)
    _seed_once(seed)
    size = len(states.free)
    space, bounds = ob.RealVectorStateSpace(size), ob.RealVectorBounds(size)
    for k in range(size):
        bounds.setLow(k, float(states.bounds[0, k]))
        bounds.setHigh(k, float(states.bounds[1, k]))
    space.setBounds(bounds)
    space.setLongestValidSegmentFraction(_STEP / space.getMaximumExtent())
    setup = og.SimpleSetup(space)
    setup.setStateValidityChecker(states.clear)
    start, goal = space.allocState(), space.allocState()
    for k, column in enumerate(states.free):
        start[k] = float(states.space.start[column])
        goal[k] = float(states.space.goals[0][column])
    setup.setStartAndGoalStates(start, goal)
    information = setup.getSpaceInformation()
    setup.setOptimizationObjective(ob.PathLengthOptimizationObjective(information))
    setup.setPlanner(getattr(og, planner)(information))
    setup.solve(seconds)
    if not setup.haveExactSolutionPath():
        raise PlanningError(f"OMPL's {planner} found no path in {seconds:g} s")
    if planner == "RRTConnect":
        setup.simplifySolution()
    found = setup.getSolutionPath().getStates()
    return np.array([states.whole(state) for state in found])


@cache
def _seeded() -> list[int]:
    """The seeds that OMPL was given in this process."""
    return []


def _seed_once(seed: int) -> None:
    """Seed OMPL, which takes one seed in a process: further tasks of it go on from there."""
    if not _seeded():
        import_module("ompl.util").RNG.setSeed(seed + 1)
        _seeded().append(seed)


def _trajectory(problem: Problem, path: Array) -> Trajectory:
    """The path at equal speed; the attitude of the base is left to the reaction."""
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    kept = np.append(True, steps > 1e-12)
    path, passed = path[kept], np.append(0.0, np.cumsum(steps[steps > 1e-12]))
    return Trajectory.of_array(
        DURATION * passed / passed[-1],
        path[:, 4:],
        problem.robot.joint_names,
        base_positions=path[:, :3] if problem.mode.has_thrusters else None,
        source=f"OMPL's path for {problem.robot.name}",
    )
