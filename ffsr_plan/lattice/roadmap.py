"""`Roadmap`: a lattice with the states of its nodes and edges, evaluated on demand."""

from __future__ import annotations

import copy

import numpy as np

from ffsr_plan.collision.contacts import named
from ffsr_plan.core.arrays import Array, Flags, IntArray, States, frozen
from ffsr_plan.core.contacts import Contact
from ffsr_plan.core.errors import InvalidInput, NoPath
from ffsr_plan.lattice.certificate import Counts
from ffsr_plan.lattice.edge_states import FREE, REFUSED, UNKNOWN
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.lattice.node_clearances import NodeClearances
from ffsr_plan.problem.advice import against_obstacles, against_self_collision
from ffsr_plan.problem.memory_estimate import check_lattice
from ffsr_plan.problem.objective import nearness, objective, path_length
from ffsr_plan.problem.problem import Problem
from ffsr_plan.proof.interval_halving import Verdict
from ffsr_plan.proof.prover import Prover
from ffsr_plan.time_limit.deadline import Deadline

_EDGES_AT_ONCE = 10_000  # that are looked at together


class Roadmap:
    """Nodes and edges of a lattice with their clearances and states.

    Attributes:
        problem: what the lattice was built from.
        deadline: after which whatever takes long raises `OutOfTime`.
        lattice: the lattice.
        prover: clearances and proofs for any offsets.
        nodes: clearances of the nodes, evaluated on demand.
        status: (m, n, n) state of each edge: UNKNOWN, FREE or REFUSED.
    """

    def __init__(self, problem: Problem, deadline: Deadline | None = None) -> None:
        """Set up the lattice; nodes are evaluated when they are first needed.

        Args:
            problem: a problem without posture axes.
            deadline: for this and all later work; none by default.

        Raises:
            StartInCollision, GoalInCollision: with link, obstacle and depth.
            NoPath: the arms collide with each other on an edge of the nominal motion, whatever the
                offsets.
        """
        check_lattice(problem)
        if problem.given_lattice.postures:
            raise InvalidInput(
                "lattice postures",
                len(problem.given_lattice.postures),
                "none: with them a node has no single attitude, which a roadmap needs",
            )
        self.problem, self.deadline = problem, deadline or Deadline()
        self.lattice = LayeredLattice(problem)
        self.prover = Prover(
            self.lattice.nominal, problem.obstacles, problem.tolerance, self.deadline,
            problem.pace(self.lattice.divisions),
        )  # fmt: skip
        self.prover.check_ends()
        self.prover.check_self_collision(against_self_collision())
        self.nodes = NodeClearances(self.lattice, self.prover)
        m, n = self.lattice.divisions, self.lattice.size
        self.status: States = np.zeros((m, n, n), dtype=np.int8)
        self._verdicts: dict[tuple[int, int, int], Verdict] = {}

    @property
    def clearances(self) -> Array:
        """(m + 1, n) clearance of every node [m]; NaN where a layer lacks the node."""
        return self.nodes.exact()

    @property
    def admissible(self) -> Flags:
        """(m + 1, n) the nodes that touch nothing."""
        return self.nodes.exact() > 0.0

    def without_edge_states(self) -> Roadmap:
        """A roadmap for another colony.

        Returns:
            A roadmap that shares the nodes of this one, all edges unknown.
        """
        twin = copy.copy(self)
        twin.status = np.zeros_like(self.status)
        twin._verdicts = {}
        return twin

    def certify(self, layer: int, tail: int, head: int) -> Verdict:
        """Prove an edge free, or refuse it; edges close to a refused one are refused with it.

        Args:
            layer: layer that the edge leaves.
            tail: node of that layer.
            head: node of the next layer.

        Returns:
            The verdict, kept for later calls.
        """
        key = (layer, tail, head)
        if key not in self._verdicts:
            ends = (self._clearance(layer, tail), self._clearance(layer + 1, head))
            offsets = self.lattice.offsets
            (verdict,) = self.prover.certify_all(
                np.array([layer]), offsets[[tail]], offsets[[head]], np.array([ends])
            )
            self._note(key, verdict)
        return self._verdicts[key]

    def _note(self, edge: tuple[int, int, int], verdict: Verdict) -> None:
        """Keep a verdict; a refusal may refuse other edges with it."""
        self._verdicts[edge] = verdict
        self.status[edge] = FREE if verdict.free else REFUSED
        if not verdict.free:
            offsets = self.lattice.offsets
            rule_out(self.status[edge[0]], offsets, offsets, edge[1:], verdict)

    def free(self, layer: int, tail: int, head: int) -> bool:
        """Whether an edge is free, certifying it if its state is unknown.

        Args:
            layer: layer that the edge leaves.
            tail: node of that layer.
            head: node of the next layer.
        """
        known = self.status[layer, tail, head]
        return bool(known == FREE or (known == UNKNOWN and self.certify(layer, tail, head).free))

    def prove_path(self, path: IntArray) -> bool:
        """Certify every edge of a path whose state is unknown.

        Args:
            path: (m + 1,) nodes, one a layer.

        Returns:
            Whether all of them are free.
        """
        layers = np.arange(len(path) - 1)
        open_ones = np.flatnonzero(self.status[layers, path[:-1], path[1:]] == UNKNOWN)
        if len(open_ones):
            clearances, offsets = self.path_clearances(path), self.lattice.offsets
            tails, heads = path[open_ones], path[open_ones + 1]
            ends = np.column_stack([clearances[open_ones], clearances[open_ones + 1]])
            edges = zip(open_ones.tolist(), tails.tolist(), heads.tolist(), strict=True)
            verdicts = self.prover.certify_all(open_ones, offsets[tails], offsets[heads], ends)
            for edge, verdict in zip(edges, verdicts, strict=True):
                self._note(edge, verdict)
        return bool(np.all(self.status[layers, path[:-1], path[1:]] == FREE))

    def is_proven(self, path: IntArray) -> bool:
        """Whether every edge of a path (m + 1,) is known to be free."""
        return bool(np.all(self.status[np.arange(len(path) - 1), path[:-1], path[1:]] == FREE))

    def refused_layers(self, path: IntArray) -> IntArray:
        """The layers that a path leaves by a refused edge.

        Args:
            path: (m + 1,) nodes, one a layer.

        Returns:
            (k,) layers in ascending order.
        """
        states = self.status[np.arange(len(self.status)), path[:-1], path[1:]]
        return np.flatnonzero(states == REFUSED)

    def prove_obvious(self) -> None:
        """Mark the edges that the clearances at their ends prove free without a query."""
        prover, base_travel = self.prover, self.lattice.base_travel
        positive = np.where(self.admissible, self.clearances, np.nan)
        others, stride = prover.speeds + prover.rounding, max(1, _EDGES_AT_ONCE // base_travel.size)
        for first in range(0, self.lattice.divisions, stride):
            self.deadline.check()
            some = slice(first, min(first + stride, self.lattice.divisions))
            sums = positive[some, :, None] + positive[1:][some, None]
            travel = base_travel + others[some, None, None]
            np.copyto(self.status[some], FREE, where=sums > travel)

    def path_length(self, path: IntArray) -> float:
        """Length of a path.

        Args:
            path: (m + 1,) nodes, one a layer.

        Returns:
            L of Eq. 6 [m].
        """
        return path_length(self.problem, self.lattice.offsets[path])

    def path_clearances(self, path: IntArray) -> Array:
        """Clearances along a path, evaluated where they are not known.

        Args:
            path: (m + 1,) nodes, one a layer.

        Returns:
            (m + 1,) link-to-sphere distances of Eq. 9 [m].
        """
        self.nodes.learn(path)
        return self.nodes.bounds[np.arange(len(path)), path]

    def objective(self, path: IntArray) -> float:
        """Objective of a path whose edges are assumed free.

        Args:
            path: (m + 1,) nodes, one a layer.

        Returns:
            F of Eq. 8 [length units].
        """
        return objective(self.problem, self.path_length(path), self.path_clearances(path))

    def edge_costs(self) -> Array:
        """Contribution of edges to F.

        Returns:
            (n, n) lengths d_pq between two layers [length units].
        """
        return self.lattice.steps / self.problem.length_unit

    def node_costs(self) -> Array:
        """Contribution of nodes to F; evaluates all of them.

        Returns:
            (m + 1, n) delta / d_imin [length units]; infinite at nodes in collision.
        """
        self.nodes.exact()
        return frozen(self.optimistic_node_costs())

    def optimistic_node_costs(self) -> Array:
        """Lower bounds of `node_costs` from the nodes evaluated so far.

        Returns:
            (m + 1, n) [length units].
        """
        costs = self.optimistic_costs_of_layers(np.arange(self.lattice.divisions + 1))
        costs[[0, -1], self.lattice.origin] = 0.0  # layers 0 and m do not count in Eq. 8
        return costs

    def optimistic_costs_of_layers(self, layers: IntArray) -> Array:
        """Lower bounds of `node_costs` on some inner layers.

        Args:
            layers: (k,) layers from 1 to m - 1.

        Returns:
            (k, n) [length units].
        """
        bounds = self.nodes.bounds[layers]
        return np.where(bounds > 0.0, nearness(self.problem, bounds), np.inf)

    def evaluate_all(self) -> None:
        """Evaluate every node now."""
        self.nodes.exact()

    def counts(self) -> Counts:
        """Edges decided and queries spent so far.

        Returns:
            Numbers of edges and of Coal queries.
        """
        return Counts(
            edges_free=int(np.count_nonzero(self.status == FREE)),
            edges_refused=int(np.count_nonzero(self.status == REFUSED)),
            node_queries=self.nodes.queries,
            edge_queries=self.prover.queries - self.nodes.queries,
        )

    def no_path(self) -> NoPath | None:
        """Search the lattice from the start, certifying edges as needed.

        Returns:
            The error that proves that there is no path; None if there is one.
        """
        m, origin = self.lattice.divisions, self.lattice.origin
        reached, admissible = [origin], self.admissible
        for layer in range(m):
            heads = np.flatnonzero(admissible[layer + 1]).tolist()
            onwards = [k for k in heads if any(self.free(layer, j, k) for j in reached)]
            if not onwards:
                contacts = self._closing(layer)
                spheres = sorted({c.obstacle for c in contacts if isinstance(c.obstacle, int)})
                ends = (self.nodes.bounds[0, origin], self.nodes.bounds[m, origin])
                advice = against_obstacles(self.problem, (float(ends[0]), float(ends[1])))
                return NoPath(layer + 1, tuple(spheres), m, contacts, advice)
            reached = onwards
        return None

    def _clearance(self, layer: int, node: int) -> float:
        if not self.nodes.known[layer, node]:
            path = np.full(self.lattice.divisions + 1, self.lattice.origin)
            path[layer] = node
            self.nodes.learn(path)
        return float(self.nodes.bounds[layer, node])

    def _closing(self, layer: int) -> tuple[Contact, ...]:
        """What blocks the edges of a layer that were looked at, and the nodes they lead to.

        One contact for each pair of link and sphere, the deepest.
        """
        offsets, nearest = self.lattice.offsets, []
        for (i, tail, head), verdict in self._verdicts.items():
            if i == layer and not verdict.free:
                nearest.append(self.prover.nearest(i, offsets[tail], offsets[head], verdict.time))
        if layer + 1 < self.lattice.divisions:
            for at in offsets[~self.admissible[layer + 1]]:
                nearest.append(self.prover.nearest(layer + 1, at, at, 0.0))
        nearest.sort(key=lambda pair: pair.distance)
        pairs = {(pair.link, pair.obstacle): pair for pair in reversed(nearest)}
        return tuple(
            named(self.problem.obstacles, p) for p in pairs.values() if p.obstacle is not None
        )


def rule_out(
    status: States, tails: Array, heads: Array, edge: tuple[int, int], verdict: Verdict
) -> None:
    """Refuse every edge of a layer that passes, at the same time, within the depth just met.

    Attitude and joints are the same at that time, and a translation shorter than the penetration
    depth does not leave the obstacle.

    Args:
        status: (j, k) of the layer's edges, updated.
        tails: (j, 3) offsets at the edges' beginnings [m].
        heads: (k, 3) offsets at their ends [m].
        edge: tail and head of the edge that was refused.
        verdict: why.
    """
    depth, t = -verdict.least_clearance * (1.0 - 1e-9), verdict.time
    if depth <= 0.0:
        return
    from ffsr_plan.lattice.refused_neighbours_kernel import refuse_near

    met = (1.0 - t) * tails[edge[0]] + t * heads[edge[1]]
    own = np.array(tails), np.array(heads)  # not read-only: a kernel is compiled for each kind
    refuse_near(status, *own, t, met, depth)
