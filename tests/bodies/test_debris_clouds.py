"""Clouds of drifting spheres: their files, and the tree over them."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.bodies.debris.drifting_tree import drifting_tree
from tests.helpers.drifting_spheres import cloud_about

GIVEN = {"centers": [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], "radii": [0.1, 0.2]}
STILL = np.zeros((2, 3))


@pytest.mark.parametrize("time", [0.0, 13.0, 40.0, 90.0])
def test_every_node_stays_around_its_spheres(time):
    cloud = cloud_about(1, 300)
    tree = drifting_tree(cloud.centers, cloud.radii, cloud.velocities, 20.0)
    away = time - tree.middle
    centers = tree.spheres[:, :3] + away * tree.drifts[:, :3]
    assert np.allclose(centers, cloud.centers_at(time)[tree.order], atol=1e-12)

    def spheres_below(node):
        left, right = tree.children[node]
        if left < 0:
            return list(range(-1 - left, right))
        return spheres_below(left) + spheres_below(right)

    assert sorted(spheres_below(0)) == list(range(300))
    for node in range(len(tree.nodes)):
        own = spheres_below(node)
        middle = tree.nodes[node, :3] + away * tree.node_drifts[node, :3]
        around = tree.nodes[node, 3] + abs(away) * tree.node_drifts[node, 3]
        reach = np.linalg.norm(centers[own] - middle, axis=1) + tree.spheres[own, 3]
        assert reach.max() <= around + 1e-12
        assert tree.drifts[own, 4].max() <= tree.node_drifts[node, 4]


def test_a_table_is_read_again_bit_for_bit(tmp_path):
    cloud = cloud_about(0)
    cloud.to_csv(tmp_path / "debris.csv")
    assert fp.DebrisCloud.from_csv(tmp_path / "debris.csv", "shell") == cloud
    assert fp.DebrisCloud.from_csv(tmp_path / "debris.csv").name == "debris.csv"


def test_columns_stand_in_any_order_and_unit(tmp_path):
    text = "vx [mm/s],vy,vz,radius [cm],x [km],y,z\n5,0.1,0,30,0.001,2,3\n"
    (tmp_path / "a.csv").write_text(text)
    cloud = fp.DebrisCloud.from_csv(tmp_path / "a.csv")
    assert np.allclose(cloud.centers, [[1.0, 2.0, 3.0]], atol=1e-15)
    assert np.allclose(cloud.velocities, [[0.005, 0.1, 0.0]], atol=1e-15)
    assert cloud.radii == pytest.approx([0.3])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("x,y,z,radius,vx,vy\n", "a column vz as well"),
        ("x,y,z,radius,vx,vy,vz,mass\n", "mass"),
        ("x,y,z,radius,vx [m],vy,vz\n", "unit of column vx"),
        ("x,y,z,radius [m/s],vx,vy,vz\n", "unit of column radius"),
        ("x,y,z,radius,vx,vy,vz\n0,0,0,0.1,0,fast,0\n", "line 2, column vy"),
        ("x,y,z,radius,vx,vy,vz\n1,0,0,0.1,0,0,0\n0,0,0,-1,0,0,0\n", r"a\.csv', radii, sphere 1"),
        ("x,y,z,radius,vx,vy,vz\n", "at least one sphere"),
    ],
)
def test_a_table_that_is_wrong_is_named(tmp_path, text, words):
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(fp.InvalidInput, match=words):
        fp.DebrisCloud.from_csv(tmp_path / "a.csv")


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("radii", [0.1, 0.0], "debris cloud 'shell', radii, sphere 1: got 0.0"),
        ("radii", [0.1], "debris cloud 'shell', radii: got '1 radii'; allowed: one for each of 2"),
        ("velocities", [[0.0, 0.0, np.nan], [0.0, 0.0, 0.0]], "velocities, sphere 0"),
        ("centers", [[0.0, 0.0, 1e7], [0.0, 0.0, 0.0]], "centers, sphere 0"),
    ],
)
def test_a_wrong_sphere_is_named_with_its_cloud(field, value, words):
    with pytest.raises(fp.InvalidInput) as error:
        fp.DebrisCloud(**{"velocities": STILL, **GIVEN, field: value}, name="shell")
    assert words in str(error.value)


def test_a_scene_has_debris_where_it_is_at_a_time():
    cloud = fp.DebrisCloud(**GIVEN, velocities=[[0.0, 0.5, 0.0], [0.0, 0.0, 0.0]], name="shell")
    scene = fp.Scene([[9.0, 0.0, 0.0]], [1.0], shapes=[fp.Ball(1.0)], debris=[cloud], growth=0.05)
    there = scene.at(4.0)
    assert np.array_equal(there.centers, [[9.0, 0.0, 0.0], [0.0, 2.0, 0.0], [1.0, 0.0, 0.0]])
    assert there.radii == pytest.approx([1.0, 0.15, 0.25])
    assert not there.moves
    assert len(scene) == len(there) == 4
    assert scene.source_of(3) == there.source_of(2) == "sphere 1 of debris cloud 'shell'"
    assert repr(scene).startswith("Scene(1 sphere, 1 ball, 1 debris cloud of 2 spheres")
    assert scene + fp.Scene() == scene
    with pytest.raises(fp.InvalidInput, match="nothing that moves"):
        _ = scene.tree


def test_debris_needs_a_duration():
    robot = fp.load_robot("planar_dual_arm")
    cloud = cloud_about(0)
    with pytest.raises(fp.InvalidInput, match="duration"):
        fp.Problem(
            robot,
            fp.Scene(debris=[cloud]),
            start=robot.neutral(),
            goal=robot.configuration((4.0, 0.0, 0.0)),
            lattice=fp.Lattice(4),
        )
