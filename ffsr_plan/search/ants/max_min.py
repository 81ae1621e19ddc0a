"""`MaxMinAntSystem`: the colony that reaches the lattice optimum."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray, frozen
from ffsr_plan.core.errors import InternalError, OutOfTime, PlanningError
from ffsr_plan.core.setting_rules import Number, Truth, WholeNumber
from ffsr_plan.core.settings import settings
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.search.lattice_planner import LatticePlanner
from ffsr_plan.search.records import Cycle, History, SearchMonitor, SearchResult, Trails
from ffsr_plan.time_limit.deadline import Deadline

if TYPE_CHECKING:  # numba takes its time: the kernels are imported when a colony runs
    from ffsr_plan.search.ants.max_min_kernels import State

_LARGE_LAYER = 100  # nodes; from this size on pheromone lies on nodes, not on edges
_EDGES_AT_ONCE = 300_000  # whose visibility is worked out between two looks at the deadline
_MOST_TRAILS = 10_000  # edges whose trails are kept for pictures
_MOST_CYCLES_PER_CHECK, _SECONDS_PER_CHECK = 64, 0.002  # between two looks at the deadline


@settings
class MaxMinAntSystem(LatticePlanner):
    """A max-min ant system (Stuetzle and Hoos 2000) with local search: the default planner.

    What differs from the paper's colony: ants see what a node costs, not only how far it is
    (visibility 1 / (d_pq + delta / d_imin)); only one path a cycle lays pheromone, which stays
    between bounds; some ants of a cycle are improved by local search; the colony restarts when
    it no longer improves. Paths are certified before they count; a refused edge is
    closed. On lattices with additive cost the local search does most of the work, as the
    documentation shows.

    Attributes:
        ants: number of ants.
        cycles: number of cycles.
        beta: weight of visibility; by default 2, and 5 from 100 nodes a layer on.
        rho: persistence of pheromone, in (0, 1).
        improved: how many ants of a cycle local search improves; 0 for none.
        patience: cycles without improvement before a restart; 0 for no restarts.
        cost_aware: whether visibility counts delta / d_imin.
        pheromone: whether ants lay and follow pheromone at all.
    """

    name: ClassVar[str] = "max-min-ant-system"
    bytes_per_edge: ClassVar[float] = 50.0  # those of the Ant System and visibility

    ants: Annotated[int, WholeNumber(at_least=1, at_most=100_000)] = 30
    cycles: Annotated[int, WholeNumber(at_least=1, at_most=1_000_000)] = 242
    beta: Annotated[float, Number(at_least=0.0, at_most=40.0)] | None = None
    rho: Annotated[float, Number(above=0.0, below=1.0)] = 0.7
    improved: Annotated[int, WholeNumber(at_most=100_000)] = 1
    patience: Annotated[int, WholeNumber(at_most=1_000_000)] = 20
    cost_aware: Annotated[bool, Truth()] = True
    pheromone: Annotated[bool, Truth()] = True

    def search(
        self, roadmap: Roadmap, rng: np.random.Generator, monitor: SearchMonitor | None = None
    ) -> SearchResult:
        """Run the colony.

        Raises:
            NoPath: proven, when every edge that leaves the start has been refused.
            OutOfTime: no path was proven by the deadline.
            PlanningError: no ant found a path, which does not prove that there is none.
        """
        from ffsr_plan.search.ants.max_min_kernels import BEST, CYCLE, DONE, run_cycles

        monitor = monitor or SearchMonitor()
        state, open_counts = self._prepared(roadmap)
        until, stride, interrupted = 0, 1, False
        try:
            while until < self.cycles:
                begin, until = time.monotonic(), min(until + stride, self.cycles)
                while run_cycles(rng, until, state) != DONE:
                    if not roadmap.prove_path(state.candidate):
                        _close_refused(roadmap, state, open_counts)
                    monitor.check()
                if monitor.on_cycle is not None:
                    monitor.on_cycle(_report(state, self.cycles))
                elif time.monotonic() - begin < _SECONDS_PER_CHECK:
                    stride = min(2 * stride, _MOST_CYCLES_PER_CHECK)
                elif time.monotonic() - begin > 2.0 * _SECONDS_PER_CHECK:
                    stride = max(stride // 2, 1)
                if until < self.cycles:
                    monitor.check()
        except OutOfTime:
            interrupted = True
            if not _found(roadmap, rng, state):
                raise
        if not np.isfinite(state.values[BEST]):
            raise roadmap.no_path() or PlanningError(
                f"none of {self.ants} ants found a free path in {state.counters[CYCLE]} "
                "cycles, which does not prove that there is none: more cycles may find one"
            )
        history = History.of_rows(state.records[: state.counters[CYCLE]])
        return SearchResult(frozen(state.best_path), history, _trails(state), interrupted)

    def _prepared(self, roadmap: Roadmap) -> tuple[State, IntArray]:
        """The state before the first cycle, and how many open edges leave each node."""
        from ffsr_plan.search.ants.open_edges import find_open_edges

        roadmap.prove_obvious()
        open_edges, open_counts = find_open_edges(
            roadmap.admissible, roadmap.status, roadmap.deadline
        )
        if open_counts[0, roadmap.lattice.origin] == 0:
            raise roadmap.no_path() or InternalError(
                "no open edge at the start, but the roadmap has a path"
            )
        return self._state(roadmap, open_edges), open_counts

    def _state(self, roadmap: Roadmap, open_edges: Flags) -> State:
        from ffsr_plan.search.ants.local_search_kernels import neighbourhood
        from ffsr_plan.search.ants.max_min_kernels import State

        m, n = roadmap.lattice.divisions, roadmap.lattice.size
        edge_costs, node_costs = roadmap.edge_costs(), roadmap.node_costs()
        visibility = self._visibility(edge_costs, node_costs, open_edges, roadmap.deadline)
        chance = 0.05 ** (1.0 / m)
        least = (1.0 - chance) / (12.0 * chance)
        patience = self.patience or np.inf
        rows = 1 if n >= _LARGE_LAYER else n
        indices = roadmap.lattice.indices
        nowhere = np.zeros(m + 1, dtype=np.int64)
        return State(
            edge_costs=edge_costs,
            node_costs=node_costs,
            open_edges=open_edges,
            status=roadmap.status,
            visibility=visibility,
            near=neighbourhood(indices, wide=False),
            wide=neighbourhood(indices, wide=True),
            rho=self.rho,
            least_pheromone=least,
            improved=self.improved,
            patience=float(patience),
            use_pheromone=self.pheromone,
            tau=np.empty((m, rows, n)),
            touched=np.zeros((m, rows), dtype=bool),
            sums=_sums(visibility, roadmap.deadline),
            sum_cycles=np.full((m, n), -1, dtype=np.int64),
            paths=np.full((self.ants, m + 1), roadmap.lattice.origin, dtype=np.int64),
            costs=np.empty(self.ants),
            searched=np.full(max(64, self.improved), np.inf),
            searched_wide=np.full(64, np.inf),
            candidate=nowhere.copy(),
            best_path=nowhere.copy(),
            restart_path=nowhere.copy(),
            counters=np.zeros(3, dtype=np.int64),
            values=np.array([np.inf, np.inf, np.inf, 1.0]),
            records=np.zeros((self.cycles, 4)),
            walked=np.zeros((m, n, n), dtype=np.int64),
            left=np.zeros((m, n), dtype=bool),
            laid=np.zeros((m, n, n)),
        )

    def _visibility(
        self, edge_costs: Array, node_costs: Array, open_edges: Flags, deadline: Deadline
    ) -> Array:
        """(m, n, n) eta^beta, eta = 1 / (d_pq + delta / d_imin), zero on closed edges."""
        n = len(edge_costs)
        beta = (2.0 if n < _LARGE_LAYER else 5.0) if self.beta is None else self.beta
        seen = np.where(np.isfinite(node_costs[1:]), node_costs[1:], 0.0) * float(self.cost_aware)
        least = np.min(np.maximum(edge_costs.min(axis=0) + seen, 1e-12))  # of all edges' costs
        result = np.empty((len(seen), n, n))
        for layers in _blocks(len(seen), n):
            deadline.check()
            cost = np.add(edge_costs, seen[layers, None], out=result[layers])
            np.maximum(cost, 1e-12, out=cost)
            cost /= least
            if beta == 2.0:
                np.divide(1.0, np.square(cost, out=cost), out=cost)
            else:
                np.power(cost, -beta, out=cost)
            cost *= open_edges[layers]
        return result


def _found(roadmap: Roadmap, rng: np.random.Generator, state: State) -> bool:
    """Whether a path has been proven; the last one, if its cycle is not done, is taken over."""
    from ffsr_plan.search.ants.max_min_kernels import BEST, CYCLE, STAGE, run_cycles

    if state.counters[STAGE] and roadmap.is_proven(state.candidate):
        run_cycles(rng, int(state.counters[CYCLE]) + 1, state)
    return bool(np.isfinite(state.values[BEST]))


def _sums(visibility: Array, deadline: Deadline) -> Array:
    """(2, m, n, n) sums of visibility along the last axis, and room for those with pheromone."""
    result = np.empty((2, *visibility.shape))
    for layers in _blocks(*visibility.shape[:2]):
        deadline.check()
        np.cumsum(visibility[layers], axis=2, out=result[0, layers])
    return result


def _blocks(m: int, n: int) -> list[slice]:
    """The m layers of n^2 edges in blocks that take some milliseconds."""
    layers = max(1, _EDGES_AT_ONCE // n**2)
    return [slice(first, first + layers) for first in range(0, m, layers)]


def _close_refused(roadmap: Roadmap, state: State, open_counts: IntArray) -> None:
    """Close the refused edges of the candidate path.

    Raises:
        NoPath: no open edge leaves the start any more.
    """
    from ffsr_plan.search.ants.open_edges import close_refused

    changed = np.zeros(open_counts.shape, dtype=bool)
    for layer in roadmap.refused_layers(state.candidate):
        close_refused(layer, roadmap.status, state.open_edges, open_counts, changed)
    if open_counts[0, roadmap.lattice.origin] == 0:
        raise roadmap.no_path() or InternalError(
            "no open edge at the start, but the roadmap has a path"
        )
    state.visibility[changed] *= state.open_edges[changed]
    state.sums[0, changed] = np.cumsum(state.visibility[changed], axis=1)
    state.sum_cycles[changed] = -1


def _report(state: State, cycles: int) -> Cycle:
    from ffsr_plan.search.ants.max_min_kernels import CYCLE, write_untouched_rows

    write_untouched_rows(state)
    number = int(state.counters[CYCLE])
    best, iteration_best, mean, distinct = map(float, state.records[number - 1])
    counts = np.zeros(state.node_costs.shape, dtype=np.int64)
    np.add.at(counts, (np.arange(len(counts)), state.paths), 1)
    path = state.best_path.copy()
    return Cycle(number, cycles, best, iteration_best, mean, int(distinct), path, counts, state.tau)


def _trails(state: State) -> Trails:
    """The most walked edges, in the order of layers and nodes."""
    from ffsr_plan.search.ants.max_min_kernels import LEVEL

    rows = np.flatnonzero(state.left)  # other rows have not even been given memory
    n = state.walked.shape[2]
    found, heads = np.nonzero(state.walked.reshape(-1, n)[rows] > 0)
    used = rows[found] * n + heads
    if len(used) > _MOST_TRAILS:
        used = used[_largest(state.walked.ravel()[used], _MOST_TRAILS)]
    edges = np.unravel_index(used, state.walked.shape)
    layer, tail, head = edges
    row = tail if state.tau.shape[1] > 1 else np.zeros_like(tail)
    level, touched = np.full(len(used), state.values[LEVEL]), state.touched[layer, row]
    level[touched] = state.tau[layer[touched], row[touched], head[touched]]
    return Trails(layer, tail, head, state.walked[edges], state.laid[edges], level)


def _largest(numbers: IntArray, count: int) -> IntArray:
    """Where the `count` largest of more numbers are, the first among equals; in their order."""
    least = np.partition(numbers, len(numbers) - count)[len(numbers) - count]
    chosen, equal = numbers > least, np.flatnonzero(numbers == least)
    chosen[equal[: count - np.count_nonzero(chosen)]] = True
    return np.flatnonzero(chosen)
