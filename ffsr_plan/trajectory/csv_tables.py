"""Tables of paths and trajectories as comma-separated values.

There is one header line with a unit in every column's name. Numbers are written with all digits:
reading them returns the same floating-point numbers.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ffsr_plan.bodies.pace import Pace
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import Array
from ffsr_plan.core.text_files import write_text
from ffsr_plan.dynamics.inverse_dynamics import States
from ffsr_plan.dynamics.motion import Motion
from ffsr_plan.robots.robot import SpaceRobot

BYTES_PER_CELL = 100
"""Memory [bytes] of a number while a table is worked out and written."""
Table = dict[str, Array]
"""Columns (N,), by header."""


def path_table(motion: Motion, parameters: Array, pace: Pace | None = None) -> Table:
    """Base pose and joints along a path.

    Args:
        motion: the motion.
        parameters: (N,) path parameters in [0, 1].
        pace: at which it is run, for a column of times; None without one.

    Returns:
        The columns.
    """
    scaled = parameters * motion.edges
    edge = np.minimum(scaled.astype(np.int64), motion.edges - 1)
    q, joints = motion.at(edge, scaled - edge), motion.joints_at(edge, scaled - edge)
    times = {} if pace is None else {"t [s]": pace.instants(scaled)}
    return {**times, "s [1]": parameters, **_pose(motion.robot, q, joints)}


def trajectory_table(robot: SpaceRobot, times: Array, states: States) -> Table:
    """All states of a flight.

    Linear base velocity and acceleration are in world axes, unlike in `States`.

    Args:
        robot: the robot, for the names of the joints.
        times: (N,) times [s].
        states: the states at these times.

    Returns:
        The columns.
    """
    v, a = states.velocities, states.accelerations
    table = {"t [s]": times, "s [1]": states.parameters}
    table |= _pose(robot, states.configurations, states.joints)
    table |= _vector("base_v{} (world axes) [m/s]", states.base_velocity)
    table |= _vector("base_w{} (base axes) [rad/s]", v[:, 3:6])
    table |= _per_joint(robot, "velocity", ("rad/s", "m/s"), v[:, 6:])
    table |= _vector("base_a{} (world axes) [m/s^2]", states.base_acceleration)
    table |= _vector("base_dw{} (base axes) [rad/s^2]", a[:, 3:6])
    table |= _per_joint(robot, "acceleration", ("rad/s^2", "m/s^2"), a[:, 6:])
    table |= _vector("thrust_{} (world axes) [N]", states.thrust)
    table |= _vector("wheel_torque_{} (base axes) [N m]", states.wheel_torque)
    table |= _vector("wheel_momentum_{} (base axes) [N m s]", states.wheel_momentum)
    table |= _per_joint(robot, "torque", ("N m", "N"), states.torques)
    return table


def write_csv(path: Path, table: Table) -> None:
    """Write a table; an existing file is replaced.

    Args:
        path: of the file.
        table: the columns.

    Raises:
        InvalidInput: a file that cannot be written.
    """
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(table)
    writer.writerows(np.column_stack(list(table.values())).tolist())
    write_text("table", path, text.getvalue())


def _pose(robot: SpaceRobot, q: Array, joints: Array) -> Table:
    table = _vector("base_{} [m]", q[:, :3])
    table |= {f"base_q{axis} [1]": q[:, 3 + k] for k, axis in enumerate("xyzw")}
    angles = rotations.to_angles(q[:, 3:7])
    table |= {f"{name} [rad]": angles[:, k] for k, name in enumerate(("alpha", "beta", "gamma"))}
    return table | _per_joint(robot, "position", ("rad", "m"), joints)


def _vector(header: str, values: Array) -> Table:
    return {header.format(axis): values[:, k] for k, axis in enumerate("xyz")}


def _per_joint(robot: SpaceRobot, quantity: str, units: tuple[str, str], values: Array) -> Table:
    """One column for each joint; `units` are those of a revolute and of a prismatic joint."""

    def columns() -> Iterator[tuple[str, Array]]:
        for k, name in enumerate(robot.joint_names):
            slides = bool(robot.prismatic[k])
            what = "force" if slides and quantity == "torque" else quantity
            yield f"{name} {what} [{units[slides]}]", values[:, k]

    return dict(columns())
