"""Locked and mimicking joints of arms on a bus."""

import numpy as np
import pinocchio as pin
import pytest

import ffsr_plan as fp
from tests.helpers.urdf_builders import (
    inertial,
    joint,
    link,
    urdf,
)

BUS = fp.Bus(
    (1.0, 0.8, 1.2),
    150.0,
    inertia=(20.0, 25.0, 30.0),
    center_of_mass=(0.02, -0.01, 0.05),
    panels=[fp.Panel((0.7, 2.0, 0.02), (0.0, 1.5, 0.1), 9.0, (0.3, -0.2, 0.1))],
)


def close(found, wanted, tolerance=1e-9):
    np.testing.assert_allclose(found, wanted, rtol=0.0, atol=tolerance)


def with_finger(**mimic):
    """An arm of a hinge, a slider that may be locked, and one that follows it."""
    heavy = inertial(1.0, (0.1, 0.1, 0.1))
    told = "".join(f" {key}='{value}'" for key, value in mimic.items())
    follower = joint("follower", "prismatic", "b", "d", (0, -0.1, 0), axis=(0, -1, 0), limit=0.2)
    return urdf(
        *(link(name, heavy) for name in "abcd"),
        joint("hinge", "continuous", "a", "b", (0, 0, 1), (0.3, np.pi / 2, 0.2)),
        joint("slider", "prismatic", "b", "c", (0, 0.1, 0), (1.0, 0.5, 0.2), (0, 1, 0), limit=0.2),
        follower.replace("</joint>", f"<mimic{told}/></joint>" if mimic else "</joint>"),
    )


def test_a_locked_joint_fixes_the_joints_that_mimic_it(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(with_finger(joint="slider", multiplier=-0.5, offset=0.03))
    locked = {"slider": 0.1, "hinge": 0.7}
    robot = fp.compose(fp.Bus((1, 1, 1), 10.0), [fp.Mount(path, prefix="p_", locked=locked)])
    assert robot.nd == 0
    path.write_text(with_finger())
    free = fp.load_robot(path)
    data = free.model.createData()
    values = locked | {"follower": -0.5 * 0.1 + 0.03}
    pin.framesForwardKinematics(free.model, data, free.configuration(joints=values))
    for name in "abcd":
        place = robot.model.frames[robot.model.getBodyId(f"p_{name}")].placement
        close(place.homogeneous, data.oMf[free.model.getBodyId(name)].homogeneous, 1e-12)


@pytest.mark.parametrize(
    ("mimic", "locked", "message"),
    [
        ({"joint": "slider"}, {}, "joint 'follower', mimic: got 'slider'; .*locked={'slider'"),
        ({"joint": "sliders"}, {}, "mimic joint: got 'sliders'; .*did you mean 'slider'"),
        ({"joint": "slider", "offset": "far"}, {"slider": 0}, "mimic offset: got 'far'"),
        ({}, {"hunge": 0.1}, "locked: got 'hunge'; .*did you mean 'hinge'"),
        ({}, {"slider": 0.21}, "locked 'slider': got 0.21; .*at most 0.2"),
        ({}, {"slider": np.nan}, "locked.slider of a mount: got nan"),
        ({}, {"hinge": "up"}, "locked.hinge of a mount: got 'up'"),
    ],
)
def test_joints_that_cannot_be_locked_or_followed_are_named(tmp_path, mimic, locked, message):
    path = tmp_path / "arm.urdf"
    path.write_text(with_finger(**mimic))
    with pytest.raises(fp.InvalidInput, match=message):
        fp.compose(fp.Bus((1, 1, 1), 10.0), [fp.Mount(path, locked=locked)])


def test_the_pandas_fingers_have_to_be_locked():
    with pytest.raises(fp.InvalidInput, match=r"lock it with locked=\{'panda_finger_joint1'"):
        fp.compose(BUS, [fp.Mount("panda")])
