"""Motions of random robots past obstacles of every shape that they graze, and what is proven.

Every motion that `Prover` calls free is looked at densely by the verification's distances, which
share no code with the planner's.
"""

from dataclasses import replace
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.prover import Prover
from ffsr_plan.scene.shapes.keep_in_zones import HalfSpace
from ffsr_plan.scene.shapes.obstacle_shapes import Ball, Box
from ffsr_plan.verification.motion_samples import samples_of
from ffsr_plan.verification.separation import SampledDistances
from ffsr_plan.verification.urdf_reading import Bodies
from tests.helpers.obstacle_shapes import random_shape
from tests.helpers.urdf_builders import box, capsule, cylinder, random_robot

SAMPLES = 400
TOLERANCE = 1e-4
SURELY_FREE = 1e-3
ZONES = ("zone box", "zone ball", "half-space")


class Counts(NamedTuple):
    """Numbers of edges."""

    free: int = 0
    false_free: int = 0
    refused: int = 0
    wrongly_refused: int = 0
    grazing_free: int = 0
    """Free ones that come nearer than a millimetre."""


def look_at(seed, kind, scenes=5):
    """One motion of one robot past obstacles of a kind that it grazes, in several scenes."""
    rng = np.random.default_rng(seed)
    solids = (bar, capsule, cylinder) if seed % 4 == 0 else (bar, capsule)  # hulls take their time
    robot = random_robot(seed, solids=solids)
    values = rng.uniform(-1.0, 1.0, robot.nd)
    step = rng.normal(size=robot.nd) * 10.0 ** rng.uniform(-2.0, 0.0)
    begin, end = (
        robot.configuration(p, a, dict(zip(robot.joint_names, v.tolist(), strict=True)))
        for p, a, v in (
            (np.zeros(3), rng.uniform(-1.3, 1.3, 3), values),
            (rng.normal(size=3) * 0.3, rng.uniform(-1.3, 1.3, 3), np.clip(values + step, -3, 3)),
        )
    )
    mode = list(Mode)[int(rng.integers(len(Mode)))]
    motion = Motion(robot, mode, begin, end, np.stack([begin[:3], end[:3]]))
    q = motion.at(np.zeros(SAMPLES + 1, dtype=np.int64), np.linspace(0.0, 1.0, SAMPLES + 1))
    counts, look = Counts(), Look(robot, q)
    for _ in range(scenes):
        scene = grazing(rng, kind, look)
        prover = Prover(motion, scene, TOLERANCE)
        ends = tuple(prover.clearances(np.array([0, 1]), np.zeros((2, 3))).tolist())
        verdict = prover.certify(0, np.zeros(3), np.zeros(3), ends) if min(ends) > 0.0 else None
        free = verdict is not None and verdict.free
        least = look.least(scene, look.all)
        if verdict is not None and not free and least > SURELY_FREE:
            least = look.least(scene, look.around(motion, verdict.time))
        counts = Counts(
            counts.free + free,
            counts.false_free + (free and least <= 0.0),
            counts.refused + (not free),
            counts.wrongly_refused + (not free and least > SURELY_FREE),
            counts.grazing_free + (free and least < SURELY_FREE),
        )
    return counts


def bar(radius, length, *place):
    """A box about as large as a capsule."""
    return box((2.0 * radius, 2.0 * radius, length), *place)


class Look:
    """Distances along a motion by the verification.

    Attributes:
        all: all its samples.
        few: one in twenty of them.
    """

    def __init__(self, robot, q):
        self._bodies, self._start = Bodies(robot.urdf, robot.srdf, robot.replacements), q[0, :3]
        self._owner = SimpleNamespace(problem=SimpleNamespace(robot=robot, start=q[0]))
        self.all, self.few = self._samples(q), self._samples(q[:: len(q) // 50])

    def _samples(self, q):
        still = np.zeros((len(q), self._owner.problem.robot.nd))
        return samples_of(self._owner, self._bodies, q, np.zeros(len(q)), still)

    def around(self, motion, time):
        """Samples between those before and after a time, where links may have come and gone."""
        near = np.clip(time + np.linspace(-1.0, 1.0, SAMPLES + 1) / SAMPLES, 0.0, 1.0)
        return self._samples(motion.at(np.zeros(SAMPLES + 1, dtype=np.int64), near))

    def least(self, scene, samples):
        """The least distance at some samples [m]."""
        distances, count = SampledDistances(self._bodies, scene, self._start), len(samples.turns)
        still = np.zeros((count, distances.outer))  # one stretch is enough for one obstacle
        whole = np.zeros(count, dtype=np.int64)
        distances.stretches(whole, samples.instants, distances.middles(samples), still)
        which = np.repeat(np.arange(count), distances.outer)
        part, whole_way = np.tile(np.arange(distances.outer), count), np.zeros(len(which), np.int64)
        return float(np.min(distances.at(samples, which, part, whole_way, np.zeros(len(which)))))


def grazing(rng, kind, look):
    """A scene of one obstacle that a motion comes near, within millimetres."""
    gap, far = rng.uniform(-2e-3, 3e-3), 3.0
    way = rng.normal(size=3)
    way /= np.linalg.norm(way)
    made = placed_zone(rng, kind, way) if kind in ZONES else placed_shape(rng, kind, way)
    for k in range(7):  # the least distance changes by at most as much as the obstacle moves
        far -= look.least(made(far), look.few if k < 6 else look.all) - gap
    return made(far)


def placed_shape(rng, kind, way):
    """A random shape, by how far out along a direction it lies."""
    shape = random_shape(rng, kind, np.zeros(3), np.full(3, 1e-9))
    return lambda far: fp.Scene(shapes=[replace(shape, position=far * way)])


def placed_zone(rng, kind, way):
    """A zone whose boundary lies so far out."""
    angles = rng.uniform(-3.0, 3.0, 3)
    if kind == "zone box":
        return lambda far: fp.Scene(
            keep_in=[Box(np.full(3, 2.0 * max(far, 0.0)), 0.2 * way, angles)]
        )
    if kind == "zone ball":
        return lambda far: fp.Scene(keep_in=[Ball(max(far, 1e-3), 0.2 * way)])
    return lambda far: fp.Scene(keep_in=[HalfSpace(way, far * way)])
