"""Counts of proven edges and distance queries, and the certificate of a plan."""

from __future__ import annotations

from typing import NamedTuple


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
        least_clearance: proven lower bound on the clearance along the whole returned motion [m].
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
