"""Motions of random robots past obstacles that they graze, and what is proven of them.

Every motion that `Prover` calls free is looked at densely by other code than the planner's: the
URDF read by yourdfpy, distances in closed form.
"""

from typing import NamedTuple

import numpy as np

import ffsr_plan as fp
from ffsr_plan.dynamics.actuation_mode import Mode
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.prover import Prover
from ffsr_plan.verification.urdf_reading import Bodies, pose
from tests.helpers.solid_distances import least_sphere_distance
from tests.helpers.urdf_builders import capsule, cylinder, random_robot

SAMPLES = 2000
TOLERANCE = 1e-4
SURELY_FREE = 1e-3


class Counts(NamedTuple):
    """What came out; all but the last three are numbers of edges."""

    free: int = 0
    false_free: int = 0
    refused: int = 0
    wrongly_refused: int = 0
    grazing_free: int = 0
    """Free ones that come nearer than a millimetre."""
    queries: int = 0
    unasked: int = 0
    """Free ones that needed no query between their ends."""

    def plus(self, other: "Counts") -> "Counts":
        """The sum."""
        return Counts(*(a + b for a, b in zip(self, other, strict=True)))


def look_at(seed: int, scenes: int = 12) -> Counts:
    """One motion of one robot among obstacles that it grazes, in several scenes."""
    rng = np.random.default_rng(seed)
    solids = (capsule, cylinder) if seed % 10 == 0 else (capsule,)  # hulls take their time
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
    bodies = Bodies(robot.urdf, robot.srdf, robot.replacements)
    joints = dict(zip(robot.joint_names, robot.joint_values(q).T, strict=True))
    poses = bodies.link_poses(pose(q[:, :3], q[:, 3:7]), joints)
    placed = [poses[shape.link] @ shape.placement for shape in bodies.shapes]
    counts = Counts()
    for _ in range(scenes):
        scene, clearance = grazing_scene(rng, bodies, placed)
        if scene is None:
            continue
        prover = Prover(motion, scene, TOLERANCE)
        still = np.zeros(3)
        ends = prover.clearances(np.array([0, 1]), np.zeros((2, 3)))
        verdict = prover.certify(0, still, still, (float(ends[0]), float(ends[1])))
        counts = counts.plus(
            Counts(
                free=verdict.free,
                false_free=verdict.free and clearance <= 0.0,
                refused=not verdict.free,
                wrongly_refused=not verdict.free and clearance > SURELY_FREE,
                grazing_free=verdict.free and clearance < SURELY_FREE,
                queries=verdict.queries if verdict.free else 0,
                unasked=verdict.free and verdict.queries == 0,
            )
        )
    return counts


def grazing_scene(
    rng: np.random.Generator, bodies: Bodies, placed: list[np.ndarray]
) -> tuple[fp.Scene | None, float]:
    """One to three spheres beside the motion, and the least clearance over all samples [m]."""
    centers, radii, least = [], [], np.inf
    for _ in range(int(rng.integers(1, 4))):
        track = placed[int(rng.integers(len(placed)))][:, :3, 3]
        center = track[int(rng.integers(len(track)))] + rng.normal(size=3) * 0.25
        away = least_distance(bodies, placed, center)
        spare = 10.0 ** rng.uniform(-4.7, -2.0) * (1.0 if rng.random() < 0.9 else -1.0)
        if away - spare > 1e-3:
            centers.append(center)
            radii.append(away - spare)
            least = min(least, spare)
    return (fp.Scene(centers, radii), least) if radii else (None, least)


def least_distance(bodies: Bodies, placed: list[np.ndarray], center: np.ndarray) -> float:
    """Least signed distance of a point from all shapes over all samples [m].

    Shapes and samples that are farther away than what is found already are left out, by the
    distance of a ball about the shape's origin.
    """
    least, rows = np.inf, []
    for shape, at in zip(bodies.shapes, placed, strict=True):
        corners = shape.points if shape.half is None else shape.half[None]
        reach = float(np.linalg.norm(corners, axis=1).max()) + shape.swell
        rows.append((np.linalg.norm(center - at[:, :3, 3], axis=1) - reach, shape, at))
    for bounds, shape, at in sorted(rows, key=lambda row: row[0].min()):
        nearest = int(np.argmin(bounds))
        for chosen in (slice(nearest, nearest + 1), None):
            near = at[chosen] if chosen is not None else at[bounds < least]
            if len(near):
                found = least_sphere_distance(shape, near, center[None], np.zeros(1))
                least = min(least, found)
    return least
