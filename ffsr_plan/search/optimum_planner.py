"""`LatticeOptimum`: the exact lattice optimum as a planner."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from ffsr_plan.core.arrays import frozen
from ffsr_plan.core.settings import settings
from ffsr_plan.lattice.optimum import lattice_optimum
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.problem.problem import Problem
from ffsr_plan.search.lattice_planner import LatticePlanner
from ffsr_plan.search.records import (
    History,
    SearchMonitor,
    SearchResult,
    Trails,
)


@settings
class LatticeOptimum(LatticePlanner):
    """The exact optimum as a planner; it has no parameters and ignores the seed.

    Of equally short paths, the one whose nodes have the lowest indices from the goal backwards
    wins, always the same one.
    """

    name: ClassVar[str] = "lattice-optimum"
    exact: ClassVar[bool] = True
    bytes_per_edge: ClassVar[float] = 2.0

    def refuse(self, problem: Problem) -> None:
        """Raise `InvalidInput` if the planner cannot solve the problem, naming one that can."""
        if problem.lattice is None or problem.lattice.progress is None:
            super().refuse(problem)

    def search(
        self, roadmap: Roadmap, rng: np.random.Generator, monitor: SearchMonitor | None = None
    ) -> SearchResult:
        """Find the optimum.

        Raises:
            NoPath: proven, with the layer that cannot be reached and the obstacles that close it.
        """
        path = lattice_optimum(roadmap)
        value = roadmap.objective(path)
        history = History.of_rows(np.array([[value, value, value, 1.0]]))
        return SearchResult(frozen(path), history, Trails.none())
