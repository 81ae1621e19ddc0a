"""Obstacles from CSV and NumPy files: what was written is read, mistakes are named."""

import numpy as np
import pytest

import ffsr_plan as fp
from tests.helpers.urdf_builders import random_scene


def written(tmp_path, text, name="debris.csv"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


def test_a_table_comes_back_bit_for_bit(tmp_path):
    scene = random_scene(np.random.default_rng(0), 200)
    scene.to_csv(tmp_path / "scene.csv")
    again = fp.Scene.from_csv(tmp_path / "scene.csv")
    assert np.array_equal(again.centers, scene.centers)
    assert np.array_equal(again.radii, scene.radii)


def test_columns_have_any_order_and_unit(tmp_path):
    text = "# tracked on Monday\nradius [cm], z,x [mm] , y [km]\n\n50,3,1000,0.002\n 1e1,-3,0,0\n"
    scene = fp.Scene.from_csv(written(tmp_path, text))
    assert scene.centers == pytest.approx(np.array([[1.0, 2.0, 3.0], [0.0, 0.0, -3.0]]))
    assert scene.radii == pytest.approx([0.5, 0.1])


def test_a_header_alone_is_an_empty_scene(tmp_path):
    assert len(fp.Scene.from_csv(written(tmp_path, "x,y,z,radius\n"))) == 0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"debris\.csv'.*a header that names x, y, z, radius"),
        ("1,2,3,4\n", r"header: got '1'; allowed: x, y, z, radius"),
        ("x,y,z,radios\n", r"header: got 'radios'.*did you mean 'radius'"),
        ("x,y,z\n", r"header: got 'x, y, z'; allowed: a column radius as well"),
        ("x,y,z,z\n", r"header: got 'z'; allowed: each column once"),
        ("x [inch],y,z,radius\n", r"unit of column x: got 'inch'; allowed: m, cm"),
        ("x,y,z,radius\n\n1,2,3,0.1\n1,zwei,3,4\n", r"line 4, column y: got 'zwei'; .*finite"),
        ("x,y,z,radius\n1,2,3,-0.1\n", r"line 2, column radius: got '-0.1'; .*greater than 0"),
        ("x,y,z,radius\n1,nan,3,0.1\n", r"line 2, column y: got 'nan'"),
        ("x,y,z,radius\n1,,3,0.1\n", r"line 2, column y: got ''"),
        ("x,y,z,radius\n1,1e6,3,.1\n", r"line 2, column y: got '1e6'; allowed: at most 100000 m"),
        ("x,y,z [km],radius\n1,2,300,.1\n", r"line 2, column z: got '300'; allowed: at most 1000"),
        ("x,y,z,radius\n1,2,3,1e10\n", r"line 2, column radius: got '1e10'; .*at most 1e\+09 m"),
        ("x;y;z;radius\n1;2;3;4\n", r"header: got 'x;y;z;radius'; .*commas .*, not semicolons$"),
        ("x\ty\tz\tradius\n", r"header: got .*; allowed: commas between columns, not tabs$"),
        ("x [mm] y z radius\n", r"header: got .*; allowed: commas between columns, not spaces$"),
        ("x,y,z,radius\n1,2,3\n", r"line 2: got '3 values'; allowed: 4, as in the header"),
    ],
)
def test_a_mistake_in_a_table_names_file_line_column_and_value(tmp_path, text, message):
    with pytest.raises(fp.InvalidInput, match=message):
        fp.Scene.from_csv(written(tmp_path, text))


def long_table(count):
    """Values (count, 4) and the lines of a table of them, which is read in several parts."""
    values = np.random.default_rng(3).uniform(0.1, 9.0, (count, 4))
    return values, ["x,y,z,radius", *(",".join(map(repr, row)) for row in values.tolist())]


def test_comments_blank_lines_and_quotes_do_not_matter_wherever_they_are(tmp_path):
    values, lines = long_table(25_000)
    for place in (25_001, 24_000, 12_000, 10_001, 10_000, 1, 0):
        lines[place:place] = ["", "# noted", " , ,,"]
    lines[-4] = ",".join(f' "{cell}"'.strip() for cell in lines[-4].split(","))
    for text in ("\n".join(lines), "\n".join(lines).replace('"', "")):
        scene = fp.Scene.from_csv(written(tmp_path, text))
        assert np.array_equal(scene.centers, values[:, :3])
        assert np.array_equal(scene.radii, values[:, 3])


@pytest.mark.parametrize("line", [2, 9_999, 10_001, 10_002, 25_001])
@pytest.mark.parametrize(
    ("mistake", "message"),
    [
        ("1,zwei,3,4", r"line {}, column y: got 'zwei'"),
        ("1,2,nan,4", r"line {}, column z: got 'nan'"),
        ("1e999,2,3,4", r"line {}, column x: got '1e999'"),
        ("1,2,3,0", r"line {}, column radius: got '0'"),
        ("1,2,3,4,5", r"line {}: got '5 values'; allowed: 4"),
    ],
    ids=["word", "nan", "overflow", "radius", "width"],
)
def test_a_mistake_in_a_long_table_is_named_too(tmp_path, line, mistake, message):
    _, lines = long_table(25_000)
    lines[line - 1] = mistake
    with pytest.raises(fp.InvalidInput, match=message.format(line)):
        fp.Scene.from_csv(written(tmp_path, "\n".join(lines)))


def test_lines_that_all_have_too_many_values_are_refused(tmp_path):
    with pytest.raises(fp.InvalidInput, match=r"line 2: got '5 values'"):
        fp.Scene.from_csv(written(tmp_path, "x,y,z,radius\n1,2,3,4,5\n1,2,3,4,5\n"))


def test_a_missing_or_unwritable_table_is_named(tmp_path):
    with pytest.raises(fp.InvalidInput, match=r"nowhere\.csv.*No such file"):
        fp.Scene.from_csv(tmp_path / "nowhere.csv")
    with pytest.raises(fp.InvalidInput, match="a file that can be written"):
        fp.Scene().to_csv(tmp_path / "no" / "folder.csv")


def test_numpy_files_hold_the_same_spheres(tmp_path):
    scene = random_scene(np.random.default_rng(1), 20)
    np.save(tmp_path / "scene.npy", np.column_stack([scene.centers, scene.radii]))
    np.savez(tmp_path / "scene.npz", centers=scene.centers, radii=scene.radii)
    for name in ("scene.npy", "scene.npz"):
        again = fp.Scene.from_numpy(tmp_path / name)
        assert np.array_equal(again.centers, scene.centers)
        assert np.array_equal(again.radii, scene.radii)


def test_a_mistake_in_a_numpy_file_is_named(tmp_path):
    np.save(tmp_path / "three.npy", np.zeros((5, 3)))
    np.save(tmp_path / "objects.npy", np.array([{}]), allow_pickle=True)
    np.savez(tmp_path / "half.npz", centers=np.zeros((5, 3)))
    np.save(tmp_path / "flat.npy", np.zeros((5, 4)))
    for name, message in {
        "three.npy": r"three\.npy': got 'shape \(5, 3\)'; allowed: shape \(N, 4\)",
        "objects.npy": r"objects\.npy': got 'numbers of the kind object'",
        "half.npz": r"half\.npz': got 'centers'; allowed: arrays centers and radii",
        "nowhere.npy": r"^NumPy file: got '.*nowhere\.npy'; allowed: .*\(No such file or dir",
        "scene.txt": r"path: got .*scene\.txt'; allowed: a path that ends in \.npy or \.npz",
        "flat.npy": r"flat\.npy', radii, row 0: got 0\.0",
    }.items():
        with pytest.raises(fp.InvalidInput, match=message):
            fp.Scene.from_numpy(tmp_path / name)


def test_a_wrong_number_in_a_numpy_file_is_named_with_its_row(tmp_path):
    table = np.ones((4000, 4))
    table[3000] = 1.0, np.inf, 3.0, 0.1
    np.save(tmp_path / "far.npy", table)
    np.savez(tmp_path / "far.npz", centers=table[:, :3], radii=table[:, 3])
    table[3000] = 1.0, 2.0, 3.0, np.nan
    np.save(tmp_path / "wide.npy", table)
    for name, column, value in (
        ("far.npy", "centers", "inf"),
        ("far.npz", "centers", "inf"),
        ("wide.npy", "radii", "nan"),
    ):
        message = rf"^NumPy file '.*{name}', {column}, row 3000: got {value}; allowed: a finite num"
        with pytest.raises(fp.InvalidInput, match=message):
            fp.Scene.from_numpy(tmp_path / name)


def test_a_sum_of_read_scenes_holds_both_in_order():
    first, second = (random_scene(np.random.default_rng(k), 3) for k in range(2))
    both = first + second + fp.Scene()
    assert np.array_equal(both.centers, np.vstack([first.centers, second.centers]))
    assert np.array_equal(both.radii, np.hstack([first.radii, second.radii]))
    with pytest.raises(TypeError):
        first + 1
