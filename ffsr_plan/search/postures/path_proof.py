"""Proof of a path through base offsets and postures, and correction of its final attitude."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ffsr_plan.collision.contacts import named, start_in_collision
from ffsr_plan.collision.distances import Nearest
from ffsr_plan.core.arrays import Array, IntArray
from ffsr_plan.core.errors import UnprovenPath
from ffsr_plan.core.rotations import angle_between
from ffsr_plan.dynamics.attitude_correction import corrected
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.problem.advice import for_proof
from ffsr_plan.problem.objective import objective, path_length
from ffsr_plan.problem.problem import Problem
from ffsr_plan.proof.prover import Prover
from ffsr_plan.search.postures.posture_lattice import PostureLattice, displacements

GOAL_TOLERANCE = 1e-8
"""Largest goal attitude error [rad] of a plan: 100 m away from the base 1e-6 m."""
CORRECTABLE = math.radians(1.0)
"""Largest goal attitude error [rad] of a path on the lattice whose correction is attempted."""
_CORRECTIONS = 12  # attempts, each without the corners that the one before could not prove


class RefusedEdge(NamedTuple):
    """An edge that could not be proven free.

    Attributes:
        layer: layer that the edge leaves.
        link: name of the nearest link.
        obstacle: index of the sphere in the scene, or name of the other link; None in an empty
            scene.
        distance: least distance met [m], negative in penetration.
    """

    layer: int
    link: str
    obstacle: int | str | None
    distance: float


class PathProof(NamedTuple):
    """A path with its exact motion, Coal's clearances and the edges that were refused.

    Attributes:
        motion: the motion along the path.
        prover: proofs along it.
        clearances: (m + 1,) at the nodes [m].
        refused: edges that could not be proven free.
        attitude_error: error of the goal attitude [rad]; 0 where none is demanded.
    """

    motion: Motion
    prover: Prover
    clearances: Array
    refused: list[RefusedEdge]
    attitude_error: float

    @property
    def holds(self) -> bool:
        """Whether all edges are proven free and the goal attitude is reached."""
        return not self.refused and self.attitude_error <= GOAL_TOLERANCE


def corners(lattice: PostureLattice, path: IntArray) -> tuple[Array, Array]:
    """Base positions and joint values along a path.

    Args:
        lattice: the lattice.
        path: (m + 1, 2) base offset and posture on each layer.

    Returns:
        (m + 1, 3) base origin in the world [m], and (m + 1, nd) joint values [rad or m].
    """
    positions = lattice.base.nominal.positions + lattice.base.offsets[path[:, 0]]
    return positions, lattice.joint_values[np.arange(len(path)), path[:, 1]]


def prove_path(lattice: PostureLattice, positions: Array, joints: Array) -> PathProof:
    """Prove the motion through base positions and joint values.

    Args:
        lattice: gives the problem.
        positions: (m + 1, 3) base origin in the world [m].
        joints: (m + 1, nd) joint values [rad or m].
    """
    problem = lattice.problem
    motion = Motion(problem.robot, problem.mode, problem.start, problem.goal, positions, joints)
    lattice.deadline.check()
    m = len(positions) - 1
    pace = problem.pace(m)
    prover = Prover(motion, problem.obstacles, problem.tolerance, lattice.deadline, pace)
    still = np.zeros(3)
    clearances = prover.clearances(np.arange(m + 1), np.zeros((m + 1, 3)))
    ends, none = np.column_stack([clearances[:-1], clearances[1:]]), np.zeros((m, 3))
    verdicts = prover.certify_all(np.arange(m), none, none, ends)
    refused = []
    for layer, (verdict, links) in enumerate(zip(verdicts, prover.links.verdicts(), strict=True)):
        if not verdict.free:
            near = prover.nearest(layer, still, still, verdict.time)
        elif not links.free:
            near = prover.links.nearest(layer, links.time)
        else:
            continue
        refused.append(RefusedEdge(layer, near.link, near.obstacle, near.distance))
    error = 0.0
    if problem.reach_attitude:
        error = float(angle_between(motion.attitudes[-1], problem.goal[3:7]))
    return PathProof(motion, prover, clearances, refused, error)


def corrected_proof(lattice: PostureLattice, proof: PathProof) -> tuple[PathProof, int]:
    """The path with its goal attitude error closed where that can be proven; and Coal queries.

    Where the corrected path is refused, the corners beside the refused edge are left unchanged and
    the others corrected. If that is refused too, the attitude there has to stay, so that the
    corners behind it are corrected only. Without a proven correction the path is returned as it is,
    and so is one that is not free, needs no correction or misses the attitude by too much.
    """
    if proof.refused or not GOAL_TOLERANCE < proof.attitude_error <= CORRECTABLE:
        return proof, 0
    problem, motion = lattice.problem, proof.motion
    directions = displacements(problem, lattice.base.nominal.joint_values)
    held = np.zeros(len(motion.positions), dtype=np.bool_)
    queries = 0
    for _ in range(_CORRECTIONS):
        joints = corrected(
            problem.robot, problem.start[3:7], problem.goal[3:7], motion.joint_values, directions,
            held, lattice.deadline,
        )  # fmt: skip
        if joints is None:
            break
        other = prove_path(lattice, motion.positions, joints)
        queries += other.prover.queries
        if other.holds:
            return other, queries
        for edge in other.refused:  # the original path has been proven there
            beside = slice(max(edge.layer - 1, 0), edge.layer + 3)
            if held[beside].all():
                beside = slice(edge.layer + 3)
            held[beside] = True
    return proof, queries


def least_clearance(proof: PathProof) -> tuple[float, int]:
    """Proven lower bound on the clearance along a path that is free [m], and Coal queries.

    Args:
        proof: of the path.

    Raises:
        OutOfTime: at the deadline.
    """
    before = proof.prover.queries
    still = np.zeros((len(proof.clearances), 3))
    least = proof.prover.least_clearance(still, proof.clearances)
    return least, proof.prover.queries - before


def check_start(problem: Problem) -> None:
    """Check that the start touches nothing.

    Raises:
        StartInCollision: with all that touches.
    """
    start = problem.start
    motion = Motion(problem.robot, problem.mode, start, start, np.tile(start[:3], (2, 1)))
    prover = Prover(motion, problem.obstacles.at(0.0), problem.tolerance)
    still = np.zeros(3)
    for near in (prover.nearest(0, still, still, 0.0), prover.links.nearest(0, 0.0)):
        if near.distance <= 0.0:
            raise start_in_collision(problem.robot, problem.obstacles.at(0.0), start)


def unproven(problem: Problem, edge: RefusedEdge, cut_short: bool) -> UnprovenPath:
    """The error for a path that could not be proven free.

    Args:
        problem: gives the scene and the lattice.
        edge: the first refused edge.
        cut_short: whether a time limit ended the search.
    """
    contact = named(problem.obstacles, Nearest(edge.distance, edge.link, edge.obstacle))
    advice = for_proof(problem, cut_short, isinstance(edge.obstacle, str))
    return UnprovenPath(
        edge.layer + 1,
        edge.link,
        edge.obstacle,
        edge.distance,
        problem.given_lattice.divisions,
        contact.source,
        advice,
    )


def length_of(lattice: PostureLattice, motion: Motion) -> float:
    """Length of a motion from its base offsets and joint displacements.

    Args:
        lattice: gives the nominal motion.
        motion: the motion.

    Returns:
        L of Eq. 6 [m].
    """
    nominal = lattice.base.nominal
    offsets = motion.positions - nominal.positions
    if motion.mode.floats:
        offsets = np.zeros_like(offsets)
    return path_length(lattice.problem, offsets, motion.joint_values - nominal.joint_values)


def objective_of(lattice: PostureLattice, proof: PathProof) -> float:
    """Objective of a proven path.

    Args:
        lattice: gives the nominal motion.
        proof: motion and clearances.

    Returns:
        F of Eq. 8 [length units].
    """
    return objective(lattice.problem, length_of(lattice, proof.motion), proof.clearances)
