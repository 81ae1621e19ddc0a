"""`MaxMinAntSystem`: the colony that reaches the lattice optimum."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ffsr_plan import paper
from ffsr_plan.colony import max_min_cycle as kernel
from ffsr_plan.colony.local_search import neighbourhood
from ffsr_plan.colony.records import Cycle, History, OnCycle, Search, Trails
from ffsr_plan.colony.ways import close_refused, open_ways
from ffsr_plan.errors import PlanningError
from ffsr_plan.inputs import Array, frozen, number, whole_number
from ffsr_plan.roadmap import Roadmap

_LARGE = 100  # nodes a layer from which on pheromone lies on nodes, not on edges


@dataclass(frozen=True)
class MaxMinAntSystem:
    """A max-min ant system (Stuetzle and Hoos 2000) with local search: the default planner.

    What differs from the paper's colony: ants see what a node costs, not only how far it is
    (visibility 1 / (d_pq + delta / d_imin)); only one path a cycle lays pheromone, which stays
    between bounds; the best ants of a cycle are improved by local search; the colony starts anew
    when it no longer gets better. Paths are certified before they count; an edge that is refused is
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

    ants: int = paper.ANTS
    cycles: int = paper.CYCLES
    beta: float | None = None
    rho: float = 0.7
    improved: int = 3
    patience: int = 20
    cost_aware: bool = True
    pheromone: bool = True

    def __post_init__(self) -> None:
        checked = {
            "ants": whole_number("ants", self.ants, at_least=1),
            "cycles": whole_number("cycles", self.cycles, at_least=1),
            "beta": None if self.beta is None else number("beta", self.beta, at_least=0.0),
            "rho": number("rho", self.rho, above=0.0, below=1.0),
            "improved": whole_number("improved", self.improved, at_least=0),
            "patience": whole_number("patience", self.patience, at_least=0),
        }
        for field, value in checked.items():
            object.__setattr__(self, field, value)

    def search(
        self, roadmap: Roadmap, rng: np.random.Generator, on_cycle: OnCycle | None = None
    ) -> Search:
        """Run the colony.

        Raises:
            NoPath: proven, when every way on from the start has been refused.
        """
        m, n = roadmap.lattice.divisions, roadmap.lattice.size
        roadmap.prove_obvious()
        ways, exits = open_ways(roadmap.admissible, roadmap.status)
        edge_costs, node_costs = roadmap.edge_costs(), roadmap.node_costs()
        chance = 0.05 ** (1.0 / m)
        settings = np.array(
            [
                self.rho,
                (1.0 - chance) / (12.0 * chance),
                self.improved,
                self.patience or np.inf,
                self.pheromone,
            ]
        )
        rows = 1 if n >= _LARGE else n
        tau, touched = np.ones((m, rows, n)), np.zeros((m, rows), dtype=bool)
        paths = np.full((self.ants, m + 1), roadmap.lattice.origin, dtype=np.int64)
        candidate, best_path, restart_path = (np.zeros(m + 1, dtype=np.int64) for _ in range(3))
        best, clock = np.array([np.inf]), np.zeros(3, dtype=np.int64)
        values = np.array([np.inf, np.inf, 1.0])
        records = np.zeros((self.cycles, 4))
        walked, laid = np.zeros((m, n, n), dtype=np.int64), np.zeros((m, n, n))
        fresh = np.full((m, n), -1, dtype=np.int64)
        visibility = self._visibility(edge_costs, node_costs) * ways
        untouched = np.cumsum(visibility, axis=2)
        state = (
            tau, visibility, edge_costs, node_costs, ways, roadmap.status,
            neighbourhood(roadmap.lattice.indices), settings, untouched, np.empty((m, n, n)),
            fresh, touched, paths, np.empty(self.ants), np.full(64, np.inf), candidate,
            best_path, restart_path, best, clock, values, records, walked, laid,
        )  # fmt: skip
        changed = np.zeros((m, n), dtype=bool)
        until = 1 if on_cycle is not None else self.cycles
        while until <= self.cycles:
            if exits[0, roadmap.lattice.origin] == 0:
                raise roadmap.no_path() or PlanningError("the ants are lost")
            if kernel.run_cycles(rng, until, *state) == kernel.PROVE:
                if not roadmap.prove_path(candidate):
                    for layer in range(m):
                        close_refused(layer, roadmap.status, ways, exits, changed)
                    visibility[changed] *= ways[changed]
                    untouched[changed] = np.cumsum(visibility[changed], axis=1)
                    fresh[changed], changed[:] = -1, False
                continue
            if on_cycle is not None:
                done = records[until - 1]
                counts = np.zeros((m + 1, n), dtype=np.int64)
                np.add.at(counts, (np.arange(m + 1), paths), 1)
                figures = (float(done[0]), float(done[1]), float(done[2]), int(done[3]))
                on_cycle(Cycle(until, self.cycles, *figures, best_path.copy(), counts, tau))
            until += 1
        if not np.isfinite(best[0]):
            raise roadmap.no_path() or PlanningError(
                f"none of {self.ants} ants found a free path in {self.cycles} cycles, "
                "though one exists; more cycles, or local search, may find it"
            )
        history = History(*(frozen(records[:, c].copy()) for c in range(3)),
                          frozen(records[:, 3].astype(np.int64)))  # fmt: skip
        used = np.nonzero(walked)
        level = tau[used] if rows > 1 else tau[used[0], 0, used[2]]
        trails = Trails(*used, walked[used], laid[used], level)
        return Search(frozen(best_path), history, trails)

    def _visibility(self, edge_costs: Array, node_costs: Array) -> Array:
        """(m, n, n) eta^beta, eta = 1 / (d_pq + delta / d_imin)."""
        n = len(edge_costs)
        beta = (2.0 if n < _LARGE else 5.0) if self.beta is None else self.beta
        seen = np.where(np.isfinite(node_costs[1:]), node_costs[1:], 0.0) * float(self.cost_aware)
        cost = np.maximum(edge_costs[None] + seen[:, None, :], 1e-12)
        cost /= cost.min()
        return np.asarray(1.0 / cost**2 if beta == 2.0 else cost**-beta)
