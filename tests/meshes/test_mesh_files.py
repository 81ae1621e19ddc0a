"""Mesh files are read as they are, or refused with the reason."""

import struct

import numpy as np
import pytest
import trimesh

import ffsr_plan as fp
from ffsr_plan.meshes import mesh_files
from ffsr_plan.meshes.collada_files import read_dae
from ffsr_plan.meshes.ply_files import read_ply
from ffsr_plan.meshes.triangle_files import read_obj, read_stl
from tests.helpers.single_link_robots import blob

FACET = "facet normal 0 0 1\nouter loop\n{}endloop\nendfacet\n"
CORNERS = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1e-1 2.5\n"
STL = "solid part\n" + FACET.format(CORNERS) + "endsolid part\n"
OBJ = "# made\nmtllib none.mtl\nv 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\n"
PLY = (
    "ply\nformat ascii 1.0\ncomment made\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar red\nelement face 2\nproperty uchar flags\n"
    "property list uchar int vertex_indices\nend_header\n"
    "0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n7 4 0 1 2 3\n7 3 0 2 1\n"
)
SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]


def test_text_and_binary_stl_state_the_same_triangles():
    solid = blob(3)
    for kind in ("stl", "stl_ascii"):
        content = solid.export(file_type=kind)
        read = read_stl(content.encode() if isinstance(content, str) else content)
        corners = read.vertices[read.faces]
        np.testing.assert_allclose(corners, solid.triangles, atol=1e-6)
    assert read_stl(STL.upper().replace("\n", "\r\n").encode()).vertices[2].tolist() == [
        0,
        0.1,
        2.5,
    ]
    two = read_stl((STL + STL).encode())
    assert two.faces.tolist() == [[0, 1, 2], [3, 4, 5]]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("2.5", "2,5", "line 6: 'vertex 0 1e-1 2,5'"),
        ("2.5", "2_5", "line 6"),
        ("vertex 1 0 0\n", "", "line 6: 'endloop'"),
        ("vertex 1 0 0\n", "vertex 1 0 0\n" * 2, "line 7: 'vertex"),
        ("vertex 1 0 0", "vertex 1 0 0 0", "line 5"),
        ("vertex 1 0 0", "vertx 1 0 0", "line 5: 'vertx"),
        ("outer loop\n", "", "line 3: 'vertex 0 0 0'"),
        ("endsolid part\n", "", "ends before 'endsolid'"),
        ("endfacet\nendsolid part\n", "", "ends before 'endsolid'"),
        ("solid part\nfacet", "facet", "bytes, which is no STL|has room for"),
    ],
)
def test_a_text_stl_with_a_fault_names_the_line(old, new, message):
    assert old in STL
    with pytest.raises(ValueError, match=message):
        read_stl(STL.replace(old, new, 1).encode())


def test_a_binary_stl_holds_as_many_triangles_as_it_states():
    content = blob(0).export(file_type="stl")
    for count in (0, 1, 0xFFFFFFFF):
        lying = content[:80] + struct.pack("<I", count) + content[84:]
        with pytest.raises(ValueError, match=f"states {count} triangles has room for 18"):
            read_stl(lying)


def test_polygons_and_relative_indices_of_an_obj_are_triangles():
    for face in ("f 1 2 3 4", "f 1//1 2//1 3//1 4//1", "f -4 -3 -2 -1", "f 1 2 \\\n3 4 # square"):
        read = read_obj((OBJ + face + "\n").encode())
        assert read.vertices.tolist() == SQUARE
        assert read.faces.tolist() == [[0, 1, 2], [0, 2, 3]]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("f 0 1 2", "line 8: 'f 0 1 2'"),
        ("f 1 2", "line 8"),
        ("f 1 2 5", "vertex 5 of 4"),
        ("f 1 2 -5", "line 8"),
        ("f 1 2 x", "line 8"),
        ("v 1 2", "line 8: 'v 1 2'"),
        ("v 1 2 1_0", "line 8"),
        ("curv 0 1 1 2", "line 8: 'curv"),
    ],
)
def test_an_obj_with_a_fault_names_the_line(line, message):
    with pytest.raises(ValueError, match=message):
        read_obj(f"{OBJ}{line}\nf 1 2 3\n".encode())


def binary_ply(order, polygons):
    name = {"<": "little", ">": "big"}[order]
    head = PLY.replace("ascii", f"binary_{name}_endian").partition("end_header\n")[0]
    head = head.replace("element face 2", f"element face {len(polygons)}") + "end_header\n"
    body = b"".join(struct.pack(f"{order}fffB", *corner, 9) for corner in SQUARE)
    for each in polygons:
        body += struct.pack(f"{order}BB{len(each)}i", 7, len(each), *each)
    return head.encode() + body


@pytest.mark.parametrize(
    "content",
    [
        PLY.encode(),
        binary_ply("<", [[0, 1, 2, 3], [0, 2, 1]]),
        binary_ply(">", [[0, 1, 2, 3], [0, 2, 1]]),
        binary_ply("<", [[0, 1, 2], [0, 2, 3], [0, 2, 1]]),
    ],
)
def test_polygons_of_a_ply_are_triangles(content):
    read = read_ply(content)
    assert read.vertices.tolist() == SQUARE
    assert read.faces.tolist() == [[0, 1, 2], [0, 2, 3], [0, 2, 1]]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("vertex 4", "vertex 5", "row 5 of vertex"),
        ("vertex 4", "vertex 3", "row 1 of face|after the last"),
        ("face 2", "face 1", "after the last element"),
        ("face 2", "face 3", "2 lines of 3 of face"),
        ("face 2", "face 4000000000", "too few for 4 of vertex, 4000000000 of face"),
        ("1 1 0 9", "1 one 0 9", "row 3 of vertex: '1 one 0 9'"),
        ("1 1 0 9", "1 1 0", "row 3 of vertex"),
        ("4 0 1 2 3", "5 0 1 2 3", "row 1 of face"),
        ("3 0 2 1", "3 0 2 4", "vertex 4 of 4"),
        ("3 0 2 1", "3 0 2 -1", "a face of vertex"),
        ("3 0 2 1", "2 0 2", "row 2 of face"),
        ("float y", "flot y", "header: 'property flot y'"),
        ("property float z\n", "", "no z of vertex|row 1 of vertex"),
        ("vertex_indices", "corners", "no vertex_indices of face"),
        ("end_header", "end", "no PLY header"),
        ("format ascii 1.0\n", "", "no format"),
    ],
)
def test_a_ply_with_a_fault_names_it(old, new, message):
    assert old in PLY
    with pytest.raises(ValueError, match=message):
        read_ply(PLY.replace(old, new, 1).encode())


def test_a_binary_ply_ends_where_its_header_says():
    whole = binary_ply("<", [[0, 1, 2, 3], [0, 2, 1]])
    for content in (whole[:-1], whole + b"0", whole[:-20], binary_ply("<", [[0, 1]])):
        with pytest.raises(ValueError, match=r"end|bytes after|fewer than three"):
            read_ply(content)


def dae(change=lambda text: text):
    return change(blob(1).export(file_type="dae").decode()).encode()


def with_position(word):
    """A change of the first coordinate in a Collada file."""

    def change(text):
        begin = text.index(">", text.index("<float_array")) + 1
        return text[:begin] + word + text[text.index(" ", begin) :]

    return change


def test_a_dae_is_read_although_its_materials_are_broken():
    read = read_dae(
        dae(lambda text: text.replace('instance_effect url="#', 'instance_effect url="#no'))
    )
    assert len(read.faces) == len(blob(1).faces)


@pytest.mark.parametrize("word", ["nan", "inf", "x"])
def test_a_dae_with_a_position_that_is_none_is_refused(word):
    with pytest.raises(ValueError, match=f"a position '{word}'"):
        read_dae(dae(with_position(word)))


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text[: len(text) // 2],
        lambda text: text.replace("<p>", "<p>99999 ", 1),
        lambda text: text.replace("<library_geometries", "<library_nothing"),
        lambda text: "<!DOCTYPE x [<!ENTITY a 'b'>]>" + text[text.index("<COLLADA") :],
        lambda text: "",
    ],
)
def test_a_dae_that_is_not_whole_is_refused(change):
    with pytest.raises(ValueError, match=r"\w"):
        read_dae(dae(change))


def test_stray_vertices_belong_to_the_hull(tmp_path):
    """A file that was cut short may still list vertices of the triangles that it has lost."""
    content = trimesh.creation.box((1, 1, 1)).export(file_type="obj") + "\nv 0 0 3\n"
    (tmp_path / "a.obj").write_text(content)
    corners = mesh_files.hull_corners("a.obj", [str(tmp_path)], "made")
    assert corners.max(axis=0).tolist() == [0.5, 0.5, 3.0]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "part.stl, an empty file"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "pointer of Git LFS.*pull"),
        (b"solid a\nendsolid a\n", "without triangles"),
        (STL.replace("2.5", "nan").encode(), r"vertex 2 at \[0.0, 0.1, nan\].*finite"),
        (STL.replace("2.5", "1e400").encode(), r"vertex 2 at \[0.0, 0.1, inf\].*finite"),
        (STL.replace("2.5", "2e9").encode(), "at most 1e.09"),
        (STL.encode(), "not flat|not closed|without a neighbour"),
    ],
)
def test_a_mesh_that_is_none_is_refused_for_robots_and_scenes(tmp_path, content, message):
    path = tmp_path / "part.stl"
    path.write_bytes(content)
    for load in (
        lambda: mesh_files.hull_corners(str(path), [], "made, link 'a'"),
        lambda: fp.Scene.from_mesh(path, 0.1),
    ):
        with pytest.raises(fp.InvalidInput, match=message) as caught:
            load()
        assert "part.stl" in str(caught.value)


def test_files_of_too_many_bytes_or_triangles_are_refused(tmp_path, monkeypatch):
    blob(0).export(tmp_path / "part.stl")
    monkeypatch.setattr(mesh_files, "MOST_TRIANGLES", 17)
    with pytest.raises(fp.InvalidInput, match=r"part\.stl of 18 triangles'; allowed: at most 17"):
        mesh_files.surface(str(tmp_path / "part.stl"), [], "made")
    monkeypatch.setattr(mesh_files, "MOST_BYTES", 900)
    with pytest.raises(fp.InvalidInput, match=r"part\.stl of 0\.000984 MB"):
        mesh_files.surface(str(tmp_path / "part.stl"), [], "made")
