"""What the command line says of a flight."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ffsr_plan.timing import TimedPlan


def flight_rows(flown: TimedPlan, rate: float) -> Iterator[tuple[str, str]]:
    """Names and values; peaks are those of so many instants a second."""
    robot, found = flown.motion.robot, flown.at(flown.clock(rate))
    yield "duration", f"{flown.duration:.2f} s"
    yield "rests on the way", f"{len(flown.rests)}, at corners of the path"
    if len(flown.pulses):
        largest = np.max(np.linalg.norm(flown.pulses, axis=1))
        yield "pulses", f"{len(flown.pulses)}, the largest {largest:.3g} m/s"
        yield "corner cut by them", f"at most {flown.corner_cut:.3g} m"
    yield "delta-v of the translation", f"{flown.delta_v:.4g} m/s"
    yield "peak thrust", f"{np.max(np.linalg.norm(found.thrust, axis=1)):.3g} N"
    if flown.motion.mode == "attitude-held":
        for name, values, unit in (
            ("torque", found.wheel_torque, "N m"),
            ("momentum", found.wheel_momentum, "N m s"),
        ):
            x, y, z = np.max(np.abs(values), axis=0)
            yield f"peak wheel {name}", f"x {x:.3g}, y {y:.3g}, z {z:.3g} {unit} in base axes"
    for k, name in enumerate(robot.joint_names):
        peak = np.max(np.abs(found.torques[:, k]))
        yield f"peak of {name}", f"{peak:.3g} " + ("N" if robot.prismatic[k] else "N m")
