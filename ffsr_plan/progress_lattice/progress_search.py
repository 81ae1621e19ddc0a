"""The exact optimum of a lattice with progress: shortest paths, nodes and edges on demand.

Nodes that are not evaluated are assumed to have the largest clearance that others allow, and edges
to be free, so that the first shortest path that holds is the optimum.
"""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import IntArray
from ffsr_plan.progress_lattice.progress_roadmap import ProgressRoadmap
from ffsr_plan.time_limit.deadline import Deadline


class ProgressSearch:
    """A search for the optimum."""

    def __init__(self, roadmap: ProgressRoadmap, deadline: Deadline) -> None:
        """A search of a roadmap.

        Args:
            roadmap: the lattice.
            deadline: after which the search raises `OutOfTime`.
        """
        self._roadmap, self._deadline = roadmap, deadline
        shape = roadmap.node_costs.shape
        self._costs = np.full(shape, np.inf)
        self._costs[0] = np.where(np.isfinite(roadmap.node_costs[0]), 0.0, np.inf)
        self._before: IntArray = np.zeros(shape, dtype=np.int64)

    def path(self) -> IntArray | None:
        """The path with the least F, all its edges proven free.

        Returns:
            (m + 1, 3) place, offset, and step aside towards the next layer; None if there is none.

        Raises:
            OutOfTime: at the deadline.
        """
        roadmap, first = self._roadmap, 0
        while True:
            path = self._shortest(first)
            if path is None:
                return None
            changed = roadmap.learn(path)
            if changed is None:
                changed = roadmap.prove(path)
            if changed is None:
                return path
            first = changed

    def _shortest(self, first: int) -> IntArray | None:
        """The shortest path at the present costs; None if there is none."""
        from ffsr_plan.progress_lattice.progress_kernels import extend, trace

        self._deadline.check()
        roadmap, steps = self._roadmap, self._roadmap.steps
        extend(
            first, roadmap.edges, roadmap.heads, roadmap.edge_costs, roadmap.node_costs,
            roadmap.at_rest, roadmap.moving, self._costs, self._before,
        )  # fmt: skip
        if not np.isfinite(self._costs[-1, steps.goal, roadmap.origin]):
            return None
        path = np.empty((len(self._costs), 3), dtype=np.int64)
        trace(self._before, roadmap.heads.shape[1], steps.goal, roadmap.origin, path)
        return path

    @property
    def closed_layer(self) -> int:
        """Where there is no path, the first layer that cannot be reached; the last if all can."""
        reached = np.isfinite(self._costs).any(axis=(1, 2))
        return int(np.argmin(reached)) if not reached.all() else len(reached) - 1
