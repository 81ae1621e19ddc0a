"""Write the bundled satellites: a bus with a UR5, and a bus with two spatial arms.

Their buses, panels, mounts, shapes and postures are chosen here. Lengths, masses and inertias of
the UR5 are those of example-robot-data (`ur_description`); `compose` fits boxes around its meshes.

Usage: `python -m tools.make_satellites urdf`, which writes URDF and SRDF of both.
"""

from __future__ import annotations

import sys
from math import pi
from pathlib import Path
from xml.etree import ElementTree

from ffsr_plan.robots.robot import SpaceRobot
from ffsr_plan.robots.urdf.number_texts import attribute_text
from ffsr_plan.satellites.arms import Arm
from ffsr_plan.satellites.bus import Bus, Panel
from ffsr_plan.satellites.composition import Mount, compose, put_together
from ffsr_plan.satellites.urdf_xml import GOLD, NAVY, box_link

LIMB = 0.6
"""Length of a limb of the spatial arms [m]."""
WIDTH = 0.08
"""Width and depth of a limb [m]."""
LIMB_MASS, YOKE_MASS = 4.0, 0.5
"""Masses [kg]."""
TURNING = (
    {"left_1": 1.0, "right_1": -1.0},
    {"left_2": 1.0, "right_2": 1.0},
    {"left_3": 1.0, "right_3": 1.0},
)
"""Posture axes for `spatial_dual_arm`: about its posture `rest`, small joint loops in the planes of
pairs of these rotate the base about three axes."""


def satellite_ur5() -> SpaceRobot:
    """A bus of 1 x 1 x 1.2 m and 200 kg with two panels, and a UR5 on a pedestal on top of it.

    The panels extend sideways (y); with all joints at zero the arm points forward (x).
    """
    panels = [
        Panel((0.8, 2.0, 0.03), (0.0, sign * 1.65, 0.0), 12.0, name=f"{side}_panel")
        for side, sign in (("left", 1.0), ("right", -1.0))
    ]
    pedestal = Panel((0.16, 0.16, 0.1), (0.3, 0.0, 0.65), 3.0, name="pedestal")
    names = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
    postures = {
        "stowed": (0.0, -3.1, 0.0, -1.6, 0.0, 0.0),  # folded back over the bus
        "ready": (0.0, -1.2, 1.8, -0.6, 1.6, 0.0),
        "reach": (0.0, -0.3, 0.3, 0.0, 1.6, 0.0),  # stretched forward
    }
    return compose(
        Bus((1.0, 1.0, 1.2), 200.0, panels=[*panels, pedestal]),
        [Mount("ur5", (0.3, 0.0, 0.7), prefix="arm_")],
        "satellite_ur5",
        postures={
            posture: {f"arm_{name}_joint": v for name, v in zip(names, values, strict=True)}
            for posture, values in postures.items()
        },
    )


def spatial_dual_arm() -> SpaceRobot:
    """A cubic bus of 20 kg whose two arms, 8.5 kg each, can rotate it about every axis.

    Each arm has a shoulder that rotates about z and then y, and an elbow that rotates about y. With
    all joints at zero the arms point sideways, the left one to +y, the right one to -y. At the
    posture `rest`, the curvatures of the connection for the three pairs of the directions `TURNING`
    are linearly independent.
    """
    booms = [
        Panel((0.06, 0.07, 0.06), (0.0, sign * 0.285, 0.0), 0.5, name=f"{side}_boom")
        for side, sign in (("left", 1.0), ("right", -1.0))
    ]
    mounts = [
        Mount("limbs", (0.0, sign * 0.4, 0.0), (sign * pi / 2, 0.0, 0.0), prefix=f"{side}_")
        for side, sign in (("left", 1.0), ("right", -1.0))
    ]
    postures = {  # joints 1, 2, 3 of the left arm, then of the right
        "rest": (1.2, 0.2, -1.4, 1.2, -0.2, 1.4),  # small joint loops rotate the bus most
        "stowed": (1.3, 2.7, 2.3, -1.3, 2.7, 2.3),
        "reach": (0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    }
    names = [f"{side}_{k}" for side in ("left", "right") for k in (1, 2, 3)]
    return put_together(
        Bus((0.5, 0.5, 0.5), 20.0, panels=booms),
        [(_limbs(), mount) for mount in mounts],
        "spatial_dual_arm",
        "boxes",
        {posture: dict(zip(names, v, strict=True)) for posture, v in postures.items()},
        (),
    )


def _limbs() -> Arm:
    """An arm of yoke, upper arm and forearm, the limbs along their x axes."""
    robot = ElementTree.Element("robot", name="limbs")
    middle = (LIMB / 2, 0.0, 0.0)
    ElementTree.SubElement(robot, "link", name="mount")
    robot.append(box_link("yoke", (0.1, 0.1, 0.1), YOKE_MASS, NAVY))
    for name in ("upper", "fore"):
        robot.append(box_link(name, (LIMB, WIDTH, WIDTH), LIMB_MASS, GOLD, middle))
    chain = (
        ("mount", "yoke", "0 0 0", "0 0 1"),
        ("yoke", "upper", "0 0 0", "0 1 0"),
        ("upper", "fore", f"{LIMB} 0 0", "0 1 0"),
    )
    for k, (parent, child, place, axis) in enumerate(chain, 1):
        joint = ElementTree.SubElement(robot, "joint", name=str(k), type="revolute")
        ElementTree.SubElement(joint, "origin", xyz=place, rpy="0 0 0")
        ElementTree.SubElement(joint, "parent", link=parent)
        ElementTree.SubElement(joint, "child", link=child)
        ElementTree.SubElement(joint, "axis", xyz=axis)
        limits = {
            "lower": attribute_text(-2.8),
            "upper": attribute_text(2.8),
            "effort": "50",
            "velocity": "0.5",
        }
        ElementTree.SubElement(joint, "limit", limits)
    return Arm(robot, "mount", (), "limbs", ())


def write(folder: Path) -> None:
    """Write URDF and SRDF files of both satellites.

    Args:
        folder: an existing folder; files of the same names are replaced.
    """
    for made in (satellite_ur5(), spatial_dual_arm()):
        made.save(folder / f"{made.name}.urdf")


if __name__ == "__main__":
    write(Path(sys.argv[1]))
