"""Scenes: sums and how they are printed."""

import numpy as np
import pytest

import ffsr_plan as fp
from tests.helpers.obstacle_shapes import KINDS, random_shape, support


def test_a_sum_holds_the_spheres_of_both_scenes():
    both = fp.Scene([[0, 0, 0]], [1.0], excess=0.1) + fp.Scene([[3, 0, 0]], [2.0])
    assert np.array_equal(both.centers, [[0, 0, 0], [3, 0, 0]])
    assert both.radii.tolist() == [1.0, 2.0]
    assert both.excess == 0.1


def test_a_scene_is_printed_as_number_and_extent():
    scene = fp.Scene([[0, 0, 0], [3, 0, 0]], [1.0, 2.0])
    assert repr(scene) == "Scene(2 spheres, x -1 to 5 m, y -2 to 2 m, z -2 to 2 m)"
    assert repr(fp.Scene()) == "Scene(0 spheres)"
    assert "x -1 to 5 m" in scene._repr_html_()
    assert "empty" in fp.Scene()._repr_html_()
    assert "0.5 m" in fp.Scene([[0, 0, 0]], [1.0], 0.5)._repr_html_()


@pytest.mark.parametrize("kind", KINDS)
def test_bounds_are_how_far_shapes_reach_along_the_axes(kind):
    shapes = [random_shape(np.random.default_rng(k), kind, -np.ones(3), np.ones(3)) for k in (1, 2)]
    low, high = fp.Scene(shapes=shapes, growth=0.25).bounds()
    for k, axis in enumerate(np.eye(3)):
        assert high[k] == pytest.approx(0.25 + max(support(s, axis[None])[0] for s in shapes))
        assert low[k] == pytest.approx(-0.25 - max(support(s, -axis[None])[0] for s in shapes))


def test_the_extent_of_a_panel_is_as_thin_as_it_is():
    scene = fp.Scene([[0, 0, 3]], [0.5], shapes=[fp.Box([4, 0.02, 1])])
    assert "x -2 to 2 m, y -0.5 to 0.5 m, z -0.5 to 3.5 m" in repr(scene)
    assert "y -0.01 to 0.01 m" in fp.Scene(shapes=scene.shapes)._repr_html_()


def test_spheres_keep_what_they_come_from(tmp_path):
    part = fp.Scene([[0, 0, 0], [1, 0, 0]], [1, 1]).named("panel.stl")
    plain = fp.Scene([[2, 0, 0]], [1])
    scene = plain + plain + part + fp.Scene() + part.named("other.obj")
    names = ["", "", "panel.stl", "panel.stl", "other.obj", "other.obj"]
    assert [scene.source_of(k) for k in range(6)] == names
    assert scene.sources == (("", 2), ("panel.stl", 2), ("other.obj", 2))
    assert (plain + plain).sources == fp.Scene().named("x").sources == ()
    scene.to_csv(tmp_path / "spheres.csv")
    assert fp.Scene.from_csv(tmp_path / "spheres.csv").sources == (("spheres.csv", 6),)


@pytest.mark.parametrize("sources", [3, [("a",)], [(1, 1)], [("a", -1)], [("a", 2)], [("a", 0.5)]])
def test_sources_that_do_not_fit_the_spheres_are_refused(sources):
    with pytest.raises(fp.InvalidInput, match="scene sources"):
        fp.Scene([[0, 0, 0]], [1], sources=sources)


@pytest.mark.parametrize(
    "others", [{"shapes": [fp.Box([1, 1, 1])]}, {"keep_in": [fp.Box([9, 9, 9])]}]
)
def test_a_table_of_spheres_is_refused_where_it_would_drop_others(others, tmp_path):
    scene = fp.Scene([[0, 0, 0]], [1.0], **others)
    with pytest.raises(fp.InvalidInput, match=r"to_csv.*1 (box|zone).*spheres alone"):
        scene.to_csv(tmp_path / "spheres.csv")
    assert not (tmp_path / "spheres.csv").exists()


@pytest.mark.parametrize(
    "too_large",
    [
        lambda: fp.Box([2e4, 1, 1]),
        lambda: fp.Ball(2e4),
        lambda: fp.Cylinder(1.0, 2e4),
        lambda: fp.Ellipsoid([1, 1, 2e4]),
        lambda: fp.Hull([[0, 0, 0], [2e4, 0, 0], [0, 1, 0], [0, 0, 1]]),
    ],
)
def test_sizes_beyond_ten_kilometres_are_refused_with_the_limit(too_large):
    with pytest.raises(fp.InvalidInput, match=r"at most 10000|10000"):
        too_large()


def test_boxes_of_the_largest_size_are_not_touched_a_metre_away():
    point = fp.load_robot("point")
    scene = fp.Scene(shapes=[fp.Box([1e4] * 3, [0.0, 5e3 + 1.5, 0.0])])
    near = fp.clearance(point, scene, point.configuration())
    assert 1.0 < near < 1.5 + 1e-5
