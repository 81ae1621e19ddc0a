"""A cycle of a colony as a picture: pheromone as ribbons, ants as dots, the best path so far."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.display.meshcat_objects import CommandLog, instances
from ffsr_plan.display.scene_objects import TRACK, add_track, add_trails, view_axes
from ffsr_plan.lattice.layered_lattice import LayeredLattice
from ffsr_plan.search.records import Cycle

_MOST = 1200  # edges drawn, the strongest
_NODES = 12  # nodes a layer between which trails run where pheromone lies on nodes
_FAINT = 1e-3  # of the strongest trail, below which none is drawn
_ANT, _ANT_RADIUS = 0xDCE6F5, 0.05


class Snapshot(NamedTuple):
    """What is drawn of a cycle, copied out of the colony's arrays."""

    edges: IntArray
    """(k, 3) layer, tail and head of the edges with most pheromone."""
    strength: Array
    """(k,) in [0, 1], logarithmic: how far tau is above that of edges where none was laid."""
    counts: IntArray
    """(m + 1, n) ants on each base offset."""
    path: IntArray
    """(m + 1,) base offsets of the best path; empty where there is none yet."""


def take(cycle: Cycle, lattice: LayeredLattice) -> Snapshot:
    """Copy what is drawn; of postures the base offset counts alone.

    Raises:
        InvalidInput: the cycle is of a colony on another lattice.
    """
    layers, nodes = cycle.counts.shape
    if layers != lattice.divisions + 1 or nodes % lattice.size:
        raise InvalidInput(
            "cycle", f"{layers} layers of {nodes} nodes",
            f"{lattice.divisions + 1} layers of {lattice.size} nodes, as of the problem watched",
        )  # fmt: skip
    postures = nodes // lattice.size
    counts = cycle.counts.reshape(layers, lattice.size, postures).sum(axis=2)
    path = cycle.path // postures if np.isfinite(cycle.best) else cycle.path[:0]
    return Snapshot(*_strongest(cycle.pheromone, lattice), counts, path)


def _strongest(tau: Array, lattice: LayeredLattice) -> tuple[IntArray, Array]:
    """The edges with most pheromone, faint ones first, and their strengths."""
    low, high = float(tau.min()), float(tau.max())
    found = np.argwhere(tau > low + _FAINT * (high - low))
    above = (tau[tuple(found.T)] - low) / max(high - low, 1e-300)
    if tau.shape[1] == 1:
        found, above = _between_nodes(found[:, [0, 2]], above, lattice)
    order = np.argsort(above, kind="stable")[-_MOST:]
    return found[order], np.clip(1.0 - np.log10(above[order]) / np.log10(_FAINT), 0.0, 1.0)


def _between_nodes(
    heads: IntArray, above: Array, lattice: LayeredLattice
) -> tuple[IntArray, Array]:
    """Where pheromone lies on nodes (k, 2), trails run to the nearest one that the next layer has.

    Returns:
        Edges (layer, tail, head), as strong as the weaker end.
    """
    strength = np.zeros((lattice.divisions + 1, lattice.size))
    strength[0, lattice.origin] = 1.0
    strength[heads[:, 0] + 1, heads[:, 1]] = above
    best = np.argsort(-strength, axis=1, kind="stable")[:, :_NODES]
    layer = np.arange(lattice.divisions)[:, None, None]
    tail, head = best[:-1, :, None], best[1:, None, :]
    weaker = np.minimum(strength[layer, tail], strength[layer + 1, head])
    apart = np.where(weaker > 0.0, lattice.distances[tail, head], np.inf)
    nearest = (apart == apart.min(axis=1, keepdims=True)) | (
        apart == apart.min(axis=2, keepdims=True)
    )
    i, j, k = np.nonzero(nearest & (weaker > 0.0))
    return np.stack([i, best[i, j], best[i + 1, k]], axis=1), weaker[i, j, k]


def commands(snapshot: Snapshot, lattice: LayeredLattice) -> list[str]:
    """What meshcat is told, packed: trails, ants and best path in place of those of before."""
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
    material = mg.MeshBasicMaterial(color=_ANT)
    dots = instances(places[visited], _ANT_RADIUS * np.cbrt(share), 6, material)
    viewer["ants"]["dots"].set_object(dots)
    if len(snapshot.path):
        track = places[np.arange(len(snapshot.path)), snapshot.path]
        add_track(viewer["tracks"]["best"], track, 0.035, TRACK, up)
    return log.commands
