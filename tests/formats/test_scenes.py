"""Scenes of other tools: the obstacles are where they were, and what is wrong is named."""

import numpy as np
import pytest

import ffsr_plan as fp

fm = fp.formats
NEW = """(noname)+
* table top
1 0 0
0 0 0.7071067811865476 0.7071067811865476
2
box
1 2 3
0.5 0 0
0 0 0 1
0 0 0 0
cylinder
0.1 0.4
0 0 1
0 0 0 1
1 0 0 1
1
corner
0 0 0
0 0 0 1
.
"""
OLD = "(noname)+\n* ball\n1\nsphere\n0.25\n1 2 3\n0 0 0 1\n0 0 0 0\n.\n"
ROBOMETRICS = """shelf:
- obstacles:
    cuboid:
      cube: {dims: [1, 2, 3], pose: [0.1, 0.2, 0.3, 0.5, 0.5, 0.5, 0.5]}
- obstacles:
    cylinder:
      can: {height: 0.2, radius: 0.05, pose: [1, 0, 0, 1, 0, 0, 0]}
    sphere: {}
"""
OBJECTS = """world:
  collision_objects:
  - id: can
    pose: {position: [0, 0, 1], orientation: [0, 0, 1, 0]}
    primitives: [{type: cylinder, dimensions: [0.2, 0.05]}, {type: 1, dimensions: [1, 2, 3]}]
    primitive_poses:
    - {position: [1, 0, 0], orientation: [0, 0, 0, 1]}
    - {position: {x: 0, y: 1, z: 0}}
"""


def everything():
    points = np.random.default_rng(0).normal(size=(12, 3))
    return fp.Scene(
        [[1.0, 2.0, 3.0]],
        [0.5],
        shapes=[
            fp.Box([1, 2, 3], [0.1, 0.2, 0.3], [0.3, 0.2, 0.1], "a box"),
            fp.Capsule(0.1, 0.5, [1, 1, 1], [0.1, 1.0, 0.5]),
            fp.Cylinder(0.2, 0.3, [0, 0, 1], [1, 0, 0]),
            fp.Hull(points, [2.0, 0.0, 0.0], [0.5, 0.1, 0.2]),
        ],
    )


def distances(scene, point):
    """Of a small robot to the scene at many places."""
    rng = np.random.default_rng(3)
    places = [point.configuration(rng.uniform(-4.0, 4.0, 3)) for _ in range(60)]
    return np.array([float(fp.clearance(point, scene, q)) for q in places])


def test_a_scene_text_holds_the_same_obstacles(point, tmp_path):
    fm.write_moveit_scene(tmp_path / "s.scene", everything())
    found = fm.read_scene(tmp_path / "s.scene")
    assert np.abs(distances(found, point) - distances(everything(), point)).max() < 1e-6
    assert found.shapes[1].name == "a box"


def test_primitives_hold_the_same_obstacles(point, tmp_path):
    pytest.importorskip("yaml")
    shapes = everything().shapes
    given = fp.Scene([[1, 2, 3]], [0.5], shapes=[shapes[0], shapes[2]])
    for end in ("yaml", "json"):
        fm.write_primitives(tmp_path / f"s.{end}", given)
        found = fm.read_scene(tmp_path / f"s.{end}")
        assert np.abs(distances(found, point) - distances(given, point)).max() < 1e-9


def test_a_model_holds_the_same_obstacles(point, tmp_path):
    pytest.importorskip("mujoco")
    fm.write_mjcf(tmp_path / "s.xml", point, everything())
    found = fm.read_mjcf_scene(tmp_path / "s.xml")
    assert np.abs(distances(found, point) - distances(everything(), point)).max() < 1e-6


def test_both_texts_of_moveit_are_read(tmp_path):
    for name, text in (("new", NEW), ("old", OLD)):
        (tmp_path / f"{name}.scene").write_text(text)
    box, can = fm.read_moveit_scene(tmp_path / "new.scene").shapes
    assert np.abs(box.position - [1.0, 0.5, 0.0]).max() < 1e-12
    assert box.size.tolist() == [1.0, 2.0, 3.0]
    assert box.name == "table top"
    assert (can.radius, can.length) == (0.1, 0.4)
    assert np.abs(can.position - [1.0, 0.0, 1.0]).max() < 1e-12
    (ball,) = fm.read_moveit_scene(tmp_path / "old.scene").shapes
    assert ball.position.tolist() == [1.0, 2.0, 3.0]


def test_both_kinds_of_primitives_are_read(tmp_path):
    pytest.importorskip("yaml")
    (tmp_path / "r.yaml").write_text(ROBOMETRICS)
    (box,) = fm.read_primitives(tmp_path / "r.yaml").shapes
    assert box.attitude.tolist() == [0.5, 0.5, 0.5, 0.5]
    assert box.position.tolist() == [0.1, 0.2, 0.3]
    (can,) = fm.read_primitives(tmp_path / "r.yaml", problem=1).shapes
    assert (can.radius, can.length, can.name) == (0.05, 0.2, "can")
    (tmp_path / "o.yaml").write_text(OBJECTS)
    can, box = fm.read_scene(tmp_path / "o.yaml").shapes
    assert (can.radius, can.length) == (0.05, 0.2)
    assert np.abs(can.position - [-1.0, 0.0, 1.0]).max() < 1e-12
    assert np.abs(box.position - [0.0, -1.0, 1.0]).max() < 1e-12


def test_cones_lie_in_their_hulls(tmp_path):
    text = OLD.replace("sphere\n0.25", "cone\n0.5 1.0")
    (tmp_path / "c.scene").write_text(text)
    (hull,) = fm.read_moveit_scene(tmp_path / "c.scene").shapes
    radii = np.linalg.norm(hull.points[:, :2], axis=1)
    assert np.cos(np.pi / 24) * radii.max() >= 0.5 - 1e-12
    assert hull.points[:, 2].max() == 0.5


@pytest.mark.parametrize(
    ("old", "new", "field"),
    [
        ("sphere", "torus", "line 4"),
        ("0.25", "x", "line 5"),
        ("0 0 0 1\n", "0 0 0 5\n", "line 7"),
        (".\n", "", "s.scene"),
        ("* ball", "ball", "line 2"),
    ],
)
def test_what_is_wrong_in_a_scene_text_is_named(tmp_path, old, new, field):
    (tmp_path / "s.scene").write_text(OLD.replace(old, new))
    with pytest.raises(fp.InvalidInput) as error:
        fm.read_moveit_scene(tmp_path / "s.scene")
    assert field in error.value.what


@pytest.mark.parametrize("scene", [fp.Scene(keep_in=[fp.Ball(5.0)]), fp.Scene(
    bodies=[fp.MovingBody([fp.Ball(1.0)], fp.Drift([1.0, 0.0, 0.0]))]), "scene"])  # fmt: skip
def test_what_a_format_lacks_is_not_written(tmp_path, scene):
    for write in (fm.write_moveit_scene, fm.write_primitives):
        path = tmp_path / ("s.scene" if write is fm.write_moveit_scene else "s.yaml")
        with pytest.raises(fp.InvalidInput, match="scene"):
            write(path, scene)
        assert not path.exists()
