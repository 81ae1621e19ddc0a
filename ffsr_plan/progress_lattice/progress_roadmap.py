"""`ProgressRoadmap`: a lattice with progress, its nodes and edges evaluated on demand."""

from __future__ import annotations

import numpy as np

from ffsr_plan.collision.contacts import goal_in_collision, start_in_collision
from ffsr_plan.collision.distances import SelfQuery
from ffsr_plan.core.arrays import Array, Flags, IntArray, States
from ffsr_plan.lattice.certificate import Counts
from ffsr_plan.lattice.edge_states import FREE, REFUSED, UNKNOWN
from ffsr_plan.problem.objective import nearness
from ffsr_plan.problem.problem import Problem
from ffsr_plan.progress_lattice.progress_bodies import ProgressBodies
from ffsr_plan.progress_lattice.progress_steps import ProgressSteps
from ffsr_plan.progress_lattice.side_steps import SideSteps
from ffsr_plan.progress_lattice.ways import Way
from ffsr_plan.proof.interval_halving import Verdict
from ffsr_plan.proof.prover import Prover
from ffsr_plan.time_limit.deadline import Deadline

_WINDOW = 3  # layers and places on either side of a node whose clearances it bounds


class ProgressRoadmap:
    """Nodes (layer, place, offset) and edges of a lattice with progress.

    Attributes:
        problem: what it was built from.
        steps: the steps of progress.
        offsets: (n, 3) of the base from the way [m].
        origin: number of the node without offset.
        heads: (n, W) offset that each step aside from each offset leads to; -1 for none.
        edges: (A, D) edge of each step from each place; -1 where there is none, or links touch.
        edge_costs: (E, W) contribution of edges to F [length units].
        node_costs: (m + 1, A, n) contribution of nodes to F, or a lower bound; infinite where a
            node is blocked [length units].
        at_rest: (E, n, W) states of edges as far as obstacles at rest count.
        moving: (m, E, n, W) the same for bodies that move; (0, ...) without any.
    """

    def __init__(
        self,
        problem: Problem,
        way: Way,
        sides: SideSteps,
        layers: int,
        deadline: Deadline,
        counted: int = 1,
        fastest: float = np.inf,
    ) -> None:
        """Set up the lattice and evaluate its nodes as far as obstacles at rest count.

        Args:
            problem: gives robot, obstacles, objective and pace.
            way: the places of progress.
            sides: the offsets.
            layers: m, number of steps in time.
            deadline: after which measurements raise `OutOfTime`.
            counted: clearances at each so many layers count in F.
            fastest: way of the base over an edge, at most [m].

        Raises:
            StartInCollision, GoalInCollision: with link, obstacle and depth.
        """
        self.problem = problem
        scene, m = problem.obstacles, layers
        self.steps = ProgressSteps(way)
        self._sides, self._counted = sides, np.arange(m + 1) % counted == 0
        self.offsets, self.origin, self.heads = sides.offsets, sides.origin, sides.heads
        self._prover = Prover(self.steps.motion, scene.at_rest, problem.tolerance, deadline)
        self.edges = self._edges_without_self_collision()
        self.edge_costs = self._lengths(fastest) / problem.length_unit
        count, n = len(self.steps.values), len(self.offsets)
        places, nodes = np.divmod(np.arange(count * n), n)
        found = self._prover.clearances(self.steps.corners[places], self.offsets[nodes])
        self._still: Array = np.where(way.holds(self.offsets), found.reshape(count, n), 0.0)
        shape = len(self.steps.lengths), n, self.heads.shape[1]
        self.at_rest: States = np.zeros(shape, dtype=np.int8)
        self._bodies: ProgressBodies | None = None
        pace = problem.pace(m)
        if scene.moves and pace is not None:
            self._bodies = ProgressBodies(self.steps, scene, pace, self.offsets, deadline)
        moving = m if self._bodies else 0
        self.moving: States = np.zeros((moving, *shape), dtype=np.int8)
        self._check_ends(m)
        self._bounds: Array = np.tile(self._still, (m + 1, 1, 1))
        self._known: Flags = np.full(self._bounds.shape, self._bodies is None)
        self.node_costs = np.empty(self._bounds.shape)
        self._node_queries = self._prover.queries
        self._price(0, m + 1)

    def learn(self, path: IntArray) -> int | None:
        """Evaluate the nodes of a path.

        Args:
            path: (m + 1, 3) place, offset and step aside on each layer.

        Returns:
            The first layer whose outgoing edges have to be searched again; None if all nodes cost
            what was assumed.
        """
        from ffsr_plan.progress_lattice.progress_kernels import take_in

        every, (places, offsets, _) = np.arange(len(path)), path.T
        layers = every[~self._known[every, places, offsets]]
        if not len(layers) or self._bodies is None:
            return None
        before = self.node_costs[layers, places[layers], offsets[layers]]
        still = self._still[places[layers], offsets[layers]]
        exact = self._bodies.least(layers, places[layers], offsets[layers], still)
        self._node_queries += len(layers)
        nodes = np.column_stack([layers, places[layers], offsets[layers]])
        between, travel = self.steps.between, self._bodies.travel
        bounds, known = self._bounds, self._known
        take_in(nodes, exact, self._sides.distances, between, travel, _WINDOW, bounds, known)
        low = max(int(layers[0]) - _WINDOW, 0)
        self._price(low, min(int(layers[-1]) + _WINDOW + 1, len(path)))
        after = self.node_costs[layers, places[layers], offsets[layers]]
        return max(low - 1, 0) if np.any(after > before) else None

    def prove(self, path: IntArray) -> int | None:
        """Prove the edges of a path.

        Args:
            path: (m + 1, 3) place, offset and step aside on each layer.

        Returns:
            The first layer whose outgoing edges have to be searched again; None if all are free.
        """
        layers, (places, offsets, asides) = np.arange(len(path) - 1), path.T
        ends = np.column_stack([places[:-1], places[1:]])
        nodes = np.column_stack([offsets[:-1], offsets[1:]])
        edges = self.edges[ends[:, 0], ends[:, 1] - ends[:, 0] + self.steps.most]
        if self._prove_at_rest(edges, ends, nodes, asides[:-1]):
            return 0
        if self._bodies is None:
            return None
        states = self.moving[layers, edges, nodes[:, 0], asides[:-1]]
        left = np.flatnonzero(states == UNKNOWN)
        found = self._bodies.certify(left, ends[left], nodes[left], self.problem.tolerance)
        refused = []
        for k, verdict in zip(left.tolist(), found, strict=True):
            self._note(self.moving[k, edges[k]], nodes[k], int(asides[k]), verdict)
            refused += [k] * (not verdict.free)
        return min(refused, default=None)

    def is_proven(self, path: IntArray) -> bool:
        """Whether every edge of a path (m + 1, 3) is known to be free."""
        layers, (places, offsets, asides) = np.arange(len(path) - 1), path.T
        edges = self.edges[places[:-1], np.diff(places) + self.steps.most]
        free = self.at_rest[edges, offsets[:-1], asides[:-1]] == FREE
        if self._bodies is not None:
            free &= self.moving[layers, edges, offsets[:-1], asides[:-1]] == FREE
        return bool(np.all(free))

    def counts(self) -> Counts:
        """Edges decided and queries spent so far."""
        status = self.moving if self._bodies else self.at_rest
        queries = self._prover.queries + (self._bodies.queries if self._bodies else 0)
        return Counts(
            edges_free=int(np.count_nonzero(status == FREE)),
            edges_refused=int(np.count_nonzero(status == REFUSED)),
            node_queries=self._node_queries,
            edge_queries=max(queries - self._node_queries, 0),
        )

    def _prove_at_rest(
        self, edges: IntArray, ends: IntArray, nodes: IntArray, asides: IntArray
    ) -> bool:
        """Whether an obstacle at rest bars one of the edges, which are proven as needed."""
        states = self.at_rest[edges, nodes[:, 0], asides]
        _, first = np.unique(
            np.column_stack([edges, nodes[:, 0], asides]), axis=0, return_index=True
        )
        left = first[states[first] == UNKNOWN]
        if not len(left):
            return False
        still = np.column_stack([self._still[ends[left, k], nodes[left, k]] for k in (0, 1)])
        tails, heads = self.offsets[nodes[left, 0]], self.offsets[nodes[left, 1]]
        verdicts = self._prover.certify_all(edges[left], tails, heads, still)
        for k, verdict in zip(left.tolist(), verdicts, strict=True):
            self._note(self.at_rest[edges[k]], nodes[k], int(asides[k]), verdict)
        return not all(verdict.free for verdict in verdicts)

    def _note(self, status: States, nodes: IntArray, aside: int, verdict: Verdict) -> None:
        """Keep a verdict on an edge of one step; a refusal may refuse others with it."""
        tail, head = nodes
        status[tail, aside] = FREE if verdict.free else REFUSED
        depth, time = -verdict.least_clearance * (1.0 - 1e-9), verdict.time
        if not verdict.free and depth > 0.0:
            from ffsr_plan.progress_lattice.progress_kernels import refuse_near

            met = (1.0 - time) * self.offsets[tail] + time * self.offsets[head]
            refuse_near(status, self.heads, np.array(self.offsets), time, met, depth)

    def _price(self, first: int, end: int) -> None:
        """Work out the costs of the nodes of some layers."""
        bounds = self._bounds[first:end]
        costs = np.where(bounds > 0.0, nearness(self.problem, bounds), np.inf)
        costs[(bounds > 0.0) & ~self._counted[first:end, None, None]] = 0.0
        self.node_costs[first:end] = costs
        for layer, place in ((0, self.steps.start), (len(self._bounds) - 1, self.steps.goal)):
            self.node_costs[layer] = np.inf  # no other node begins or ends a path
            self.node_costs[layer, place, self.origin] = 0.0

    def _lengths(self, fastest: float) -> Array:
        """(E, W) length of each edge with each step aside [m]; infinite where it is too fast."""
        along, aside = self.steps.motion.base_steps(), self._sides.ways
        added = np.sum(aside**2, axis=1) + 2.0 * along @ aside.T
        squares = self.steps.lengths[:, None] ** 2 + added * self.problem.position_weight**2
        moved = np.linalg.norm(along[:, None] + aside, axis=2)
        lengths = np.sqrt(np.maximum(squares, 0.0))
        return np.where(moved <= fastest * (1.0 + 1e-9), lengths, np.inf)

    def _edges_without_self_collision(self) -> IntArray:
        """(A, D) the steps on which no links touch one another; -1 for others."""
        free = np.array([verdict.free for verdict in self._prover.links.verdicts()])
        edges = self.steps.edges
        return np.where((edges >= 0) & free[edges], edges, -1)

    def _check_ends(self, last: int) -> None:
        """Raise if start or goal, on the layers 0 and `last`, touches something at its time."""
        problem, steps = self.problem, self.steps
        robot, scene = problem.robot, problem.obstacles
        layers, places = np.array([0, last]), np.array([steps.start, steps.goal])
        origins = np.full(2, self.origin)
        clear = self._still[places, origins]
        if self._bodies is not None:
            clear = self._bodies.least(layers, places, origins, clear)
        ends = steps.motion.configurations()[steps.corners[places]]
        for k, (q, time) in enumerate(zip(ends, (0.0, problem.duration or 0.0), strict=True)):
            if clear[k] > 0.0 and SelfQuery(robot).nearest(q).distance > 0.0:
                continue
            there = scene.at(time)
            if k:
                raise goal_in_collision(robot, there, q)
            raise start_in_collision(robot, there, q)
