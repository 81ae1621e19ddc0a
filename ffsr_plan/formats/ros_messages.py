"""Trajectories as ROS 2 messages: JointTrajectory, MultiDOFJointTrajectory, RobotTrajectory.

Messages are mappings here, as `ros2 topic echo` prints them and as JSON bridges send them. They say
nothing of the motion between two points; where velocities are given it is cubic, as controllers
have it, and otherwise linear.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import text
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.formats.values.data_files import field_of, read_data, write_data
from ffsr_plan.trajectory.trajectory import Trajectory, spline_rates

_NANO = 1e-9
_WRAPPERS = ("trajectory", "robot_trajectory", "planned_trajectory", "goal", "msg", "message")
BASE_JOINT = "base_joint"
"""Name of the joint of the base, where none is given."""


def read_ros(path: str | Path, interpolation: str | None = None) -> Trajectory:
    """Read a message as JSON or YAML.

    It is a `trajectory_msgs/JointTrajectory`, a `trajectory_msgs/MultiDOFJointTrajectory`, whose
    one joint is the base, or a `moveit_msgs/RobotTrajectory`, which holds both; also as an entry
    `trajectory` or `planned_trajectory` of another message. Accelerations and efforts are skipped.

    Args:
        path: the file; it ends in .json, .yaml or .yml.
        interpolation: `linear` or `cubic`; by default cubic where velocities are given.

    Raises:
        InvalidInput: names the file, the field, its value and what is allowed.
    """
    return trajectory_from(f"file '{path}'", read_data("trajectory", path), interpolation)


def write_ros(
    path: str | Path,
    trajectory: Trajectory,
    *,
    frame_id: str = "world",
    base_joint: str = BASE_JOINT,
) -> None:
    """Write a `moveit_msgs/RobotTrajectory` as JSON or YAML; see `messages_of`.

    Args:
        path: the file, replaced if it exists; it ends in .json, .yaml or .yml.
        trajectory: the trajectory.
        frame_id: name of the world's frame.
        base_joint: name of the joint between world and base.

    Raises:
        InvalidInput: no trajectory, or a file that cannot be written.
    """
    write_data(path, messages_of(trajectory, frame_id=frame_id, base_joint=base_joint))


def messages_of(
    trajectory: Trajectory, *, frame_id: str = "world", base_joint: str = BASE_JOINT
) -> dict[str, Any]:
    """A trajectory as a RobotTrajectory: of the joints, and of the base as far as it is given.

    Times count from the first one and are rounded to nanoseconds. Of a cubic trajectory all points
    have velocities, also where the trajectory itself has none; of a linear one none have. The base
    has its velocity in world axes and no angular velocity.

    Args:
        trajectory: the trajectory.
        frame_id: name of the world's frame.
        base_joint: name of the joint between world and base.

    Returns:
        The message as a mapping.

    Raises:
        InvalidInput: no trajectory, or names that are no texts.
    """
    if not isinstance(trajectory, Trajectory):
        raise InvalidInput("trajectory", trajectory, "a Trajectory")
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": text("frame_id", frame_id)}
    text("base_joint", base_joint)
    names = list(trajectory.joints)
    clock = [_duration(time) for time in (trajectory.times - trajectory.times[0]).tolist()]
    values = trajectory.joint_array(names)
    rates = np.zeros((len(clock), 0))
    if trajectory.interpolation == "cubic":
        given = bool(trajectory.velocities)
        rates = trajectory.joint_array(names, True) if given else _rates(trajectory, values)
    points = [
        {"positions": q, "velocities": v, "accelerations": [], "effort": [], "time_from_start": at}
        for q, v, at in zip(values.tolist(), rates.tolist(), clock, strict=True)
    ]
    joints = {"header": header, "joint_names": names, "points": points}
    return {
        "joint_trajectory": joints if names else {**joints, "points": []},
        "multi_dof_joint_trajectory": _base_message(trajectory, header, base_joint, clock),
    }


def _base_message(
    trajectory: Trajectory, header: dict[str, Any], name: str, clock: list[dict[str, int]]
) -> dict[str, Any]:
    """The MultiDOFJointTrajectory of the base; without points where the base is not given."""
    places, attitudes = trajectory.base_positions, trajectory.base_attitudes
    message: dict[str, Any] = {"header": header, "joint_names": [], "points": []}
    if places is None and attitudes is None:
        return message
    count = len(clock)
    where = np.zeros((count, 3)) if places is None else places
    turned = np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)) if attitudes is None else attitudes
    rates: Array | None = None
    if trajectory.interpolation == "cubic" and places is not None:
        rates = trajectory.base_velocities
        rates = _rates(trajectory, places) if rates is None else rates
    points = []
    for k, at in enumerate(clock):
        pose = {"translation": _named(where[k], "xyz"), "rotation": _named(turned[k], "xyzw")}
        twist = []
        if rates is not None:
            twist = [{"linear": _named(rates[k], "xyz"), "angular": _named(np.zeros(3), "xyz")}]
        points.append(
            {"transforms": [pose], "velocities": twist, "accelerations": [], "time_from_start": at}
        )
    return {**message, "joint_names": [name], "points": points}


def trajectory_from(what: str, message: object, interpolation: str | None) -> Trajectory:
    """The trajectory of a message.

    Args:
        what: name of the message in errors.
        message: a mapping.
        interpolation: `linear` or `cubic`; None for what the velocities say.

    Raises:
        InvalidInput: names the field, its value and what is allowed.
    """
    parts = {"joint_trajectory": message, "multi_dof_joint_trajectory": None}
    for _ in range(4):  # messages within messages
        if isinstance(message, list) and message:
            if len(message) > 1:
                raise InvalidInput(what, f"{len(message)} messages in a list", "one trajectory")
            message = message[0]
        if not isinstance(message, dict) or "points" in message or "joint_trajectory" in message:
            break
        inner = next((name for name in _WRAPPERS if name in message), None)
        if inner is None:
            break
        message = message[inner]
    if not isinstance(message, dict):
        raise InvalidInput(what, message, "a message of joints over time")
    if "joint_trajectory" in message or "multi_dof_joint_trajectory" in message:
        parts = {name: message.get(name) for name in parts}
    else:
        of_base = _is_base(message)
        parts = {
            "joint_trajectory": None if of_base else message,
            "multi_dof_joint_trajectory": message if of_base else None,
        }
    joints = _joints(what, parts["joint_trajectory"])
    base = _base(what, parts["multi_dof_joint_trajectory"])
    if not joints and not base:
        raise InvalidInput(what, "no points", "points of a JointTrajectory")
    times = joints.pop("times", None)
    base_times = base.pop("times", times)
    if times is not None and not np.array_equal(times, base_times):
        raise InvalidInput(f"{what}, times of the base", base_times.tolist(), "those of the joints")
    moving = bool(joints.get("velocities")) or "base_velocities" in base
    chosen = interpolation or ("cubic" if moving else "linear")
    given = {"joints": {}, **joints, **base}
    return Trajectory(
        base_times if times is None else times, **given, interpolation=chosen, source=what
    )


def _is_base(message: dict[str, Any]) -> bool:
    points = message.get("points")
    return bool(points) and isinstance(points, list) and "transforms" in points[0]


def _joints(what: str, message: object) -> dict[str, Any]:
    """Times, joints and velocities of a JointTrajectory; nothing without points."""
    if message is None:
        return {}
    names = field_of(f"{what}, joint_trajectory", message, "joint_names", list, [])
    points = field_of(f"{what}, joint_trajectory", message, "points", list, [])
    if not points:
        return {}
    columns: dict[str, list[list[float]]] = {"positions": [], "velocities": []}
    for k, point in enumerate(points):
        where = f"{what}, points.{k}"
        for name, rows in columns.items():
            row = field_of(where, point, name, list, [])
            if len(row) != len(names) and (row or name == "positions"):
                raise InvalidInput(f"{where}, {name}", row, f"{len(names)} numbers, one per joint")
            rows.append(row)
    with_rates = [bool(row) for row in columns["velocities"]]
    found: dict[str, Any] = {"times": _times(what, points)}
    found["joints"] = _columns(names, columns["positions"])
    if names and all(with_rates):
        found["velocities"] = _columns(names, columns["velocities"])
    elif any(with_rates):
        k = with_rates.index(False)
        raise InvalidInput(f"{what}, points.{k}, velocities", "none", "velocities, as elsewhere")
    return found


def _base(what: str, message: object) -> dict[str, Any]:
    """Times and poses of a MultiDOFJointTrajectory; nothing without points."""
    if message is None:
        return {}
    where = f"{what}, multi_dof_joint_trajectory"
    names = field_of(where, message, "joint_names", list, [])
    points = field_of(where, message, "points", list, [])
    if not points:
        return {}
    if len(names) != 1:
        raise InvalidInput(f"{where}, joint_names", names, "one name, of the joint of the base")
    places, turns, rates = [], [], []
    for k, point in enumerate(points):
        at = f"{where}, points.{k}"
        pose = next(iter(field_of(at, point, "transforms", list)), None)
        places.append(_numbers(at, field_of(at, pose, "translation", dict), "xyz"))
        turns.append(_numbers(at, field_of(at, pose, "rotation", dict), "xyzw"))
        for twist in field_of(at, point, "velocities", list, [])[:1]:
            rates.append(_numbers(at, field_of(at, twist, "linear", dict), "xyz"))
    found = {"times": _times(where, points), "base_positions": places, "base_attitudes": turns}
    return {**found, "base_velocities": rates} if len(rates) == len(points) else found


def _times(what: str, points: list[Any]) -> Array:
    """(N,) times from the start [s]."""
    times = []
    for k, point in enumerate(points):
        at = field_of(f"{what}, points.{k}", point, "time_from_start", object)
        if isinstance(at, dict):
            nano = at.get("nanosec", at.get("nsecs", 0))
            seconds = at.get("sec", at.get("secs"))
            numbers = all(isinstance(each, (int, float)) for each in (seconds, nano))
            at = seconds + _NANO * nano if numbers else None  # type: ignore[operator]
        if isinstance(at, bool) or not isinstance(at, (int, float)):
            value = point["time_from_start"]
            raise InvalidInput(f"{what}, points.{k}, time_from_start", value, "sec and nanosec")
        times.append(float(at))
    return np.array(times)


def _duration(time: float) -> dict[str, int]:
    seconds, nano = divmod(round(time / _NANO), 10**9)
    return {"sec": seconds, "nanosec": nano}


def _rates(trajectory: Trajectory, values: Array) -> Array:
    return spline_rates(trajectory.times, values)


def _named(values: Array, axes: str) -> dict[str, float]:
    return dict(zip(axes, values.tolist(), strict=True))


def _numbers(what: str, table: dict[str, Any], axes: str) -> list[float]:
    missing = [axis for axis in axes if axis not in table]
    if missing:
        raise InvalidInput(what, table, f"numbers {', '.join(axes)}")
    return [table[axis] for axis in axes]


def _columns(names: list[str], rows: list[list[float]]) -> dict[str, list[float]]:
    return {name: [row[k] for row in rows] for k, name in enumerate(names)}
