"""Random edges and plans agree with a checker that uses none of the package's code."""

import numpy as np
import pytest

import ffsr_plan as fp

pytest.importorskip("mujoco", minversion="4")

from tests.helpers.mujoco_checker import Checker, Course, least_along
from tests.helpers.random_satellites import LIMIT, SOLIDS, random_satellite, write_files
from tests.helpers.sample_sizes import sample

MODES = ("free-flying", "attitude-held", "free-floating")
AGREEMENT = 1e-6  # [m] and [rad], between two engines
TOLERANCE = 1e-4  # [m], below which an edge may be refused
WITH_CYLINDERS = (*SOLIDS, "cylinder")


def random_joints(satellite, rng, spread=1.0):
    return np.array(
        [rng.uniform(-1.0, 1.0) * spread * LIMIT.get(body.kind, 3.0) for body in satellite.moving]
    )


def unit_quaternion(rng):
    quat = rng.normal(size=4)
    return quat / np.linalg.norm(quat)


def configuration(robot, checker, position, quat, joints):
    """(nq,) of a robot, from values in the checker's order of joints."""
    order = [checker.names.index(name) for name in robot.joint_names]
    return robot.assemble(np.asarray(position), np.asarray(quat), joints[order])


def grazing(course, checker, rng):
    """Spheres, most of them enlarged or shrunk until they just touch or just miss the motion."""
    centers, radii = [], []
    for _ in range(int(rng.integers(1, 4))):
        center = course(rng.random())[0] + rng.normal(size=3) * 1.5
        centers.append(center)
        radii.append(0.05)
    probe = Checker(checker.satellite, np.array(centers[:1]), radii[:1])
    gap = least_along(probe, course, 40).obstacle + radii[0]
    radii[0] = max(1e-3, gap + float(rng.choice([-0.2, -3e-3, -2e-4, 1e-4, 3e-3])))
    return np.array(centers), np.array(radii)


def shorter_way(satellite, change):
    """Continuous joints take the shorter direction."""
    wraps = np.array([body.kind == "continuous" for body in satellite.moving])
    return np.where(wraps, (change + np.pi) % (2.0 * np.pi) - np.pi, change)


@pytest.mark.parametrize("seed", range(sample(8, 20)))
def test_edges_are_free_if_and_only_if_the_checker_says_so(seed, tmp_path):
    rng = np.random.default_rng([12, seed])
    satellite = random_satellite(rng, WITH_CYLINDERS if seed % 4 == 0 else SOLIDS)
    exact = all(s.kind != "cylinder" for body in satellite.bodies for s in body.solids)
    urdf, srdf = write_files(satellite, tmp_path)
    robot = fp.load_robot(urdf, srdf=srdf)
    alone = Checker(satellite, np.zeros((0, 3)), [])
    wrong, free, refused = [], 0, 0
    for k in range(50):
        mode = MODES[k % 3]
        first, quat = random_joints(satellite, rng), unit_quaternion(rng)
        change = shorter_way(satellite, random_joints(satellite, rng, 0.5))
        last = first + change
        limits = np.array([LIMIT.get(body.kind, np.inf) for body in satellite.moving])
        last = np.clip(last, -limits, limits)
        goal_quat = unit_quaternion(rng)
        ends = np.array([rng.normal(size=3), rng.normal(size=3)])
        course = Course(alone, mode, (ends[0], quat), goal_quat, ends, np.array([first, last]))
        centers, radii = grazing(course, alone, rng)
        checker = Checker(satellite, centers, radii)
        least = least_along(checker, course, 80)
        proof = fp.certify_edge(
            robot,
            fp.Scene(centers, radii),
            configuration(robot, checker, ends[0], quat, first),
            configuration(robot, checker, ends[1], goal_quat, last),
            mode,
        )
        free, refused = free + proof.free, refused + (not proof.free)
        touches = min(least) < -AGREEMENT
        clear = min(least) > TOLERANCE + AGREEMENT
        arrived = course(1.0)
        arrival = configuration(robot, checker, *arrived)
        off = np.abs(proof.arrival - arrival).max()
        off = min(off, np.abs(proof.arrival[3:7] + arrival[3:7]).max()) if off > 1.0 else off
        if proof.free and (touches or proof.proven_clearance > least.obstacle + AGREEMENT):
            wrong.append((k, mode, "free", proof.proven_clearance, *least))
        if not proof.free and clear and exact:
            wrong.append((k, mode, "refused", proof.least_clearance, *least))
        if off > AGREEMENT:
            wrong.append((k, mode, "arrival", off))
    assert not wrong
    assert free + refused == 50


def random_problem(satellite, robot, checker, rng):
    """A problem of any mode, with or without posture axes and a goal attitude."""
    mode = MODES[int(rng.integers(3))]
    postures = mode == "free-floating" or rng.random() < 0.3
    first, quat = random_joints(satellite, rng, 0.7), unit_quaternion(rng)
    last = first + random_joints(satellite, rng, 0.15)
    limits = np.array([LIMIT.get(body.kind, np.inf) for body in satellite.moving])
    last = np.clip(last, -limits, limits)
    begin, end = rng.uniform(-3.0, 3.0, 3), rng.uniform(-3.0, 3.0, 3)
    goal_quat, reach = unit_quaternion(rng), False
    axes = {}
    if postures:
        joints = {name: float(rng.normal()) for name in robot.joint_names}
        axes["postures"] = [fp.PostureAxis(joints, 2, float(rng.uniform(0.05, 0.4)))]
        reach = mode != "attitude-held" and rng.random() < 0.4
    if mode != "free-floating":
        axes["lateral"] = fp.Axis(2, 0.3)
        axes["normal"] = fp.Axis(1, 0.4) if rng.random() < 0.5 else None
    positions = np.array([begin, end])
    if reach:  # what a posture on the way brings about can be reached
        middle = first + 0.3 * np.array([joints[name] for name in checker.names])
        middle = np.clip(middle, -limits, limits)
        bent = np.array([first, middle, 0.5 * (middle + last), last])
        way = Course(checker, mode, (begin, quat), quat, positions[[0, 0, 1, 1]], bent)
        goal_quat = way(1.0)[1]
    spheres = int(rng.integers(0, 7))
    centers = begin + rng.random((spheres, 1)) * (end - begin) + rng.normal(size=(spheres, 3))
    return fp.Problem(
        robot,
        fp.Scene(centers, rng.uniform(0.05, 0.5, spheres)),
        configuration(robot, checker, begin, quat, first),
        configuration(robot, checker, end, goal_quat, last),
        mode,
        fp.Lattice(int(rng.integers(4, 9)), **axes),
        delta=float(rng.choice([0.0, 1e-9, 0.02, 1.0, 1e6])),
        length_unit=float(rng.choice([1e-6, 0.1, 1.0, 1e6])),
        clearance_cap=None if rng.random() < 0.7 else 0.5,
        position_weight=float(rng.choice([0.2, 1.0])),
        rotation_weight=float(rng.choice([0.0, 0.5, 1.0])),
        reach_attitude=reach,
    )


def random_planner(problem, rng):
    if problem.lattice.postures:
        return fp.PostureAnnealing(ants=5, cycles=5, annealing_shifts=300)
    return (
        fp.AntSystem(ants=5, cycles=4),
        fp.MaxMinAntSystem(ants=5, cycles=5),
        fp.LatticeOptimum(),
    )[int(rng.integers(3))]


def paths_and_costs(plan, course, checker):
    """L [m] and F of a motion by Eqs. 4, 6 and 8, and the clearances at its nodes."""
    problem, m = plan.problem, course.edges
    corners = [course(k / m) for k in range(m + 1)]
    held, floats = problem.mode == "attitude-held", problem.mode == "free-floating"
    metres = np.array([body.kind == "prismatic" for body in checker.satellite.moving])
    weight = np.where(metres, problem.position_weight, problem.rotation_weight)
    joints = np.array([c[2] for c in corners]) * weight
    base = np.array([c[0] for c in corners]) * (0.0 if floats else problem.position_weight)
    nominal_joints, nominal_base = (joints[-1] - joints[0]) / m, (base[-1] - base[0]) / m
    overlap = min(1.0, abs(float(problem.start[3:7] @ problem.goal[3:7])))
    turn = 2.0 * np.arccos(overlap) / m * problem.rotation_weight if held else 0.0
    nominal = np.sum(nominal_joints**2) + np.sum(nominal_base**2) + turn**2
    length = sum(
        np.sqrt(
            nominal
            + np.sum((joints[k + 1] - joints[k] - nominal_joints) ** 2)
            + np.sum((base[k + 1] - base[k] - nominal_base) ** 2)
        )
        for k in range(m)
    )
    clearances = np.array([checker.contact(*c).obstacle for c in corners])
    cap = problem.clearance_cap or np.inf
    unit = problem.length_unit
    inverse = float(np.sum(unit / np.minimum(clearances[1:-1], cap)))
    return length, length / unit + problem.delta * inverse, clearances


def faults_of(plan, checker):
    """What the checker finds wrong about a plan."""
    problem, motion = plan.problem, plan.motion
    order = [problem.robot.joint_names.index(name) for name in checker.names]
    start, goal, m = problem.start, problem.goal, motion.edges
    joints = motion.joint_values[:, order]
    course = Course(
        checker, str(problem.mode), (start[:3], start[3:7]), goal[3:7], motion.positions, joints
    )
    times = np.linspace(0.0, 1.0, 10 * m + 1)
    faults = []
    for s, q in zip(times, plan.at(times), strict=True):
        wanted = configuration(problem.robot, checker, *course(s))
        if wanted[3:7] @ q[3:7] < 0.0:
            wanted[3:7] *= -1.0
        if np.abs(wanted - q).max() > AGREEMENT:
            faults.append(f"the motion differs by {np.abs(wanted - q).max():.3g} at {s:.3f}")
            break
    arrival = course(1.0)
    ends = configuration(problem.robot, checker, *arrival)
    missed = np.abs(ends[7:] - goal[7:]).max(initial=0.0)
    if problem.mode != "free-floating":
        missed = max(missed, np.abs(ends[:3] - goal[:3]).max())
    if problem.mode == "attitude-held" or problem.reach_attitude:
        missed = max(missed, 2.0 * np.sqrt(max(0.0, 1.0 - abs(ends[3:7] @ goal[3:7]) ** 2)))
    if missed > 2.0 * AGREEMENT:
        faults.append(f"the goal is missed by {missed:.3g}")
    least = least_along(checker, course, 20 * m)
    if min(least) <= 0.0 or plan.certificate.least_clearance > least.obstacle + AGREEMENT:
        faults.append(f"{least} where {plan.certificate.least_clearance} is proven")
    length, objective, clearances = paths_and_costs(plan, course, checker)
    if abs(length - plan.length) > 1e-9 * max(1.0, length):
        faults.append(f"the length is {length}, not {plan.length}")
    with np.errstate(invalid="ignore"):
        error = np.where(clearances == plan.clearances, 0.0, np.abs(clearances - plan.clearances))
    if error.max() > AGREEMENT:
        faults.append(f"node clearances differ by {error.max():.3g}")
    unit = problem.length_unit
    blur = problem.delta * unit * float(np.sum(AGREEMENT / clearances[1:-1] ** 2))
    if abs(objective - plan.objective) > blur + 1e-9 * objective:
        faults.append(f"F is {objective}, not {plan.objective}")
    if not plan.verify(50).ok:
        faults.append(f"verify: {plan.verify(50).problems}")
    return faults


@pytest.mark.parametrize("part", range(sample(5, 10)))
def test_plans_agree_with_the_checker(part, tmp_path):
    rng = np.random.default_rng([34, part])
    wrong, found, tried = [], 0, 0
    while found < 10 and tried < 40:
        tried += 1
        satellite = random_satellite(rng, arms=1 + tried % 2, depth=2)
        robot = fp.load_robot(*write_files(satellite, tmp_path)[:1], srdf=tmp_path / "random.srdf")
        alone = Checker(satellite, np.zeros((0, 3)), [])
        problem = random_problem(satellite, robot, alone, rng)
        try:
            plan = fp.plan(problem, random_planner(problem, rng), seed=tried)
        except fp.PlanningError:
            continue
        found += 1
        checker = Checker(satellite, problem.scene.centers, problem.scene.radii)
        wrong += [(part, tried, str(problem.mode), fault) for fault in faults_of(plan, checker)]
    assert not wrong
    assert found == 10
