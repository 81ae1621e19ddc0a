"""Picture of one cycle of a colony: pheromone as ribbons, ants as dots, the best path so far."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.display.scenes.meshcat_objects import CommandLog, instances
from ffsr_plan.display.scenes.projection import view_axes
from ffsr_plan.display.scenes.scene_objects import TRACK, add_track, add_trails
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.search.records import Cycle

_DRAWN_EDGES = 1200  # at most, the strongest
_DRAWN_NODES = 12  # at most in each layer, where pheromone lies on nodes
_LEAST_SHARE = 1e-3  # of the strongest trail's excess pheromone, below which none is drawn
_ANT_COLOUR = 0xDCE6F5
_ANT_RADIUS = 0.05  # [m], of a dot that stands for all ants


class Snapshot(NamedTuple):
    """The parts of a cycle that are drawn, copied from the colony's arrays.

    Attributes:
        edges: (k, 3) layer, tail and head of the edges with most pheromone.
        strength: (k,) in [0, 1], logarithmic: excess of tau over that of edges without deposit.
        counts: (m + 1, n) ants on each base offset.
        path: (m + 1,) base offsets of the best path; empty if there is none yet.
    """

    edges: IntArray
    strength: Array
    counts: IntArray
    path: IntArray


def take(cycle: Cycle, lattice: LayeredLattice) -> Snapshot:
    """Copy the drawn parts of a cycle.

    Args:
        cycle: the cycle. Nodes that differ only in posture are merged.
        lattice: base offsets of the problem that is watched.

    Raises:
        InvalidInput: the cycle belongs to another lattice.
    """
    layers, nodes = cycle.counts.shape
    if layers != lattice.divisions + 1 or nodes % lattice.size:
        expected = f"{lattice.divisions + 1} layers of {lattice.size} nodes, as in the problem"
        raise InvalidInput("cycle", f"{layers} layers of {nodes} nodes", expected)
    postures = nodes // lattice.size
    counts = cycle.counts.reshape(layers, lattice.size, postures).sum(axis=2)
    path = cycle.path // postures if np.isfinite(cycle.best) else cycle.path[:0]
    return Snapshot(*_strongest(cycle.pheromone, lattice), counts, path)


def _strongest(tau: Array, lattice: LayeredLattice) -> tuple[IntArray, Array]:
    """The edges with most pheromone, faint ones first, and their strengths."""
    low, high = float(tau.min()), float(tau.max())
    edges = np.argwhere(tau > low + _LEAST_SHARE * (high - low))
    excess = (tau[tuple(edges.T)] - low) / max(high - low, 1e-300)
    if tau.shape[1] == 1:
        edges, excess = _between_nodes(edges[:, [0, 2]], excess, lattice)
    order = np.argsort(excess, kind="stable")[-_DRAWN_EDGES:]
    strength = 1.0 - np.log10(excess[order]) / np.log10(_LEAST_SHARE)
    return edges[order], np.clip(strength, 0.0, 1.0)


def _between_nodes(
    heads: IntArray, excess: Array, lattice: LayeredLattice
) -> tuple[IntArray, Array]:
    """Edges between nearest nodes of neighbouring layers, for pheromone that lies on nodes.

    Args:
        heads: (k, 2) layer of the edge and index of the node at its head.
        excess: (k,) pheromone of the nodes above the least.
        lattice: the nodes.

    Returns:
        Edges (layer, tail, head), and the lesser excess of the two ends.
    """
    strength = np.zeros((lattice.divisions + 1, lattice.size))
    strength[0, lattice.origin] = 1.0
    strength[heads[:, 0] + 1, heads[:, 1]] = excess
    best = np.argsort(-strength, axis=1, kind="stable")[:, :_DRAWN_NODES]
    layer = np.arange(lattice.divisions)[:, None, None]
    tail, head = best[:-1, :, None], best[1:, None, :]
    weaker = np.minimum(strength[layer, tail], strength[layer + 1, head])
    distance = np.where(weaker > 0.0, lattice.distances[tail, head], np.inf)
    to_tail = distance == distance.min(axis=1, keepdims=True)
    nearest = to_tail | (distance == distance.min(axis=2, keepdims=True))
    i, j, k = np.nonzero(nearest & (weaker > 0.0))
    return np.stack([i, best[i, j], best[i + 1, k]], axis=1), weaker[i, j, k]


def commands(snapshot: Snapshot, lattice: LayeredLattice) -> list[str]:
    """Packed meshcat commands that replace the trails, the ants and the best path.

    Args:
        snapshot: the cycle, see `take`.
        lattice: gives the positions of the nodes.
    """
    import meshcat
    import meshcat.geometry as mg

    log = CommandLog()
    viewer = meshcat.Visualizer(window=log)
    up = view_axes(lattice.problem)[2]
    places = lattice.nominal.positions[:, None] + lattice.offsets
    layer, tail, head = snapshot.edges.T
    if len(layer):
        segments = np.stack([places[layer, tail], places[layer + 1, head]], axis=1)
        add_trails(viewer["trails"]["tau"], segments, snapshot.strength, up)
    else:
        viewer["trails"]["tau"].delete()
    visited = np.nonzero(snapshot.counts)
    share = snapshot.counts[visited] / snapshot.counts[0].sum()
    material = mg.MeshBasicMaterial(color=_ANT_COLOUR)
    dots = instances(places[visited], _ANT_RADIUS * np.cbrt(share), 6, material)
    viewer["ants"]["dots"].set_object(dots)
    if len(snapshot.path):
        track = places[np.arange(len(snapshot.path)), snapshot.path]
        add_track(viewer["tracks"]["best"], track, 0.035, TRACK, up)
    return log.commands
