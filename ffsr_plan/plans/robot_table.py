"""The table of a robot in a plan file."""

from __future__ import annotations

from typing import Any

from ffsr_plan.robots.robot import SpaceRobot


def robot_table(robot: SpaceRobot) -> dict[str, Any]:
    """Everything that a robot was made from, meshes included, and what it made of its shapes.

    Args:
        robot: the robot.
    """
    return {
        "name": robot.name,
        "urdf": robot.urdf,
        "package_dirs": list(robot.package_dirs),
        "srdf": robot.srdf,
        "disabled_pairs": [list(pair) for pair in robot.disabled_pairs],
        "containers": robot.containers._asdict(),
        "meshes": {address: corners.tolist() for address, corners in robot.meshes.items()},
        "replacements": [
            {"link": r.link, "number": r.number, "shape": r.shape, "by": r.by, "excess": r.excess}
            for r in robot.replacements
        ],
    }
