"""Tables and arrays: what is written is read again, and strangers' headers are understood."""

import numpy as np
import pytest

import ffsr_plan as fp


def example(**more):
    rng = np.random.default_rng(1)
    quats = rng.normal(size=(4, 4))
    return fp.Trajectory(
        [0.0, 0.5, 0.75, 2.0],
        {"a": rng.normal(size=4), "b-2": rng.normal(size=4)},
        velocities={"a": rng.normal(size=4), "b-2": rng.normal(size=4)},
        base_positions=rng.normal(size=(4, 3)),
        base_velocities=rng.normal(size=(4, 3)),
        base_attitudes=quats / np.linalg.norm(quats, axis=1)[:, None],
        interpolation="cubic",
        **more,
    )


@pytest.mark.parametrize("end", ["csv", "npz"])
def test_what_is_written_is_read_bit_for_bit(tmp_path, end):
    given = example()
    fp.formats.write_trajectory(tmp_path / f"t.{end}", given)
    assert fp.formats.read_trajectory(tmp_path / f"t.{end}") == given
    assert fp.formats.read_trajectory(tmp_path / f"t.{end}", "linear").interpolation == "linear"


def test_units_of_the_header_count(tmp_path):
    path = tmp_path / "t.csv"
    header = "time [ms], j 1 [deg] ,slide [mm],j 1 velocity [deg/s],slide velocity,slide effort\n"
    path.write_text(header + "0,90,500,180,0.25,9\n\n# a note\n500,0,0,0,0,9\n")
    found = fp.formats.read_csv(path)
    assert found.times.tolist() == [0.0, 0.5]
    assert found.joints["j 1"][0] == pytest.approx(np.pi / 2)
    assert found.joints["slide"].tolist() == [0.5, 0.0]
    assert found.velocities["j 1"][0] == pytest.approx(np.pi)
    assert list(found.joints) == ["j 1", "slide"]


def test_units_in_parentheses_count_and_remarks_before_units_do_not(tmp_path):
    path = tmp_path / "t.csv"
    path.write_text("time (ms),a (deg),b position (deg),c (hinge) [rad]\n0,0,0,0\n500,90,180,1\n")
    found = fp.formats.read_csv(path)
    assert found.times.tolist() == [0.0, 0.5]
    last = [found.joints[name][1] for name in "abc"]
    assert last == pytest.approx([np.pi / 2, np.pi, 1.0])
    path.write_text("time,a (grad)\n0,0\n1,1\n")
    with pytest.raises(fp.InvalidInput, match="unit of column 'a'"):
        fp.formats.read_csv(path)


def test_times_of_a_calendar_count_from_the_first(tmp_path):
    (tmp_path / "t.csv").write_text("t,a\n1700000000.5,0\n1700000001.0,1\n")
    assert fp.formats.read_csv(tmp_path / "t.csv").times.tolist() == [0.0, 0.5]


def test_tables_of_plans_and_flights_are_read(fig2a_plan, tmp_path):
    fig2a_plan.to_csv(tmp_path / "p.csv")
    found = fp.formats.read_csv(tmp_path / "p.csv")
    robot = fig2a_plan.problem.robot
    assert tuple(found.joints) == robot.joint_names
    rows = robot.assemble(
        found.base_positions, found.base_attitudes, found.joint_array(robot.joint_names)
    )
    assert np.abs(rows - fig2a_plan.configurations).max() < 1e-15


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ("a,b\n0,1\n", "header"),
        ("t,a\n0,1\n1\n", "line 3"),
        ("t,a\n0,1\n1,x\n", "line 3, column 'a'"),
        ("t,a\n0,1\n1,nan\n", "line 3, column 'a'"),
        ("t,a [furlong]\n0,1\n1,2\n", "unit of column 'a'"),
        ("t,a,a\n0,1,1\n1,2,2\n", "header"),
        ("t,a,base_x\n0,1,1\n1,2,2\n", "header"),
        ("t,time,a\n0,0,1\n1,1,2\n", "header"),
        ("t,a\n1,1\n1,2\n", "times, row 1"),
        ("t,a\n1,1\n", "times"),
        ("", "CSV file"),
    ],
)
def test_what_is_wrong_in_a_table_is_named(tmp_path, text, field):
    (tmp_path / "t.csv").write_text(text)
    with pytest.raises(fp.InvalidInput) as error:
        fp.formats.read_csv(tmp_path / "t.csv")
    assert field in error.value.what
    assert "t.csv" in error.value.what


@pytest.mark.parametrize("name", ["t.xyz", "t", "t.csv"])
def test_files_of_no_known_kind_are_refused(tmp_path, name):
    with pytest.raises(fp.InvalidInput, match="trajectory"):
        fp.formats.read_trajectory(tmp_path / name)
