"""Tables of poses in CSV files."""

import numpy as np
import pytest

import ffsr_plan as fp

HEADER = "t,x,y,z,qx,qy,qz,qw"


def written(folder, text):
    (folder / "track.csv").write_text(text)
    return folder / "track.csv"


def test_a_table_is_read_in_any_order_and_unit(tmp_path):
    text = """# a target
t [min], z [mm], x, y [cm], qw, qx, qy, qz

0, 1000, 1.5, 50, 1, 0, 0, 0
0.5, 2000, 2.5, 60, 2, 0, 0, 0
"""
    with pytest.raises(fp.InvalidInput, match=r"attitudes\.1"):
        fp.Track.from_csv(written(tmp_path, text))
    track = fp.Track.from_csv(written(tmp_path, text.replace(" 2, 0, 0, 0", " 1, 0, 0, 0")))
    assert np.array_equal(track.times, [0.0, 30.0])
    assert np.allclose(track.positions, [[1.5, 0.5, 1.0], [2.5, 0.6, 2.0]], atol=1e-15)
    assert np.array_equal(track.attitudes, [[0.0, 0.0, 0.0, 1.0]] * 2)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "a header that names t, x"),
        ("t,x,y,z,qx,qy,qz\n", "a column qw as well"),
        (f"{HEADER},vx\n", "vx"),
        (f"{HEADER.replace('qx', 'qx [rad]')}\n", "unit of column qx"),
        (f"{HEADER.replace('x,y', 'x [ft],y')}\n", "unit of column x"),
        (f"{HEADER}\n0,0,0,0,0,0,0\n", "line 2"),
        (f"{HEADER}\n0,0,0,far,0,0,0,1\n", "line 2, column z"),
        (f"{HEADER}\n0,0,0,nan,0,0,0,1\n", "a finite number"),
        (f"{HEADER}\n0,0,0,0,0,0,0,1\n", "at least two times"),
    ],
)
def test_a_table_that_is_wrong_is_named(tmp_path, text, words):
    with pytest.raises(fp.InvalidInput, match=words):
        fp.Track.from_csv(written(tmp_path, text))
