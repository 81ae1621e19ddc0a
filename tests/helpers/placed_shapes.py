"""Robot solids and obstacle shapes at random places, and their distances by scipy alone.

The point of a body that lies farthest along a direction is written down here from its sizes. If
the farthest points of two bodies along n and -n are put d apart along n, then d is their distance,
which takes no algorithm. At other places the nearest points are sought by sequential quadratic
programming over convex weights; the distance of any two points of the bodies is an upper bound.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
from scipy.optimize import minimize
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

import ffsr_plan as fp
from ffsr_plan.scene.shapes.obstacle_shapes import Ball, Box, Capsule, Cylinder, Ellipsoid, Hull
from ffsr_plan.verification import solids
from ffsr_plan.verification.motion_samples import Samples
from ffsr_plan.verification.separation import SampledDistances

_HERE = np.eye(4)
_SIGNS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])


def quaternion(rng):
    """(4,) a random attitude."""
    quat = rng.normal(size=4)
    return quat / np.linalg.norm(quat)


def sizes(rng, most, count):
    """Lengths from a hundredth of `most` [m] on, most of them short."""
    return (most * 10.0 ** rng.uniform(-2.0, 0.0, count)).tolist()


def polytope(rng, swell=0.0, count=12):
    """A robot solid: the hull of points, widened."""
    return solids.Shape("link", _HERE, rng.normal(size=(count, 3)) * 0.3 + 0.2, swell)


SOLIDS = {
    "box": lambda rng: solids.box("link", _HERE, np.array(sizes(rng, 0.6, 3))),
    "ball": lambda rng: solids.ball("link", _HERE, *sizes(rng, 0.6, 1)),
    "capsule": lambda rng: solids.capsule("link", _HERE, *sizes(rng, 0.6, 2)),
    "polytope": polytope,
    "widened polytope": lambda rng: polytope(rng, *sizes(rng, 0.3, 1)),
}
"""Makers of every kind of robot solid."""

SHAPES = {
    "box": lambda rng: Box(sizes(rng, 2.0, 3), attitude=quaternion(rng)),
    "panel": lambda rng: Box([*sizes(rng, 3.0, 2), 0.0], attitude=quaternion(rng)),
    "rod": lambda rng: Box([0.0, *sizes(rng, 3.0, 1), 0.0], attitude=quaternion(rng)),
    "ball": lambda rng: Ball(*sizes(rng, 2.0, 1)),
    "capsule": lambda rng: Capsule(*sizes(rng, 2.0, 2), attitude=quaternion(rng)),
    "cylinder": lambda rng: Cylinder(*sizes(rng, 2.0, 2), attitude=quaternion(rng)),
    "ellipsoid": lambda rng: Ellipsoid(sizes(rng, 2.0, 3), attitude=quaternion(rng)),
    "hull": lambda rng: Hull(rng.normal(size=(15, 3)) + 3.0, attitude=quaternion(rng)),
}
"""Makers of every kind of obstacle shape, flat boxes too, about the origin."""


def moved(shape, by):
    """A shape, displaced by (3,) [m]."""
    return replace(shape, position=shape.position + by)


def turn_of(shape):
    """(3, 3) rotation of a shape's axes."""
    return Rotation.from_quat(shape.attitude).as_matrix()


def corners_of(shape):
    """(n, 3) corners along a shape's axes; a shape without corners has its middle or its ends."""
    if isinstance(shape, Box):
        return 0.5 * _SIGNS * shape.size
    if isinstance(shape, (Capsule, Cylinder)):
        return np.array([[0, 0, -0.5 * shape.length], [0, 0, 0.5 * shape.length]])
    return shape.points if isinstance(shape, Hull) else np.zeros((1, 3))


def round_part(shape):
    """(3,) semi-axes of the ellipsoid at every corner of a shape [m]."""
    if isinstance(shape, (Ball, Capsule)):
        return np.full(3, shape.radius)
    if isinstance(shape, Cylinder):
        return np.array([shape.radius, shape.radius, 0.0])
    return shape.semi_axes if isinstance(shape, Ellipsoid) else np.zeros(3)


def farthest_of_shape(shape, direction):
    """(3,) the point of a shape in the world that lies farthest along a direction [m]."""
    local = direction @ turn_of(shape)
    corners, axes = corners_of(shape), round_part(shape)
    point = corners[np.argmax(corners @ local)]
    size = np.linalg.norm(axes * local)
    if size > 0.0:
        point = point + axes**2 * local / size
    return turn_of(shape) @ point + shape.position


def farthest_of_solid(solid, turn, place, direction):
    """(3,) the same of a robot solid at a rotation (3, 3) and a place (3,)."""
    points = solid.points @ turn.T + place
    return points[np.argmax(points @ direction)] + solid.swell * direction


def middle_and_depth(points, axes):
    """A point of a hull with an ellipsoid added, and the radius of a ball about it inside [m]."""
    middle = np.mean(points, axis=0)
    spans = np.linalg.matrix_rank(points - middle, tol=1e-9) == 3
    hull = ConvexHull(points).equations if spans else np.zeros((1, 4))
    depth = float(np.min(-hull[:, 3] - hull[:, :3] @ middle))
    if len(points) == 2 and axes[2] == 0.0:  # a cylinder
        return middle, min(axes[0], abs(points[1, 2]))
    return middle, depth + float(axes.min())


def directions(rng, solid, turn, shape):
    """Directions of all kinds of contacts: any, along axes of both bodies, across edges of both."""
    own, other = turn.T, turn_of(shape).T
    across = np.cross(own[:, None], other[None]).reshape(-1, 3)
    level = rng.normal(size=3)
    level -= other[2] * (level @ other[2])  # across the axis of a cylinder
    some = [rng.normal(size=3), level, own[rng.integers(3)], other[rng.integers(3)]]
    some.append(across[rng.integers(len(across))])
    return [d / np.linalg.norm(d) * rng.choice([-1.0, 1.0]) for d in some]


def nearest_points(solid, turn, place, shape):
    """An upper bound on the distance of a solid from a shape [m]; sharp where they are apart."""
    a = solid.points @ turn.T + place
    b = corners_of(shape) @ turn_of(shape).T + shape.position
    ball = isinstance(shape, (Ball, Capsule))
    axes = np.zeros(3) if ball else round_part(shape)
    skin = shape.radius if ball else 0.0
    n, m = len(a), len(b)

    def between(v):
        return v[:n] @ a - v[n : n + m] @ b - turn_of(shape) @ (axes * v[n + m :])

    def slope(v):
        d = between(v)
        return 2.0 * np.concatenate([a @ d, -b @ d, -axes * (turn_of(shape).T @ d)])

    limits = [
        {"type": "eq", "fun": lambda v: v[:n].sum() - 1.0},
        {"type": "eq", "fun": lambda v: v[n : n + m].sum() - 1.0},
        {"type": "ineq", "fun": lambda v: 1.0 - v[n + m :] @ v[n + m :]},
    ]
    bounds = [(0.0, 1.0)] * (n + m) + [(-1.0, 1.0)] * 3
    v = np.concatenate([np.full(n, 1.0 / n), np.full(m, 1.0 / m), np.zeros(3)])
    square = np.inf
    while square - between(v) @ between(v) > 1e-9:  # it stops early at times: begin anew
        square = between(v) @ between(v)
        v = minimize(
            lambda v: between(v) @ between(v), v, jac=slope, bounds=bounds, constraints=limits,
            method="SLSQP", options={"ftol": 1e-15, "maxiter": 100},
        ).x  # fmt: skip
    v[: n + m] = np.clip(v[: n + m], 0.0, None)  # so that both points do lie in the bodies
    v[:n] /= v[:n].sum()
    v[n : n + m] /= v[n : n + m].sum()
    v[n + m :] /= max(1.0, np.linalg.norm(v[n + m :]))
    return float(np.linalg.norm(between(v))) - solid.swell - skin


def samples_at(base_turns, base_places, turns, places):
    """Samples of one configuration or more: rotations and places of the base and of the solids."""
    return Samples(base_turns, base_places, turns, places, *[None] * 4)


def placed_samples(rng, turns, places):
    """Samples of which the solids' rotations (N, s, 3, 3) and places (N, s, 3) are known [m].

    The base has any other pose; what is relative to it follows.
    """
    count = len(places)
    base = Rotation.from_quat(rng.normal(size=(count, 4))).as_matrix()
    at = rng.normal(size=(count, 3)) * 3.0
    inverse = np.swapaxes(base, 1, 2)[:, None]
    relative = np.einsum("nsij,nsj->nsi", inverse, places - at[:, None])
    return samples_at(base, at, np.ascontiguousarray(inverse @ turns), relative)


def robot_of(*shapes):
    """A robot of solids that ignore one another, in place of one read from a URDF."""
    return SimpleNamespace(shapes=list(shapes), pairs=list)


def measured(rng, solid, turn, place, scene, origin=(0.0, 0.0, 0.0)):
    """Signed distance of a solid from a scene, by the verification [m]."""
    origin = np.array(origin)
    distances = SampledDistances(robot_of(solid), scene, origin)
    samples = placed_samples(rng, turn[None, None], (place - origin)[None, None])
    return float(distances.clearances(samples)[0])


def scene_of(*shapes, **others):
    """A scene of shapes."""
    return fp.Scene(shapes=shapes, **others)
