"""Refinement of a certified lattice path to offsets between the nodes; F never rises.

Lattice paths are a little too long because their slopes come in steps. On four levels, each with
half the spacing of the one before, every layer is given the offsets around its present one, and the
exact optimum over them is taken, edges certified lazily; this is repeated while F falls and a
node lies on the rim of its offsets.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray, States, frozen
from ffsr_plan.lattice.certificate import Counts
from ffsr_plan.lattice.edge_states import REFUSED
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.lattice.roadmap import rule_out
from ffsr_plan.lattice.shortest_path import LazyShortestPath
from ffsr_plan.problem.objective import nearness, objective, path_length
from ffsr_plan.proof.interval_halving import Verdict, certify
from ffsr_plan.proof.prover import Prover

_LEVELS = 4
_FINEST = 2**_LEVELS
_ROUNDS = 8
_REACH = 2  # offsets to either side, so five a layer and axis


class RefinedPath(NamedTuple):
    """A path moved off the lattice, all its edges proven free.

    Attributes:
        offsets: (m + 1, 3) displacement of the base from the nominal positions [m].
        clearances: (m + 1,) at the nodes [m].
        length: L of Eq. 6 [m].
        objective: F of Eq. 8 [length units], lower than before.
        counts: edges and queries that the refinement took.
    """

    offsets: Array
    clearances: Array
    length: float
    objective: float
    counts: Counts


def refined_path(
    lattice: LayeredLattice,
    prover: Prover,
    offsets: Array,
    clearances: Array,
    objective: float,
    stop_requested: Callable[[], bool] = bool,
) -> RefinedPath | None:
    """Move a proven path off the lattice to where F is lower; None where F does not fall.

    Offsets stay within the lattice's window, in steps of a sixteenth of its spacing.

    Args:
        lattice: the lattice, without posture axes.
        prover: proofs along the lattice's nominal motion.
        offsets: (m + 1, 3) of the path [m].
        clearances: (m + 1,) at its nodes [m].
        objective: F of the path [length units].
        stop_requested: asked between rounds; whether to end with what has been reached.
    """
    if not lattice.problem.lattice.axes:
        return None  # one node a layer: there is no offset to change
    descent = _Descent(lattice, prover, offsets, clearances, objective)
    for level in range(1, _LEVELS + 1):
        for _ in range(_ROUNDS):
            if stop_requested() or not descent.improve(_FINEST // 2**level):
                break
    if not descent.objective < objective:
        return None
    moved = descent.coordinates @ descent.unit
    return RefinedPath(
        offsets=moved,
        clearances=frozen(descent.clearances),
        length=path_length(lattice.problem, moved),
        objective=descent.objective,
        counts=descent.counts(),
    )


class _Descent:
    """A path in whole sixteenths of the lattice's spacing, going down in F."""

    def __init__(
        self,
        lattice: LayeredLattice,
        prover: Prover,
        offsets: Array,
        clearances: Array,
        objective: float,
    ) -> None:
        self._problem, self._prover = lattice.problem, prover
        settings = lattice.problem.lattice
        axes = [getattr(settings, name) for name in settings.axes]
        self.unit = lattice.directions * (np.array([a.spacing for a in axes]) / _FINEST)[:, None]
        """(axes, 3) displacement [m] of one sixteenth along each axis."""
        self._rim = np.array([a.half_count for a in axes]) * _FINEST
        sizes = np.sum(self.unit**2, axis=1)
        self.coordinates: IntArray = np.rint(offsets @ self.unit.T / sizes).astype(np.int64)
        self.clearances, self.objective = np.array(clearances), objective
        self._known: dict[tuple[int, bytes], float] = {}
        self._verdicts: dict[tuple[int, bytes, bytes], Verdict] = {}
        self._queries_before, self._node_queries = prover.queries, 0
        steps = range(-_REACH, _REACH + 1)
        self._around = np.array(list(product(steps, repeat=len(axes))), dtype=np.int64)

    def counts(self) -> Counts:
        """Edges decided and queries spent so far."""
        free = sum(verdict.free for verdict in self._verdicts.values())
        return Counts(
            edges_free=free,
            edges_refused=len(self._verdicts) - free,
            node_queries=self._node_queries,
            edge_queries=self._prover.queries - self._queries_before - self._node_queries,
        )

    def improve(self, step: int) -> bool:
        """Take the best of the offsets around; whether another round may help."""
        choices, present = self._choices(step)
        clearances = self._clearances(choices, present)
        offsets = choices @ self.unit
        node_costs = np.where(clearances > 0.0, nearness(self._problem, clearances), np.inf)
        node_costs[[0, -1], 0] = 0.0
        across = np.linalg.norm(offsets[1:, None] - offsets[:-1, :, None], axis=3)
        steps = np.sqrt(self._problem.delta_d**2 + (across * self._problem.position_weight) ** 2)
        status = np.zeros(steps.shape, dtype=np.int8)
        edge_costs = steps / self._problem.length_unit
        search = LazyShortestPath(edge_costs, node_costs, status, 0)
        path = search.path()
        while path is not None:
            refused = self._refused_layer(path, choices, offsets, clearances, status)
            if refused is None:
                break
            path = search.path(refused)
        if path is None:
            return False
        layers = np.arange(len(path))
        coordinates, ends = choices[layers, path], clearances[layers, path]
        length = path_length(self._problem, coordinates @ self.unit)
        value = objective(self._problem, length, ends)
        if not value < self.objective * (1.0 - 1e-12):
            return False
        moved = np.abs(coordinates - self.coordinates)
        self.coordinates, self.clearances, self.objective = coordinates, ends, value
        return bool(np.any(moved == _REACH * step))

    def _choices(self, step: int) -> tuple[IntArray, Flags]:
        """(m + 1, w, axes) offsets around the present ones, and which of them are allowed."""
        choices = self.coordinates[:, None] + step * self._around
        present = np.all(np.abs(choices) <= self._rim, axis=2)
        for end in (0, -1):
            choices[end], present[end] = self.coordinates[end], False
            present[end, 0] = True
        return choices, present

    def _clearances(self, choices: IntArray, present: Flags) -> Array:
        """(m + 1, w) clearances, -inf where an offset is not allowed; each asked for once."""
        clearances = np.full(present.shape, -np.inf)
        for i, k in zip(*np.nonzero(present), strict=True):
            key = (int(i), choices[i, k].tobytes())
            if key not in self._known:
                at = choices[i, k][None] @ self.unit
                before = self._prover.queries
                self._known[key] = float(self._prover.clearances(np.array([i]), at)[0])
                self._node_queries += self._prover.queries - before
            clearances[i, k] = self._known[key]
        return clearances

    def _refused_layer(
        self, path: IntArray, choices: IntArray, offsets: Array, clearances: Array, status: States
    ) -> int | None:
        """Certify the edges of a path; set refusals in `status`, return the first one's layer."""
        for i, (a, b) in enumerate(pairwise(path)):
            key = (i, choices[i, a].tobytes(), choices[i + 1, b].tobytes())
            verdict = self._verdicts.get(key)
            if verdict is None:
                ends = (float(clearances[i, a]), float(clearances[i + 1, b]))
                edge = self._prover.obstacle_edge(i, offsets[i, a], offsets[i + 1, b])
                verdict = certify(edge, ends, self._prover.tolerance)
                self._verdicts[key] = verdict
            if not verdict.free:
                status[i, a, b] = REFUSED
                rule_out(status[i], offsets[i], offsets[i + 1], (int(a), int(b)), verdict)
        refused = status[np.arange(len(path) - 1), path[:-1], path[1:]] == REFUSED
        return int(np.argmax(refused)) if refused.any() else None
