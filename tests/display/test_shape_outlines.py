"""Meshes of shapes are closed, face outwards and fill the right volume; outlines project them."""

from collections import Counter

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.display.scenes.projection import convex_outline
from ffsr_plan.display.scenes.shape_outlines import (
    joined,
    labels,
    mesh_of,
    outline_of,
    points_of_extent,
    section,
    shaded_sides,
    unit_normals,
)

PLACED = {"position": [1.0, -2.0, 0.5], "attitude": [0.4, -0.3, 0.8]}
LIGHT = np.array([0.0, 0.0, 1.0])
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
VOLUMES = [
    (fp.Box([0.4, 1.0, 2.0], **PLACED), 0.8),
    (fp.Ball(0.7, PLACED["position"]), 4.0 / 3.0 * np.pi * 0.7**3),
    (fp.Capsule(0.3, 1.2, **PLACED), np.pi * 0.09 * 1.2 + 4.0 / 3.0 * np.pi * 0.027),
    (fp.Cylinder(0.3, 1.2, **PLACED), np.pi * 0.09 * 1.2),
    (fp.Ellipsoid([0.2, 0.4, 0.9], **PLACED), 4.0 / 3.0 * np.pi * 0.072),
    (fp.Hull(CORNERS, **PLACED), 1.0 / 6.0),
]
SHAPES = [shape for shape, _ in VOLUMES]
by_kind = pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.word)


def area(polygon):
    x, y = polygon.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


@pytest.mark.parametrize(("shape", "volume"), VOLUMES, ids=[shape.word for shape in SHAPES])
def test_a_mesh_encloses_the_volume_of_its_shape(shape, volume):
    """By the divergence theorem; the sign says that faces are counter-clockwise from outside."""
    a, b, c = np.moveaxis(mesh_of(shape, 48).triangles, 1, 0)
    enclosed = float(np.sum(np.cross(a, b) * c)) / 6.0
    assert enclosed == pytest.approx(volume, rel=5e-3)
    assert enclosed <= volume * (1.0 + 1e-9)


@by_kind
def test_a_mesh_is_closed(shape):
    """Each edge is there twice, once in each direction."""
    corners = np.round(mesh_of(shape).triangles, 9) + 0.0
    edges = Counter()
    for triangle in corners:
        names = [tuple(corner) for corner in triangle]
        edges.update(zip(names, names[1:] + names[:1], strict=True))
    assert all(edges[b, a] == count == 1 for (a, b), count in edges.items())


def distance_outside(shape, points):
    """How far points (n, 3) are beyond the surface in its own axes; 0 on it, by hand."""
    local = (points - shape.position) @ rotations.matrix(shape.attitude)
    if isinstance(shape, fp.Ellipsoid):
        return np.linalg.norm(local / shape.semi_axes, axis=1) - 1.0
    beyond = np.abs(local) - shape.half_sides
    if isinstance(shape, fp.Cylinder):
        aside = np.linalg.norm(local[:, :2], axis=1) - shape.radius
        return np.maximum(aside, beyond[:, 2])
    if isinstance(shape, fp.Box):
        return beyond.max(axis=1)
    return np.linalg.norm(np.maximum(beyond, 0.0), axis=1) - shape.skin


@pytest.mark.parametrize("shape", SHAPES[:5], ids=lambda shape: shape.word)
@pytest.mark.parametrize("rings", [6, 7, 24])
def test_vertices_lie_on_the_surface(shape, rings):
    outside = distance_outside(shape, mesh_of(shape, rings).vertices)
    poles = isinstance(shape, fp.Cylinder) * 4 * 2 * (rings // 2)  # in the middle of its two lids
    assert np.count_nonzero(np.abs(outside) > 1e-9) <= poles
    assert outside.max() < 1e-9


def test_a_flat_panel_is_seen_edge_on():
    panel = fp.Box([2.0, 0.0, 1.0])
    outline = outline_of(panel, np.eye(3)[:2])
    assert np.ptp(outline[:, 0]) == pytest.approx(2.0)
    assert 0.0 < np.ptp(outline[:, 1]) <= 0.02
    assert area(outline) > 0.0


@pytest.mark.parametrize("angle", [0.0, 0.3, np.pi / 4])
def test_a_box_seen_from_above_is_its_rotated_rectangle(angle):
    outline = outline_of(fp.Box([2.0, 0.5, 1.0], [3.0, 1.0, 9.0], [angle, 0, 0]), np.eye(3)[:2])
    assert len(outline) == 4
    assert area(outline) == pytest.approx(1.0)
    assert np.allclose(outline.mean(axis=0), [3.0, 1.0])


def test_a_capsule_from_the_side_is_a_rectangle_with_half_discs():
    outline = outline_of(fp.Capsule(0.3, 1.2), np.array([[1.0, 0, 0], [0, 0, 1.0]]))
    assert area(outline) == pytest.approx(0.6 * 1.2 + np.pi * 0.09, rel=1e-3)
    assert np.allclose(outline.max(axis=0), [0.3, 0.9])


@by_kind
def test_an_outline_holds_the_projection_of_the_mesh_closely(shape):
    axes = rotations.matrix(rotations.from_angles(np.array([0.2, 0.9, -0.4])))
    outline, flat = outline_of(shape, axes[:2]), mesh_of(shape, 96).vertices @ axes[:2].T
    assert area(outline) == pytest.approx(area(convex_outline(flat)), rel=2e-3)
    both = convex_outline(np.vstack([outline, flat]))
    assert area(both) == pytest.approx(area(outline), rel=2e-3)


@by_kind
def test_the_sides_that_face_the_viewer_cover_the_outline_once(shape):
    """Of a convex body; light from the viewer is the cosine of the side's angle."""
    axes = rotations.matrix(rotations.from_angles(np.array([0.2, 0.9, -0.4])))
    triangles, light = shaded_sides(shape, axes, LIGHT)
    seen = sum(area(triangle) for triangle in triangles)
    assert seen == pytest.approx(area(convex_outline(mesh_of(shape).vertices @ axes[:2].T)))
    assert seen == pytest.approx(area(outline_of(shape, axes[:2])), rel=1e-2)
    assert np.all((light > 0.0) & (light <= 1.0))
    normals = unit_normals(mesh_of(shape).triangles @ axes.T)
    assert np.allclose(np.sort(light), np.sort(normals[normals[:, 2] > 0.0, 2]))


def test_a_cut_of_a_ball_is_a_smaller_circle():
    ball = fp.Ball(1.0, [2.0, 0.0, 0.0])
    for height in (0.0, 0.01, 0.6, -0.6):  # at 0, the plane goes through vertices
        cut = section(ball, np.eye(3), height)
        radii = np.linalg.norm(cut - [2.0, 0.0], axis=1)
        assert np.allclose(radii, np.sqrt(1.0 - height**2), atol=6e-3)
    assert len(section(ball, np.eye(3), 1.1)) == 0


@by_kind
def test_a_cut_lies_inside_the_outline(shape):
    height = float(mesh_of(shape).vertices[:, 2].mean())
    cut, outline = section(shape, np.eye(3), height), outline_of(shape, np.eye(3)[:2])
    assert 0.0 < area(cut) <= area(outline) + 1e-9
    both = convex_outline(np.vstack([cut, outline]))
    assert area(both) == pytest.approx(area(outline), rel=1e-3)


def test_labels_are_names_or_numbers_among_all_obstacles():
    shapes = [fp.Box([1, 1, 1], [0, 0, 3], name="bus"), fp.Ball(0.5, [1, 2, 3])]
    scene = fp.Scene([[0, 0, 0], [1, 1, 1]], [0.1, 0.1], shapes=shapes)
    assert [(each.text, each.is_name) for each in labels(scene)] == [("bus", True), ("3", False)]
    assert [each.top for each in labels(scene)] == pytest.approx([3.5, 3.5])
    assert np.array_equal(labels(scene)[1].at, [1.0, 2.0, 3.0])


def test_extents_hold_shapes_and_zones_that_end():
    zones = [fp.Box([8, 6, 4]), fp.HalfSpace([1, 0, 0], [90, 0, 0])]
    points = points_of_extent(fp.Scene(shapes=[fp.Ball(1.0, [5, 0, 0])], keep_in=zones))
    assert np.allclose(points.max(axis=0), [6.0, 3.0, 2.0])
    assert np.allclose(points.min(axis=0), [-4.0, -3.0, -2.0])
    assert points_of_extent(fp.Scene([[1, 1, 1]], [1.0])).shape == (0, 3)


def test_joined_meshes_keep_their_triangles():
    meshes = [mesh_of(shape, 8) for shape in SHAPES]
    expected = np.concatenate([mesh.triangles for mesh in meshes])
    assert np.array_equal(joined(meshes).triangles, expected)
