"""Problems without a lattice: among spheres, through a gap, out of a cup, beside a box."""

import numpy as np

import ffsr_plan as fp

STOWED = (0.0, -3.1, 0.0, -1.6, 0.0, 0.0)


def clear(robot, scene, q, room):
    return fp.clearance(robot, scene, q) > room and not len(fp.self_collisions(robot, q))


def scattered(robot, seed, mode="free-flying", **options):
    """Spheres between start and goal, 4 m apart; postures at random within the limits."""
    rng = np.random.default_rng([1, seed])
    while True:
        count = int(rng.integers(6, 12))
        centers = rng.uniform([0.6, -2.0, 0.0], [3.4, 2.0, 0.0], (count, 3))
        scene = fp.Scene(centers, rng.uniform(0.1, 0.3, count))
        postures = rng.uniform(robot.lower, robot.upper, (2, robot.nd)).clip(-2.5, 2.5)
        quat = np.array([0.0, 0.0, 0.0, 1.0])
        ends = [
            robot.assemble(np.array(place), quat, posture)
            for place, posture in zip(([0.0, 0, 0], [4.0, 0, 0]), postures, strict=True)
        ]
        if all(clear(robot, scene, q, 0.03) for q in ends):
            return fp.Problem(robot, scene, *ends, mode, **options)


def held_turn(problem, angle):
    """The same problem in the mode attitude-held, ending at an attitude about z [rad]."""
    quat = np.array([0.0, 0.0, np.sin(0.5 * angle), np.cos(0.5 * angle)])
    robot, goal = problem.robot, problem.goal
    turned = robot.assemble(goal[:3], quat, robot.joint_values(goal))
    return fp.Problem(robot, problem.scene, problem.start, turned, "attitude-held")


def wall(x, low, high, radius):
    count = max(2, int(np.ceil((high - low) / (1.2 * radius))) + 1)
    return [[x, y, 0.0] for y in np.linspace(low, high, count)], [radius] * count


def gap(robot, seed, width=1.1):
    """A wall with a gap that stretched arms do not fit through."""
    rng = np.random.default_rng([2, seed])
    middle, radius = rng.uniform(-0.5, 0.5), 0.2
    first, second = (
        wall(2.0, -3.0, middle - 0.5 * width - radius, radius),
        wall(2.0, middle + 0.5 * width + radius, 3.0, radius),
    )
    scene = fp.Scene(first[0] + second[0], first[1] + second[1])
    start, goal = robot.configuration(), robot.configuration((4.0, 0.0, 0.0))
    window = ((-1.0, -2.5, 0.0), (5.0, 2.5, 0.0))
    return fp.Problem(robot, scene, start, goal, window=window)


def cup(robot, **options):
    """The start is in a cup that opens backwards."""
    centers, radii = wall(1.5, -1.4, 1.4, 0.2)
    for y in (-1.4, 1.4):
        along = np.linspace(-0.5, 1.5, 10)
        centers += [[x, y, 0.0] for x in along]
        radii += [0.2] * 10
    start, goal = robot.configuration(), robot.configuration((4.0, 0.0, 0.0))
    return fp.Problem(robot, fp.Scene(centers, radii), start, goal, **options)


def beside_a_box(robot, seed):
    """A free-floating arm has to get around spheres before it; `robot` is the UR5 satellite."""
    rng = np.random.default_rng([4, seed])
    middle = np.array([rng.uniform(0.9, 1.05), rng.uniform(-0.2, 0.2), rng.uniform(0.9, 1.1)])
    grid = np.stack(np.meshgrid(*[np.linspace(-0.25, 0.25, 5)] * 3), axis=-1).reshape(-1, 3)
    shell = grid[np.abs(grid).max(axis=1) > 0.2]
    scene = fp.Scene(middle + shell, np.full(len(shell), 0.07))
    quat = np.array([0.0, 0.0, 0.0, 1.0])
    start = robot.assemble(np.zeros(3), quat, np.array(STOWED))
    while True:
        low, high = [-3.0, -3.0, -2.8, -3.0, -3.0, -1.0], [3.0, 0.5, 2.8, 3.0, 3.0, 1.0]
        goal = robot.assemble(np.zeros(3), quat, rng.uniform(low, high))
        if clear(robot, scene, goal, 0.05):
            return fp.Problem(robot, scene, start, goal, "free-floating")
