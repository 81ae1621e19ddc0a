"""Spheres around meshes: nothing that is enclosed sticks out, and nothing reaches too far."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.core.rotations import from_angles, matrix
from ffsr_plan.meshes.sphere_cover import winding_number

POSE = {"scale": 2.0, "position": (1.0, -2.0, 0.5), "attitude": (0.7, -0.4, 1.2)}
MESHES = {
    "box": trimesh.creation.box((1.0, 0.4, 0.2)),
    "ball": trimesh.creation.icosphere(3, 0.5),
    "ring": trimesh.creation.torus(0.5, 0.15),
    "pipe": trimesh.creation.annulus(0.2, 0.3, 0.8),
    "plate": trimesh.creation.box((1.0, 1.0, 0.002)),
}


def covered(scene, points, slack=1e-12):
    return [
        np.min(np.linalg.norm(scene.centers - point, axis=1) - scene.radii) <= slack
        for point in points
    ]


def points_in(mesh, count, rng):
    """Points of the solid: on its surface, and drawn in its box and kept if a ray says inside."""
    on, _ = trimesh.sample.sample_surface(mesh, count, seed=int(rng.integers(1 << 30)))
    drawn = rng.uniform(*mesh.bounds, (count, 3))
    return np.vstack([on, drawn[mesh.contains(drawn)]])


def posed(points):
    turned = matrix(from_angles(np.array(POSE["attitude"])))
    return POSE["scale"] * points @ turned.T + POSE["position"]


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("excess", [0.4, 0.15])
def test_spheres_cover_a_posed_and_scaled_mesh(name, excess):
    rng = np.random.default_rng(0)
    scene = fp.Scene.from_mesh(MESHES[name], excess, **POSE)
    assert all(covered(scene, posed(points_in(MESHES[name], 400, rng))))
    assert scene.excess == excess


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("excess", [0.2, 0.07])
def test_no_sphere_exceeds_the_stated_excess(name, excess):
    mesh, rng = MESHES[name], np.random.default_rng(1)
    scene = fp.Scene.from_mesh(mesh, excess)
    chosen = rng.choice(len(scene), 200)
    out = rng.normal(size=(200, 3))
    out /= np.linalg.norm(out, axis=1)[:, None]
    rim = scene.centers[chosen] + scene.radii[chosen, None] * out
    rim = np.vstack([rim, scene.centers + scene.radii[:, None] * (1.0, 0.0, 0.0)])
    rim = rim[~mesh.contains(rim)]
    _, away, _ = trimesh.proximity.closest_point(mesh, rim)
    assert np.all(away <= excess)
    assert np.max(away) > 0.3 * excess  # and the excess is no idle figure


def reach_beyond_box(centers, radii, half):
    """How far the farthest ball reaches beyond a box of half edges `half` about the origin."""
    beyond = np.abs(centers) - half
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=1)
    return np.max(outside + np.minimum(beyond.max(axis=1), 0.0) + radii)


@given(st.integers(0, 100_000))
@settings(max_examples=25)
def test_every_ball_around_a_box_keeps_the_excess(seed):
    """From a middle at depth d, a ball of radius R reaches R - d beyond the box: closed form."""
    rng = np.random.default_rng(seed)
    half, angles = rng.uniform(0.1, 0.7, 3), rng.uniform(-1.5, 1.5, 3) * (seed % 2)
    excess = float(10.0 ** rng.uniform(-1.5, -0.5))
    scene = fp.Scene.from_mesh(trimesh.creation.box(2.0 * half), excess, attitude=angles)
    local = scene.centers @ matrix(from_angles(angles))
    assert 0.45 * excess < reach_beyond_box(local, scene.radii, half) <= excess


@pytest.mark.parametrize("cubes", [7, 15, 31, 63])
def test_balls_that_fit_the_grid_keep_the_excess(cubes):
    half, excess = 0.5 * cubes * 0.1 / np.sqrt(3.0), 0.1  # a larger cube would end at the surface
    scene = fp.Scene.from_mesh(trimesh.creation.box((2.0 * half,) * 3), excess)
    assert reach_beyond_box(scene.centers, scene.radii, half) <= excess


def test_enclosed_cubes_are_merged():
    """Each cube on its own would take twice to three times as many spheres."""
    ball = trimesh.creation.icosphere(3, 1.0)
    solid = fp.Scene.from_mesh(ball, 0.1)
    shell = fp.Scene.from_mesh(ball, 0.1, inside=False)
    assert len(shell) < len(solid) < 1.7 * len(shell)
    volume, edge = 4.0 / 3.0 * np.pi, 0.1 / np.sqrt(3.0)
    assert len(solid) < 0.45 * volume / edge**3
    assert solid.radii.max() > 4 * solid.radii.min()
    assert covered(solid, np.zeros((1, 3)))[0]
    assert not covered(shell, np.zeros((1, 3)))[0]


def test_half_the_excess_needs_about_four_times_the_spheres():
    counts = [len(fp.Scene.from_mesh(MESHES["box"], excess)) for excess in (0.1, 0.05, 0.025)]
    assert np.all(np.diff(np.log2(counts)) < 2.5)


def test_cavities_and_narrow_openings_stay_free():
    outer, inner = trimesh.creation.icosphere(3, 1.0), trimesh.creation.icosphere(3, 0.7)
    inner.invert()
    hollow = trimesh.util.concatenate([outer, inner])
    scene = fp.Scene.from_mesh(hollow, 0.05)
    assert not covered(scene, np.zeros((1, 3)))[0]
    assert covered(scene, np.array([[0.0, 0.85, 0.0]]))[0]
    # a pipe closed but for a hole far smaller than a cube: its hollow is outside, and stays free
    neck = trimesh.creation.revolve(
        [
            (0.01, 0.0),
            (0.6, 0.0),
            (0.6, 1.0),
            (0.0, 1.0),
            (0.0, 0.8),
            (0.4, 0.8),
            (0.4, 0.2),
            (0.01, 0.2),
            (0.01, 0.0),
        ],
        sections=24,
    )
    assert neck.is_watertight
    if neck.volume < 0:
        neck.invert()
    middle = np.array([[0.0, 0.0, 0.5]])
    assert not covered(fp.Scene.from_mesh(neck, 0.12), middle)[0]


def test_overlapping_and_inside_out_parts_are_solid():
    left, right = MESHES["box"].copy(), MESHES["box"].copy()
    right.apply_translation((0.5, 0.0, 0.0))
    both = trimesh.util.concatenate([left, right])
    scene = fp.Scene.from_mesh(both, 0.1)
    assert all(covered(scene, np.array([[0.25, 0.0, 0.0], [0.9, 0.0, 0.0]])))
    left.invert()
    assert covered(fp.Scene.from_mesh(left, 0.1), np.zeros((1, 3)))[0]


def test_parts_that_share_an_edge_or_a_face_are_closed():
    box = MESHES["box"]
    for shift in ((0.0, 0.4, 0.2), (0.0, 0.0, 0.2), (0.0, 0.0, 0.0)):
        other = box.copy()
        other.apply_translation(shift)
        both = trimesh.Trimesh(np.vstack([box.vertices, other.vertices]), process=False)
        both.faces = np.vstack([box.faces, other.faces + len(box.vertices)])
        assert all(covered(fp.Scene.from_mesh(both, 0.2), np.array([[0.0, 0.0, 0.0], shift])))


def test_of_an_open_mesh_only_the_surface_is_covered():
    bowl = trimesh.creation.icosphere(2, 0.5).slice_plane((0, 0, 0), (0, 0, 1))
    with pytest.raises(fp.InvalidInput, match=r"edges without a neighbour.*inside=False"):
        fp.Scene.from_mesh(bowl, 0.1)
    scene = fp.Scene.from_mesh(bowl, 0.1, inside=False)
    on, _ = trimesh.sample.sample_surface(bowl, 200, seed=0)
    assert all(covered(scene, on))
    flipped = MESHES["box"].copy()
    flipped.faces[0] = flipped.faces[0][::-1]
    with pytest.raises(fp.InvalidInput, match="faces the same way"):
        fp.Scene.from_mesh(flipped, 0.1)


def test_a_mesh_is_read_from_its_file(tmp_path):
    path = tmp_path / "box.stl"
    MESHES["box"].export(path)
    read, given = (fp.Scene.from_mesh(mesh, 0.1) for mesh in (path, MESHES["box"]))
    assert np.allclose(read.centers, given.centers, atol=1e-6)
    assert np.allclose(read.radii, given.radii, atol=1e-6)


@given(st.integers(0, 100_000))
@settings(max_examples=20)
def test_random_polyhedra_lie_in_their_spheres(seed):
    rng = np.random.default_rng(seed)
    mesh = trimesh.convex.convex_hull(rng.normal(size=(12, 3)) * rng.uniform(0.1, 1.0, 3))
    excess = float(rng.uniform(0.1, 0.5))
    scene = fp.Scene.from_mesh(mesh, excess)
    shares = rng.dirichlet(np.ones(len(mesh.vertices)), 200)
    assert all(covered(scene, np.vstack([shares @ mesh.vertices, mesh.vertices])))


def test_the_winding_number_is_one_inside_and_zero_outside():
    ball = np.asarray(trimesh.creation.icosphere(2).triangles)
    assert winding_number(ball, np.array([0.3, 0.2, -0.4])) == pytest.approx(1.0)
    assert winding_number(ball, np.array([1.3, 0.2, -0.4])) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"mesh": "nowhere.stl"}, r"mesh: got '.*nowhere\.stl'; allowed: an existing file"),
        ({"mesh": 3}, r"mesh: got 3; allowed: a path, or an object with triangles"),
        ({"excess": 0.0}, r"excess: got 0\.0; .*greater than 0"),
        ({"excess": 1e-5}, r"excess: got 1e-05; allowed: about 0\.00\d+ m or more for its size"),
        ({"scale": -1.0}, r"scale.*greater than 0"),
        ({"position": (0, 0)}, r"position \(shape \(2,\)\)"),
        ({"inside": 1}, r"inside.*True or False"),
    ],
)
def test_what_cannot_be_covered_is_refused_by_name(wrong, message):
    with pytest.raises(fp.InvalidInput, match=message):
        fp.Scene.from_mesh(**{"mesh": MESHES["box"], "excess": 0.1, **wrong})
