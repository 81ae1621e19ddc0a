"""Ant colony and annealing on a lattice where the attitude at a node depends on the path to it.

Ants follow the cost to go at the nominal attitude and lay pheromone on changes of the base offset
and on posture steps, layer by layer. The best ant of a cycle is improved by shifts of whole
segments; longer annealings of such shifts end the search. Every path is costed at the attitude that
it really leads to.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated, NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.rotations import angle_between, slerp
from ffsr_plan.core.setting_rules import Number, Truth, WholeNumber
from ffsr_plan.core.settings import settings
from ffsr_plan.search.postures.annealing_kernels import anneal, uncosted_path
from ffsr_plan.search.postures.ant_tour_kernels import cost_to_go, lay_pheromone, walk
from ffsr_plan.search.postures.cost_kernels import PostureGrid, is_free, path_cost
from ffsr_plan.search.postures.path_proof import CORRECTABLE
from ffsr_plan.search.postures.posture_lattice import PostureLattice
from ffsr_plan.search.postures.posture_lattice_arrays import without_edge
from ffsr_plan.search.records import Cycle, History, SearchMonitor, Trails

_BEST_LAYS_EVERY = 3  # cycles; in the others the best ant of the cycle lays pheromone
_DEMANDED_WEIGHT = 4.0  # factor of the cost of a radian after a path that could not be corrected
_LEAST_GAIN = 1e-9  # [m] by which a path has to be better to count as better


_Positive = Annotated[float, Number(at_least=1e-9, at_most=1e9)]
PositivePair = tuple[_Positive, _Positive]
_SHIFTS_TO_TURN, _SHIFTS_TO_PASS = 3000, 1000


@settings
class AnnealingSettings:
    """Settings of ants and annealing.

    Attributes:
        ants: number of ants in a cycle, at least 1.
        cycles: largest number of cycles, at least 1.
        pheromone: whether ants lay and follow pheromone at all.
        detour_scale: detour [m] at which an ant takes a step e times less often than the best one.
        rho: persistence of pheromone, in (0, 1).
        least_pheromone: lower bound on pheromone, in (0, 1); tau starts at 1.
        patience: cycles without improvement after which the ants stop, at least 1.
        descent_shifts: segment shifts tried on the best ant of each cycle.
        annealing_shifts: segment shifts for each layer in each annealing; by default 3000 where the
            arms have to bring about a goal attitude, and 1000 otherwise.
        temperatures: pairs of temperatures [m], begin and end of each annealing after the ants.
            The first, hottest annealing decides how often the arms loop; the others improve the
            path that it leaves.
        attitude_weights: cost [m] of a radian of goal attitude error, at the beginning of an
            annealing and from half of its shifts on; the latter judges paths.
    """

    ants: Annotated[int, WholeNumber(at_least=1, at_most=100_000)] = 30
    cycles: Annotated[int, WholeNumber(at_least=1, at_most=1_000_000)] = 242
    pheromone: Annotated[bool, Truth()] = True
    detour_scale: _Positive = 0.15
    rho: Annotated[float, Number(above=0.0, below=1.0)] = 0.9
    least_pheromone: Annotated[float, Number(above=0.0, below=1.0)] = 0.02
    patience: Annotated[int, WholeNumber(at_least=1, at_most=1_000_000)] = 30
    descent_shifts: Annotated[int, WholeNumber(at_most=1_000_000)] = 200
    annealing_shifts: Annotated[int, WholeNumber(at_most=1_000_000)] | None = None
    temperatures: tuple[PositivePair, ...] = ((1.0, 0.03), (1.0, 1e-3), (0.3, 1e-3))
    attitude_weights: PositivePair = (5.0, 100.0)

    def shifts_per_layer(self, reach_attitude: bool) -> int:
        """Segment shifts for each layer in one annealing."""
        if self.annealing_shifts is not None:
            return self.annealing_shifts
        return _SHIFTS_TO_TURN if reach_attitude else _SHIFTS_TO_PASS


class PosturePath(NamedTuple):
    """The result of a colony.

    Attributes:
        path: (m + 1, 2) base offset and posture on each layer.
        cost: cost of the path [m], with penalties for collision and for goal attitude error.
        history: costs per cycle [m]; each annealing counts as one cycle.
        trails: the changes of the base offset that ants walked.
        interrupted: whether the time limit or Ctrl-C ended the search early.
    """

    path: IntArray
    cost: float
    history: History
    trails: Trails
    interrupted: bool


class PostureColony:
    """Ants and annealing on one lattice.

    Attributes:
        grid: the lattice as arrays, with the edges refused so far.
        best: (m + 1, 2) the best path so far.
        best_cost: its cost [m].
    """

    def __init__(
        self,
        lattice: PostureLattice,
        grid: PostureGrid,
        chosen: AnnealingSettings,
        rng: np.random.Generator,
    ) -> None:
        self._lattice, self._settings, self._rng = lattice, chosen, rng
        self.grid = grid
        self._weights = np.array(chosen.attitude_weights, dtype=np.float64)
        m, (postures, steps) = len(grid.rows) - 1, grid.successors.shape
        offsets = len(grid.across)
        self._cost_to_go = cost_to_go(grid, _guiding_attitudes(lattice), lattice.deadline)
        self._offset_pheromone = np.ones((m, offsets, offsets))
        self._posture_pheromone = np.ones((m, postures, steps))
        self._walked = np.zeros((m, offsets, offsets), dtype=np.int64)
        self._laid = np.zeros((m, offsets, offsets))
        self._records: list[tuple[float, float, float, int]] = []
        self.best = np.tile(grid.origin, (m + 1, 1))
        self.best_cost = self.cost(self.best)

    def search(self, monitor: SearchMonitor) -> PosturePath:
        """Run the ants, then the annealings. The monitor ends both early, and is told the best."""
        interrupted = self._run_ants(monitor) or self._run_annealings(monitor)
        history = History.of_rows(np.array(self._records, dtype=np.float64))
        return PosturePath(self.best, self.best_cost, history, self._trails(), interrupted)

    def cost(self, path: IntArray) -> float:
        """Cost of a path (m + 1, 2) [m]."""
        return float(path_cost(self.grid, uncosted_path(path), float(self._weights[1])))

    def shortcomings(self, path: IntArray) -> str:
        """What keeps a path (m + 1, 2) from being proven, at its nodes; empty where nothing does.

        Args:
            path: the path.
        """
        costed = uncosted_path(path)
        path_cost(self.grid, costed, float(self._weights[1]))
        if not np.all(costed.clearances[1:] > 0.0) and not is_free(self.grid):
            return "is in collision at a node"
        error = float(angle_between(costed.quats[-1], self.grid.goal))
        if self.grid.reach_attitude and error > CORRECTABLE:
            return f"misses the goal attitude by {math.degrees(error):.2g} degrees"
        return ""

    def refuse(self, layer: int, path: IntArray) -> None:
        """Exclude the edge by which a path (m + 1, 2) leaves a layer."""
        self.grid = without_edge(self.grid, layer, path)

    def demand(self, free_error: float) -> None:
        """Let an error of the goal attitude cost more: four times as much, from `free_error` on.

        Args:
            free_error: what costs nothing [rad], unless less costs something already.
        """
        self.grid = self.grid._replace(free_error=min(self.grid.free_error, free_error))
        self._weights = _DEMANDED_WEIGHT * self._weights

    def annealed(
        self,
        path: IntArray,
        shifts: int,
        hot: float,
        cold: float,
        stop_requested: Callable[[], bool] = bool,
    ) -> tuple[IntArray, float]:
        """The best path of an annealing from `path`, and its cost [m].

        Args:
            path: (m + 1, 2) base offset and posture on each layer.
            shifts: number of segment shifts to try.
            hot: temperature at the beginning [m].
            cold: temperature at the end [m].
            stop_requested: asked every few milliseconds; whether to end with what there is.
        """
        return self._shifted(path, shifts, hot, cold, self._weights, stop_requested)

    def _shifted(
        self,
        path: IntArray,
        shifts: int,
        hot: float,
        cold: float,
        weights: Array,
        stop_requested: Callable[[], bool],
    ) -> tuple[IntArray, float]:
        result = np.empty_like(path)
        cost = anneal(
            self.grid, self._rng, path, shifts, hot, cold, weights, result, stop_requested
        )
        return result, cost

    def _run_ants(self, monitor: SearchMonitor) -> bool:
        """Run cycles until none improves the path any more; whether the monitor ended them."""
        chosen, stale = self._settings, 0
        late_weights = np.full(2, self._weights[1])
        for _ in range(chosen.cycles):
            paths, costs = self._tours(monitor)
            if not paths:
                break
            leader = paths[int(np.argmin(costs))]
            improved, cost = self._shifted(
                leader, chosen.descent_shifts, 1e-3, 1e-4, late_weights, monitor.expired
            )
            stale += 1
            if cost < self.best_cost - _LEAST_GAIN:
                self.best, self.best_cost, stale = improved, cost, 0
            distinct = len({path.tobytes() for path in paths})
            self._records.append((self.best_cost, cost, float(np.mean(costs)), distinct))
            if monitor.on_cycle is not None:
                monitor.on_cycle(self._cycle(paths))
            if chosen.pheromone:
                best_lays = len(self._records) % _BEST_LAYS_EVERY == 0
                self._lay(self.best if best_lays else improved)
            if stale >= chosen.patience:
                break
            monitor.on_path(self.best)
            if monitor.expired():
                return True
        return False

    def _tours(self, monitor: SearchMonitor) -> tuple[list[IntArray], list[float]]:
        """Paths of the ants that got to the goal, and their costs [m]."""
        m, paths, costs = len(self._walked), [], []
        layers = np.arange(m)
        for _ in range(self._settings.ants):
            if monitor.expired():
                break
            path = np.empty((m + 1, 2), dtype=np.int64)
            if walk(
                self.grid,
                self._rng,
                self._cost_to_go,
                self._settings.detour_scale,
                self._offset_pheromone,
                self._posture_pheromone,
                path,
            ):
                paths.append(path)
                self._walked[layers, path[:-1, 0], path[1:, 0]] += 1
                costs.append(self.cost(path))
        return paths, costs

    def _lay(self, path: IntArray) -> None:
        rho, least = self._settings.rho, self._settings.least_pheromone
        tables = self._offset_pheromone, self._posture_pheromone
        for pheromone in tables:
            np.maximum(rho * pheromone, least, out=pheromone)
        lay_pheromone(self.grid, 1.0 - rho, path, *tables)
        self._laid[np.arange(len(path) - 1), path[:-1, 0], path[1:, 0]] += 1.0 - rho

    def _run_annealings(self, monitor: SearchMonitor) -> bool:
        """Anneal the best path; whether the monitor ended that."""
        problem = self._lattice.problem
        shifts = len(self._walked) * self._settings.shifts_per_layer(problem.reach_attitude)
        for hot, cold in self._settings.temperatures:
            path, cost = self.annealed(self.best, shifts, hot, cold, monitor.expired)
            if cost < self.best_cost - _LEAST_GAIN:
                self.best, self.best_cost = path, cost
            self._records.append((self.best_cost, cost, cost, 1))
            monitor.on_path(self.best)
            if monitor.expired():
                return True
        return False

    def _trails(self) -> Trails:
        """Where the ants moved the base; nothing where there is one base offset."""
        if self._walked.shape[1] == 1:
            return Trails.none()
        layer, tail, head = edges = np.nonzero(self._walked)
        pheromone = self._offset_pheromone[edges]
        return Trails(layer, tail, head, self._walked[edges], self._laid[edges], pheromone)

    def _cycle(self, paths: list[IntArray]) -> Cycle:
        """The last cycle in terms of the lattice, F in units of length."""
        postures, unit = len(self.grid.successors), self._lattice.problem.length_unit
        best, *walked = (path[:, 0] * postures + path[:, 1] for path in (self.best, *paths))
        counts = np.zeros((len(best), len(self.grid.across) * postures), dtype=np.int64)
        np.add.at(counts, (np.arange(len(best)), np.array(walked)), 1)
        best_cost, cost, mean, distinct = self._records[-1]
        return Cycle(
            number=len(self._records),
            cycles=self._settings.cycles,
            best=best_cost / unit,
            iteration_best=cost / unit,
            mean=mean / unit,
            distinct=distinct,
            path=best,
            counts=counts,
            pheromone=self._offset_pheromone,
        )


def _guiding_attitudes(lattice: PostureLattice) -> Array:
    """(m + 1, 4) attitudes at which the cost to go is worked out (xyzw).

    The nominal ones, or those from start to goal where the goal attitude is to be reached.
    """
    problem = lattice.problem
    if not problem.reach_attitude:
        return np.array(lattice.base.nominal.attitudes)
    progress = np.linspace(0.0, 1.0, problem.given_lattice.divisions + 1)
    return slerp(problem.start[3:7], problem.goal[3:7], progress)
