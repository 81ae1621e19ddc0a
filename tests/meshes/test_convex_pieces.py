"""Convex hulls that cover a mesh."""

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

import ffsr_plan as fp
from ffsr_plan.meshes.convex_pieces import connected_parts, convex_pieces, cut

RING, TUBE = 1.0, 0.25
TORUS = trimesh.creation.torus(RING, TUBE, major_sections=32, minor_sections=16)


def inside_any(pieces, points, slack=1e-9):
    found = np.zeros(len(points), dtype=bool)
    for piece in pieces:
        faces = ConvexHull(piece).equations
        found |= np.all(points @ faces[:, :3].T + faces[:, 3] <= slack, axis=1)
    return found


@pytest.mark.parametrize("most", [1, 2, 5, 12])
def test_the_hulls_cover_all_that_the_mesh_encloses(most):
    """Convex combinations of points of one cross-section of the tube lie in the torus."""
    pieces = convex_pieces(np.array(TORUS.triangles), most)
    assert len(pieces) <= most
    rng = np.random.default_rng(0)
    rows = TORUS.vertices.reshape(32, 16, 3)
    shares = rng.dirichlet(np.ones(16), size=(32, 60))
    assert inside_any(pieces, np.einsum("ikj,ijc->ikc", shares, rows).reshape(-1, 3)).all()
    points = TORUS.triangles[rng.integers(len(TORUS.triangles), size=4000)]
    surface = np.einsum("kj,kjc->kc", rng.dirichlet(np.ones(3), size=4000), points)
    assert inside_any(pieces, surface).all()


def surface_of(filled):
    """(k, 3, 3) triangles around the filled cells (a, b, c) of a grid of cubes of one metre."""
    padded, triangles = np.pad(filled, 1), []
    for cell in np.argwhere(padded):
        for axis in range(3):
            for side in (0, 1):
                beside = cell.copy()
                beside[axis] += 2 * side - 1
                if padded[tuple(beside)]:
                    continue
                u, v = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
                corner = cell - 1.0 + side * np.eye(3)[axis]
                square = [corner, corner + u, corner + u + v, corner + v][:: 2 * side - 1]
                triangles += [[square[0], square[1], square[2]], [square[0], square[2], square[3]]]
    return np.array(triangles, dtype=float)


@pytest.mark.parametrize("most", [4, 12, 40])
def test_parts_inside_the_solid_are_covered_too(most):
    """Cuts in three directions leave parts of which no corner is one of the surface."""
    cross, rng = np.zeros((7, 7, 7), dtype=bool), np.random.default_rng(1)
    cross[1:6, 1:6, 1:6] = True
    for axis in range(3):
        arm = [slice(2, 5)] * 3
        arm[axis] = slice(None)
        cross[tuple(arm)] = True
    cross[1:3, 1:3, 1:3] = False
    pieces = convex_pieces(surface_of(cross), most)
    assert len(pieces) > most // 2
    points = rng.uniform(0.0, 7.0, (20_000, 3))
    points = points[cross[tuple(points.astype(int).T)]]
    assert inside_any(pieces, points).all()


def test_more_pieces_open_the_hole_of_a_ring():
    hole = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.0, -0.3, 0.0]])
    assert inside_any(convex_pieces(np.array(TORUS.triangles), 1), hole).all()
    assert not inside_any(convex_pieces(np.array(TORUS.triangles), 12), hole).any()


def test_a_convex_mesh_is_one_piece():
    box = trimesh.creation.box((1.0, 2.0, 3.0))
    (points,) = convex_pieces(np.array(box.triangles), 10)
    assert len(points) == 8


def test_connected_parts_are_told_apart():
    far = trimesh.creation.icosphere(radius=0.2).apply_translation([3.0, 0.0, 0.0])
    both = np.concatenate([TORUS.triangles, far.triangles])
    parts = connected_parts(both)
    assert sorted(map(len, parts)) == sorted([len(TORUS.faces), len(far.faces)])
    with pytest.raises(fp.InvalidInput, match="at least 2, the mesh's connected parts"):
        convex_pieces(both, 1)


def test_a_cut_keeps_the_area_of_the_triangles():
    def area(triangles):
        sides = triangles[:, 1:] - triangles[:, :1]
        return 0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum()

    triangles = np.array(TORUS.triangles)
    for axis, place in ((0, 0.3), (1, 0.0), (2, 0.1), (0, 9.0)):
        below, above = cut(triangles, axis, place)
        assert area(below) + area(above) == pytest.approx(area(triangles), rel=1e-12)
        assert np.all(below[..., axis] <= place)
        assert np.all(above[..., axis] >= place)


def test_hulls_of_a_file_are_placed_and_named(tmp_path):
    TORUS.export(tmp_path / "ring.stl")
    hulls = fp.mesh_hulls(tmp_path / "ring.stl", 6, scale=2.0, position=(5.0, 0.0, 0.0))
    assert {each.name for each in hulls} == {"ring.stl"}
    reach = max(np.max(each.points[:, 0] + each.position[0]) for each in hulls)
    assert reach == pytest.approx(5.0 + 2.0 * (RING + TUBE), abs=1e-5)
    robot = fp.load_robot("point")
    scene = fp.Scene(shapes=fp.mesh_hulls(TORUS, 12))
    assert fp.clearance(robot, scene, robot.neutral()) > 0.3


@pytest.mark.parametrize("mesh", [3, "missing.stl", trimesh.Trimesh()])
def test_what_is_no_mesh_is_refused(mesh):
    with pytest.raises(fp.InvalidInput, match="mesh"):
        fp.mesh_hulls(mesh)
