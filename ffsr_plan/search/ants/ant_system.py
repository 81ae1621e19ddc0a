"""`AntSystem`: the paper's ant colony, Steps 1 to 5 with Eqs. 10 to 13."""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray, frozen
from ffsr_plan.core.errors import InternalError, OutOfTime
from ffsr_plan.core.setting_rules import Number, WholeNumber
from ffsr_plan.core.settings import settings
from ffsr_plan.lattice.edge_states import REFUSED, UNKNOWN
from ffsr_plan.lattice.roadmap import Roadmap
from ffsr_plan.search.lattice_planner import LatticePlanner
from ffsr_plan.search.records import Cycle, History, SearchMonitor, SearchResult, Trails
from ffsr_plan.time_limit.deadline import Deadline

_LEAST_PHEROMONE = 1e-300  # pheromone never underflows to zero, so that log(tau) exists


@settings
class AntSystem(LatticePlanner):
    """The paper's planner.

    An ant on node p chooses node q of the next layer with probability proportional to
    tau_pq^alpha (1/d_pq)^beta over the allowed nodes (Eq. 11). After each cycle
    tau <- rho tau + sum_k Q / F_k on the edges that ant k used (Eqs. 12 and 13): rho is the share
    that *persists*. The colony stops when all ants take one path, or after `cycles` cycles; the
    best path met is the result.

    Attributes:
        ants: M_h, number of ants.
        cycles: N_max, most cycles.
        alpha: weight of pheromone.
        beta: weight of visibility.
        rho: persistence of pheromone, in (0, 1).
        Q: pheromone that an ant lays on its path, in units of F.
        C: initial pheromone tau(0). The paper does not give it; this default is ours.
    """

    name: ClassVar[str] = "ant-system"
    bytes_per_edge: ClassVar[float] = 40.0  # pheromone, roulettes, ants and what they lay

    ants: Annotated[int, WholeNumber(at_least=1, at_most=100_000)] = 30
    cycles: Annotated[int, WholeNumber(at_least=1, at_most=1_000_000)] = 242
    alpha: Annotated[float, Number(at_least=0.0, at_most=40.0)] = 1.0
    beta: Annotated[float, Number(at_least=0.0, at_most=40.0)] = 5.0
    rho: Annotated[float, Number(above=0.0, below=1.0)] = 0.526
    Q: Annotated[float, Number(at_least=1e-9, at_most=1e9)] = 320.0
    C: Annotated[float, Number(at_least=1e-9, at_most=1e9)] = 10.0

    def search(
        self, roadmap: Roadmap, rng: np.random.Generator, monitor: SearchMonitor | None = None
    ) -> SearchResult:
        """Run the colony.

        Raises:
            NoPath: proven, when every edge that leaves the start has been refused.
            OutOfTime: no ant had a path by the deadline.
        """
        monitor = monitor or SearchMonitor()
        m, n = roadmap.lattice.divisions, roadmap.lattice.size
        roadmap.prove_obvious()
        walk = Walk(self, roadmap, rng)
        tau = np.full((m, n, n), self.C)
        walked, laid = np.zeros((m, n, n), dtype=np.int64), np.zeros((m, n, n))
        edge_costs, node_costs = roadmap.edge_costs(), roadmap.node_costs()
        records: list[tuple[float, float, float, int]] = []
        best, best_path = np.inf, np.zeros(m + 1, dtype=np.int64)
        interrupted = False
        for cycle in range(1, self.cycles + 1):
            try:
                paths = walk.tours(tau, monitor.deadline)
            except OutOfTime:
                interrupted, paths = True, walk.finished
                if not len(paths) and not records:
                    raise
                if not len(paths):
                    break
            along = np.broadcast_to(np.arange(m + 1), paths.shape)
            costs = edge_costs[paths[:, :-1], paths[:, 1:]].sum(axis=1)
            costs += node_costs[along, paths].sum(axis=1)
            leader = int(np.argmin(costs))
            if costs[leader] < best:
                best, best_path = float(costs[leader]), paths[leader].copy()
            edges = (along[:, :-1], paths[:, :-1], paths[:, 1:])
            deposit = np.broadcast_to((self.Q / costs)[:, None], (len(paths), m))
            tau *= self.rho
            np.add.at(tau, edges, deposit)
            np.maximum(tau, _LEAST_PHEROMONE, out=tau)
            np.add.at(laid, edges, deposit)
            np.add.at(walked, edges, 1)
            distinct = len(np.unique(paths, axis=0))
            records.append((best, float(costs[leader]), float(np.mean(costs)), distinct))
            if monitor.on_cycle is not None and not interrupted:
                counts = np.zeros((m + 1, n), dtype=np.int64)
                np.add.at(counts, (along, paths), 1)
                monitor.on_cycle(Cycle(cycle, self.cycles, *records[-1], best_path, counts, tau))
            interrupted |= monitor.expired() and distinct > 1 and cycle < self.cycles
            if distinct == 1 or interrupted:
                break
        trails = _trails(walked, laid, tau)
        return SearchResult(
            frozen(best_path), History.of_rows(np.array(records)), trails, interrupted
        )


class Walk:
    """Ants walking from start to goal by Eq. 11.

    Edges are certified when an ant first chooses them. One that is refused is closed and the ant
    draws again, which gives exactly the roulette wheel over the allowed edges. Nodes from
    which the goal is known to be unreachable are not allowed.
    """

    def __init__(self, settings: AntSystem, roadmap: Roadmap, rng: np.random.Generator) -> None:
        from ffsr_plan.search.ants.open_edges import find_open_edges

        m, n = roadmap.lattice.divisions, roadmap.lattice.size
        self._roadmap, self._rng, self._alpha = roadmap, rng, settings.alpha
        steps = np.maximum(roadmap.lattice.steps, 1e-12)  # a step of no length at all stays visible
        self._log_visibility = -settings.beta * np.log(steps)
        self._open_edges, self._open_counts = find_open_edges(
            roadmap.admissible, roadmap.status, roadmap.deadline
        )
        self._roulettes = np.empty((m, n, n))
        self._changed = np.ones((m, n), dtype=bool)
        self._paths = np.full((settings.ants, m + 1), roadmap.lattice.origin, dtype=np.int64)
        self._done = 0

    @property
    def finished(self) -> IntArray:
        """(k, m + 1) the paths of the k ants that have got to the goal in the present cycle."""
        return self._paths[: self._done]

    def tours(self, tau: Array, deadline: Deadline | None = None) -> IntArray:
        """(ants, m + 1) free paths drawn by Eq. 11; valid until the next call.

        Args:
            tau: (m, n, n) pheromone.
            deadline: looked at after each proof.

        Raises:
            NoPath: the start has become a dead end.
            OutOfTime: at the deadline; `finished` has the paths so far.
        """
        from ffsr_plan.search.ants.ant_system_kernels import walk
        from ffsr_plan.search.ants.open_edges import close_refused

        roadmap, paths = self._roadmap, self._paths
        self._changed[:] = True
        ant, layer, self._done = 0, -1, 0
        while True:
            ant, layer = walk(
                self._rng,
                tau,
                self._alpha,
                self._log_visibility,
                self._open_edges,
                self._open_counts,
                roadmap.status,
                self._roulettes,
                self._changed,
                paths,
                ant,
                layer,
            )
            self._done = max(ant, 0)
            if ant == len(paths):
                return paths
            if ant < 0:
                raise roadmap.no_path() or InternalError(
                    "no open edge at the start, but the roadmap has a path"
                )
            edge = layer, int(paths[ant, layer]), int(paths[ant, layer + 1])
            if roadmap.status[edge] == UNKNOWN:
                roadmap.certify(*edge)
            if roadmap.status[edge] == REFUSED:
                close_refused(
                    layer, roadmap.status, self._open_edges, self._open_counts, self._changed
                )
            if deadline is not None:
                deadline.check()


def _trails(walked: IntArray, laid: Array, tau: Array) -> Trails:
    used = np.nonzero(walked)
    layer, tail, head = used
    return Trails(layer, tail, head, walked[used], laid[used], tau[used])
