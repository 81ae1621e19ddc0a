"""Memory that a lattice takes, from its counts, before any array is made.

The numbers of bytes are those of the arrays, confirmed by measurement: tests/problem/
test_memory_estimate.py compares the estimates with the peak memory of whole searches.
"""

from __future__ import annotations

import math

from ffsr_plan.core.cost_estimate import MOST_BYTES, check_memory, check_work
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.problem.lattice_settings import Progress
from ffsr_plan.problem.problem import Problem

BYTES_PER_PAIR_OF_OFFSETS = 64
"""Distances and lengths between the offsets of two layers, and what they are made from [bytes]."""
_BYTES_PER_LAYER = 3000  # motion, base reaction and clearances
_BYTES_PER_SHAPE = 1900  # of the robot, on each layer: placements at the corners and for proofs
_BYTES_PER_NODE = 40
_BYTES_PER_ANT = 40  # on each layer
_BYTES_PER_COLONY, _BYTES_PER_TRAIL, _MOST_TRAILS = 20_000, 48, 10_000  # of its result
_SECONDS_PER_PAIR = 2e-5  # distances of two links over an edge [s]
_BYTES_PER_REFINED_EDGE = 60
_REFINED_OFFSETS = 5  # along each axis; see `refinement.refined_path`
MOST_EDGES_AT_ONCE = 1_000_000
"""Edges of the first round of refinement at most."""
_ADVICE = "fewer divisions, a smaller half_count or fewer axes"


def check_lattice(problem: Problem, bytes_per_edge: float = 1.0, ants: int = 0) -> None:
    """Check that a search of the base offsets takes no more memory and work than is allowed.

    Args:
        problem: gives the lattice and the robot.
        bytes_per_edge: memory of all arrays with one entry for each edge [bytes].
        ants: ants of a cycle, each of which has a path.

    Raises:
        InvalidInput: with the counts that cause it; or not a problem.
    """
    if not isinstance(problem, Problem):
        raise InvalidInput("problem", problem, "a Problem")
    lattice = problem.given_lattice
    axes = [getattr(lattice, name) for name in lattice.axes]
    nodes = math.prod(2 * axis.half_count + 1 for axis in axes)
    layers = lattice.divisions + 1
    if lattice.progress is not None:
        _check_progress(problem, lattice.progress, layers, nodes)
        return
    shapes = int(problem.robot.collision_model.ngeoms)
    per_layer = _BYTES_PER_LAYER + _BYTES_PER_SHAPE * shapes
    fixed = layers * (per_layer + _BYTES_PER_NODE * nodes) + BYTES_PER_PAIR_OF_OFFSETS * nodes**2
    fixed += _BYTES_PER_ANT * layers * ants
    refined = _REFINED_OFFSETS ** (2 * len(axes)) if axes else 0
    if axes and problem.delta > 0.0:
        refined = max(refined, min(nodes**2, MOST_EDGES_AT_ONCE // lattice.divisions))
    most = max(bytes_per_edge, _BYTES_PER_REFINED_EDGE * refined / nodes**2)
    counts = {"layers": layers, "nodes": nodes, "nodes of the next layer": nodes}
    check_memory("lattice", counts, most, _ADVICE, fixed)
    pairs = len(problem.robot.collision_model.collisionPairs)
    counts = {"layers": layers, "pairs of links": pairs}
    check_work("lattice", counts, _SECONDS_PER_PAIR, f"{_ADVICE}, or an SRDF that exempts pairs")


def _check_progress(problem: Problem, progress: Progress, layers: int, nodes: int) -> None:
    """Raise `InvalidInput` for a lattice with progress that would take too much memory."""
    bodies, axes = len(problem.scene.bodies), len(problem.given_lattice.axes)
    places = progress.before + progress.steps + progress.beyond + 1
    shapes = int(problem.robot.collision_model.ngeoms)
    moves = (2 * progress.most + 1) * (2 * progress.aside + 1) ** axes
    each = 40.0 + moves * problem.scene.moves + 240.0 * shapes * bodies / nodes
    fixed = places * (2 * progress.most + 2) * (_BYTES_PER_LAYER + _BYTES_PER_SHAPE * shapes)
    fixed += BYTES_PER_PAIR_OF_OFFSETS * nodes**2 + moves * places * nodes
    counts = {"layers": layers, "places": places, "nodes": nodes}
    check_memory("lattice", counts, each, _ADVICE, fixed)


def check_colonies(problem: Problem, colonies: int) -> None:
    """Raise `InvalidInput` if the results of so many colonies would take too much memory.

    A lattice that is too large for one colony is another matter: its own check names it.

    Args:
        problem: gives the lattice.
        colonies: number of independent colonies, whose results are compared at the end.
    """
    lattice = problem.lattice
    if lattice is None:
        return
    axes = [getattr(lattice, name) for name in lattice.axes]
    edges = lattice.divisions * math.prod(2 * axis.half_count + 1 for axis in axes) ** 2
    of_path = (_BYTES_PER_LAYER if lattice.postures else 8) * lattice.divisions
    each = _BYTES_PER_COLONY + of_path + _BYTES_PER_TRAIL * min(edges, _MOST_TRAILS)
    if each <= MOST_BYTES:
        check_memory("colonies", {"colonies": colonies}, each, "fewer colonies")
