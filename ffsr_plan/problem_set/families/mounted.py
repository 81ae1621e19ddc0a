"""Families `servicing` and `remounted`: a Panda arm on buses of different masses.

The servicing scene is that of the public repository free-floating-manipulation: an arm on a
servicer reaches out under a structure of the target. Remounted are scenes in which fixed-base
planners are compared: the cage of spheres of VAMP, and shelves such as those of MotionBenchMaker,
drawn anew.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.problem_set.families.drafts import Draft, Family, Tables, box, clear, joints, spheres
from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.satellites.bus import Bus
from ffsr_plan.satellites.composition import Mount, compose
from ffsr_plan.scene.scene import Scene
from ffsr_plan.scene.shapes.obstacle_shapes import Box

MASSES = (2300, 1000, 500, 300, 250, 200, 150)  # [kg]
LIGHT = 300  # [kg]
MOUNT = 0.32  # [m] of the arm's root above the middle of the bus
CENTER = (-0.041018, -0.00014, MOUNT + 0.049974)  # of mass of the bus [m]
START = np.array([0.0, -1.30, 0.0, -2.60, 0.0, 1.50, 0.0])
GOAL = np.array([0.0, 0.25, 0.0, -1.05, 0.0, 1.30, 0.0])
CAGE_START = np.array([0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785])
CAGE_GOAL = np.array([2.35, 1.0, 0.0, -0.8, 0.0, 2.5, 0.785])
CAGE = np.array([
    [0.55, 0.0, 0.25], [0.35, 0.35, 0.25], [0.0, 0.55, 0.25], [-0.55, 0.0, 0.25],
    [-0.35, -0.35, 0.25], [0.0, -0.55, 0.25], [0.35, -0.35, 0.25], [0.35, 0.35, 0.8],
    [0.0, 0.55, 0.8], [-0.35, 0.35, 0.8], [-0.55, 0.0, 0.8], [-0.35, -0.35, 0.8],
    [0.0, -0.55, 0.8], [0.35, -0.35, 0.8],
])  # fmt: skip
"""(14, 3) centres of the spheres of the cage in the frame of the arm's root [m]."""
TOOL = 0.2  # [m] of the middle between the fingers from the last joint
_TRIES = 20000
_ROOM = 0.02  # [m]


@cache
def servicer(mass: int) -> SpaceRobot:
    """The Panda on a bus; meshes become boxes, so that its URDF needs no other file.

    Args:
        mass: of the bus [kg].
    """
    bus = Bus((0.60, 0.60, 0.36), float(mass), (0.25 * mass,) * 3, center_of_mass=CENTER)
    arm = Mount("panda", position=(0.0, 0.0, MOUNT), locked={"panda_finger_joint1": 0.0})
    return compose(bus, [arm], f"servicer_{mass}")


def robot_files() -> dict[str, str]:
    """Texts of the URDF and SRDF files of all buses, by file name in the folder of robots."""
    files = {}
    for mass in MASSES:
        robot = servicer(mass)
        files[f"{robot.name}.urdf"], files[f"{robot.name}.srdf"] = robot.urdf, robot.srdf or ""
    return files


def draw_servicing(rng: np.random.Generator, number: int) -> Draft:
    """A problem: the seven masses in turn; the first seven are the published scene.

    Args:
        rng: random numbers of the problem.
        number: of the problem in the family.
    """
    mass, first = MASSES[number % 7], number < 7
    robot, shift, turn = servicer(mass), rng.uniform(-0.04, 0.04, 3), rng.uniform(-0.15, 0.15, 3)
    start, goal = START + rng.normal(0.0, 0.1, 7), GOAL + rng.normal(0.0, 0.08, 7)
    if first:
        shift, turn, start, goal = 0.0 * shift, 0.0 * turn, START, GOAL
    place = np.array([0.46, 0.0, 0.96 + MOUNT]) + shift
    tables = _floating(mass, joints(robot, start), joints(robot, goal))
    tables["obstacles"] = [box((0.52, 0.60, 0.12), place, "target", turn)]
    if mass <= LIGHT and (first or number % 2):  # as the straight way would leave the goal blocked
        tables["goal"]["attitude"] = [0.0, 0.0, 0.0]
    back = ", back at its attitude" if "attitude" in tables["goal"] else ""
    return Draft(f"a bus of {mass} kg{back}", tables, 0.004)


def draw_remounted(rng: np.random.Generator, number: int) -> Draft | None:
    """A problem: cages and shelves in turn, on buses of five masses.

    Args:
        rng: random numbers of the problem.
        number: of the problem in the family.
    """
    mass = MASSES[1:6][number // 2 % 5]
    draft = _shelf(rng, mass) if number % 2 else _cage(rng, mass, number == 0)
    if draft is None or number % 5 < 4:
        return draft
    draft.tables["goal"]["attitude"] = [0.0, 0.0, 0.0]
    return draft._replace(title=f"{draft.title}, back at its attitude")


def _floating(mass: int, start: dict[str, float], goal: dict[str, float]) -> Tables:
    name = f"robots/servicer_{mass}"
    return {
        "robot": {"urdf": f"{name}.urdf", "srdf": f"{name}.srdf", "mode": "free-floating"},
        "start": {"joints": start},
        "goal": {"joints": goal},
    }


def _cage(rng: np.random.Generator, mass: int, first: bool) -> Draft:
    """The cage, its spheres moved a little."""
    robot = servicer(mass)
    moved = CAGE + rng.normal(0.0, 0.0 if first else 0.03, CAGE.shape) + (0.0, 0.0, MOUNT)
    other = 0.0 if first else rng.normal(0.0, 0.1, 7)
    tables = _floating(mass, joints(robot, CAGE_START), joints(robot, CAGE_GOAL + other))
    tables["obstacles"] = spheres(moved, np.full(len(moved), 0.2 if first else 0.18))
    return Draft(f"a cage of spheres, a bus of {mass} kg", tables, 0.01)


def _shelf(rng: np.random.Generator, mass: int) -> Draft | None:
    """Shelves beside the arm: the tool moves from one cell to another."""
    robot = servicer(mass)
    near, depth = rng.uniform(0.45, 0.55), 0.35
    width, low, pitch = (
        rng.uniform(0.7, 0.9),
        MOUNT + rng.uniform(-0.1, 0.1),
        rng.uniform(0.34, 0.42),
    )
    middle, thick = near + 0.5 * depth, 0.02
    heights = low + pitch * np.arange(3)
    parts = [
        box((depth, width, thick), (middle, 0.0, z), f"board {k}") for k, z in enumerate(heights)
    ]
    tall = 2.0 * pitch + thick
    for y, name in ((0.5, "left"), (-0.5, "right"), (0.0, "middle")):
        place = (middle, y * width, low + pitch)
        parts.append(box((depth, thick, tall), place, f"{name} side"))
    scene = Scene(shapes=[Box(p["box"]["size"], p["box"]["position"]) for p in parts])
    half = np.array([0.5 * depth + 0.05, 0.25 * width, 0.5 * pitch])  # a tool may look out a little
    cells = [
        np.array([middle, y * width, low + z * pitch]) for y in (-0.25, 0.25) for z in (0.5, 1.5)
    ]
    values = rng.uniform(robot.lower, robot.upper, (_TRIES, robot.nd))
    poses = robot.tree.poses(values)
    tools = poses.origins[:, -1] + poses.rotations[:, -1] @ np.array([0.0, 0.0, TOOL])
    ends: list[tuple[int, Array]] = []
    for k in rng.permutation(len(cells)).tolist():
        for q in values[np.all(np.abs(tools - cells[k]) < half, axis=1)]:
            if clear(robot, scene, robot.configuration(joints=joints(robot, q)), _ROOM):
                ends.append((k, q))
                break
        if len(ends) == 2:
            break
    if len(ends) < 2:
        return None
    tables = _floating(mass, *(joints(robot, q) for _, q in ends))
    tables["obstacles"] = parts
    return Draft(f"shelves, a bus of {mass} kg", tables, 0.01)


SERVICING = Family(
    "servicing", "the servicing scene, a Panda on buses of seven masses", 28, 20.0, draw_servicing
)
REMOUNTED = Family(
    "remounted",
    "fixed-base scenes with the Panda remounted on a bus: cages and shelves",
    30,
    20.0,
    draw_remounted,
)
