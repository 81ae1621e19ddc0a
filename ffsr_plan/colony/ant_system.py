"""`AntSystem`: the paper's ant colony, Steps 1 to 5 with Eqs. 10 to 13."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ffsr_plan import paper
from ffsr_plan.colony.records import Cycle, History, OnCycle, Search, Trails
from ffsr_plan.inputs import Array, IntArray, frozen, number, whole_number
from ffsr_plan.roadmap import Roadmap

_FAINT = 1e-300  # pheromone never underflows to zero, so that log(tau) exists


@dataclass(frozen=True)
class AntSystem:
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

    ants: int = paper.ANTS
    cycles: int = paper.CYCLES
    alpha: float = paper.ALPHA
    beta: float = paper.BETA
    rho: float = paper.RHO
    Q: float = paper.Q
    C: float = 10.0

    def __post_init__(self) -> None:
        checked = {
            "ants": whole_number("ants", self.ants, at_least=1),
            "cycles": whole_number("cycles", self.cycles, at_least=1),
            "alpha": number("alpha", self.alpha, at_least=0.0),
            "beta": number("beta", self.beta, at_least=0.0),
            "rho": number("rho", self.rho, above=0.0, below=1.0),
            "Q": number("Q", self.Q, above=0.0),
            "C": number("C", self.C, above=0.0),
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
        layers = np.arange(m)
        walk = _Walk(self, roadmap, rng)
        tau = np.full((m, n, n), self.C)
        walked, laid = np.zeros((m, n, n), dtype=np.int64), np.zeros((m, n, n))
        records: list[tuple[float, float, float, int]] = []
        best, best_path = np.inf, np.zeros(m + 1, dtype=np.int64)
        for cycle in range(1, self.cycles + 1):
            paths = walk.tours(tau)
            costs = np.array([roadmap.objective(path) for path in paths])
            leader = int(np.argmin(costs))
            if costs[leader] < best:
                best, best_path = float(costs[leader]), paths[leader]
            edges = (np.broadcast_to(layers, (self.ants, m)), paths[:, :-1], paths[:, 1:])
            tau *= self.rho
            deposit = np.broadcast_to((self.Q / costs)[:, None], (self.ants, m))
            np.add.at(tau, edges, deposit)
            np.add.at(laid, edges, deposit)
            np.maximum(tau, _FAINT, out=tau)
            np.add.at(walked, edges, 1)
            distinct = len(np.unique(paths, axis=0))
            records.append((best, float(costs[leader]), float(np.mean(costs)), distinct))
            if on_cycle is not None:
                counts = np.zeros((m + 1, n), dtype=np.int64)
                np.add.at(counts, (np.broadcast_to(np.arange(m + 1), paths.shape), paths), 1)
                on_cycle(Cycle(cycle, self.cycles, *records[-1], best_path, counts, tau))
            if distinct == 1:
                break
        return Search(frozen(best_path), _history(records), _trails(walked, laid, tau))


class _Walk:
    """Ants walking from start to goal, all of a cycle side by side, layer by layer.

    Edges are certified when an ant first chooses them. One that is refused is barred and the ant
    draws again, which gives exactly the roulette wheel over the allowed edges. A node with no way
    on is barred in turn, and the ant starts anew; if that happens to the start, no path exists.
    """

    def __init__(self, settings: AntSystem, roadmap: Roadmap, rng: np.random.Generator) -> None:
        m, n = roadmap.lattice.divisions, roadmap.lattice.size
        self._ants, self._alpha = settings.ants, settings.alpha
        self._roadmap, self._rng = roadmap, rng
        self._visibility = -settings.beta * np.log(_positive(roadmap.lattice.steps))  # log eta^beta
        self._open = roadmap.admissible[:-1, :, None] & roadmap.admissible[1:, None, :]
        self._proven = np.zeros((m, n, n), dtype=bool)
        self._furthest = 0

    def tours(self, tau: Array) -> IntArray:
        """(ants, m + 1) free paths drawn by Eq. 11."""
        m, origin = self._roadmap.lattice.divisions, self._roadmap.lattice.origin
        paths = np.full((self._ants, m + 1), origin, dtype=np.int64)
        waiting = np.arange(self._ants)
        while len(waiting):
            lost: list[int] = []
            walking = waiting
            for layer in range(m):
                heads = self._step(layer, paths[walking, layer], tau[layer])
                stuck = heads < 0
                lost.extend(walking[stuck])
                walking = walking[~stuck]
                paths[walking, layer + 1] = heads[~stuck]
            waiting = np.array(lost, dtype=np.int64)
        return paths

    def _step(self, layer: int, tails: IntArray, tau: Array) -> IntArray:
        """The next node of each ant on `tails`, or -1 for ants at a dead end."""
        heads = np.full(len(tails), -1, dtype=np.int64)
        drawing = np.arange(len(tails))
        while len(drawing):
            at = tails[drawing]
            allowed = self._open[layer, at]
            alive = allowed.any(axis=1)
            for node in np.unique(at[~alive]):
                self._bar(layer, int(node))
            drawing, at, allowed = drawing[alive], at[alive], allowed[alive]
            if not len(drawing):
                break
            heads[drawing] = self._draw(at, allowed, tau)
            refused = [not self._free(layer, at[k], heads[a]) for k, a in enumerate(drawing)]
            drawing = drawing[refused]
            heads[drawing] = -1
        if (heads >= 0).any():
            self._furthest = max(self._furthest, layer + 1)
        return heads

    def _draw(self, tails: IntArray, allowed: NDArray[np.bool_], tau: Array) -> IntArray:
        """Roulette wheel of Eq. 11. Weights are scaled by the row's largest: ratios are all."""
        log_weight = self._alpha * np.log(tau[tails]) + self._visibility[tails]
        log_weight[~allowed] = -np.inf
        weight = np.exp(log_weight - log_weight.max(axis=1, keepdims=True))
        wheel = np.cumsum(weight, axis=1)
        spin = self._rng.random(len(tails)) * wheel[:, -1]
        return np.asarray(np.argmax(wheel > spin[:, None], axis=1))

    def _free(self, layer: int, tail: int, head: int) -> bool:
        if not self._proven[layer, tail, head]:
            if not self._roadmap.certify(layer, int(tail), int(head)).free:
                self._open[layer, tail, head] = False
                return False
            self._proven[layer, tail, head] = True
        return True

    def _bar(self, layer: int, node: int) -> None:
        """No way leads on from this node: no ant may step onto it again."""
        if layer == 0:
            raise self._roadmap.no_path(self._furthest + 1)
        self._open[layer - 1, :, node] = False


def _positive(steps: Array) -> Array:
    """d_pq, zero (a start and goal that coincide in all that counts) replaced by a tiny length."""
    return np.maximum(steps, 1e-12)


def _history(records: list[tuple[float, float, float, int]]) -> History:
    best, iteration_best, mean, distinct = zip(*records, strict=True)
    return History(
        frozen(np.array(best)),
        frozen(np.array(iteration_best)),
        frozen(np.array(mean)),
        frozen(np.array(distinct, dtype=np.int64)),
    )


def _trails(walked: IntArray, laid: Array, tau: Array) -> Trails:
    used = np.nonzero(walked)
    layer, tail, head = used
    return Trails(layer, tail, head, walked[used], laid[used], tau[used])
