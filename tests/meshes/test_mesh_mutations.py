"""Damaged mesh files: a shape around all of the mesh, or one error that names the file."""

import resource

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

import ffsr_plan as fp
from tests.helpers.single_link_robots import MASS
from tests.helpers.urdf_builders import link, mesh, urdf

KINDS = {  # suffix and options of trimesh's export
    "text stl": ("stl", {"file_type": "stl_ascii"}),
    "binary stl": ("stl", {"file_type": "stl"}),
    "obj": ("obj", {"file_type": "obj"}),
    "text ply": ("ply", {"file_type": "ply", "encoding": "ascii"}),
    "binary ply": ("ply", {"file_type": "ply", "encoding": "binary"}),
}
POINTER = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n"
GARBAGE = [
    b"",
    b" \n\n",
    POINTER,
    b"<html>404: not found</html>\n",
    bytes(200),
    b"solid a\nendsolid",
]
WORDS = [
    b"nan",
    b"inf",
    b"-inf",
    b"1e300",
    b"-4e38",
    b"1e7",
    b"0",
    b"-1",
    b"1_0",
    b"x",
    b"1,5",
    b"7",
]
FLOATS = [np.nan, np.inf, -np.inf, 3e38, 1e7, 0.0]


def whole(kind, rng):
    """A part as a file of some kind, in bytes."""
    size = rng.uniform(0.3, 0.8, 3)
    solid = trimesh.creation.box(size) if rng.random() < 0.5 else trimesh.creation.icosphere(1, 0.4)
    solid.apply_translation(rng.uniform(-0.3, 0.3, 3))
    content = solid.export(**KINDS[kind][1])
    return content.encode() if isinstance(content, str) else content


def damaged(content, rng):
    """One damage, at random."""
    lines, place = content.split(b"\n"), int(rng.integers(len(content)))
    line = int(rng.integers(len(lines)))
    kind = int(rng.integers(12))
    if kind == 0:
        return content[:place]
    if kind == 1:
        return GARBAGE[int(rng.integers(len(GARBAGE)))]
    if kind in (2, 3, 4):
        words = lines[line].split(b" ")
        words[int(rng.integers(len(words)))] = WORDS[int(rng.integers(len(WORDS)))]
        return b"\n".join([*lines[:line], b" ".join(words), *lines[line + 1 :]])
    if kind == 5:
        return b"\n".join([*lines[:line], *lines[line + 1 :]])
    if kind == 6:
        return b"\n".join([*lines[:line], lines[line], *lines[line:]])
    if kind == 7:
        return content[:place] + rng.bytes(1) + content[place + 1 :]
    if kind == 8:
        return content[:place] + rng.bytes(int(rng.integers(1, 40))) + content[place:]
    if kind == 9:  # a count, or anything else of four bytes
        place = 80 if rng.random() < 0.5 else place
        return content[:place] + rng.bytes(4) + content[place + 4 :]
    if kind == 10:
        number = np.float32(FLOATS[int(rng.integers(len(FLOATS)))]).tobytes()
        place = 84 + 50 * int(rng.integers(max(1, len(content) // 50 - 2))) + 12
        return content[:place] + number + content[place + 4 :]
    return content.replace(b"vertex", b"V").replace(b"V", b"face", 1).replace(b"V", b"vertex")


def vertices_of(content, kind):
    """Vertices of an undamaged part of a file, by a reader that asks no questions."""
    if kind == "binary stl":
        records = np.frombuffer(content[84:], _RECORD)
        return records["corners"].reshape(-1, 3).astype(float)
    if kind.endswith("ply"):
        head, body = content.split(b"end_header\n", 1)
        count = int(head.split(b"element vertex ")[1].split()[0])
        if kind == "text ply":
            return np.array([row.split()[:3] for row in body.split(b"\n")[:count]], dtype=float)
        return np.frombuffer(body[: 12 * count], "<f4").reshape(-1, 3).astype(float)
    word = b"v" if kind == "obj" else b"vertex"
    rows = [row.split() for row in content.splitlines()]
    return np.array([row[1:4] for row in rows if row and row[0].lower() == word], dtype=float)


def corners_of(content, kind):
    """Vertices of the triangles of such a file: others are no part of the surface."""
    vertices = vertices_of(content, kind)
    if kind.endswith("stl"):
        return vertices
    if kind == "obj":
        rows = [row.split() for row in content.splitlines() if row[:2] == b"f "]
        return vertices[[int(word) - 1 for row in rows for word in row[1:]]]
    body = content.split(b"end_header\n", 1)[1]
    if kind == "text ply":
        rows = [row.split() for row in body.split(b"\n")[len(vertices) :]]
        return vertices[[int(word) for row in rows for word in row[1:]]]
    faces = np.frombuffer(body[12 * len(vertices) :], "u1,(3,)<i4")["f1"]
    return vertices[faces.ravel()]


_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def check_robot(path, content, kind):
    path.with_name("made.urdf").write_text(urdf(link("base", MASS, mesh(path.name))))
    (replaced,) = fp.load_robot(path.with_name("made.urdf")).replacements
    solid, vertices = np.array(replaced.points), vertices_of(content, kind)
    assert np.isfinite(solid).all()
    assert np.isfinite(vertices).all()
    sides = ConvexHull(solid).equations
    assert np.max(vertices @ sides[:, :3].T + sides[:, 3]) <= 1e-6


def check_scene(path, content, kind):
    scene, vertices = fp.Scene.from_mesh(path, 0.1), corners_of(content, kind)
    assert np.isfinite(scene.centers).all()
    assert np.isfinite(vertices).all()
    gaps = np.linalg.norm(vertices[:, None] - scene.centers, axis=2) - scene.radii
    assert np.max(gaps.min(axis=1)) <= 1e-6


@pytest.mark.parametrize("kind", KINDS)
def test_a_damaged_mesh_is_covered_or_refused_by_name(tmp_path, capfd, kind):
    rng = np.random.default_rng(27)
    path = tmp_path / f"part.{KINDS[kind][0]}"
    before, taken, refused = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, 0, 0
    for k in range(120):
        content = whole(kind, rng)
        content = damaged(content, rng) if k else content
        path.write_bytes(content)
        said = outcome(check_robot if k % 2 else check_scene, path, content, kind)
        taken += said is None
        if said is not None:
            assert path.name in said
            assert "\n" not in said
            refused += 1
    assert taken >= 5
    assert refused >= 40
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 400_000  # kB
    assert capfd.readouterr() == ("", "")


def outcome(check, *arguments):
    """The text of an `InvalidInput`, or None."""
    try:
        check(*arguments)
    except fp.InvalidInput as error:
        return str(error)
    return None
