"""Problems of six kinds without a lattice, drawn by seed.

They are of the kinds of `problems.json`, drawn anew and independently, so that what was measured
there can be measured again on problems that no one has seen. In kinds 1 to 5 the straight motion
from start to goal is not free.
"""

from collections.abc import Callable
from functools import cache

import numpy as np

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.proof.prover import Prover

UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])
STOWED = np.array([0.0, -3.1, 0.0, -1.6, 0.0, 0.0])


def drawn(kind: int, seed: int) -> fp.Problem:
    """The problem of a kind that belongs to a seed."""
    rng = np.random.default_rng([kind, seed])
    while (problem := KINDS[kind](rng)) is None:
        pass
    return problem


def among_spheres(rng: np.random.Generator) -> fp.Problem | None:
    """Kind 1: both postures at random within the limits, 5 m apart, 8 to 14 spheres."""
    robot, count = loaded("planar_dual_arm"), int(rng.integers(8, 15))
    centers = rng.uniform([0.6, -2.2, 0.0], [4.4, 2.2, 0.0], (count, 3))
    scene = fp.Scene(centers, rng.uniform(0.12, 0.4, count))
    postures = rng.uniform(robot.lower, robot.upper, (2, robot.nd))
    return _across(robot, scene, *postures, 5.0, ((-1.0, -3.0, 0.0), (6.0, 3.0, 0.0)))


def through_walls(rng: np.random.Generator) -> fp.Problem | None:
    """Kind 2: one or two walls with a gap of 0.95 to 1.25 m, arms stretched out at both ends."""
    robot, rows, radii = loaded("planar_dual_arm"), [], []
    for x in [2.0] if rng.random() < 0.5 else [1.6, 3.4]:
        middle, gap, radius = (
            rng.uniform(-0.6, 0.6),
            rng.uniform(0.95, 1.25),
            rng.uniform(0.15, 0.3),
        )
        for side in (-1.0, 1.0):
            rows.append(_row((x, middle + side * (0.5 * gap + radius)), (x, side * 3.6), radius))
            radii.append(np.full(len(rows[-1]), radius))
    scene = fp.Scene(np.concatenate(rows), np.concatenate(radii))
    posture = np.clip(rng.normal(0.0, 0.25, robot.nd), robot.lower, robot.upper)
    window = ((-1.0, -3.0, 0.0), (6.0, 3.0, 0.0))
    return _across(robot, scene, posture, posture, 5.0, window)


def out_of_a_cup(rng: np.random.Generator) -> fp.Problem | None:
    """Kind 3: the start lies in a cup that is open backwards."""
    robot = loaded("planar_dual_arm")
    radius, half, depth = rng.uniform(0.12, 0.25), rng.uniform(1.25, 1.6), rng.uniform(1.3, 1.8)
    back = rng.uniform(-1.0, 0.2)
    centers = np.concatenate(
        [
            _row((depth, -half), (depth, half), radius),
            _row((back, half), (depth, half), radius),
            _row((back, -half), (depth, -half), radius),
        ]
    )
    folded = np.array([1.0, 1.6, 0.0, -1.0, -1.6, 0.0]) * rng.uniform()
    start = np.clip(folded + rng.normal(0.0, 0.5, robot.nd), robot.lower, robot.upper)
    goal = 0.6 * rng.uniform(robot.lower, robot.upper)
    scene = fp.Scene(centers, np.full(len(centers), radius))
    return _across(robot, scene, start, goal, 5.0, ((-3.0, -4.0, 0.0), (6.5, 4.0, 0.0)))


def beside_a_box(rng: np.random.Generator) -> fp.Problem | None:
    """Kind 4: a free-floating arm puts its tool beside or behind a box covered by spheres."""
    robot = loaded("satellite_ur5")
    half, radius = rng.uniform([0.12, 0.2, 0.15], [0.25, 0.4, 0.35]), rng.uniform(0.05, 0.09)
    middle = rng.uniform([0.85, -0.3, 0.85], [1.05, 0.3, 1.15])
    turn = rotations.matrix(rotations.exp(rng.normal(0.0, 0.3, 3)))
    shell = _shell(half, radius) @ turn.T
    scene = fp.Scene(middle + shell, np.full(len(shell), radius))
    start = robot.assemble(np.zeros(3), UPRIGHT, STOWED)
    low = [-np.pi, -np.pi, -2.8, -np.pi, -np.pi, -1.0]
    for _ in range(3000):
        posture = rng.uniform(low, [np.pi, 0.5, 2.8, np.pi, np.pi, 1.0])
        tool = robot.tree.poses(posture[None]).origins[0, -1]
        local = (tool - middle) @ turn
        if np.max(np.abs(local) - half) > radius + 0.3 or local[0] < -0.05:
            continue
        goal = robot.assemble(np.zeros(3), UPRIGHT, posture)
        if (found := _blocked(robot, scene, start, goal, "free-floating", None, 0.015)) is not None:
            return found
    return None


def past_spheres(rng: np.random.Generator) -> fp.Problem | None:
    """Kind 5: a satellite with panels of 5.3 m and a UR5 flies 5 m past 15 to 39 spheres."""
    robot, count = loaded("satellite_ur5"), int(rng.integers(15, 40))
    centers = rng.uniform([1.7, -3.0, -2.0], [3.5, 3.0, 2.2], (count, 3))
    scene = fp.Scene(centers, rng.uniform(0.1, 0.3, count))
    named = [np.array(list(posture.values())) for posture in robot.postures.values()]
    for _ in range(200):
        start = named[int(rng.integers(len(named)))] + rng.normal(0.0, 0.2, robot.nd)
        goal = rng.uniform([-2.5, -2.8, -2.5, -2, -2, -1], [2.5, 0.2, 2.5, 2, 2, 1])
        start = np.clip(start, robot.lower, robot.upper)
        window = ((-1.0, -3.0, -3.0), (6.0, 3.0, 3.0))
        if (found := _across(robot, scene, start, goal, 5.0, window, 0.015)) is not None:
            return found
    return None


def to_an_attitude(rng: np.random.Generator) -> fp.Problem | None:
    """Kind 6: 3 m past a few spheres, the arms have to turn the base by 10 to 45 degrees.

    Every other one in space, drawn by `rng` as well.
    """
    planar = rng.random() < 0.5
    robot = loaded("planar_dual_arm" if planar else "spatial_dual_arm")
    count = int(rng.integers(2, 6) if planar else rng.integers(4, 10))
    low, high = ([0.8, -2.0, 0.0], [2.2, 2.0, 0.0]) if planar else ([0.8, -2, -1.5], [2.2, 2, 1.5])
    scene = fp.Scene(rng.uniform(low, high, (count, 3)), rng.uniform(0.12, 0.35, count))
    axis = np.array([0.0, 0.0, rng.choice([-1.0, 1.0])]) if planar else rng.normal(size=3)
    angle = np.radians(rng.uniform(10.0, 45.0 if planar else 40.0))
    rest = np.zeros(6) if planar else np.array(list(robot.postures["rest"].values()))
    postures = np.clip(rest + rng.normal(0.0, 0.4, (2, 6)), robot.lower, robot.upper)
    start = robot.assemble(np.zeros(3), UPRIGHT, postures[0])
    turned = rotations.exp(axis / np.linalg.norm(axis) * angle)
    goal = robot.assemble(np.array([3.0, 0.0, 0.0]), turned, postures[1])
    if not _clear(robot, scene, (start, goal), 0.03 if planar else 0.008):
        return None
    depth = 0.0 if planar else 2.5
    window = ((-1.0, -2.5, -depth), (4.0, 2.5, depth))
    return fp.Problem(robot, scene, start, goal, window=window, reach_attitude=True)


@cache
def loaded(name: str) -> fp.SpaceRobot:
    """A bundled robot, read once."""
    return fp.load_robot(name)


def _across(
    robot: fp.SpaceRobot,
    scene: fp.Scene,
    begin: np.ndarray,
    end: np.ndarray,
    distance: float,
    window: object,
    room: float = 0.03,
) -> fp.Problem | None:
    """Straight ahead along x, from one posture to another."""
    start = robot.assemble(np.zeros(3), UPRIGHT, begin)
    goal = robot.assemble(np.array([distance, 0.0, 0.0]), UPRIGHT, end)
    return _blocked(robot, scene, start, goal, "free-flying", window, room)


def _blocked(
    robot: fp.SpaceRobot,
    scene: fp.Scene,
    start: np.ndarray,
    goal: np.ndarray,
    mode: str,
    window: object,
    room: float,
) -> fp.Problem | None:
    """The problem, if its ends are clear by so much [m] and the straight motion is not free.

    The goal's attitude is that at which the straight motion arrives.
    """
    if not _clear(robot, scene, (start,), room):
        return None
    problem = fp.Problem(robot, scene, start, goal, mode, window=window)
    ends = np.stack([start[:3], start[:3] + problem.base_displacement])
    motion = Motion(robot, problem.mode, start, goal, ends)
    if not _clear(robot, scene, (motion.configurations()[-1],), room):
        return None
    prover, still = Prover(motion, scene, problem.tolerance), np.zeros((2, 3))
    clear = prover.clearances(np.array([0, 1]), still)
    free = prover.certify(0, still[0], still[0], (float(clear[0]), float(clear[1]))).free
    return None if free else problem


def _clear(
    robot: fp.SpaceRobot, scene: fp.Scene, ends: tuple[np.ndarray, ...], room: float
) -> bool:
    return all(
        fp.clearance(robot, scene, q) > room and not len(fp.self_collisions(robot, q)) for q in ends
    )


def _row(begin: tuple[float, float], end: tuple[float, float], radius: float) -> np.ndarray:
    """(k, 3) centres in the plane z = 0 from one point to another, 1.2 radii apart at most."""
    way = np.subtract(end, begin)
    count = max(2, int(np.ceil(np.linalg.norm(way) / (1.2 * radius))) + 1)
    centers = np.zeros((count, 3))
    centers[:, :2] = begin + np.linspace(0.0, 1.0, count)[:, None] * way
    return centers


def _shell(half: np.ndarray, radius: float) -> np.ndarray:
    """(k, 3) points on the surface of a box about the origin, 1.3 radii apart at most."""
    axes = [np.linspace(-h, h, max(2, int(np.ceil(2 * h / (1.3 * radius))) + 1)) for h in half]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return points[np.any(np.abs(points) > half - 1e-9, axis=1)]


KINDS: dict[int, Callable[[np.random.Generator], fp.Problem | None]] = {
    1: among_spheres,
    2: through_walls,
    3: out_of_a_cup,
    4: beside_a_box,
    5: past_spheres,
    6: to_an_attitude,
}
