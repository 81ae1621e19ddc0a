"""Arms on a bus: the saved URDF means the same to three readers, and is what its parts are."""

from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
import pytest
import trimesh
import yourdfpy
from scipy.spatial.transform import Rotation

import ffsr_plan as fp
from ffsr_plan.satellites import arms
from tests.helpers.urdf_builders import (
    box,
    capsule,
    inertial,
    joint,
    link,
    mesh,
    random_robot,
    sphere,
    urdf,
)

BUS = fp.Bus(
    (1.0, 0.8, 1.2),
    150.0,
    inertia=(20.0, 25.0, 30.0),
    center_of_mass=(0.02, -0.01, 0.05),
    panels=[fp.Panel((0.7, 2.0, 0.02), (0.0, 1.5, 0.1), 9.0, (0.3, -0.2, 0.1))],
)
FINGERS = {"panda_finger_joint1": 0.03}
FOUR = [
    fp.Mount("panda", (0.5, 0.1, 0.2), (0.4, 1.2, -0.7), "panda_", FINGERS),
    fp.Mount("ur5", (-0.5, 0.0, 0.3), (2.0, -0.3, 0.5), "ur_"),
    fp.Mount("kinova", (0.0, 0.4, -0.6), (0.0, 0.0, np.pi), ""),
    fp.Mount("z1", (0.1, -0.4, 0.6), (-1.0, 0.2, 0.3), "z_", {"joint4": -0.7}),
]
TWINS = [
    fp.Mount("ur5", (0.0, s * 0.4, 0.0), (0.0, 0.0, -s * np.pi / 2), p)
    for s, p in ((1, "l_"), (-1, "r_"))
]


@pytest.fixture(scope="module")
def random_arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("arms") / "random.urdf"
    path.write_text(random_robot(7, arms=2).urdf)
    return path


@pytest.fixture(scope="module", params=["four", "twins", "random"])
def case(request, random_arm):
    """Mounts, and the robot that they make on the bus."""
    mounts = {
        "four": FOUR,
        "twins": TWINS,
        "random": [
            fp.Mount(random_arm, (0.2, 0.1, 0.7), (0.3, 0.2, -0.9), "a_", {"j0_0": 0.6}),
            fp.Mount(str(random_arm), (0.0, 0.1, -0.7), (-0.3, 2.2, 1.9), "b_"),
        ],
    }[request.param]
    return mounts, fp.compose(BUS, mounts, request.param)


@pytest.fixture(scope="module")
def saved(case, tmp_path_factory):
    path = tmp_path_factory.mktemp("robots") / f"{case[1].name}.urdf"
    case[1].save(path)
    return path


def transform(position, angles):
    """(4, 4) from ZYX angles, by other means than the package's."""
    result = np.eye(4)
    result[:3, :3] = Rotation.from_euler("ZYX", angles).as_matrix()
    result[:3, 3] = position
    return result


def own_poses(mount, values):
    """(4, 4) pose of each link of an arm in its root link, from its own URDF; by pose in the bus.

    `values` are those of the composed robot; locked and mimicking joints are where they were put.
    """
    path, _, _ = arms.find_arm(mount.arm)
    model = pin.buildModelFromUrdf(str(path))
    data, q = model.createData(), pin.neutral(model)
    fingers = dict.fromkeys(("panda_finger_joint2",), FINGERS["panda_finger_joint1"])
    for name, j in zip(model.names[1:], model.joints[1:], strict=True):
        value = values.get(mount.prefix + name, mount.locked.get(name, fingers.get(name)))
        both = [value] if j.nq == 1 else [np.cos(value), np.sin(value)]
        q[j.idx_q : j.idx_q + j.nq] = both
    pin.framesForwardKinematics(model, data, q)
    place = transform(mount.position, mount.attitude)
    return {
        mount.prefix + frame.name: place @ data.oMf[k].homogeneous
        for k, frame in enumerate(model.frames)
        if frame.type == pin.FrameType.BODY
    }


def expected(mounts, values):
    """Pose in the bus, and mass, centre and inertia in its own axes, of each link."""
    poses = {"bus": np.eye(4), "panel_1": transform((0.0, 1.5, 0.1), (0.3, -0.2, 0.1))}
    x, y, z = 0.7**2, 2.0**2, 0.02**2
    panel = 9.0 / 12.0 * np.diag([y + z, x + z, x + y])
    masses = {
        "bus": (150.0, np.array([0.02, -0.01, 0.05]), np.diag([20.0, 25.0, 30.0])),
        "panel_1": (9.0, np.zeros(3), panel),
    }
    for mount in mounts:
        poses |= own_poses(mount, values)
        root = ElementTree.parse(arms.find_arm(mount.arm)[0]).getroot()
        for part in root.findall("link"):
            masses[mount.prefix + part.get("name")] = own_inertia(part.find("inertial"))
    assert set(poses) == set(masses)
    return poses, masses


def own_inertia(element):
    if element is None:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    xx, yy, zz, xy, xz, yz = (
        float(element.find("inertia").get(k)) for k in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    )
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    origin = element.find("origin")
    place = {} if origin is None else origin.attrib
    turn = Rotation.from_euler("xyz", np.array(place.get("rpy", "0 0 0").split(), float))
    matrix = turn.as_matrix()
    center = np.array(place.get("xyz", "0 0 0").split(), float)
    return float(element.find("mass").get("value")), center, matrix @ tensor @ matrix.T


def draw(robot, seed):
    rng = np.random.default_rng(seed)
    low, high = np.maximum(robot.lower, -3.0), np.minimum(robot.upper, 3.0)
    return dict(zip(robot.joint_names, rng.uniform(low, high).tolist(), strict=True))


def close(found, wanted, tolerance=1e-9):
    np.testing.assert_allclose(found, wanted, rtol=0.0, atol=tolerance)


@pytest.mark.parametrize("seed", [0, 1])
def test_links_are_where_the_arms_own_urdf_has_them(case, seed):
    mounts, robot = case
    values = draw(robot, seed)
    poses, masses = expected(mounts, values)
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.configuration(joints=values))
    bodies = {j: pin.Inertia.Zero() for j in range(1, robot.model.njoints)}
    for k, frame in enumerate(robot.model.frames):
        if frame.type == pin.FrameType.BODY:
            close(data.oMf[k].homogeneous, poses.pop(frame.name))
            own = pin.Inertia(*masses.pop(frame.name))
            bodies[frame.parentJoint] += frame.placement.act(own) if own.mass else own
    assert not poses
    assert not masses
    for j, own in bodies.items():
        close(robot.model.inertias[j].matrix(), own.matrix())


@pytest.mark.parametrize("seed", [2, 3])
def test_yourdfpy_reads_the_same_robot_from_the_file(case, saved, seed):
    mounts, robot = case
    values = draw(robot, seed)
    poses, masses = expected(mounts, values)
    read = yourdfpy.URDF.load(str(saved), load_meshes=False)
    assert read.validate()
    read.update_cfg(values)
    for part in read.robot.links:
        close(read.get_transform(part.name, "bus"), poses.pop(part.name))
        mass, center, tensor = masses.pop(part.name)
        place = np.eye(4) if part.inertial.origin is None else part.inertial.origin
        close(part.inertial.mass, mass)
        close(place[:3, 3], center)
        close(place[:3, :3] @ part.inertial.inertia @ place[:3, :3].T, tensor)
    assert not poses
    assert not masses


@pytest.mark.parametrize("seed", [4, 5])
def test_mujoco_compiles_the_same_robot_from_the_file(case, saved, seed):
    mujoco = pytest.importorskip("mujoco", minversion="4.0")
    mounts, robot = case
    values = draw(robot, seed)
    poses, masses = expected(mounts, values)
    root = ElementTree.parse(saved).getroot()
    settings = {
        "fusestatic": "false",
        "balanceinertia": "false",
        "boundmass": "0",
        "boundinertia": "0",
    }
    ElementTree.SubElement(ElementTree.SubElement(root, "mujoco"), "compiler", settings)
    spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))
    spec.worldbody.first_body().add_freejoint()
    model = spec.compile()
    data = mujoco.MjData(model)
    for name, value in values.items():
        data.qpos[model.joint(name).qposadr[0]] = value
    mujoco.mj_kinematics(model, data)
    assert model.nbody == 1 + len(poses)
    assert model.ngeom >= robot.collision_model.ngeoms
    for k in range(1, model.nbody):
        pose = poses.pop(model.body(k).name)
        close(data.xpos[k], pose[:3, 3])
        close(data.xmat[k].reshape(3, 3), pose[:3, :3])
        mass, center, tensor = masses.pop(model.body(k).name)
        close(model.body_mass[k], mass)
        if mass > 0.0:
            axes = Rotation.from_quat(np.roll(model.body_iquat[k], -1)).as_matrix()
            close(model.body_ipos[k], center)
            close(axes @ np.diag(model.body_inertia[k]) @ axes.T, tensor)


def test_mujoco_invents_no_mass_for_massless_links(tmp_path):
    mujoco = pytest.importorskip("mujoco", minversion="4.0")
    path = tmp_path / "arm.urdf"
    path.write_text(
        urdf(
            link("a", sphere(0.1)),
            link("b", inertial(1.0, (0.1, 0.1, 0.1))),
            link("tool", box((0.1, 0.1, 0.1))),
            joint("j", "revolute", "a", "b", (0, 0, 1)),
            joint("k", "fixed", "b", "tool", (0, 0, 1)),
        )
    )
    fp.compose(fp.Bus((1, 1, 1), 10.0), [fp.Mount(path)]).save(tmp_path / "made.urdf")
    spec = mujoco.MjSpec.from_file(str(tmp_path / "made.urdf"))
    spec.worldbody.first_body().add_freejoint()
    close(spec.compile().body_mass.sum(), 11.0)


def test_the_saved_robot_loads_again_as_the_same_robot(case, saved):
    _, robot = case
    srdf = saved.with_suffix(".srdf")
    again = fp.load_robot(saved, srdf=srdf if srdf.is_file() else None)
    assert again.model == robot.model
    assert (again.name, again.urdf, again.srdf) == (robot.name, robot.urdf, robot.srdf)
    assert again.collision_model == robot.collision_model
    assert again.postures == robot.postures


def test_the_connection_keeps_mujocos_angular_momentum_zero(case):
    mujoco = pytest.importorskip("mujoco", minversion="4.0")
    from tests.helpers.mujoco_flight import mujoco_model

    _, robot = case
    values, rng = draw(robot, 6), np.random.default_rng(6)
    q = robot.configuration(joints=values)
    rates = dict(zip(robot.joint_names, rng.normal(size=robot.nd).tolist(), strict=True))
    omega = fp.momentum.connection(robot, q) @ list(rates.values())
    model = mujoco_model(robot)
    data = mujoco.MjData(model)
    data.qvel[3:6] = omega
    for name, value in values.items():
        data.qpos[model.joint(name).qposadr[0]] = value
        data.qvel[model.joint(name).dofadr[0]] = rates[name]
    mujoco.mj_forward(model, data)
    mujoco.mj_subtreeVel(model, data)
    data.qvel[3:6] = 0.0
    reacting = np.array(data.subtree_angmom[1])
    mujoco.mj_forward(model, data)
    mujoco.mj_subtreeVel(model, data)
    still = np.linalg.norm(data.subtree_angmom[1])
    assert still > 0.1
    close(reacting / still, np.zeros(3))


def test_every_known_arm_can_be_mounted():
    for name in fp.arm_names():
        locked = FINGERS if name == "panda" else {}
        robot = fp.compose(fp.Bus((1, 1, 1), 100.0), [fp.Mount(name, (0, 0, 0.5), locked=locked)])
        assert robot.nd in (6, 7)
        assert not robot.replacements or name == "z1"  # whose own cylinders stay
        assert "mesh" not in {e.tag for e in ElementTree.fromstring(robot.urdf).iter()}


def test_a_bus_has_the_inertia_of_a_homogeneous_box():
    robot = fp.compose(fp.Bus((1.0, 2.0, 3.0), 12.0), [])
    base = robot.model.inertias[1]
    close(base.inertia, np.diag([13.0, 10.0, 5.0]))
    close(base.lever, np.zeros(3))


def test_pairs_exempt_in_an_arms_srdf_stay_exempt(case):
    mounts, robot = case
    if mounts is TWINS:
        assert ("l_base_link", "l_upper_arm_link") in robot.disabled_pairs
        assert ("r_forearm_link", "r_wrist_2_link") in robot.disabled_pairs
        assert not [p for p in robot.disabled_pairs if p[0][0] != p[1][0]]
    if mounts is FOUR:
        assert ("panda_panda_link5", "panda_panda_link7") in robot.disabled_pairs


def test_postures_and_exempt_links_are_in_the_srdf(random_arm, tmp_path):
    (tmp_path / "arm.srdf").write_text(
        "<robot name='a'><disable_collisions link1='arm0_0' link2='arm1_0'/></robot>"
    )
    robot = fp.compose(
        BUS,
        [fp.Mount(random_arm, prefix="a_", srdf=tmp_path / "arm.srdf")],
        postures={"folded": {"a_j0_0": 0.25}},
        may_touch=[("bus", "a_arm0_0")],
    )
    assert robot.postures == {"folded": {"a_j0_0": 0.25}}
    assert robot.disabled_pairs == (("a_arm0_0", "a_arm1_0"), ("a_arm0_0", "bus"))


def test_meshes_are_kept_by_absolute_path_when_asked_for(tmp_path):
    mount = [fp.Mount("ur5", (0, 0, 0.5))]
    robot = fp.compose(fp.Bus((1, 1, 1), 100.0), mount, shapes="meshes")
    assert len(robot.replacements) == 7
    robot.save(tmp_path / "there.urdf")
    again = fp.load_robot(tmp_path / "there.urdf", meshes="capsule")
    assert {r.by for r in again.replacements} == {"capsule"}
    assert robot.visual_model.ngeoms == 8  # the bus and the arm's seven pictures


def test_capsules_and_cylinders_are_kept(tmp_path):
    heavy = inertial(1.0, (0.1, 0.1, 0.1))
    path = tmp_path / "arm.urdf"
    path.write_text(
        urdf(
            link("a", heavy, sphere(0.1), capsule(0.1, 0.3)),
            link("b", heavy, box((1, 2, 3), rpy=(0.1, 0.2, 0.3))),
            joint("j", "prismatic", "a", "b", (0, 0, 1)),
        )
    )
    robot = fp.compose(fp.Bus((1, 1, 1), 10.0), [fp.Mount(path, (0, 0, 2))])
    names = [type(g.geometry).__name__ for g in robot.collision_model.geometryObjects]
    assert names == ["Box", "Sphere", "Capsule", "Box"]


def test_boxes_follow_origin_and_scale_of_their_mesh(tmp_path):
    """A mesh that is turned, shifted and mirrored: its points must lie in some box of the link."""
    corners = np.array([[0, 0, 0], [0.4, 0, 0], [0, 0.1, 0], [0.1, 0.02, 0.9], [0.3, 0.1, 0.2]])
    solid = trimesh.convex.convex_hull(corners)
    solid.export(tmp_path / "part.stl")
    scale, xyz, rpy = (-1.0, 2.0, 0.5), (0.3, -0.2, 0.1), (0.4, -0.7, 1.1)
    heavy = inertial(1.0, (0.1, 0.1, 0.1))
    path = tmp_path / "arm.urdf"
    path.write_text(urdf(link("a", heavy, mesh("part.stl", scale, xyz, rpy))))
    place = ((0.1, 0.2, 2.0), (0.5, 0.2, -0.1))
    robot = fp.compose(fp.Bus((0.1, 0.1, 0.1), 10.0), [fp.Mount(path, *place)])
    assert "around part.stl, at most" in robot.urdf
    assert robot.meshes == {}
    turn = Rotation.from_euler("xyz", rpy).as_matrix()
    points = np.array(trimesh.sample.sample_surface(solid, 500, seed=0)[0]) * scale @ turn.T + xyz
    root = transform(*place)
    points = points @ root[:3, :3].T + root[:3, 3]
    held = np.zeros(len(points), dtype=bool)
    for shape in robot.collision_model.geometryObjects[1:]:
        local = (points - shape.placement.translation) @ shape.placement.rotation
        held |= np.all(np.abs(local) <= shape.geometry.halfSide + 1e-7, axis=1)  # STL: 32 bits
    assert held.all()


def test_a_plan_of_a_composed_satellite_verifies(tmp_path):
    robot = fp.compose(
        fp.Bus((0.6, 0.6, 0.6), 40.0),
        [fp.Mount("z1", (0.3, 0.0, 0.0), (0.0, np.pi / 2, 0.0), locked={"jointGripper": -0.5})],
    )
    bent = {"joint2": 1.2, "joint3": -1.2, "joint5": 0.4}
    problem = fp.Problem(
        robot,
        fp.Scene([[1.5, 0.2, 0.0], [2.0, -0.9, 0.1]], [0.15, 0.2]),
        start=robot.configuration(joints={"joint1": 1.0, "joint2": 0.4, "joint3": -0.4}),
        goal=robot.configuration((3.0, 0.0, 0.0), joints=bent),
        lattice=fp.Lattice(12, fp.Axis(5, 0.25)),
        delta=0.01,
    )
    plan = fp.plan(problem, seed=0)
    assert plan.verify(200).ok
    assert np.linalg.norm(plan.arrival_attitude) > 1e-3
    plan.save(tmp_path / "plan.json")
    assert fp.Plan.load(tmp_path / "plan.json").problem.robot.urdf == robot.urdf
