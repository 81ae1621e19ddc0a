"""Travel of a robot's points along an edge, sampled, for comparison with the travel bound.

Sampling uses Pinocchio's kinematics along the motion and `Reaction` for the attitude. A polyline is
never longer than the path itself.
"""

from itertools import product
from typing import NamedTuple

import coal
import numpy as np
import pinocchio as pin

from ffsr_plan.core import rotations
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.proof.kernels.travel import BaseMotion
from ffsr_plan.proof.travel_bound import TravelBound
from tests.helpers.random_robots import Limb, Z, at, body, random_tree

SAMPLES = 24
ROUNDING = 1e-12


class SampledEdge(NamedTuple):
    """An edge: joints from `begin` by `step`, base from attitude `start`, reacting or rotated."""

    robot: object
    begin: np.ndarray
    step: np.ndarray
    start: np.ndarray = rotations.IDENTITY
    turn: "np.ndarray | None" = None

    def attitudes(self, times):
        if self.turn is not None:
            return rotations.multiply(self.start, rotations.exp(times[:, None] * self.turn))
        if self.robot.nd == 0:
            return np.tile(self.start, (len(times), 1))
        reaction = Reaction.along(self.robot, np.array([self.begin, self.begin + self.step]))
        edge = np.zeros(len(times), dtype=int)
        return rotations.multiply(self.start, reaction.rotation(edge, times))

    def joints(self, times):
        return self.begin + times[:, None] * self.step

    def travel(self, middles, lengths, error=0.0):
        bound, rates = TravelBound(self.robot), np.tile(self.step, (len(middles), 1))
        base = BaseMotion(True, False, np.zeros((len(middles), 3)), error)
        if self.turn is not None:
            base = BaseMotion(False, False, np.tile(self.turn, (len(middles), 1)), 0.0)
        return bound.in_world(self.joints(middles), rates, lengths, base, self.attitudes(middles))

    def in_base(self, middles, lengths):
        rates = np.tile(self.step, (len(middles), 1))
        travel = TravelBound(self.robot).in_base(self.joints(middles), rates, lengths)
        return travel.bounds(np.arange(len(middles)), np.zeros((len(middles), 3)))

    def places(self, middle, length, in_base=False):
        """Points of each shape, [(SAMPLES + 1, n, 3)], about the base origin."""
        times = middle + length * np.linspace(-0.5, 0.5, SAMPLES + 1)
        quats = rotations.IDENTITY if in_base else self.attitudes(times)
        shapes, data = self.robot.collision_model.geometryObjects, self.robot.model.createData()
        outlines = [outline(g) for g in shapes]
        found = [[] for _ in shapes]
        for q in self.robot.assemble(np.zeros(3), quats, self.joints(times)):
            pin.forwardKinematics(self.robot.model, data, q)
            for k, g in enumerate(shapes):
                pose = data.oMi[g.parentJoint]
                found[k].append(outlines[k] @ pose.rotation.T + pose.translation)
        return [np.array(f) for f in found]


def outline(geometry):
    """Points of a shape: corners and others, or the core of a sphere or capsule."""
    solid, rng = geometry.geometry, np.random.default_rng(0)
    if isinstance(solid, coal.Sphere):
        points = np.zeros((1, 3))
    elif isinstance(solid, coal.Capsule):
        points = np.outer([-1.0, -0.3, 0.5, 1.0], [0.0, 0.0, solid.halfLength])
    elif isinstance(solid, coal.Box):
        points = np.array(list(product((-1.0, 1.0), repeat=3)))
        points = np.concatenate([points, rng.uniform(-1, 1, (3, 3))]) * solid.halfSide
    else:
        points = solid.points()
    return points @ geometry.placement.rotation.T + geometry.placement.translation


def lengths_of(places, base_step, length):
    """(g,) longest path of any point of each shape [m]."""
    shift = length * np.linspace(0.0, 1.0, SAMPLES + 1)[:, None, None] * base_step
    steps = [np.linalg.norm(np.diff(p + shift, axis=0), axis=2) for p in places]
    return np.array([np.sum(s, axis=0).max() for s in steps])


def case(seed, held):
    """A random robot on an edge, and four intervals of it, from the whole to 1/64."""
    rng, robot = np.random.default_rng(seed), random_tree(seed)
    step = rng.normal(size=robot.nd) * 10.0 ** rng.uniform(-2.0, 0.3)
    turn = rng.normal(size=3) * 10.0 ** rng.uniform(-2.0, 0.3) if held else None
    start = rotations.exp(rng.normal(size=3))
    way = SampledEdge(robot, rng.uniform(-1.5, 1.5, robot.nd), step, start, turn)
    lengths = 0.5 ** rng.uniform(0.0, 6.0, 4)
    lengths[0] = 1.0
    return way, rng, rng.uniform(0.5 * lengths, 1.0 - 0.5 * lengths), lengths


def base_steps(rng, travel):
    """Base steps, random or such that a point hardly moves and only its curvature remains."""
    count, points = travel.points["speed"].shape
    steps = rng.normal(size=(count, 3)) * rng.uniform(0, 0.5, (count, 1))
    against = -travel.points["velocity"][np.arange(count), rng.integers(points, size=count)]
    return np.where(rng.random((count, 1)) < 0.5, steps, against)


def tightness(way, base_step=None, length=1.0, middle=0.5):
    """(g,) sampled travel / T of each shape; by default the base step stops the last point."""
    travel = way.travel(np.array([middle]), np.array([length]))
    step = -travel.points["velocity"][0, -1] if base_step is None else base_step
    bound = travel.bounds(0, step)
    sampled = lengths_of(way.places(middle, length), step, length)
    assert np.all(sampled <= bound + ROUNDING)
    return sampled / bound


STILL = np.zeros(3)


def limb(kind, axis=Z, place=None, mass=1e-9, moment=1e-12, lever=(0, 0, 0), shapes=(), parent=0):
    """A limb, by default of almost no mass, so that the base does not react."""
    return Limb(parent, kind, axis, place or at(), body(mass, moment, lever), list(shapes))
