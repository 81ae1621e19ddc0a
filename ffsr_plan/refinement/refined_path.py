"""Refinement of a certified lattice path to offsets between the nodes.

Lattice paths are a little too long because their slopes come in steps. And as F contains clearances
at the nodes only, they may pass an obstacle closely between two nodes, the more so the larger delta
is. Refinement lowers F of the whole motion (`problem.objective`); at delta = 0 that is F itself,
the length.

Where delta > 0, the path over the lattice's own offsets that is best in this measure comes first.
Then, on four levels, each with half the spacing of the one before, every layer is given the offsets
around its present one, and the best path over them is taken; this is repeated while the value falls
and a node lies on the rim of its offsets.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, Flags, IntArray, frozen
from ffsr_plan.core.errors import OutOfTime
from ffsr_plan.lattice.certificate import Counts
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.lattice.node_clearances import NodeClearances
from ffsr_plan.problem.memory_estimate import MOST_EDGES_AT_ONCE
from ffsr_plan.problem.objective import objective, path_length
from ffsr_plan.problem.problem import Problem
from ffsr_plan.proof.prover import Prover
from ffsr_plan.refinement.band_search import NO_GAIN, BandSearch
from ffsr_plan.refinement.edge_clearances import EdgeClearances
from ffsr_plan.refinement.offset_band import OffsetBand
from ffsr_plan.time_limit.deadline import Deadline

_FINEST = 16
_STEPS = (8, 4, 2, 1)  # of the levels, in sixteenths of the spacing
_ROUNDS = 8
_EXHAUSTIVE = 10**6


class _Level(NamedTuple):
    """How the offsets of a level are chosen and searched.

    Attributes:
        step: distance between two offsets, in sixteenths of the spacing.
        reach: offsets to either side of the path, along each axis.
        candidates: number of paths to evaluate in a round at most.
        rounds: number of rounds at most.
        gain: relative gain that another round needs.
    """

    step: int
    reach: int
    candidates: int
    rounds: int
    gain: float


def _levels(problem: Problem) -> list[_Level]:
    """The levels: where delta > 0, first the lattice itself, and then fewer paths and rounds."""
    if problem.delta == 0.0:
        return [_Level(step, 2, _EXHAUSTIVE, _ROUNDS, 0.0) for step in _STEPS]
    reach_on_lattice, reach = 2, 1
    if len(problem.given_lattice.axes) == 1:
        offsets = math.isqrt(MOST_EDGES_AT_ONCE // problem.given_lattice.divisions)
        reach_on_lattice, reach = min(40, max(2, (offsets - 1) // 2)), 2
    return [
        _Level(_FINEST, reach_on_lattice, _EXHAUSTIVE, 1, 0.0),
        *(_Level(step, reach, 10, _ROUNDS, 1e-4) for step in _STEPS),
    ]


class RefinedPath(NamedTuple):
    """A path moved off the lattice, all its edges proven free.

    Attributes:
        offsets: (m + 1, 3) displacement of the base from the nominal positions [m].
        clearances: (m + 1,) at the nodes [m].
        length: L of Eq. 6 [m].
        objective: F of Eq. 8 [length units], with the clearances at the nodes.
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
    nodes: NodeClearances | None = None,
    deadline: Deadline | None = None,
) -> tuple[RefinedPath | None, bool]:
    """Move a proven path to where F of the whole motion is lower.

    Offsets stay within the lattice's window, in steps of a sixteenth of its spacing.

    Args:
        lattice: the lattice, without posture axes.
        prover: proofs along the lattice's nominal motion.
        offsets: (m + 1, 3) of the path [m].
        clearances: (m + 1,) at its nodes [m].
        nodes: clearances of the lattice's nodes as far as they are known; they save queries.
        deadline: when to end with what has been reached; that of `prover`.

    Returns:
        The path, None where F does not fall; and whether the deadline ended it early.
    """
    problem = lattice.problem
    if not problem.given_lattice.axes:
        return None, False  # with one node a layer there is no offset to change
    descent, cut_short = _Descent(lattice, prover, offsets, clearances), False
    deadline, edges, before = deadline or Deadline(), descent.edges, np.inf
    try:
        deadline.check()
        before = edges.motion_objective(descent.coordinates @ descent.unit, descent.clearances)
        descent.value = before
        if problem.delta > 0.0 and nodes is not None:
            descent.learn(nodes.known, nodes.bounds, lattice.indices)
        for level in _levels(problem):
            for _ in range(level.rounds):
                deadline.check()
                band = descent.band(level)
                measured = descent.measured(band)
                search = BandSearch(problem, edges, band, measured, descent.value)
                path = search.best_path(level.candidates)
                if path is None or not descent.take(band, measured, path, level):
                    break
    except OutOfTime:
        cut_short = True
    return descent.result() if descent.value < before else None, cut_short


class _Descent:
    """A path in whole sixteenths of the lattice's spacing; F of its whole motion goes down."""

    def __init__(
        self, lattice: LayeredLattice, prover: Prover, offsets: Array, clearances: Array
    ) -> None:
        self._problem, self._prover = lattice.problem, prover
        settings = lattice.problem.given_lattice
        axes = [getattr(settings, name) for name in settings.axes]
        self.unit = lattice.directions * (np.array([a.spacing for a in axes]) / _FINEST)[:, None]
        """(axes, 3) displacement [m] of one sixteenth along each axis."""
        self._rim = np.array([a.half_count for a in axes]) * _FINEST
        sizes = np.sum(self.unit**2, axis=1)
        self.coordinates: IntArray = np.rint(offsets @ self.unit.T / sizes).astype(np.int64)
        self._names, self._known = np.zeros(0, dtype=np.int64), np.zeros(0)
        self.edges = EdgeClearances(lattice.problem, prover)
        self._queries_before, self._node_queries = prover.queries, 0
        self.clearances = np.array(clearances)
        self.value = np.inf

    def result(self) -> RefinedPath:
        """The path as it is."""
        moved = self.coordinates @ self.unit
        length = path_length(self._problem, moved)
        return RefinedPath(
            offsets=moved,
            clearances=frozen(self.clearances),
            length=length,
            objective=objective(self._problem, length, self.clearances),
            counts=self.counts(),
        )

    def counts(self) -> Counts:
        """Edges decided and queries spent so far."""
        return self.edges.counts(self._node_queries, self._prover.queries - self._queries_before)

    def learn(self, known: Flags, clearances: Array, indices: IntArray) -> None:
        """Take over clearances of lattice nodes, so that they are not measured again.

        Args:
            known: (m + 1, n) the nodes whose clearance is known.
            clearances: (m + 1, n) at these nodes [m].
            indices: (n, axes) offset of each node in the lattice's spacing.
        """
        layers, nodes = np.nonzero(known & (clearances > -np.inf))
        names = self._named(layers, indices[nodes] * _FINEST)
        self._keep(names, clearances[layers, nodes])

    def band(self, level: _Level) -> OffsetBand:
        """The offsets around the path; on the lattice itself, moved into the window."""
        reach = np.full(len(self._rim), level.reach)
        middle = self.coordinates
        if level.step == _FINEST:
            reach = np.minimum(reach, self._rim // _FINEST)
            inner = self._rim - reach * _FINEST
            middle = np.clip(middle, -inner, inner)
        return OffsetBand(self._problem, middle, self._rim, self.unit, level.step, reach)

    def take(self, band: OffsetBand, measured: Array, path: IntArray, level: _Level) -> bool:
        """Move to a path over a band if it is better; whether another round may help.

        Args:
            band: the band.
            measured: (m + 1, w) clearances of its nodes [m].
            path: (m + 1,) nodes.
            level: the level.
        """
        layers = np.arange(len(path))
        coordinates, clearances = band.choices[layers, path], measured[layers, path]
        value = self.edges.motion_objective(coordinates @ self.unit, clearances)
        if not value < self.value * NO_GAIN:
            return False
        gained = value <= self.value * (1.0 - level.gain)
        moved = np.abs(coordinates - self.coordinates)
        self.coordinates, self.clearances, self.value = coordinates, clearances, value
        return gained and bool(np.any(moved == level.reach * level.step))

    def measured(self, band: OffsetBand) -> Array:
        """(m + 1, w) clearances, -inf where an offset is not allowed; each measured once."""
        layers, nodes = np.nonzero(band.present)
        names = self._named(layers, band.choices[layers, nodes])
        places = np.searchsorted(self._names, names)
        missing = places == len(self._names)
        missing[~missing] = self._names[places[~missing]] != names[~missing]
        if np.any(missing):
            before = self._prover.queries
            at = band.offsets[layers[missing], nodes[missing]]
            found = self._prover.clearances(layers[missing], at)
            self._node_queries += self._prover.queries - before
            self._keep(names[missing], found)
            places = np.searchsorted(self._names, names)
        clearances = np.full(band.present.shape, -np.inf)
        clearances[layers, nodes] = self._known[places]
        return clearances

    def _named(self, layers: IntArray, offsets: IntArray) -> IntArray:
        """(k,) one number for each layer (k,) and offset (k, axes)."""
        names = layers
        for column, rim in zip(offsets.T, self._rim, strict=True):
            names = names * (2 * rim + 1) + column + rim
        return names

    def _keep(self, names: IntArray, clearances: Array) -> None:
        """Keep the clearances (k,) of offsets that were not known, by their names (k,)."""
        names = np.concatenate([self._names, names])
        order = np.argsort(names, kind="stable")
        known = np.concatenate([self._known, clearances])
        self._names, self._known = names[order], known[order]
