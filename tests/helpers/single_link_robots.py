"""Robots of one link, and meshes for it."""

import numpy as np
import trimesh

from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.urdf_builders import inertial, link, urdf

MASS = inertial(2.0, (1.0, 1.0, 1.0))


def one_link(*shapes, **options):
    return robot_from_urdf(urdf(link("base", MASS, *shapes)), "one", **options)


def blob(seed, count=20):
    """A mesh without symmetry, off its frame's origin."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(count, 3)) * rng.uniform(0.03, 0.2, 3) + rng.uniform(-0.3, 0.3, 3)
    return trimesh.convex.convex_hull(points)


def inside_out(solid, points):
    """Signed distances of points from a trimesh solid, positive outside, by trimesh alone."""
    return -trimesh.proximity.signed_distance(solid, points)
