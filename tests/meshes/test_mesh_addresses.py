"""Addresses of mesh files: packages as ROS finds them, escapes, and what an error says."""

import numpy as np
import pytest
import trimesh

import ffsr_plan as fp
from ffsr_plan.meshes.mesh_addresses import find, found
from ffsr_plan.meshes.mesh_files import hull_corners
from tests.helpers.single_link_robots import MASS, blob
from tests.helpers.urdf_builders import link, mesh, urdf


@pytest.fixture
def workspace(tmp_path, monkeypatch):
    """A workspace with a robot's package, one of meshes beside it, and a renamed one."""
    for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
        monkeypatch.delenv(variable, raising=False)
    for folder in ("ws/arm_robot/urdf", "ws/arm_robot/parts", "ws/tool_meshes", "ws/checkout-3"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "ws/checkout-3/package.xml").write_text("<package><name>renamed</name></package>")
    for place in ("arm_robot/parts/a.stl", "tool_meshes/b.stl", "checkout-3/c d.stl"):
        blob(0).export(tmp_path / "ws" / place)
    return tmp_path / "ws"


def below(workspace, address, folder="arm_robot/urdf"):
    path = find(address, [str(workspace / folder)])
    return None if path is None else path.resolve().relative_to(workspace.resolve()).as_posix()


def test_a_package_is_found_upwards_by_its_folder(workspace):
    assert below(workspace, "package://arm_robot/parts/a.stl") == "arm_robot/parts/a.stl"
    assert below(workspace, "package://tool_meshes/b.stl") == "tool_meshes/b.stl"
    assert below(workspace, "package://arm_robot/parts/b.stl") is None
    assert below(workspace, "package://arm/parts/a.stl") is None


def test_a_package_is_found_by_the_name_in_its_manifest(workspace):
    assert below(workspace, "package://renamed/c d.stl", "checkout-3") == "checkout-3/c d.stl"
    assert below(workspace, "package://renamed/c%20d.stl", "checkout-3") == "checkout-3/c d.stl"
    deeper = "checkout-3/urdf/arms"
    assert below(workspace, "package://renamed/c d.stl", deeper) == "checkout-3/c d.stl"
    (workspace / "checkout-3/package.xml").write_text("<package>")
    assert below(workspace, "package://renamed/c d.stl", "checkout-3") is None


@pytest.mark.parametrize(
    ("variable", "entry"),
    [
        ("ROS_PACKAGE_PATH", "ws"),
        ("ROS_PACKAGE_PATH", "ws/tool_meshes"),
        ("ROS_PACKAGE_PATH", "nowhere:."),
        ("AMENT_PREFIX_PATH", "install"),
    ],
)
def test_a_package_is_found_by_the_variables_of_ros(
    workspace, tmp_path, monkeypatch, variable, entry
):
    (tmp_path / "elsewhere").mkdir()
    address, folders = "package://tool_meshes/b.stl", [str(tmp_path / "elsewhere")]
    if variable.startswith("AMENT"):
        (tmp_path / "install").mkdir()
        workspace.rename(tmp_path / "install" / "share")
    else:
        workspace.rename(tmp_path / "elsewhere" / "ws")
        (tmp_path / "ws").symlink_to(tmp_path / "elsewhere" / "ws")
        folders = []
    assert find(address, folders) is None
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv(variable, ":".join(str(tmp_path / each) for each in entry.split(":")))
    assert find(address, folders) is not None


def test_file_addresses_are_decoded(workspace):
    place = workspace / "checkout-3" / "c d.stl"
    for address in (
        f"file://{place}",
        f"file:{place}",
        f"file://localhost{place}",
        f"file://{str(place).replace(' ', '%20')}",
        "file://c%20d.stl",
        "c d.stl",
    ):
        assert below(workspace, address, "checkout-3") == "checkout-3/c d.stl", address
    assert below(workspace, "c%20d.stl", "checkout-3") is None


@pytest.mark.parametrize(
    "address", [r"package://arm_robot\parts\a.stl", r"..\parts\a.stl", r"file://..\parts\a.stl"]
)
def test_backslashes_of_windows_are_slashes(workspace, address):
    assert below(workspace, address) == "arm_robot/parts/a.stl"


def test_a_missing_file_names_what_was_searched(workspace, monkeypatch):
    monkeypatch.setenv("ROS_PACKAGE_PATH", "/opt/somewhere")
    folder = str(workspace / "arm_robot" / "urdf")
    with pytest.raises(fp.InvalidInput, match="package 'gone' searched in") as caught:
        found("package://gone/a.stl", ["/first", folder], "robot")
    for part in ("/first", f"above {folder}", "ROS_PACKAGE_PATH (/opt/somewhere)", "AMENT"):
        assert part in str(caught.value)
    with pytest.raises(fp.InvalidInput, match="nothing is downloaded from https://"):
        found("https://a.b/c.stl", [folder], "robot")
    with pytest.raises(fp.InvalidInput, match=rf"an existing file \(looked for in {folder}\)$"):
        found("a.stl", [folder], "robot")
    with pytest.raises(fp.InvalidInput, match=r"an existing file \(there is none\)$"):
        found("/nowhere/a.stl", [folder], "robot")
    assert find("a" * 5000, [folder]) is None
    assert find("package://" + "a/" * 3000, [folder]) is None


def test_robots_and_mounts_use_package_dirs(workspace, tmp_path):
    address, away = "package://tool_meshes/b.stl", tmp_path / "away"
    away.mkdir()
    text = urdf(link("base", MASS, mesh(address)))
    (away / "arm.urdf").write_text(text)
    (workspace / "arm_robot/urdf/arm.urdf").write_text(text)
    bus = fp.Bus(size=(1, 1, 1), mass=10.0)
    for path, folders in (
        (workspace / "arm_robot/urdf/arm.urdf", ()),
        (away / "arm.urdf", [workspace]),
        (away / "arm.urdf", [str(workspace / "tool_meshes")]),
    ):
        assert list(fp.load_robot(path, folders).meshes) == [address]
        mount = fp.Mount(path, position=(1, 0, 0), prefix="a_", package_dirs=folders)
        assert "a_base" in fp.compose(bus, [mount]).link_names
    for load in (
        lambda: fp.load_robot(away / "arm.urdf"),
        lambda: fp.compose(bus, [fp.Mount(away / "arm.urdf")]),
    ):
        with pytest.raises(fp.InvalidInput, match=r"link 'base', collision mesh.*'tool_meshes'"):
            load()
    for wrong in ("folder", [3], 4):
        with pytest.raises(fp.InvalidInput, match="package_dirs"):
            fp.load_robot(away / "arm.urdf", wrong)
        with pytest.raises(fp.InvalidInput, match="package_dirs of a mount"):
            fp.Mount("z1", package_dirs=wrong)


def test_pictures_show_meshes_of_packages_too(workspace):
    path = workspace / "arm_robot/urdf/arm.urdf"
    shape = mesh("package://tool_meshes/b.stl")
    path.write_text(urdf(link("base", MASS, shape, shape.replace("collision", "visual"))))
    assert fp.load_robot(path).visual_model.ngeoms == 1


def test_mesh_addresses_are_packages_paths_or_files(tmp_path):
    (tmp_path / "pkg").mkdir()
    blob(3).export(tmp_path / "pkg" / "blob.stl")
    path = tmp_path / "pkg" / "robot.urdf"
    for address in ("package://pkg/blob.stl", "blob.stl", f"file://{tmp_path}/pkg/blob.stl"):
        path.write_text(urdf(link("base", MASS, mesh(address))))
        robot = fp.load_robot(path, [tmp_path])
        assert list(robot.meshes) == [address]


@pytest.mark.parametrize(
    "address",
    [
        "gone.stl",
        "package://pkg/gone.stl",
        "file:///gone.stl",
        "http://127.0.0.1/a.stl",
        "bad.stl",
        "flat.stl",
        "robot.urdf",
        "bad.dae",
    ],
)
def test_a_mesh_that_cannot_be_used_is_named_with_its_link(tmp_path, address):
    (tmp_path / "127.0.0.1").mkdir()
    blob(0).export(tmp_path / "127.0.0.1" / "a.stl")  # where a part of the address would lead
    (tmp_path / "bad.stl").write_text("no mesh at all")
    (tmp_path / "bad.dae").write_text("<COLLADA>")
    trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 2, 3]]).export(
        tmp_path / "flat.stl"
    )
    path = tmp_path / "robot.urdf"
    path.write_text(urdf(link("base", MASS, mesh(address))))
    with pytest.raises(fp.InvalidInput, match="link 'base'") as caught:
        fp.load_robot(path)
    assert address in str(caught.value)


def test_the_unit_that_a_dae_names_is_applied(tmp_path):
    path = tmp_path / "blob.dae"
    blob(5).export(path)
    exported = path.read_text()
    metres = hull_corners("blob.dae", [str(tmp_path)], "")
    path.write_text(exported.replace("<up_axis>", "<unit name='inch' meter='0.0254'/><up_axis>"))
    inches = hull_corners("blob.dae", [str(tmp_path)], "")
    assert np.allclose(inches, 0.0254 * metres)
