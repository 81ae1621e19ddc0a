"""Distances, centre of mass and step lengths at dense samples of a plan's motion."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.verification.separation import separation
from ffsr_plan.verification.solids import Shape, least_sphere_distance
from ffsr_plan.verification.urdf_reading import Bodies, pose

if TYPE_CHECKING:
    from ffsr_plan.plans.plan_data import PlanData

_BOUNDING_SPHERE_GAP = 0.02  # [m] pairs farther apart are bounded by their bounding spheres


class EdgeSamples(NamedTuple):
    """Results of dense samples on one edge.

    Attributes:
        clearance: least distance of a link to an obstacle [m].
        separation: least lower bound on the distance of two links that must not touch [m].
        centers_of_mass: (n, 3) of the whole robot, world axes [m].
        largest_step: longest displacement of a shape's centre between two samples [m].
    """

    clearance: float
    separation: float
    centers_of_mass: Array
    largest_step: float


def sample_edges(plan: PlanData, bodies: Bodies, samples: int) -> list[EdgeSamples]:
    """Sample every edge of a plan.

    Args:
        plan: the plan.
        bodies: the robot, from its URDF.
        samples: number of equal time steps on each edge.

    Returns:
        The results, edge by edge.
    """
    pairs = bodies.pairs()
    divisions = plan.problem.lattice.divisions
    results = []
    for edge in range(divisions):
        q = plan.at(np.minimum((edge + np.linspace(0.0, 1.0, samples + 1)) / divisions, 1.0))
        poses = link_poses(plan, bodies, q)
        placed = [poses[s.link] @ s.placement for s in bodies.shapes]
        steps = [np.linalg.norm(np.diff(p[:, :3, 3], axis=0), axis=1).max() for p in placed]
        results.append(
            EdgeSamples(
                _least_clearance(plan, bodies.shapes, placed),
                _least_separation(pairs, dict(zip(bodies.shapes, placed, strict=True))),
                _centers_of_mass(bodies, poses),
                max([0.0, *map(float, steps)]),
            )
        )
    return results


def link_poses(plan: PlanData, bodies: Bodies, q: Array) -> dict[str, Array]:
    """Poses of all links by name.

    Args:
        plan: the plan, for the names of the joints.
        bodies: the robot, from its URDF.
        q: (N, nq) configurations.

    Returns:
        (N, 4, 4) for each link, link axes to world axes.
    """
    robot = plan.problem.robot
    values = robot.joint_values(q)
    joints = {name: values[:, k] for k, name in enumerate(robot.joint_names)}
    return bodies.link_poses(pose(q[:, :3], q[:, 3:7]), joints)


def _centers_of_mass(bodies: Bodies, poses: dict[str, Array]) -> Array:
    """(N, 3) of the whole robot in the world [m]."""
    mass, moment = 0.0, np.zeros(3)
    for link, inertial in bodies.inertials.items():
        frame = poses[link] @ (np.eye(4) if inertial.origin is None else inertial.origin)
        mass, moment = mass + inertial.mass, moment + inertial.mass * frame[:, :3, 3]
    return moment / mass


def _least_clearance(plan: PlanData, shapes: list[Shape], placed: list[Array]) -> float:
    """Least distance over all samples, without the spheres that cannot be the nearest."""
    centers, radii = plan.problem.scene.centers, plan.problem.scene.radii
    least = np.inf
    if len(radii) == 0:
        return least
    for shape, at in zip(shapes, placed, strict=True):
        track = at[:, :3, 3]
        middle = track.mean(axis=0)
        extent = float(np.linalg.norm(track - middle, axis=1).max())
        distance = np.linalg.norm(centers - middle, axis=1) - radii
        near = distance - extent - shape.radius <= min(least, float(distance.min()) + extent)
        if near.any():
            least = min(least, least_sphere_distance(shape, at, centers[near], radii[near]))
    return least


def _least_separation(pairs: list[tuple[Shape, Shape]], placed: dict[Shape, Array]) -> float:
    """Least lower bound over all samples of all pairs, by bounding spheres for distant pairs."""
    least = np.inf
    for a, b in pairs:
        pose_a, pose_b = placed[a], placed[b]
        gap = np.linalg.norm(pose_a[:, :3, 3] - pose_b[:, :3, 3], axis=1) - a.radius - b.radius
        close = gap <= _BOUNDING_SPHERE_GAP
        least = min(least, float(np.min(gap[~close], initial=np.inf)))
        if close.any():
            least = min(least, float(separation(a, pose_a[close], b, pose_b[close]).min()))
    return least
