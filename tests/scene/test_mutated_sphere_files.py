"""Mutated files of spheres: the right spheres, or one sentence; never another error."""

import csv
import io
import tracemalloc
import zipfile

import numpy as np
import pytest

import ffsr_plan as fp

MUTATIONS = 300
ODD_CELLS = ["", " ", "nan", "inf", "-1", "0", "1e400", "1_0", "0x10", "9" * 5000, "\u0661", "x",
             '"', "1,5", "\x00", "1e308", "-0", "1 2", "#", "\ud7ff", "x [mm]"]  # fmt: skip
RIGHT_CELLS = ["2.5", "1e-1", "+3", " 4 ", ".5", "6.", "7E0", "08"]
ODD_HEADERS = [
    "x",
    "X",
    "x [mm]",
    "x [furlong]",
    "radius",
    "",
    "x" + " " * 100_000 + "!",
    "x[m",
    "y",
]


def refused_or(read, path):
    """The scene, or None if the file is refused in one sentence that names it."""
    try:
        return read(path)
    except fp.InvalidInput as error:
        sentence = str(error)
    assert sentence.isprintable()
    assert len(sentence) < 1500
    return None


def mutated_table(rng):
    """Text of a table, perhaps wrong."""
    cells = [["x", "y", "z", "radius"]]
    cells += [[repr(v) for v in row] for row in rng.uniform(0.1, 9.0, (4, 4)).tolist()]
    for _ in range(int(rng.integers(1, 3))):
        row, column = int(rng.integers(5)), int(rng.integers(4))
        kind = int(rng.integers(8))
        if kind == 0:
            cells[0][column] = str(rng.choice(ODD_HEADERS))
        elif kind == 1:
            cells[row].append("1.0")
        elif kind == 2:
            del cells[row][-1]
            cells[row] = cells[row] or ["#"]
        else:
            column = min(column, len(cells[row]) - 1)
            choice = ODD_CELLS if kind < 5 or row == 0 else RIGHT_CELLS
            cells[row][column] = str(rng.choice(choice))
    text = str(rng.choice(["\n", "\r\n", "\n\n"])).join(",".join(row) for row in cells)
    return text if rng.random() < 0.9 else "\ufeff" + text[: int(rng.integers(len(text)))]


def test_mutated_tables_are_read_as_they_say_or_refused(tmp_path):
    rng, read = np.random.default_rng(4), 0
    for k in range(MUTATIONS):
        text, path = mutated_table(rng), tmp_path / f"{k}.csv"
        path.write_text(text, encoding="utf-8", newline="")
        scene = refused_or(fp.Scene.from_csv, path)
        if scene is None:
            continue
        read += 1
        header, *rows = [
            row for row in csv.reader(io.StringIO(text.removeprefix("\ufeff"), newline=""))
            if any(cell.strip() for cell in row) and not row[0].lstrip().startswith("#")
        ]  # fmt: skip
        scale = [1e-3 if "mm" in name else 1.0 for name in header]
        names = [name.split()[0].strip() for name in header]
        wanted = np.array(rows, dtype=float).reshape(-1, len(names)) * scale
        for name, column in zip("xyz", scene.centers.T, strict=True):
            np.testing.assert_allclose(column, wanted[:, names.index(name)])
        np.testing.assert_allclose(scene.radii, wanted[:, names.index("radius")])
    assert 20 < read < MUTATIONS - 100


def test_mutated_arrays_are_read_or_refused(tmp_path):
    rng, read = np.random.default_rng(5), 0
    buffer = io.BytesIO()
    for k in range(MUTATIONS):
        path = tmp_path / f"{k}.{'npz' if k % 2 else 'npy'}"
        rows = rng.uniform(0.1, 9.0, (4, 4))
        kind = str(
            rng.choice(["f8", "f4", "i8", "c16", "U3", "?", "O", "M8[s]"], p=[0.44] + 7 * [0.08])
        )
        array = rows.astype("f8").astype(kind) if kind != "M8[s]" else np.zeros((4, 4), kind)
        buffer = io.BytesIO()
        if k % 2:
            members = {"centers": array[:, :3], "radii": array[:, 3], "other": rows}
            if rng.random() < 0.2:
                members.pop(str(rng.choice(list(members))))
            np.savez(buffer, **members)
        else:
            np.save(buffer, np.asfortranarray(array) if rng.random() < 0.3 else array)
        content = bytearray(buffer.getvalue())
        if rng.random() < 0.6:
            for _ in range(int(rng.integers(1, 4))):
                content[int(rng.integers(min(len(content), 200)))] = int(rng.integers(256))
        if rng.random() < 0.1:
            content = content[: int(rng.integers(len(content)))]
        path.write_bytes(content)
        scene = refused_or(fp.Scene.from_numpy, path)
        read += scene is not None
    assert 20 < read < MUTATIONS - 100


def header(shape, kind="<f8"):
    buffer = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        buffer, {"descr": kind, "fortran_order": False, "shape": shape}
    )
    return buffer.getvalue()


@pytest.mark.parametrize("shape", [(10**12, 4), (10**30, 4), (2**62, 4), (0, 4), (-1, 4), (5, 4)])
def test_a_header_that_states_more_than_there_is_costs_nothing(tmp_path, shape):
    (tmp_path / "s.npy").write_bytes(header(shape))
    tracemalloc.start()
    scene = refused_or(fp.Scene.from_numpy, tmp_path / "s.npy")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert scene is None or len(scene) == 0
    assert peak < 1e7


def test_members_that_are_not_needed_are_not_expanded(tmp_path):
    path = tmp_path / "bomb.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, array in (("centers", [[1.0, 2.0, 3.0]]), ("radii", [0.5])):
            buffer = io.BytesIO()
            np.save(buffer, np.array(array))
            archive.writestr(f"{name}.npy", buffer.getvalue())
        archive.writestr("unused.npy", header((10**8,)) + bytes(10**8))
    tracemalloc.start()
    assert len(fp.Scene.from_numpy(path)) == 1
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 1e7


@pytest.mark.parametrize("cell", ["1_0", "\u0661", "\uff11", "0x1", "1e", "infinity", "1 0"])
def test_a_number_is_written_as_everywhere_else(tmp_path, cell):
    (tmp_path / "s.csv").write_text(f"x,y,z,radius\n{cell},1,1,1\n", encoding="utf-8")
    with pytest.raises(fp.InvalidInput, match=r"line 2, column x: got"):
        fp.Scene.from_csv(tmp_path / "s.csv")


def test_a_file_without_end_is_refused():
    with pytest.raises(fp.InvalidInput, match="more than 256 MB"):
        fp.Scene.from_csv("/dev/zero")


def test_a_long_field_is_refused_with_its_line(tmp_path):
    (tmp_path / "s.csv").write_text("x,y,z,radius\n" + "1" * 140_000 + ",1,1,1\n")
    with pytest.raises(fp.InvalidInput, match=r"line 2: got '140006 characters'"):
        fp.Scene.from_csv(tmp_path / "s.csv")
