"""The bundled satellites: files, postures, and what their arms can do."""

import numpy as np
import pinocchio as pin
import pytest

import ffsr_plan as fp
from ffsr_plan.collision.distances import SelfQuery
from ffsr_plan.core.bundled_files import folder
from ffsr_plan.robots.summary import reach_bound
from tests.helpers.spatial_robot import curvatures
from tests.helpers.urdf_builders import capsule, inertial, joint, link, sphere, urdf
from tools import make_satellites

NAMES = ("satellite_ur5", "spatial_dual_arm")


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    path = tmp_path_factory.mktemp("satellites")
    make_satellites.write(path)
    return path


@pytest.mark.parametrize("name", NAMES)
def test_the_bundled_files_are_what_the_functions_build(written, name):
    for suffix in (".urdf", ".srdf"):
        made = (written / f"{name}{suffix}").read_text()
        assert made == (folder("urdf") / f"{name}{suffix}").read_text()


@pytest.mark.parametrize("name", NAMES)
def test_links_do_not_touch_in_any_posture(name):
    robot = fp.load_robot(name)
    query = SelfQuery(robot)
    assert {"stowed", "reach"} <= set(robot.postures)
    for posture in ({}, *robot.postures.values()):
        assert query.distance(robot.configuration(joints=posture)) > 0.01
    for posture in robot.postures.values():
        assert set(posture) == set(robot.joint_names)


def farthest(robot, posture):
    """Metres from the base origin to the farthest corner of a shape on the arms."""
    model, geometry = robot.model, robot.collision_model
    data, placed = model.createData(), geometry.createData()
    q = robot.configuration(joints=posture)
    pin.updateGeometryPlacements(model, data, geometry, placed, q)
    return max(
        np.linalg.norm(placed.oMg[k].act(np.array([x, y, z]) * shape.geometry.halfSide))
        for k, shape in enumerate(geometry.geometryObjects)
        if shape.parentJoint > 1
        for x in (-1, 1)
        for y in (-1, 1)
        for z in (-1, 1)
    )


@pytest.mark.parametrize("name", NAMES)
def test_no_posture_exceeds_the_reach_bound(name):
    robot = fp.load_robot(name)
    bound = reach_bound(robot)
    stowed, reaching = (farthest(robot, robot.postures[p]) for p in ("stowed", "reach"))
    assert 1.25 * stowed < reaching <= bound + 1e-9 < 1.4 * reaching
    rng = np.random.default_rng(0)
    for _ in range(200):
        values = rng.uniform(robot.lower, robot.upper)
        joints = dict(zip(robot.joint_names, values.tolist(), strict=True))
        assert farthest(robot, joints) <= bound


def test_a_stretched_arm_attains_the_reach_bound():
    robot = fp.load_robot("planar_dual_arm")
    away = np.arctan2(0.12, 0.27)  # at which an arm points away from the base origin
    flat = np.hypot(0.12, 0.27) + 0.4 + 0.4 + np.hypot(0.1266, 0.03)  # to a corner in the plane
    stretched = farthest(robot, {"left_1": -away})
    assert stretched == pytest.approx(np.hypot(flat, 0.03), abs=0.005)
    assert stretched - 1e-9 <= reach_bound(robot) < stretched + 0.01
    assert reach_bound(fp.load_robot("point")) == 0.0


def test_the_reach_bound_includes_slides_and_capsule_radii(tmp_path):
    heavy = inertial(1.0, (0.1, 0.1, 0.1))
    path = tmp_path / "arm.urdf"
    path.write_text(
        urdf(
            link("a", heavy, sphere(0.01)),
            link("b", heavy),
            link("c", heavy, capsule(0.1, 0.6, (0.0, 0.0, 0.3))),
            joint("turn", "continuous", "a", "b", (0.0, 0.0, 0.0), axis=(1.0, 0.0, 0.0)),
            joint("slide", "prismatic", "b", "c", (0.0, 0.0, 0.1), limit=0.7),
        )
    )
    bus = fp.Bus((2.0, 2.0, 2.0), 10.0)
    robot = fp.compose(bus, [fp.Mount(path, (0.0, 0.5, 0.0))])
    assert reach_bound(robot) == pytest.approx(0.5 + 0.1 + 0.7 + 0.6 + 0.1, abs=1e-6)
    fixed = fp.compose(bus, [fp.Mount(path, locked={"turn": 0.0, "slide": 0.7})])
    assert reach_bound(fixed) == 0.0  # what is fixed to the bus is no arm


def test_summaries_list_joints_mass_and_postures():
    summaries = {summary.name: summary for summary in fp.robot_summaries()}
    assert list(summaries) == fp.robot_names()
    for name, summary in summaries.items():
        robot = fp.load_robot(name)
        assert summary.mass == pytest.approx(pin.computeTotalMass(robot.model))
        assert summary.joint_names == robot.joint_names
        assert summary.postures == tuple(robot.postures)
    assert summaries["spatial_dual_arm"].mass == pytest.approx(20.0 + 2 * (0.5 + 0.5 + 4 + 4))
    assert summaries["satellite_ur5"].mass == pytest.approx(200 + 2 * 12 + 3 + 20.9939, abs=1e-9)


def test_small_joint_loops_rotate_the_base_about_three_axes():
    robot = fp.load_robot("spatial_dual_arm")
    rest = np.array([robot.postures["rest"][name] for name in robot.joint_names])
    ways = [[way.get(name, 0.0) for name in robot.joint_names] for way in make_satellites.TURNING]
    singular = np.linalg.svd(curvatures(robot, rest, np.array(ways)))[1]
    assert singular[-1] > 0.1  # [rad] for each unit of area, about the weakest axis


def test_a_plan_of_the_bundled_satellite_verifies():
    robot = fp.load_robot("satellite_ur5")
    problem = fp.Problem(
        robot,
        fp.Scene([[3.0, 0.4, 0.9], [2.0, -2.6, 0.0]], [0.4, 0.3]),
        start=robot.configuration(joints=robot.postures["stowed"]),
        goal=robot.configuration((5.0, 0.0, 0.0), joints=robot.postures["ready"]),
        lattice=fp.Lattice(12, fp.Axis(6, 0.3), fp.Axis(6, 0.3)),
        delta=0.01,
    )
    plan = fp.plan(problem, fp.LatticeOptimum(), refine=False)
    assert plan.verify(200).ok
    assert np.linalg.norm(plan.arrival_attitude) > 1e-3
