"""What a colony reports: each cycle as it goes, and the whole search at its end."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray

if TYPE_CHECKING:
    from ffsr_plan.lattice.roadmap import Roadmap


class Cycle(NamedTuple):
    """The state of the colony after one cycle, for callbacks."""

    number: int
    """Cycles done, from 1."""
    cycles: int
    """Cycles allowed."""
    best: float
    """Least F so far."""
    iteration_best: float
    mean: float
    distinct: int
    """Different paths among the ants; 1 is stagnation."""
    path: IntArray
    """(m + 1,) nodes of the best path so far; with posture axes, base offset times the number of
    postures plus posture."""
    counts: IntArray
    """(m + 1, n) ants on each node in this cycle (b_j of Eq. 10)."""
    pheromone: Array
    """(m, n, n) tau of each edge, with posture axes of each change of the base offset, or (m, 1, n)
    where pheromone lies on the nodes that edges lead to; a view that the colony goes on
    changing."""


OnCycle = Callable[[Cycle], object]


@dataclass(frozen=True)
class Watch:
    """What looks on while a planner searches."""

    on_cycle: OnCycle | None = None
    """Called after each cycle."""
    deadline: float = math.inf
    """When to stop, by `time.monotonic()`."""

    def over(self) -> bool:
        """Whether the time is up."""
        return time.monotonic() >= self.deadline


class History(NamedTuple):
    """One entry a cycle, arrays of shape (cycles,)."""

    best: Array
    """Least F so far."""
    iteration_best: Array
    """Least F among the ants of the cycle."""
    mean: Array
    """Mean F of the ants of the cycle."""
    distinct: IntArray
    """Different paths among the ants of the cycle."""


class Trails(NamedTuple):
    """The edges that ants walked, arrays of shape (edges,); only the most walked of very many."""

    layer: IntArray
    """Layer that the edge leaves."""
    tail: IntArray
    """Node left, 0 .. n-1 (a row of `LayeredLattice.indices`)."""
    head: IntArray
    """Node reached on the next layer."""
    ants: IntArray
    """How many ants walked it, all cycles together (Eq. 10 summed over time)."""
    laid: Array
    """Pheromone that they laid on it, all cycles together, before any evaporated."""
    pheromone: Array
    """tau at the end."""


class Search(NamedTuple):
    """The outcome of a planner."""

    path: IntArray
    """(m + 1,) nodes of the best path."""
    history: History
    trails: Trails
    interrupted: bool = False
    """Whether the time limit or Ctrl-C ended it early."""


class Planner(Protocol):
    """What `plan` can run: settings with a name and a search."""

    name: ClassVar[str]
    __dataclass_fields__: ClassVar[dict[str, Any]]

    def search(
        self, roadmap: Roadmap, rng: np.random.Generator, watch: Watch | None = None
    ) -> Search:
        """Search a roadmap for a path, all of whose edges are proven free."""
