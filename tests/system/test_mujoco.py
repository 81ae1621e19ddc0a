"""MuJoCo, which knows nothing of this package, flies the plans and finds the same motion."""

import numpy as np
import pinocchio as pin
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.reaction import Reaction
from tests.helpers.urdf_builders import random_configuration, random_robot, random_scene

mujoco = pytest.importorskip("mujoco", minversion="4")

from tests.helpers import mujoco_flight as engine  # noqa: E402 - it cannot be imported where there is no MuJoCo

AGREEMENT = 1e-5  # [rad], [m] and relative, where the laws of motion decide
FOLLOWED = 1e-3  # [m], thrusters cut the path's corners
DURATION = 100.0  # [s]
SPATIAL = (7, 39)  # random robots with hinges and slides
MODES = ("free-flying", "attitude-held")


def robot_named(name):
    return fp.load_robot(name) if isinstance(name, str) else random_robot(name, arms=2, depth=3)


@pytest.fixture(scope="module")
def plans():
    """By mode and robot: fig2a, and bent paths of random spatial robots that begin askew."""
    fig2a, found = fp.load_scenario("fig2a"), {}
    turned = np.array(fig2a.goal)
    turned[3:7] = rotations.from_angles([0.9, 0.0, 0.0])
    for mode in MODES:
        problem = fp.Problem(
            fig2a.robot, fig2a.scene, fig2a.start, turned, mode=mode, lattice=fig2a.lattice,
            delta=fig2a.delta, length_unit=fig2a.length_unit,
        )  # fmt: skip
        found[mode, "planar_dual_arm"] = fp.plan(problem, fp.LatticeOptimum())
    for seed in SPATIAL:
        robot, rng = robot_named(seed), np.random.default_rng(seed)
        assert 0 < robot.prismatic.sum() < robot.nd
        start, goal = (np.array(random_configuration(robot, rng, 0.2)) for _ in range(2))
        goal[0] += 6.0
        for mode in MODES:
            problem = fp.Problem(
                robot, random_scene(rng, 3), start, goal, mode=mode, delta=0.5,
                lattice=fp.Lattice(8, fp.Axis(3, 0.4), fp.Axis(1, 0.5)),
            )  # fmt: skip
            found[mode, seed] = fp.plan(problem, fp.AntSystem(ants=5, cycles=3), seed)
    return found


@pytest.mark.parametrize("name", ["planar_dual_arm", *SPATIAL, 9, 12])
def test_the_engine_and_pinocchio_have_the_same_bodies(name):
    robot = robot_named(name)
    model = engine.mujoco_model(robot)
    data = mujoco.MjData(model)
    bodies = robot.model.inertias
    for j, frame in enumerate(["base", *robot.joint_names], start=1):
        b = 1 if frame == "base" else int(model.joint(frame).bodyid[0])
        turn = rotations.matrix(np.roll(model.body_iquat[b], -1))
        assert model.body_mass[b] == pytest.approx(bodies[j].mass, rel=1e-12)
        assert np.allclose(model.body_ipos[b], bodies[j].lever, atol=1e-12)
        inertia = turn @ np.diag(model.body_inertia[b]) @ turn.T
        assert np.allclose(inertia, bodies[j].inertia, atol=1e-9 * bodies[j].mass)
    assert model.body_mass.sum() == pytest.approx(sum(b.mass for b in bodies[1:]), rel=1e-12)
    # and as a whole, anywhere: the joint-space inertia about the base's origin
    q = random_configuration(robot, np.random.default_rng(5))
    data.qpos[:3], data.qpos[3:7] = q[:3], np.roll(q[3:7], 1)
    places, dofs = engine.joint_slots(robot, model)
    data.qpos[places] = robot.joint_values(q)
    mujoco.mj_forward(model, data)
    order = np.array([*range(6), *dofs])
    found = engine.joint_space_inertia(model, data)[np.ix_(order, order)]
    expected = pin.crba(robot.model, robot.model.createData(), q)
    expected = np.triu(expected) + np.triu(expected, 1).T
    to_base = np.eye(model.nv)
    to_base[:3, :3] = rotations.matrix(q[3:7]).T  # the engine's linear rates are in world axes
    assert np.allclose(found, to_base.T @ expected @ to_base, atol=1e-9)


@pytest.mark.parametrize("name", ["planar_dual_arm", *SPATIAL])
def test_mujoco_rotates_a_free_flying_base_as_planned(plans, name):
    plan = plans["free-flying", name]
    robot = plan.problem.robot
    flight = engine.fly(robot, "free-flying", engine.course_of(plan, DURATION), DURATION)
    reaction = Reaction.along(robot, flight.joints).attitudes(flight.attitudes[0])
    planned = plan.at(engine.progress(flight.times, DURATION)[0])
    turned = rotations.angle_between(reaction[0], reaction).max()
    off = rotations.angle_between(flight.attitudes, reaction).max()
    off_plan = rotations.angle_between(flight.attitudes, planned[:, 3:7]).max()
    away = np.linalg.norm(flight.positions - planned[:, :3], axis=1).max()
    assert turned > 0.1
    assert off < AGREEMENT
    assert off_plan < AGREEMENT
    assert away < FOLLOWED
    assert np.all(flight.impulses == 0.0)


@pytest.mark.parametrize("name", ["planar_dual_arm", *SPATIAL])
def test_the_engines_wheels_store_what_the_plan_says(plans, name):
    plan = plans["attitude-held", name]
    course = engine.course_of(plan, DURATION)
    flight = engine.fly(plan.problem.robot, "attitude-held", course, DURATION)
    wheels = plan.wheel_momentum(DURATION, np.minimum(flight.times, DURATION))
    planned = plan.at(wheels.parameters)
    held = rotations.angle_between(flight.attitudes, planned[:, 3:7]).max()
    away = np.linalg.norm(flight.positions - planned[:, :3], axis=1).max()
    by_moment = np.linalg.norm(wheels.world + flight.impulses, axis=1).max()
    by_bodies = np.linalg.norm(wheels.world + flight.momenta, axis=1).max()
    assert held < AGREEMENT
    assert away < FOLLOWED
    assert wheels.peak > 1e-3
    assert by_moment < AGREEMENT * wheels.peak
    assert by_bodies < AGREEMENT * wheels.peak


def waving(robot, start, duration, seed):
    """Every joint swings at its own pace and amplitude, beginning at rest."""
    rng = np.random.default_rng(seed)
    size = np.where(robot.prismatic, 0.3, 1.2) * rng.uniform(0.4, 1.0, robot.nd)
    pace = rng.uniform(2.0, 6.0, robot.nd) / duration
    begin = robot.joint_values(start)
    base = (start[:3], np.zeros(3), np.zeros(3)), (start[3:7], np.zeros(3), np.zeros(3))

    def course(t):
        return engine.Course(*base, (
            begin + size * (1.0 - np.cos(pace * t)),
            size * pace * np.sin(pace * t),
            size * pace**2 * np.cos(pace * t),
        ))  # fmt: skip

    return course


def centers_of_mass(robot, joint_values):
    """(N, 3) in base axes from the base's origin."""
    data = robot.model.createData()
    q = robot.assemble(np.zeros(3), rotations.IDENTITY, joint_values)
    return np.array([pin.centerOfMass(robot.model, data, each) for each in q])


@pytest.mark.parametrize("name", ["planar_dual_arm", *SPATIAL, 9])
def test_without_thrusters_the_centre_of_mass_is_at_rest(name):
    robot = robot_named(name)
    start = random_configuration(robot, np.random.default_rng(3))
    flight = engine.fly(robot, "free-floating", waving(robot, start, 20.0, 4), 20.0, every=1)
    attitudes = Reaction.along(robot, flight.joints).attitudes(start[3:7])
    levers = centers_of_mass(robot, flight.joints)
    turned = np.einsum("nij,nj->ni", rotations.matrix(attitudes), levers)
    positions = start[:3] + turned[0] - turned
    off = rotations.angle_between(flight.attitudes, attitudes).max()
    away = np.linalg.norm(flight.positions - positions, axis=1).max()
    moved = np.linalg.norm(positions - positions[0], axis=1).max()
    assert rotations.angle_between(attitudes[0], attitudes).max() > 0.1
    assert moved > 0.01
    assert off < AGREEMENT
    assert away < AGREEMENT
