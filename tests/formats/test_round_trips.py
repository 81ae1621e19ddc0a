"""A plan made here is read back from each format to 1e-9, and judged as it was."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core.rotations import angle_between

fm = fp.formats
CLOSE = 1e-9


@pytest.fixture(scope="module", params=["plan", "smooth plan"])
def given(request, fig2a_plan):
    return fm.trajectory_of(
        fig2a_plan if request.param == "plan" else fig2a_plan.smooth(), duration=97.0
    )


def differences(one, other):
    """Greatest differences of times, joints, velocities, base positions and attitudes."""
    yield np.abs(one.times - other.times).max()
    for held, found in ((one.joints, other.joints), (one.velocities, other.velocities)):
        assert set(held) == set(found)
        yield max((np.abs(held[name] - found[name]).max() for name in held), default=0.0)
    yield np.abs(one.base_positions - other.base_positions).max()
    yield angle_between(one.base_attitudes, other.base_attitudes).max()
    if one.base_velocities is not None:
        yield np.abs(one.base_velocities - other.base_velocities).max()


@pytest.mark.parametrize("end", ["csv", "npz", "json", "yaml", "mcap"])
def test_trajectories_come_back_from_their_file(given, end, tmp_path):
    pytest.importorskip({"yaml": "yaml", "mcap": "mcap_ros2"}.get(end, "numpy"))
    fm.write_trajectory(tmp_path / f"t.{end}", given)
    found = fm.read_trajectory(tmp_path / f"t.{end}")
    assert max(differences(given, found)) < CLOSE
    assert found.interpolation == given.interpolation


def test_ephemerides_come_back_from_their_messages(given, tmp_path):
    fm.write_aem(tmp_path / "t.aem", given)
    fm.write_oem(tmp_path / "t.oem", given)
    turned, moved = fm.read_aem(tmp_path / "t.aem"), fm.read_oem(tmp_path / "t.oem")
    joined = fp.Trajectory(
        moved.times,
        given.joints,
        velocities=given.velocities,
        base_positions=moved.base_positions,
        base_velocities=None if given.base_velocities is None else moved.base_velocities,
        base_attitudes=turned.base_attitudes,
        interpolation=moved.interpolation,
    )
    assert max(differences(given, joined)) < CLOSE
    assert moved.interpolation == given.interpolation
    assert np.array_equal(turned.times, moved.times)


def test_keyframes_come_back_from_a_model(given, fig2a_plan, tmp_path):
    mujoco = pytest.importorskip("mujoco")
    robot, scene = fig2a_plan.problem.robot, fig2a_plan.problem.scene
    fm.write_mjcf(tmp_path / "t.xml", robot, scene, given)
    found = fm.read_trajectory(tmp_path / "t.xml")
    assert max(differences(given, found)) < CLOSE
    assert found.interpolation == given.interpolation
    assert len(fm.read_mjcf_scene(tmp_path / "t.xml").shapes) == len(scene)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "t.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 20)
    assert np.array_equal(data.ctrl, data.qpos[7:])


def test_servos_of_a_model_fly_what_the_report_says(robot, tmp_path):
    mujoco = pytest.importorskip("mujoco")
    joints = {name: [0.0, 0.0, 0.0] for name in robot.joint_names}
    joints |= {"left_1": [0.0, 0.7, 1.4], "left_2": [0.0, -0.2, -0.9], "right_3": [0.0, 0.9, 0.0]}
    given = fp.Trajectory([0.0, 1.0, 3.0], joints, interpolation="cubic")
    report = fp.certify(robot, fp.Scene(), given)
    fm.write_mjcf(tmp_path / "t.xml", robot, fp.Scene(), report.with_base())
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "t.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    wanted = robot.joint_values(report.at(np.linspace(0.0, 3.0, 301)))
    for row in [*wanted, *wanted[[-1] * 50]]:  # and half a second for the servos to come to rest
        data.ctrl[:] = row
        mujoco.mj_step(model, data, 5)
    end = report.at([3.0])[0]
    assert report.turn > 0.2
    assert angle_between(end[3:7], data.qpos[[4, 5, 6, 3]]) < 0.01 * report.turn
    assert np.abs(end[:3] - data.qpos[:3]).max() < 1e-3
    assert np.abs(end[7:] - data.qpos[7:]).max() < 1e-3


def test_a_model_weighs_and_moves_as_the_robot(robot, tmp_path):
    mujoco = pytest.importorskip("mujoco")
    import pinocchio as pin

    rng = np.random.default_rng(4)
    joints = {name: rng.uniform(-1.0, 1.0, 2) for name in robot.joint_names}
    given = fp.certify(robot, fp.Scene(), fp.Trajectory([0.0, 1.0], joints)).with_base()
    fm.write_mjcf(tmp_path / "t.xml", robot, fp.Scene(), given)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "t.xml"))
    data, own = mujoco.MjData(model), robot.model.createData()
    mujoco.mj_resetDataKeyframe(model, data, 1)
    mujoco.mj_forward(model, data)
    q = robot.assemble(
        given.base_positions[1], given.base_attitudes[1], given.joint_array(robot.joint_names)[1]
    )
    pin.framesForwardKinematics(robot.model, own, q)
    assert model.body_subtreemass[0] == pytest.approx(robot.mass)
    assert np.abs(data.subtree_com[0] - pin.centerOfMass(robot.model, own, q)).max() < 1e-12
    places = [own.oMi[j].translation for j in range(1, robot.model.njoints)]
    assert np.abs(data.xpos[1:] - places).max() < 1e-12


def test_a_saved_plan_is_a_trajectory(fig2a_plan, tmp_path):
    fig2a_plan.save(tmp_path / "plan.json")
    assert fm.read_trajectory(tmp_path / "plan.json") == fm.trajectory_of(fig2a_plan)
    problem = fig2a_plan.problem
    report = fp.certify(problem.robot, problem.scene, tmp_path / "plan.json", problem.mode)
    assert report.free


def test_flights_are_sampled_with_their_velocities(fig2a_plan):
    flight = fig2a_plan.timed(joint_acceleration=0.5, thruster_acceleration=0.1)
    given = fm.trajectory_of(flight, rate=20.0)
    problem = fig2a_plan.problem
    report = fp.certify(problem.robot, problem.scene, given, problem.mode)
    assert report.free
    between = given.times[:-1] + 0.5 * np.diff(given.times)
    apart = report.at(between) - flight.at(between).configurations
    assert np.abs(apart).max() < 1e-5
