"""Trajectories in MCAP files, as `ros2 bag` records them; no ROS installation is needed."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.checks import text, whole_number
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import reason, write_files
from ffsr_plan.formats.ros_messages import BASE_JOINT, messages_of, trajectory_from
from ffsr_plan.formats.values.data_files import extra
from ffsr_plan.trajectory.trajectory import Trajectory

_JOINTS = "trajectory_msgs/msg/JointTrajectory"
_BASE = "trajectory_msgs/msg/MultiDOFJointTrajectory"
_ROBOT = "moveit_msgs/msg/RobotTrajectory"
_DISPLAY = "moveit_msgs/msg/DisplayTrajectory"
_STATES = "sensor_msgs/msg/JointState"
_TOPICS = {_JOINTS: "/joint_trajectory", _BASE: "/base_trajectory"}
_RULE = "=" * 80
_TIME = f"{_RULE}\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
_DURATION = f"{_RULE}\nMSG: builtin_interfaces/Duration\nint32 sec\nuint32 nanosec\n"
_HEADER = f"{_RULE}\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n{_TIME}"
_VECTOR = f"{_RULE}\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"
_QUATERNION = (
    f"{_RULE}\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"
)
_DEFINITIONS = {
    _JOINTS: (
        "std_msgs/Header header\nstring[] joint_names\nJointTrajectoryPoint[] points\n"
        f"{_RULE}\nMSG: trajectory_msgs/JointTrajectoryPoint\nfloat64[] positions\n"
        "float64[] velocities\nfloat64[] accelerations\nfloat64[] effort\n"
        f"builtin_interfaces/Duration time_from_start\n{_HEADER}{_DURATION}"
    ),
    _BASE: (
        "std_msgs/Header header\nstring[] joint_names\nMultiDOFJointTrajectoryPoint[] points\n"
        f"{_RULE}\nMSG: trajectory_msgs/MultiDOFJointTrajectoryPoint\n"
        "geometry_msgs/Transform[] transforms\ngeometry_msgs/Twist[] velocities\n"
        "geometry_msgs/Twist[] accelerations\nbuiltin_interfaces/Duration time_from_start\n"
        f"{_RULE}\nMSG: geometry_msgs/Transform\nVector3 translation\nQuaternion rotation\n"
        f"{_RULE}\nMSG: geometry_msgs/Twist\nVector3 linear\nVector3 angular\n"
        f"{_HEADER}{_DURATION}{_VECTOR}{_QUATERNION}"
    ),
}


def read_mcap(
    path: str | Path,
    interpolation: str | None = None,
    *,
    topic: str | None = None,
    number: int | None = None,
) -> Trajectory:
    """Read the trajectory of a bag, or the states of the joints that it recorded.

    Read are JointTrajectory with, if there is one, the MultiDOFJointTrajectory of the base;
    otherwise RobotTrajectory or DisplayTrajectory; otherwise all JointState messages of one topic,
    each of which is a row. Of several trajectories one has to be chosen.

    Args:
        path: the file; it ends in `.mcap`.
        interpolation: `linear` or `cubic`; by default cubic where velocities are given, but linear
            between recorded states.
        topic: the only one that is read; by default all.
        number: which trajectory of the bag, from 0 in the order of their times; None if there is
            one only.

    Raises:
        InvalidInput: names the file, the field, its value and what is allowed.
    """
    target, what = checked_path("trajectory", path, ".mcap"), f"bag '{path}'"
    if topic is not None:
        text("topic", topic)
    factory = extra("mcap_ros2.decoder").DecoderFactory
    make_reader, topics = extra("mcap.reader").make_reader, None if topic is None else [topic]
    found: dict[str, list[Any]] = {}
    try:
        with target.open("rb") as file:
            reader = make_reader(file, decoder_factories=[factory()])
            for schema, channel, _, message in reader.iter_decoded_messages(topics):
                if schema.name in (_JOINTS, _BASE, _ROBOT, _DISPLAY, _STATES):
                    found.setdefault(str(schema.name), []).append((str(channel.topic), message))
    except InvalidInput:
        raise
    except Exception as error:  # of the package: damaged files raise many kinds
        allowed = f"an MCAP file of ROS 2 messages ({reason(error)})"
        raise InvalidInput("trajectory", str(path), allowed) from None
    if topic is not None and not found:
        raise InvalidInput(f"{what}, topic", topic, "a topic of joints over time in this bag")
    if number is not None:
        whole_number("number", number, at_least=0)
    for kind in (_JOINTS, _BASE, _ROBOT, _DISPLAY):
        if kind in found:
            message = _chosen(f"{what}, {kind}", found[kind], number)
            if kind == _JOINTS and _BASE in found:
                base = _chosen(f"{what}, {_BASE}", found[_BASE], number)
                message = {"joint_trajectory": message, "multi_dof_joint_trajectory": base}
            return trajectory_from(what, message, interpolation)
    if _STATES in found:
        return _from_states(what, found[_STATES], interpolation or "linear")
    allowed = f"one of {', '.join((_JOINTS, _BASE, _ROBOT, _DISPLAY, _STATES))}"
    raise InvalidInput(what, "no message of joints over time", allowed)


def write_mcap(
    path: str | Path,
    trajectory: Trajectory,
    *,
    frame_id: str = "world",
    base_joint: str = BASE_JOINT,
) -> None:
    """Write a bag with a JointTrajectory, and a MultiDOFJointTrajectory where the base is given.

    See `messages_of` for what they hold.

    Args:
        path: the file, replaced if it exists; it ends in `.mcap`.
        trajectory: the trajectory.
        frame_id: name of the world's frame.
        base_joint: name of the joint between world and base.

    Raises:
        InvalidInput: no trajectory, or a file that cannot be written.
    """
    target, content = checked_path("path", path, ".mcap"), io.BytesIO()
    message = messages_of(trajectory, frame_id=frame_id, base_joint=base_joint)
    writer = extra("mcap_ros2.writer").Writer(content)
    for kind, name in ((_JOINTS, "joint_trajectory"), (_BASE, "multi_dof_joint_trajectory")):
        if message[name]["points"]:
            schema = writer.register_msgdef(kind, _DEFINITIONS[kind])
            writer.write_message(_TOPICS[kind], schema, message[name], log_time=0, publish_time=0)
    writer.finish()
    write_files("path", {target: content.getvalue()})


def _chosen(what: str, messages: list[tuple[str, Any]], number: int | None) -> Any:  # noqa: ANN401
    """The message that is meant, as plain values."""
    count = len(messages)
    if (number is None and count > 1) or (number is not None and number >= count):
        topics = ", ".join(dict.fromkeys(topic for topic, _ in messages))
        allowed = f"one; of several, choose by `topic` or `number` (0 to {count - 1}) of read_mcap"
        asked = f"{count} on {topics}" + ("" if number is None else f", number {number} asked for")
        raise InvalidInput(what, asked, allowed)
    return _plain(messages[number or 0][1])


def _plain(message: object) -> Any:  # noqa: ANN401 - what a message holds
    """A message as mappings, lists and numbers."""
    if message is None or isinstance(message, (bool, int, float, str, bytes)):
        return message
    if isinstance(message, (list, tuple)):
        return [_plain(each) for each in message]
    if hasattr(message, "tolist"):  # an array of numbers
        return message.tolist()
    names = getattr(type(message), "__slots__", None) or vars(message)
    return {name.lstrip("_"): _plain(getattr(message, name)) for name in names}


def _from_states(what: str, states: list[tuple[str, Any]], interpolation: str) -> Trajectory:
    """The trajectory of the recorded states of one topic."""
    topics = list(dict.fromkeys(name for name, _ in states))
    if len(topics) > 1:
        raise InvalidInput(f"{what}, topics of {_STATES}", ", ".join(topics), "one: `topic` of it")
    topic, rows = topics[0], [_plain(message) for _, message in states]
    names = rows[0]["name"]
    times, positions, velocities = [], list[list[float]](), list[list[float]]()
    for k, row in enumerate(rows):
        if row["name"] != names or len(row["position"]) != len(names):
            raise InvalidInput(f"{what}, message {k} of {topic}", row["name"], ", ".join(names))
        stamp = row["header"]["stamp"]
        times.append((stamp["sec"] - rows[0]["header"]["stamp"]["sec"]) + 1e-9 * stamp["nanosec"])
        positions.append(row["position"])
        velocities.append(row["velocity"])
    given = None
    if interpolation == "cubic" and all(len(row) == len(names) for row in velocities):
        given = velocities
    return Trajectory.of_array(
        times, positions, names, velocities=given, interpolation=interpolation, source=what
    )
