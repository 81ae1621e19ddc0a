"""Laws of Pinocchio's models of a URDF."""

import pytest

from ffsr_plan.core.errors import InvalidInput
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers import urdf_builders


def test_joints_beyond_memory_are_refused_before_any_data_is_made():
    names = [f"link_{k}" for k in range(260)]
    links = [
        urdf_builders.link(name, urdf_builders.inertial(1.0, (1.0, 1.0, 1.0))) for name in names
    ]
    joints = [
        urdf_builders.joint(f"joint_{k}", "revolute", names[0], names[k], (0.1, 0.0, 0.0))
        for k in range(1, len(names))
    ]
    text = urdf_builders.urdf(*links, *joints)
    with pytest.raises(
        InvalidInput, match=r"cube of degrees of freedom 18609625: 2\.38 GB; .*locked"
    ):
        robot_from_urdf(text, "many")
