"""Scenes: sums and how they are printed."""

import numpy as np

import ffsr_plan as fp


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
