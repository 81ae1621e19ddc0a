"""Pictures show visual meshes where a robot has them, or the shapes that are checked."""

import base64
import json
import re
from importlib.metadata import PackageNotFoundError, distribution

import pytest
import umsgpack
from PIL import Image

import ffsr_plan as fp
from ffsr_plan.display.scenes.projection import visible_shapes

try:
    distribution("example-robot-data")
    has_arms = True
except PackageNotFoundError:
    has_arms = False

needs_arms = pytest.mark.skipif(not has_arms, reason="example-robot-data is not installed")


@pytest.fixture(scope="module")
def plan():
    bus = fp.Bus(size=(1.0, 1.0, 1.0), mass=200.0)
    arms = [fp.Mount("ur5", position=(0.0, 0.0, 0.5), prefix="arm_")]
    robot = fp.compose(bus, arms, shapes="meshes")
    goal = robot.configuration((2.0, 0.0, 0.0), joints={"arm_shoulder_pan_joint": 0.4})
    lattice = fp.Lattice(4, fp.Axis(1, 0.2))
    return fp.plan(fp.Problem(robot, fp.Scene(), robot.neutral(), goal, lattice=lattice))


def triangles(page):
    """Triangles of the robot on a page, without its transparent copies."""
    text = re.search(r'"commands": (\[.*?\])', page, flags=re.S)[1]
    commands = [umsgpack.unpackb(base64.b64decode(c)) for c in json.loads(text)]
    return sum(
        len(geometry["data"]["index"]["array"].data) // 12
        for c in commands
        if c["type"] == "set_object" and c["path"].startswith("/meshcat/robot/")
        for geometry in c["object"]["geometries"]
        if "data" in geometry
    )


@needs_arms
def test_a_robot_of_meshes_looks_as_its_urdf_says_or_as_it_is_checked(plan, tmp_path):
    robot = plan.problem.robot
    fine = sum(
        shape.geometry.num_tris
        for shape in visible_shapes(robot)
        if hasattr(shape.geometry, "num_tris")
    )
    assert fine > 20_000
    pages = {}
    for shapes in ("visual", "collision"):
        path = tmp_path / f"{shapes}.html"
        plan.write_html(path, shapes=shapes)
        pages[shapes] = path.read_text(encoding="utf-8")
    assert triangles(pages["visual"]) == fine
    assert 0 < triangles(pages["collision"]) < fine / 4


@needs_arms
def test_moving_pictures_show_the_chosen_shapes(plan, tmp_path):
    flight = plan.timed(joint_acceleration=0.1, thruster_acceleration=0.05)
    for name, write, given in (
        ("plan", plan.write_gif, {"frames": 2}),
        ("flight", flight.write_gif, {"speed": 50}),
    ):
        for shapes in ("visual", "collision"):
            write(tmp_path / f"{name}_{shapes}.gif", width=300, shapes=shapes, **given)
        first, second = (
            Image.open(tmp_path / f"{name}_{shapes}.gif").convert("RGB").tobytes()
            for shapes in ("visual", "collision")
        )
        assert first != second


def test_other_shapes_are_refused(fig2a_plan, flight, tmp_path):
    for write in (fig2a_plan.write_html, flight.write_html):
        with pytest.raises(fp.InvalidInput, match=r"shapes.*visual, collision"):
            write(tmp_path / "page.html", shapes="visuals")
    for write in (fig2a_plan.write_gif, flight.write_gif):
        with pytest.raises(fp.InvalidInput, match=r"shapes.*visual, collision"):
            write(tmp_path / "plan.gif", shapes="visuals")


@needs_arms
def test_visual_meshes_keep_the_colours_of_their_urdf():
    robot = fp.compose(fp.Bus(size=(1, 1, 1), mass=50.0), [fp.Mount("so101")], shapes="meshes")
    meshes = [shape for shape in visible_shapes(robot) if hasattr(shape.geometry, "num_tris")]
    colours = {tuple(round(float(part), 2) for part in shape.meshColor) for shape in meshes}
    assert colours == {(1.0, 0.82, 0.12, 1.0), (0.1, 0.1, 0.1, 1.0)}  # printed parts, motors
