"""CCSDS messages as keywords and values: attitude (AEM) and orbit ephemeris messages (OEM).

CCSDS 504.0-B-1 and 502.0-B-2. Positions are in kilometres there. Neither has joints: of a
trajectory, an AEM holds the base attitudes and an OEM the base positions and velocities.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import datetime, timezone
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ffsr_plan.core.arrays import Array
from ffsr_plan.core.checks import one_of
from ffsr_plan.core.checks import path as checked_path
from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.core.text_files import read_text, write_text
from ffsr_plan.trajectory.trajectory import Trajectory, spline_rates

_KM = 1000.0  # [m]
_WORD = re.compile(r"[A-Z0-9][A-Z0-9_ ./-]*")
_TIME = re.compile(r"(\d{4})-(\d\d-\d\d|\d{3})T(\d\d):(\d\d):(\d\d)(?:\.(\d+))?Z?")
_CREATED = "2000-01-01T00:00:00"  # equal trajectories give equal files
_DEGREES = {"LINEAR": "linear", "HERMITE": "cubic", "LAGRANGE": "cubic"}


class Frames(NamedTuple):
    """What a message says besides numbers.

    Attributes:
        epoch: of the time 0 of the trajectory, such as 2026-03-01T12:00:00.
        time_system: such as UTC, TAI or TDB.
        frame: reference frame that the world's axes are, such as EME2000, ICRF, RTN or LVLH.
        center: origin of it, such as EARTH or the name of a target.
        object_name: name of the robot.
        object_id: international designator of it.
        body_frame: name of the axes of the base.
        originator: who made the message.
    """

    epoch: str = _CREATED
    time_system: str = "UTC"
    frame: str = "EME2000"
    center: str = "EARTH"
    object_name: str = "SERVICER"
    object_id: str = "2000-000A"
    body_frame: str = "SC_BODY_1"
    originator: str = "FFSR-PLAN"


def write_aem(path: str | Path, trajectory: Trajectory, frames: Frames | None = None) -> None:
    """Write the base attitudes as an attitude ephemeris message.

    The quaternion is that of the rotation from the reference frame to the base's axes, its scalar
    last (ATTITUDE_DIR A2B, QUATERNION_TYPE LAST). Joints and positions are not in it.

    Args:
        path: the file, replaced if it exists.
        trajectory: with base attitudes.
        frames: epoch, frames and names; by default those of `Frames`.

    Raises:
        InvalidInput: no base attitudes, a word that is not allowed, or a file that cannot be
            written.
    """
    said = _checked(trajectory, frames)
    if trajectory.base_attitudes is None:
        raise InvalidInput("trajectory", trajectory, "a trajectory with base attitudes")
    clock = _clock(said.epoch, trajectory.times)
    rows = trajectory.base_attitudes
    meta = {
        "OBJECT_NAME": said.object_name,
        "OBJECT_ID": said.object_id,
        "CENTER_NAME": said.center,
        "REF_FRAME_A": said.frame,
        "REF_FRAME_B": said.body_frame,
        "ATTITUDE_DIR": "A2B",
        "TIME_SYSTEM": said.time_system,
        "START_TIME": clock[0],
        "STOP_TIME": clock[-1],
        "ATTITUDE_TYPE": "QUATERNION",
        "QUATERNION_TYPE": "LAST",
        "INTERPOLATION_METHOD": "LINEAR",
        "INTERPOLATION_DEGREE": "1",
    }
    head = {"CCSDS_AEM_VERS": "1.0", "CREATION_DATE": _CREATED, "ORIGINATOR": said.originator}
    lines = ["DATA_START", *_lines(clock, rows), "DATA_STOP"]
    write_text("path", checked_path("path", path), _message(head, meta, lines))


def read_aem(path: str | Path) -> Trajectory:
    """Read an attitude ephemeris message of one segment of quaternions.

    Args:
        path: the file.

    Returns:
        A trajectory without joints; its times count from the first one. The attitudes are those of
        REF_FRAME_B in REF_FRAME_A, the world, where the direction is A2B, and the inverse of what
        is written where it is B2A.

    Raises:
        InvalidInput: names the file, the keyword, its value and what is allowed.
    """
    what, meta, clock, rows = _read(path, "CCSDS_AEM_VERS", 5)
    one_of(f"{what}, ATTITUDE_TYPE", meta.get("ATTITUDE_TYPE"), ["QUATERNION"])
    first = one_of(f"{what}, QUATERNION_TYPE", meta.get("QUATERNION_TYPE"), ["LAST", "FIRST"])
    way = one_of(f"{what}, ATTITUDE_DIR", meta.get("ATTITUDE_DIR"), ["A2B", "B2A"])
    quats = rows[:, [1, 2, 3, 0]] if first == "FIRST" else rows
    if way == "B2A":
        quats = quats * np.array([-1.0, -1.0, -1.0, 1.0])
    return Trajectory(clock, {}, base_attitudes=quats, source=what)


def write_oem(path: str | Path, trajectory: Trajectory, frames: Frames | None = None) -> None:
    """Write the base positions and velocities as an orbit ephemeris message [km, km/s].

    Velocities that the trajectory lacks are those of its pieces; at a corner between two linear
    ones, of the piece that begins. Joints and attitudes are not in it.

    Args:
        path: the file, replaced if it exists.
        trajectory: with base positions.
        frames: epoch, frames and names; by default those of `Frames`.

    Raises:
        InvalidInput: no base positions, a word that is not allowed, or a file that cannot be
            written.
    """
    said = _checked(trajectory, frames)
    if trajectory.base_positions is None:
        raise InvalidInput("trajectory", trajectory, "a trajectory with base positions")
    clock, places = _clock(said.epoch, trajectory.times), trajectory.base_positions
    rates, cubic = trajectory.base_velocities, trajectory.interpolation == "cubic"
    if rates is None and cubic:
        rates = spline_rates(trajectory.times, places)
    elif rates is None:
        steps = np.diff(places, axis=0) / np.diff(trajectory.times)[:, None]
        rates = np.vstack([steps, steps[-1:]])
    meta = {
        "OBJECT_NAME": said.object_name,
        "OBJECT_ID": said.object_id,
        "CENTER_NAME": said.center,
        "REF_FRAME": said.frame,
        "TIME_SYSTEM": said.time_system,
        "START_TIME": clock[0],
        "STOP_TIME": clock[-1],
        "INTERPOLATION": "HERMITE" if cubic else "LINEAR",
        "INTERPOLATION_DEGREE": "3" if cubic else "1",
    }
    head = {"CCSDS_OEM_VERS": "2.0", "CREATION_DATE": _CREATED, "ORIGINATOR": said.originator}
    lines = _lines(clock, np.hstack([places, rates]) / _KM)
    write_text("path", checked_path("path", path), _message(head, meta, lines))


def read_oem(path: str | Path) -> Trajectory:
    """Read an orbit ephemeris message of one segment.

    Args:
        path: the file.

    Returns:
        A trajectory without joints; its times count from the first one. It is cubic, with the
        velocities of the file, unless that says LINEAR.

    Raises:
        InvalidInput: names the file, the keyword, its value and what is allowed.
    """
    what, meta, clock, rows = _read(path, "CCSDS_OEM_VERS", 7)
    method = one_of(
        f"{what}, INTERPOLATION", meta.get("INTERPOLATION", "HERMITE").upper(), list(_DEGREES)
    )
    return Trajectory(
        clock,
        {},
        base_positions=_KM * rows[:, :3],
        base_velocities=_KM * rows[:, 3:6],
        interpolation=_DEGREES[method],
        source=what,
    )


def _checked(trajectory: object, frames: Frames | None) -> Frames:
    """The frames, checked; the default ones without."""
    if not isinstance(trajectory, Trajectory):
        raise InvalidInput("trajectory", trajectory, "a Trajectory")
    said = Frames() if frames is None else frames
    if not isinstance(said, Frames):
        raise InvalidInput("frames", frames, "a Frames")
    for name, word in said._asdict().items():
        if name != "epoch" and not (isinstance(word, str) and _WORD.fullmatch(word)):
            allowed = "capital letters, digits, blanks and _ . / -, as keywords of CCSDS have them"
            raise InvalidInput(f"frames.{name}", word, allowed)
    _instant("frames.epoch", said.epoch)
    return said


def _clock(epoch: str, times: Array) -> list[str]:
    """Times after an epoch as texts, to the nanosecond."""
    begin = _instant("frames.epoch", epoch)
    texts = []
    for time in times.tolist():
        seconds, nano = divmod(begin + round(time * 1e9), 10**9)
        day = datetime.fromtimestamp(seconds, timezone.utc).strftime("%Y-%m-%dT%H:%M:%S")
        texts.append(f"{day}.{nano:09d}")
    return texts


def _instant(what: str, given: object) -> int:
    """Nanoseconds since 1970, every day of 86 400 seconds, of an epoch as CCSDS writes it."""
    found = _TIME.fullmatch(given) if isinstance(given, str) else None
    try:
        if found is None:
            raise ValueError
        year, day, hour, minute, second, part = found.groups()
        form = "%Y-%j" if len(day) == 3 else "%Y-%m-%d"
        date = datetime.strptime(f"{year}-{day}", form).replace(tzinfo=timezone.utc)
        if int(hour) > 23 or int(minute) > 59 or int(second) > 60:  # 60 in a leap second
            raise ValueError
        clock = (int(hour) * 60 + int(minute)) * 60 + int(second)
        return (int(date.timestamp()) + clock) * 10**9 + round(float(f"0.{part or 0}") * 1e9)
    except ValueError:
        allowed = "an epoch such as 2026-03-01T12:00:00.5 or 2026-060T12:00:00.5"
        raise InvalidInput(what, given, allowed) from None


def _lines(clock: Sequence[str], rows: Array) -> list[str]:
    """Lines of data."""
    pairs = zip(clock, rows.tolist(), strict=True)
    return [f"{time} {' '.join(map(repr, row))}" for time, row in pairs]


def _message(head: dict[str, str], meta: dict[str, str], lines: list[str]) -> str:
    """Text of a message."""
    first = [f"{name} = {value}" for name, value in head.items()]
    about = [f"{name} = {value}" for name, value in meta.items()]
    return "\n".join([*first, "", "META_START", *about, "META_STOP", "", *lines, ""])


def _read(path: str | Path, kind: str, width: int) -> tuple[str, dict[str, str], Array, Array]:
    """Name, keywords, times (N,) from the first one [s] and numbers of a message of one segment."""
    what, target = f"message '{path}'", checked_path("message", path)
    meta: dict[str, str] = {}
    rows, clock, segments = list[list[float]](), list[int](), 0
    for number, line in enumerate(read_text("message", target, "utf-8-sig").splitlines(), start=1):
        words, where = line.split(), f"{what}, line {number}"
        if not words or words[0] == "COMMENT":
            continue
        if words[0] in ("META_START", "META_STOP", "DATA_START", "DATA_STOP"):
            segments += words[0] == "META_START"
        elif words[0] == "COVARIANCE_START":
            break
        elif "=" in line:
            name, _, value = line.partition("=")
            meta[name.strip()] = value.strip()
        else:
            clock.append(_instant(f"{where}, epoch", words[0]))
            rows.append(_numbers(where, words, width))
    if kind not in meta:
        raise InvalidInput(what, next(iter(meta), "no keyword"), f"a message that begins {kind}")
    if segments != 1:
        raise InvalidInput(f"{what}, segments", segments, "one segment")
    if len(rows) < 2:
        raise InvalidInput(f"{what}, lines of data", len(rows), "at least two")
    times = np.array([(at - clock[0]) * 1e-9 for at in clock])
    return what, meta, times, np.array(rows)


def _numbers(where: str, words: list[str], width: int) -> list[float]:
    """Numbers of a line of data; an orbit may have accelerations too, which are skipped."""
    try:
        if len(words) != width and not (width == 7 and len(words) == 10):
            raise ValueError
        return [float(word) for word in words[1:width]]
    except ValueError:
        allowed = f"an epoch and {width - 1} numbers"
        raise InvalidInput(where, " ".join(words), allowed) from None
