"""`Roadmap`: the lattice with its clearances, and its edges certified when they are asked for."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ffsr_plan.collision import Nearest, obstacle_query, self_query
from ffsr_plan.edges import Verdict, certify, clearance_bound
from ffsr_plan.errors import GoalInCollision, NoPath, StartInCollision
from ffsr_plan.inputs import Array, IntArray, frozen
from ffsr_plan.lattice import LayeredLattice
from ffsr_plan.objective import nearness, objective, path_length
from ffsr_plan.problem import Problem
from ffsr_plan.travel import swing

_BOUND_GAP = 1e-3  # [m] between the clearance proven along a path and the least one met


class Certificate(NamedTuple):
    """What was proven, and at what cost."""

    edges_free: int
    """Edges proven free."""
    edges_blocked: int
    """Edges refused."""
    node_queries: int
    """Coal queries for the clearances of nodes: one a configuration, over all pairs."""
    edge_queries: int
    """Coal queries inside edges, obstacles and self-collision together."""
    least_clearance: float
    """Proven lower bound on the clearance all along the returned path [m]."""


class Roadmap:
    """Nodes with exact clearances and lazily certified edges.

    Attributes:
        lattice: the lattice.
        clearances: (m + 1, n) clearance of each node [m]; NaN where a layer lacks the node.
        admissible: (m + 1, n) the nodes that touch nothing.
    """

    def __init__(self, problem: Problem) -> None:
        """Evaluate all nodes.

        Raises:
            StartInCollision, GoalInCollision: with link, obstacle and depth.
            NoPath: if the arms collide with each other on the way, at every node alike.
        """
        self.problem = problem
        self.lattice = LayeredLattice(problem)
        self._obstacles = obstacle_query(problem.robot, problem.scene)
        self._self = self_query(problem.robot)
        m, n = self.lattice.divisions, self.lattice.size
        self._check_ends()
        clearances = np.full((m + 1, n), np.nan)
        for i in (0, m):
            end = self.lattice.layer(i)[self.lattice.origin]
            clearances[i, self.lattice.origin] = self._obstacles.distance(end)
        for i in range(1, m):
            clearances[i] = self._obstacles.distances(self.lattice.layer(i))
        self.clearances = frozen(clearances)
        self.admissible: NDArray[np.bool_] = clearances > 0.0
        self.admissible.setflags(write=False)
        self._node_queries = self._obstacles.count
        begin = np.abs(self.lattice.nominal.joint_values[0])
        end = np.abs(self.lattice.nominal.joint_values[-1])
        self._swing = swing(
            problem.robot,
            problem.joint_travel / m,
            np.maximum(begin, end),
            None if problem.mode == "free-flying" else problem.turn / m,
        )
        self._verdicts: dict[tuple[int, int, int], Verdict] = {}
        self._nominal: dict[tuple[int, float], Array] = {}
        self._certify_self_collision()

    def certify(self, layer: int, tail: int, head: int) -> Verdict:
        """The verdict on the edge from node `tail` of `layer` to node `head` of the next one."""
        key = (layer, tail, head)
        if key not in self._verdicts:
            self._verdicts[key] = self._examine(layer, tail, head)
        return self._verdicts[key]

    def path_length(self, path: IntArray) -> float:
        """L of Eq. 6 [m] of a path, node indices (m + 1,)."""
        return path_length(self.problem, self.lattice.offsets[path])

    def path_clearances(self, path: IntArray) -> Array:
        """(m + 1,) clearances at the nodes of a path [m]."""
        return self.clearances[np.arange(len(path)), path]

    def objective(self, path: IntArray) -> float:
        """F of Eq. 8 of a path, node indices (m + 1,), edges taken as free."""
        return objective(self.problem, self.path_length(path), self.path_clearances(path))

    def nearness(self) -> Array:
        """(m + 1, n) delta / d_imin of the nodes; layers 0 and m do not count in F."""
        return nearness(self.problem, self.clearances)

    def certificate(self, path: IntArray) -> Certificate:
        """Sum up the proofs, after certifying every edge of `path`."""
        edges = [(i, int(j), int(k)) for i, (j, k) in enumerate(pairwise(path))]
        free = all(self.certify(*edge).free for edge in edges)
        bounds = (
            [clearance_bound(*self._question(*edge), _BOUND_GAP) for edge in edges] if free else []
        )
        proven = sum(v.free for v in self._verdicts.values())
        return Certificate(
            edges_free=proven,
            edges_blocked=len(self._verdicts) - proven,
            node_queries=self._node_queries,
            edge_queries=self._obstacles.count - self._node_queries + self._self.count,
            least_clearance=min(bounds, default=0.0),
        )

    def no_path(self, layer: int) -> NoPath:
        """The error that says that no node of `layer` can be reached, and what is in the way."""
        closing: set[int | str] = set()
        for (i, tail, head), verdict in self._verdicts.items():
            if i == layer - 1 and not verdict.free:
                q = self._on_edge(i, tail, head, verdict.time)
                closing.add(self._obstacles.nearest(q).other)
        if layer < self.lattice.divisions:
            for node in np.flatnonzero(~self.admissible[layer]):
                closing.add(self._obstacles.nearest(self.lattice.layer(layer)[node]).other)
        order = sorted(closing, key=lambda name: (isinstance(name, str), name))
        return NoPath(layer, tuple(order), self.lattice.divisions)

    def _examine(self, layer: int, tail: int, head: int) -> Verdict:
        return certify(*self._question(layer, tail, head), self.problem.tolerance)

    def _question(
        self, layer: int, tail: int, head: int
    ) -> tuple[Callable[[float], float], tuple[float, float], float]:
        """What a proof about an edge needs: clearance along it, at its ends, and the travel."""
        speed = float(self.lattice.base_travel[tail, head] + np.max(self._swing.world, initial=0.0))
        ends = (float(self.clearances[layer, tail]), float(self.clearances[layer + 1, head]))

        def clearance_at(time: float) -> float:
            return self._obstacles.distance(self._on_edge(layer, tail, head, time))

        return clearance_at, ends, speed

    def _on_edge(self, layer: int, tail: int, head: int, time: float) -> Array:
        q = self._nominal_at(layer, time).copy()
        offsets = self.lattice.offsets
        q[:3] += (1.0 - time) * offsets[tail] + time * offsets[head]
        return q

    def _nominal_at(self, layer: int, time: float) -> Array:
        """Halving asks for the same few times on every edge of a layer, so they are kept."""
        key = (layer, time)
        if key not in self._nominal:
            at = self.lattice.nominal.at(np.array([layer]), np.array([time]))
            self._nominal[key] = frozen(at[0])
        return self._nominal[key]

    def _check_ends(self) -> None:
        nominal = self.lattice.nominal.configurations()
        for q, error in ((nominal[0], StartInCollision), (nominal[-1], GoalInCollision)):
            for query in (self._obstacles, self._self):
                near: Nearest = query.nearest(q)
                if near.distance <= 0.0:
                    raise error(near.link, near.other, -near.distance)

    def _certify_self_collision(self) -> None:
        """One verdict an edge of the joint path serves all nodes: it does not see the base."""
        if self._self.empty:
            return
        m = self.lattice.divisions
        corners = self.lattice.nominal.configurations()
        pairs = self.problem.robot.collision_model.collisionPairs
        in_base = self._swing.in_base
        speed = max(float(in_base[p.first] + in_base[p.second]) for p in pairs)
        ends = self._self.distances(corners)
        for i in range(m):
            between = partial(self._self_distance, i)
            verdict = certify(
                between, (float(ends[i]), float(ends[i + 1])), speed, self.problem.tolerance
            )
            if not verdict.free:
                near = self._self.nearest(self._nominal_at(i, verdict.time))
                raise NoPath(i + 1, (near.link, near.other), m)

    def _self_distance(self, layer: int, time: float) -> float:
        return self._self.distance(self._nominal_at(layer, time))
