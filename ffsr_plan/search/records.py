"""Records of a search: its request, each cycle, and its result."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray, equal_by_content, frozen
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.lattice.certificate import Certificate
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.search.fuel_figures import FuelFigures
from ffsr_plan.time_limit.deadline import Deadline


@equal_by_content
class Cycle(NamedTuple):
    """The state of a colony after one cycle, as callbacks receive it.

    Attributes:
        number: cycles done, from 1.
        cycles: cycles allowed.
        best: least F so far.
        iteration_best: least F among the ants of the cycle.
        mean: mean F of the ants of the cycle.
        distinct: number of different paths among the ants; 1 is stagnation.
        path: (m + 1,) nodes of the best path so far; with posture axes, the index of the base
            offset times the number of postures plus the index of the posture.
        counts: (m + 1, n) ants on each node in this cycle (b_j of Eq. 10).
        pheromone: (m, n, n) tau of each edge, with posture axes of each change of the base offset,
            or (m, 1, n) where pheromone lies on the nodes that edges lead to; a view that the
            colony changes in later cycles.
    """

    number: int
    cycles: int
    best: float
    iteration_best: float
    mean: float
    distinct: int
    path: IntArray
    counts: IntArray
    pheromone: Array


@equal_by_content
class TreeCycle(NamedTuple):
    """The state of a search by trees after one round, as callbacks receive it.

    Attributes:
        number: rounds done, from 1.
        cycles: rounds that are expected; the last one may come earlier or later.
        best: F of the best path that is proven free; infinite where there is none yet.
        iteration_best: F of the best path of the round, not proven; infinite without one.
        checks: configurations checked so far.
        nodes: of all trees so far.
        path: (m + 1, 3) base origin at the corners of the best path [m]; (0, 3) without one.
        arrival: (nq,) configuration at its end [m, quaternion xyzw, rad or m]; (0,) without one.
        branches: of the trees of the last search; none where the robot floats.
    """

    number: int
    cycles: int
    best: float
    iteration_best: float
    checks: int
    nodes: int
    path: Array
    arrival: Array
    branches: Branches


OnCycle = Callable[[Any], object]
"""Called with a `Cycle` by a colony, with a `TreeCycle` by a search by trees."""


class SearchMonitor(NamedTuple):
    """Callback and stopping condition of a search.

    Attributes:
        on_cycle: called after each cycle, or None.
        deadline: when to stop; None for never.
        reserve: time that is needed after the search [s].
        on_path: called with the best path every now and then, for proofs ahead of the end.
    """

    on_cycle: OnCycle | None = None
    deadline: Deadline | None = None
    reserve: Callable[[], float] = float
    on_path: Callable[[IntArray], object] = len

    def expired(self) -> bool:
        """Whether the search has to end now."""
        deadline = self.deadline
        if deadline is None:
            return False
        return deadline.stopped() or deadline.remaining() <= self.reserve()

    def check(self) -> None:
        """Raise `OutOfTime` if the search has to end now."""
        if self.deadline is not None:
            self.deadline.check()


@equal_by_content
class History(NamedTuple):
    """Progress of a search, one entry a cycle.

    Attributes:
        best: (cycles,) least F so far.
        iteration_best: (cycles,) least F among the ants of the cycle.
        mean: (cycles,) mean F of the ants of the cycle.
        distinct: (cycles,) number of different paths among the ants of the cycle.
    """

    best: Array
    iteration_best: Array
    mean: Array
    distinct: IntArray

    @classmethod
    def of_rows(cls, rows: Array) -> History:
        """The history of rows (cycles, 4): best, iteration best, mean, number of paths."""
        table = np.array(rows, dtype=np.float64).reshape(-1, 4)
        best, iteration_best, mean = (frozen(table[:, k].copy()) for k in range(3))
        return cls(best, iteration_best, mean, frozen(table[:, 3].astype(np.int64)))


@equal_by_content
class Trails(NamedTuple):
    """The edges that ants walked; of very many, those walked most.

    On lattices with posture axes an edge is a change of the base offset alone.

    Attributes:
        layer: (edges,) layer that the edge leaves.
        tail: (edges,) node left, 0 .. n-1 (a row of `LayeredLattice.indices`).
        head: (edges,) node reached on the next layer.
        ants: (edges,) how many ants walked it, all cycles together (Eq. 10 summed over time).
        laid: (edges,) pheromone laid on it, all cycles together, before any evaporated.
        pheromone: (edges,) tau at the end.
    """

    layer: IntArray
    tail: IntArray
    head: IntArray
    ants: IntArray
    laid: Array
    pheromone: Array

    @classmethod
    def none(cls) -> Trails:
        """The trails of a planner without ants."""
        nodes, amounts = np.zeros(0, dtype=np.int64), np.zeros(0)
        return cls(nodes, nodes, nodes, nodes, amounts, amounts)


@equal_by_content
class Branches(NamedTuple):
    """Edges of the trees of a search, for pictures.

    Attributes:
        begin: (edges, 3) base origin at the node that is nearer to the root [m].
        end: (edges, 3) base origin at the other node [m].
        tree: (edges,) 0 for the tree from the start, 1 for the tree from the goals.
    """

    begin: Array
    end: Array
    tree: IntArray

    @classmethod
    def none(cls) -> Branches:
        """No edges."""
        return cls(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0, dtype=np.int64))


@equal_by_content
class SearchResult(NamedTuple):
    """The result of a search over a roadmap.

    Attributes:
        path: (m + 1,) nodes of the best path, all its edges proven free.
        history: progress of the search.
        trails: the edges that ants walked.
        interrupted: whether the time limit or Ctrl-C ended it early.
    """

    path: IntArray
    history: History
    trails: Trails
    interrupted: bool = False


class SearchRequest(NamedTuple):
    """How a planner is to be run.

    Attributes:
        refine: whether to move the path off the lattice in the end; None for where that is
            possible.
        colonies: number of independent colonies.
        workers: number of processes that they are spread over.
        scheduler: of a Dask cluster whose workers they are spread over instead, or a client of it.
        on_cycle: called after each cycle of a single colony, or None.
        deadline: when all has to end, by the time limit or Ctrl-C; None for never.
        begin: called when the search begins, after the lattice has been set up.
        first: whether the first path that is proven free is enough.
        incumbent: a motion that is known to be free, which a search by trees is to improve; None
            for none.
    """

    refine: bool | None = None
    colonies: int = 1
    workers: int = 1
    scheduler: object = None
    on_cycle: OnCycle | None = None
    deadline: Deadline | None = None
    begin: Callable[[], object] = bool
    first: bool = False
    incumbent: Motion | None = None

    def monitor(self) -> SearchMonitor:
        """The monitor of a search that begins now."""
        self.begin()
        return SearchMonitor(self.on_cycle, self.deadline)


@equal_by_content
class Solution(NamedTuple):
    """What a planner returns: a proven motion and its figures of merit.

    Attributes:
        lattice: the lattice that was searched; None without one.
        motion: the motion that was proven free.
        nodes: (m + 1,) offset indices along the path, 0 = no offset; (m + 1, axes) where the
            lattice has several axes; (0,) without a lattice.
        length: L of Eq. 6 [m].
        objective: F of Eq. 8 [length units].
        lattice_objective: F of the path on the lattice, before refinement.
        optimum: F of the exact lattice optimum, or a lower bound on it.
        optimum_is_exact: which of the two it is: a bound with posture axes, and where the search
            for it was cut short.
        clearances: (m + 1,) least link-to-sphere distance at each node [m].
        history: progress of the search.
        trails: the edges that ants walked; without a lattice, those of the trees.
        certificate: what was proven.
        interrupted: whether Ctrl-C or the time limit ended the search early.
        fuel: change of velocity, of a planner that looks for little of it; else None.
    """

    lattice: LayeredLattice | None
    motion: Motion
    nodes: IntArray
    length: float
    objective: float
    lattice_objective: float
    optimum: float
    optimum_is_exact: bool
    clearances: Array
    history: History
    trails: Trails | Branches
    certificate: Certificate
    interrupted: bool
    fuel: FuelFigures | None = None
