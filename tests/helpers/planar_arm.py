"""A satellite with an arm of two links in a plane, whose reach has a closed form."""

from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.urdf_builders import box, inertial, joint, link, sphere, urdf

UPPER, FORE, SHOULDER = 0.7, 0.5, 0.3


def planar_arm(base_mass, elbow_limit=3.0):
    """Two links in the world's xy-plane, shoulder `SHOULDER` ahead of the base's centre."""
    rod = (0.001, 0.02, 0.02)
    return robot_from_urdf(
        urdf(
            link("base", inertial(base_mass, (base_mass / 6.0,) * 3), box((0.3, 0.3, 0.3))),
            link("upper", inertial(2.0, rod, (UPPER / 2, 0, 0)), sphere(0.03, (UPPER / 2, 0, 0))),
            link("fore", inertial(1.0, rod, (FORE / 2, 0, 0)), sphere(0.03, (FORE / 2, 0, 0))),
            link("tool", inertial(0.1, (0.001,) * 3), sphere(0.02)),
            joint("shoulder", "revolute", "base", "upper", (SHOULDER, 0, 0)),
            joint("elbow", "revolute", "upper", "fore", (UPPER, 0, 0), limit=elbow_limit),
            joint("wrist", "revolute", "fore", "tool", (FORE, 0, 0)),
        ),
        "planar_arm",
    )  # fmt: skip
