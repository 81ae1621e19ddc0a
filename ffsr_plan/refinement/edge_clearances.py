"""Least clearances on the edges of displaced motions, each edge proven free or refused."""

from __future__ import annotations

import numpy as np

from ffsr_plan.core.arrays import Array, Flags
from ffsr_plan.lattice.certificate import Counts
from ffsr_plan.problem.objective import motion_objective, path_length
from ffsr_plan.problem.problem import Problem
from ffsr_plan.proof.interval_halving import Verdict
from ffsr_plan.proof.prover import Prover
from ffsr_plan.refinement.offset_band import OffsetBand


class EdgeClearances:
    """Verdicts on edges between any offsets, each computed once.

    The least clearance is the least of those sampled (`proof.sampled_edges`). At delta = 0, where
    clearance costs nothing, edges are only proven free.
    """

    def __init__(self, problem: Problem, prover: Prover) -> None:
        self._problem, self._prover = problem, prover
        self._verdicts: dict[tuple[int, bytes, bytes], Verdict] = {}

    def of_path(self, offsets: Array, clearances: Array) -> list[Verdict]:
        """Verdicts on the m edges of a path.

        Args:
            offsets: (m + 1, 3) displacement of the base from the nominal positions [m].
            clearances: (m + 1,) at the nodes [m].
        """
        names = [at.tobytes() for at in offsets]
        keys = [(i, names[i], names[i + 1]) for i in range(len(names) - 1)]
        unknown = np.array([i for i, key in enumerate(keys) if key not in self._verdicts], np.int64)
        if not len(unknown):
            return [self._verdicts[key] for key in keys]
        prover = self._prover
        tails, heads = offsets[unknown], offsets[unknown + 1]
        ends = np.stack([clearances[unknown], clearances[unknown + 1]], axis=1)
        sampled: list[Verdict | None] = [None] * len(unknown)
        if self._problem.delta > 0.0:
            sampled = list(prover.sampled_edges(unknown, tails, heads, ends))
        left = [k for k, each in enumerate(sampled) if _undecided(each, prover.tolerance)]
        proofs = prover.certify_all(unknown[left], tails[left], heads[left], ends[left])
        for k, proof in zip(left, proofs, strict=True):
            before = sampled[k]
            sampled[k] = proof if before is None else _closer(proof, before)
        for layer, verdict in zip(unknown.tolist(), sampled, strict=True):
            assert verdict is not None
            self._verdicts[keys[layer]] = verdict
        return [self._verdicts[key] for key in keys]

    def half_way(self, band: OffsetBand, edges: Flags) -> Array:
        """Clearances half-way on edges of a band.

        Args:
            band: the band.
            edges: (m, w, w) the e edges that matter.

        Returns:
            (e,) [m], in the order of `np.nonzero`.
        """
        layers, offsets, place = band.half_way(edges)
        return self._prover.half_way(layers, offsets)[place]

    def motion_objective(self, offsets: Array, clearances: Array) -> float:
        """F of the whole motion along a path; infinite if an edge is not proven free.

        Args:
            offsets: (m + 1, 3) displacement of the base from the nominal positions [m].
            clearances: (m + 1,) at the nodes [m].
        """
        least = proven_clearances(self.of_path(offsets, clearances))
        return motion_objective(self._problem, path_length(self._problem, offsets), least)

    def counts(self, node_queries: int, queries: int) -> Counts:
        """Edges decided so far.

        Args:
            node_queries: queries spent on nodes.
            queries: all queries spent.
        """
        free = sum(verdict.free for verdict in self._verdicts.values())
        return Counts(
            edges_free=free,
            edges_refused=len(self._verdicts) - free,
            node_queries=node_queries,
            edge_queries=queries - node_queries,
        )


def proven_clearances(verdicts: list[Verdict]) -> Array:
    """(k,) least clearances of edges [m], zero on those that are not proven free."""
    return np.array([each.least_clearance if each.free else 0.0 for each in verdicts])


def _undecided(verdict: Verdict | None, tolerance: float) -> bool:
    """Whether samples neither prove an edge free nor come within the tolerance."""
    return verdict is None or (not verdict.free and verdict.least_clearance > tolerance)


def _closer(proof: Verdict, sampled: Verdict) -> Verdict:
    """The verdict of a proof, with the least clearance of both."""
    nearest = min((proof.least_clearance, proof.time), (sampled.least_clearance, sampled.time))
    return Verdict(proof.free, *nearest, proof.queries + sampled.queries)
