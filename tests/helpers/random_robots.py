"""Robots built joint by joint, with all kinds of joints and shapes, hulls included."""

from typing import NamedTuple

import coal
import numpy as np
import pinocchio as pin

from ffsr_plan.core import rotations
from ffsr_plan.robots.robot import SpaceRobot

KINDS = {
    "revolute": pin.JointModelRevoluteUnaligned,
    "prismatic": pin.JointModelPrismaticUnaligned,
}
ALONG_AXES = {
    "revolute": (pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ),
    "continuous": (pin.JointModelRUBX, pin.JointModelRUBY, pin.JointModelRUBZ),
    "prismatic": (pin.JointModelPX, pin.JointModelPY, pin.JointModelPZ),
}
Z = (0.0, 0.0, 1.0)


class Limb(NamedTuple):
    """A link with the joint to its parent.

    Attributes:
        parent: 0 for the base, k for the k-th limb.
        kind: kind of the joint.
        axis: 0, 1 or 2 for x, y or z, or a unit vector.
        place: placement of the joint in the parent's frame.
        body: mass and inertia.
        shapes: pairs of a Coal solid and its placement.
    """

    parent: int
    kind: str
    axis: "int | tuple[float, float, float]"
    place: pin.SE3
    body: pin.Inertia
    shapes: list


def at(x=0.0, y=0.0, z=0.0):
    return pin.SE3(np.eye(3), np.array([x, y, z]))


def body(mass, moment, xyz=(0.0, 0.0, 0.0)):
    """Mass and principal moments about the centre of mass, one number if they are equal."""
    return pin.Inertia(mass, np.array(xyz, dtype=float), np.diag(np.broadcast_to(moment, 3)))


def dot(x=0.0, y=0.0, z=0.0):
    """A small sphere: a shape of which one point matters."""
    return coal.Sphere(0.01), at(x, y, z)


def put_together(base, base_shapes, limbs):
    model, shapes = pin.Model(), pin.GeometryModel()
    model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root")
    for k, limb in enumerate(limbs):
        along = isinstance(limb.axis, int)
        made = (
            ALONG_AXES[limb.kind][limb.axis]() if along else KINDS[limb.kind](np.array(limb.axis))
        )
        model.addJoint(limb.parent + 1, made, limb.place, f"j{k}")
    for j, (inertia, solids) in enumerate(
        [(base, base_shapes), *((limb.body, limb.shapes) for limb in limbs)]
    ):
        model.appendBodyToJoint(j + 1, inertia, pin.SE3.Identity())
        for n, (solid, place) in enumerate(solids):
            shapes.addGeometryObject(pin.GeometryObject(f"{j}_{n}", j + 1, place, solid))
    return SpaceRobot("made", "", model, shapes, pin.GeometryModel())


def random_tree(seed, arms=2, depth=4):
    """Joints and shapes of all kinds; bases from far lighter than the arms to far heavier."""
    rng = np.random.default_rng(seed)
    scale = 10.0 ** rng.uniform(-1.5, 1.0)  # of the base's mass and size against a link's
    base = pin.Inertia(2.0 * scale, 0.1 * rng.normal(size=3), _moments(rng, 0.4 * scale))
    limbs = []
    for _ in range(arms):
        parent = 0
        for _ in range(int(rng.integers(1, depth + 1))):
            kind = str(rng.choice(list(ALONG_AXES)))
            axis = rng.normal(size=3)
            aligned = kind == "continuous" or rng.random() < 0.6
            reach = _somewhere(rng, 0.6)
            mass = rng.uniform(0.1, 3.0)
            limbs.append(
                Limb(
                    parent,
                    kind,
                    int(rng.integers(3)) if aligned else tuple(axis / np.linalg.norm(axis)),
                    _somewhere(rng, 0.8),
                    pin.Inertia(mass, reach.translation, _moments(rng, 0.1 * mass)),
                    [(_solid(rng), reach)],
                )
            )
            # sometimes an arm branches
            parent = len(limbs) if rng.random() < 0.85 else parent
    return put_together(base, [(_solid(rng), _somewhere(rng, 0.3))], limbs)


def _somewhere(rng, reach):
    turn = rotations.matrix(rotations.exp(rng.normal(size=3) * rng.choice([0.0, 1.5])))
    return pin.SE3(turn, rng.uniform(-reach, reach, 3))


def _moments(rng, size):
    """Inertia of a random body, slender, flat or round, in random axes."""
    x, y, z = 10.0 ** rng.uniform(-2.0, 0.0, 3) * size
    turn = rotations.matrix(rotations.exp(rng.normal(size=3)))
    return turn @ np.diag([y + z, x + z, x + y]) @ turn.T


def _solid(rng):
    kind = rng.integers(4)
    if kind == 0:
        return coal.Sphere(rng.uniform(0.03, 0.2))
    if kind == 1:
        return coal.Capsule(rng.uniform(0.03, 0.1), rng.uniform(0.1, 0.8))
    if kind == 2:
        return coal.Box(*rng.uniform(0.05, 0.5, 3))
    cloud = coal.BVHModelOBBRSS()
    cloud.beginModel(0, 12)
    cloud.addVertices(rng.uniform(-0.3, 0.3, (12, 3)))
    cloud.endModel()
    cloud.buildConvexHull(True, "Qt")
    return cloud.convex
