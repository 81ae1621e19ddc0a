"""Counts of proven edges and distance queries, and the certificate of a plan."""

from __future__ import annotations

from typing import NamedTuple

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.errors import OutOfTime
from ffsr_plan.proof.prover import Prover


class Counts(NamedTuple):
    """Edges decided and distance queries spent.

    Attributes:
        edges_free: edges proven free, most of them by the clearances at their ends alone.
        edges_refused: edges refused, each by its own proof or because it is close to a refused one.
        node_queries: Coal queries for the clearances of nodes, one a configuration over all pairs.
        edge_queries: Coal queries for all proofs, obstacles and self-collision together.
    """

    edges_free: int
    edges_refused: int
    node_queries: int
    edge_queries: int

    def plus(self, other: Counts) -> Counts:
        """The sum of both, field by field."""
        return Counts(*(a + b for a, b in zip(self, other, strict=True)))


class Certificate(NamedTuple):
    """What was proven about a plan, and how many queries it took.

    Attributes:
        edges_free: edges proven free during the search and the refinement.
        edges_refused: edges refused during the search and the refinement.
        node_queries: Coal queries for the clearances of nodes, one a configuration over all pairs.
        edge_queries: Coal queries for all proofs, obstacles and self-collision together.
        least_clearance: proven lower bound on the clearance along the whole returned motion [m]; 0
            where a time limit left no time to work it out.
        unchecked_links: links of the robot without a collision shape, for which nothing is proven.
    """

    edges_free: int
    edges_refused: int
    node_queries: int
    edge_queries: int
    least_clearance: float
    unchecked_links: tuple[str, ...]

    @property
    def counts(self) -> Counts:
        """The counts alone."""
        return Counts(*self[:4])


def proven_clearance(prover: Prover, offsets: Array, clearances: Array) -> tuple[float, bool]:
    """Proven lower bound on the clearance along a path whose edges are free.

    Args:
        prover: proofs along the motion from which offsets are counted.
        offsets: (m + 1, 3) offsets of the path's nodes [m].
        clearances: (m + 1,) clearances at the nodes [m].

    Returns:
        The bound [m], and whether the deadline cut it short, in which case it is 0.
    """
    try:
        return prover.least_clearance(offsets, clearances), False
    except OutOfTime:
        return 0.0, True
