"""Boxes around meshes hold all that the mesh encloses, with little to spare."""

import numpy as np
import pytest
import trimesh

from ffsr_plan.meshes import box_cover
from ffsr_plan.meshes.mesh_files import surface
from ffsr_plan.satellites import arms


def triangles_of(mesh):
    return np.asarray(mesh.triangles, dtype=np.float64)


def held(boxes, points):
    low = np.array([box.low for box in boxes])[:, None]
    high = np.array([box.high for box in boxes])[:, None]
    return np.any(np.all((points >= low) & (points <= high), axis=2), axis=0)


def volume(boxes):
    return sum(np.prod(box.high - box.low) for box in boxes)


def corner(along):
    """Two boxes that make an L, the long one along an axis."""
    sizes = np.array([[0.1, 0.1, 0.9], [0.1, 0.5, 0.1]])
    places = np.array([[0.05, 0.05, 0.45], [0.05, 0.25, 0.05]])
    sizes, places = (np.roll(values, along - 2, axis=1) for values in (sizes, places))
    return trimesh.util.concatenate(
        [
            trimesh.creation.box(size, trimesh.transformations.translation_matrix(place))
            for size, place in zip(sizes, places, strict=True)
        ]
    )


@pytest.mark.parametrize("along", [0, 1, 2])
def test_an_l_becomes_two_boxes(along):
    boxes = box_cover.boxes_around(triangles_of(corner(along)))
    assert len(boxes) == 2
    wanted = 0.1 * 0.1 * 0.9 + 0.1 * 0.4 * 0.1
    assert wanted - 1e-9 <= volume(boxes) <= 1.05 * wanted


def test_a_box_is_its_own_box():
    mesh = trimesh.creation.box((0.3, 0.2, 0.1))
    (box,) = box_cover.boxes_around(triangles_of(mesh))
    np.testing.assert_allclose(box.high - box.low, (0.3, 0.2, 0.1), atol=1e-9)


def test_points_within_a_ring_a_ball_and_a_rod_are_in_the_boxes():
    """Solids whose inside is known by formula, turned anyhow."""
    rng = np.random.default_rng(0)
    solids = {
        "ring": (
            trimesh.creation.torus(0.3, 0.1, 64, 32),
            # the mesh lies inside the ring, by less than 1 %
            lambda p: np.hypot(np.hypot(p[:, 0], p[:, 1]) - 0.3, p[:, 2]) < 0.098,
        ),
        "ball": (trimesh.creation.icosphere(4, 0.2), lambda p: np.linalg.norm(p, axis=1) < 0.199),
        "rod": (
            trimesh.creation.cylinder(0.05, 0.8, 64),
            lambda p: (np.hypot(p[:, 0], p[:, 1]) < 0.0499) & (np.abs(p[:, 2]) < 0.4),
        ),
    }
    for mesh, inside in solids.values():
        for _ in range(5):
            turn = trimesh.transformations.random_rotation_matrix(rng.random(3))
            points = rng.uniform(-0.5, 0.5, (20000, 3))
            points = points[inside(points)] @ turn[:3, :3].T
            boxes = box_cover.boxes_around(triangles_of(mesh.copy().apply_transform(turn)))
            assert 1 <= len(boxes) <= box_cover.MOST_BOXES
            assert held(boxes, points).all()


@pytest.mark.parametrize("name", ["kinova", "ur5", "z1"])
def test_the_boxes_contain_every_mesh_of_an_arm(name):
    arm, rng = arms.load_arm(name, {}), np.random.default_rng(1)
    for mesh in arm.robot.iterfind("link/collision/geometry/mesh"):
        triangles = surface(mesh.get("filename"), arm.folders, name)
        boxes = box_cover.boxes_around(triangles)
        weights = rng.dirichlet((1.0, 1.0, 1.0), (20, len(triangles)))
        points = np.einsum("skc,kcd->skd", weights, triangles).reshape(-1, 3)
        assert held(boxes, np.vstack([points, triangles.reshape(-1, 3)])).all()
        size = np.prod(np.ptp(triangles.reshape(-1, 3), axis=0) + 2e-4)
        assert volume(boxes) <= size
