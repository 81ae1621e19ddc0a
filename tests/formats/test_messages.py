"""Messages of strangers: ROS 2, MCAP and CCSDS, and what is wrong in them."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

import ffsr_plan as fp

fm = fp.formats
POINT = {"positions": [0.0, 1.0], "time_from_start": {"sec": 0, "nanosec": 0}}
LATER = {"positions": [0.5, 0.5], "time_from_start": {"sec": 1, "nanosec": 500000000}}
MESSAGE = {"joint_names": ["a", "b"], "points": [POINT, LATER]}


def read(tmp_path, message):
    (tmp_path / "m.json").write_text(json.dumps(message))
    return fm.read_trajectory(tmp_path / "m.json")


@pytest.mark.parametrize(
    "wrap",
    [
        lambda m: m,
        lambda m: {"joint_trajectory": m},
        lambda m: {"trajectory": {"joint_trajectory": m, "multi_dof_joint_trajectory": {}}},
        lambda m: {"goal": {"trajectory": m}},
        lambda m: {"trajectory": [{"joint_trajectory": m}]},  # a DisplayTrajectory
    ],
)
def test_joints_are_found_within_messages(tmp_path, wrap):
    found = read(tmp_path, wrap(MESSAGE))
    assert found.times.tolist() == [0.0, 1.5]
    assert found.joints["b"].tolist() == [1.0, 0.5]
    assert found.interpolation == "linear"


def test_velocities_make_a_message_cubic(tmp_path):
    points = [{**POINT, "velocities": [0.0, 0.1]}, {**LATER, "velocities": [0.0, 0.2]}]
    found = read(tmp_path, {**MESSAGE, "points": points})
    assert found.interpolation == "cubic"
    assert found.velocities["b"].tolist() == [0.1, 0.2]


def test_echoed_yaml_is_read(tmp_path):
    pytest.importorskip("yaml")
    (tmp_path / "m.yaml").write_text(
        "joint_names: [a]\npoints:\n- positions: [0.0]\n  velocities: []\n"
        "  time_from_start: {sec: 0, nanosec: 0}\n- positions: [1.0]\n"
        "  time_from_start: {sec: 2, nanosec: 0}\n---\n"
    )
    assert fm.read_trajectory(tmp_path / "m.yaml").joints["a"].tolist() == [0.0, 1.0]


@pytest.mark.parametrize(
    ("message", "field"),
    [
        ({}, "m.json"),
        ([MESSAGE, MESSAGE], "m.json"),
        ({"trajectory": [MESSAGE, MESSAGE]}, "m.json"),  # all of a plan, not its first part
        ([], "m.json"),
        ({**MESSAGE, "points": []}, "m.json"),
        ({**MESSAGE, "points": [POINT, {**LATER, "positions": [1.0]}]}, "points.1, positions"),
        ({**MESSAGE, "points": [POINT, {"positions": [1.0, 1.0]}]}, "points.1"),
        ({**MESSAGE, "points": [POINT, {**LATER, "time_from_start": "1"}]}, "time_from_start"),
        ({**MESSAGE, "points": [POINT, POINT]}, "times, row 1"),
        ({**MESSAGE, "points": [POINT, {**LATER, "velocities": [0.0, 0.0]}]}, "points.0"),
    ],
)
def test_what_is_wrong_in_a_message_is_named(tmp_path, message, field):
    with pytest.raises(fp.InvalidInput) as error:
        read(tmp_path, message)
    assert field in error.value.what


def test_several_documents_are_no_message(tmp_path):
    pytest.importorskip("yaml")
    (tmp_path / "m.yaml").write_text(f"{json.dumps(MESSAGE)}\n---\n{json.dumps(MESSAGE)}\n---\n")
    with pytest.raises(fp.InvalidInput, match="2 YAML documents"):
        fm.read_trajectory(tmp_path / "m.yaml")


def test_of_several_trajectories_in_a_bag_one_is_chosen(tmp_path):
    pytest.importorskip("mcap_ros2.writer")
    from mcap.reader import make_reader
    from mcap.writer import Writer

    firsts = []
    with (tmp_path / "two.mcap").open("wb") as out:
        bag = Writer(out)
        bag.start()
        for k, last in enumerate((0.5, 0.7)):
            fm.write_mcap(tmp_path / "one.mcap", fp.Trajectory([0.0, 1.0], {"a": [0.0, last]}))
            with (tmp_path / "one.mcap").open("rb") as file:
                for schema, channel, message in make_reader(file).iter_messages():
                    kind = bag.register_schema(schema.name, schema.encoding, schema.data)
                    topic = bag.register_channel(f"/arm_{k}", channel.message_encoding, kind)
                    bag.add_message(topic, k, message.data, k)
                    firsts.append(last)
        bag.finish()
    with pytest.raises(fp.InvalidInput, match="2 on /arm_0, /arm_1"):
        fm.read_trajectory(tmp_path / "two.mcap")
    for k, last in enumerate(firsts):
        for choice in ({"number": k}, {"topic": f"/arm_{k}"}):
            assert fm.read_mcap(tmp_path / "two.mcap", **choice).joints["a"][1] == last
    with pytest.raises(fp.InvalidInput, match="number 2 asked for"):
        fm.read_mcap(tmp_path / "two.mcap", number=2)
    for wrong in ({"number": -1}, {"topic": "/arm_2"}, {"topic": 2}):
        with pytest.raises(fp.InvalidInput, match=next(iter(wrong))):
            fm.read_mcap(tmp_path / "two.mcap", **wrong)


def test_recorded_joint_states_are_rows(tmp_path):
    writer = pytest.importorskip("mcap_ros2.writer")
    rule = "=" * 80
    definition = (
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
        f"float64[] effort\n{rule}\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\n"
        f"string frame_id\n{rule}\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
    )
    with (tmp_path / "b.mcap").open("wb") as file:
        bag = writer.Writer(file)
        schema = bag.register_msgdef("sensor_msgs/msg/JointState", definition)
        for k in range(3):
            stamp = SimpleNamespace(sec=1700000000 + k, nanosec=250000000)
            message = SimpleNamespace(
                header=SimpleNamespace(stamp=stamp, frame_id=""), name=["a", "b"],
                position=[0.1 * k, -0.1 * k], velocity=[], effort=[],
            )  # fmt: skip
            bag.write_message("/joint_states", schema, message, log_time=k, publish_time=k)
        bag.finish()
    found = fm.read_trajectory(tmp_path / "b.mcap")
    assert (found.times - found.times[0]).tolist() == [0.0, 1.0, 2.0]
    assert found.joints["b"].tolist() == [0.0, -0.1, -0.2]
    (tmp_path / "c.mcap").write_bytes((tmp_path / "b.mcap").read_bytes()[:100])
    with pytest.raises(fp.InvalidInput, match="MCAP"):
        fm.read_trajectory(tmp_path / "c.mcap")


def ephemeris():
    half = np.array([0.0, 0.3, 0.5])
    quats = np.column_stack([np.sin(half), 0.0 * half, 0.0 * half, np.cos(half)])
    places = np.array([[0.0, 1.0, 2.0], [0.5, 1.0, 2.0], [1.5, 1.0, 2.5]])
    return fp.Trajectory([0.0, 1.0, 3.0], {}, base_positions=places, base_attitudes=quats)


def test_the_other_way_of_writing_an_attitude_is_the_same(tmp_path):
    path, given = tmp_path / "t.aem", ephemeris()
    fm.write_aem(path, given, fm.Frames(epoch="2026-060T23:59:59.5", frame="RTN"))
    text = path.read_text()
    assert "2026-03-02T00:00:00.500000000" in text
    lines = text.splitlines()
    data = lines.index("DATA_START")
    for k in range(data + 1, data + 4):
        time, x, y, z, w = lines[k].split()
        lines[k] = f"{time} {w} {-float(x)} {-float(y)} {-float(z)}"
    other = "\n".join(lines).replace("A2B", "B2A").replace("= LAST", "= FIRST")
    (tmp_path / "u.aem").write_text(other)
    for name in ("t.aem", "u.aem"):
        assert np.array_equal(fm.read_aem(tmp_path / name).base_attitudes, given.base_attitudes)


def test_another_library_reads_the_orbit(tmp_path):
    oem, given = pytest.importorskip("oem"), ephemeris()
    fm.write_oem(tmp_path / "t.oem", given, fm.Frames(center="MARS", frame="ICRF"))
    (segment,) = oem.OrbitEphemerisMessage.open(tmp_path / "t.oem").segments
    states = list(segment.states)
    assert np.abs(1e3 * np.array([s.position for s in states]) - given.base_positions).max() < 1e-9
    assert np.abs(1e3 * states[0].velocity - [0.5, 0.0, 0.0]).max() < 1e-9
    assert segment.metadata["CENTER_NAME"] == "MARS"


@pytest.mark.parametrize(
    ("change", "field"),
    [
        (("CCSDS_AEM_VERS", "CCSDS_XYZ_VERS"), "t.aem"),
        (("= QUATERNION\n", "= EULER_ANGLE\n"), "ATTITUDE_TYPE"),
        (("= A2B", "= C2D"), "ATTITUDE_DIR"),
        (("META_STOP\n", "META_STOP\nMETA_START\nMETA_STOP\n"), "segments"),
        (("T00:00:01", "T00:70:01"), "epoch"),
        (("T00:00:01.000000000 ", "T00:00:01.000000000 x "), "line"),
    ],
)
def test_what_is_wrong_in_an_ephemeris_is_named(tmp_path, change, field):
    fm.write_aem(tmp_path / "t.aem", ephemeris())
    text = (tmp_path / "t.aem").read_text()
    assert change[0] in text
    (tmp_path / "t.aem").write_text(text.replace(*change))
    with pytest.raises(fp.InvalidInput) as error:
        fm.read_aem(tmp_path / "t.aem")
    assert field in error.value.what


def test_words_that_a_message_cannot_hold_are_refused(tmp_path):
    with pytest.raises(fp.InvalidInput, match=r"frames\.frame"):
        fm.write_aem(tmp_path / "t.aem", ephemeris(), fm.Frames(frame="two\nlines"))
    with pytest.raises(fp.InvalidInput, match="base attitudes"):
        fm.write_aem(tmp_path / "t.aem", fp.Trajectory([0, 1], {"a": [0, 1]}))
