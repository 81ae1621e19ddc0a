"""Why a pose is out of reach: too far or close, joint limits, attitude, reaction."""

import pickle

import numpy as np
import pytest

import ffsr_plan as fp
from tests.helpers.frame_poses import angles_of, pose_of
from tests.helpers.planar_arm import FORE, SHOULDER, UPPER, planar_arm


def failure(arm, place, attitude=None, mode="attitude-held", **options):
    with pytest.raises(fp.PoseOutOfReach) as caught:
        fp.inverse_kinematics(
            arm, None, "tool", place, attitude, start=arm.neutral(), mode=mode, **options
        )
    return caught.value


@pytest.mark.parametrize("mode", ["attitude-held", "free-flying", "free-floating"])
@pytest.mark.parametrize(
    ("ahead", "cause", "reach"),
    [(2.5, "too far", UPPER + FORE), (SHOULDER + 0.05, "too close", UPPER - FORE)],
)
def test_a_pose_too_far_or_too_close_is_measured_from_the_mount(mode, ahead, cause, reach):
    arm = planar_arm(1e4, elbow_limit=np.pi)
    error = failure(arm, (ahead, 0.0, 0.0), mode=mode)
    assert error.cause == cause
    assert error.arm.mount == "shoulder"
    assert error.arm.distance == pytest.approx(ahead - SHOULDER)
    assert error.arm.reach == pytest.approx(reach, abs=2e-3)
    assert f"it is {cause}" in str(error)
    assert "joint 'shoulder'" in str(error)
    words = "nearer to the pose by" if cause == "too far" else "farther from the pose by"
    assert words in error.advice[-1]


def test_the_distance_counts_from_where_the_base_is_to_be():
    arm = planar_arm(1e4)
    error = failure(
        arm, (4.0, 1.0, 0.0), base_position=(1.0, 1.0, 0.0), base_attitude=(np.pi, 0.0, 0.0)
    )
    assert error.arm.distance == pytest.approx(3.0 + SHOULDER)
    again = pickle.loads(pickle.dumps(error))
    assert (again.cause, again.arm, str(again)) == (error.cause, error.arm, str(error))


@pytest.mark.parametrize("mode", ["attitude-held", "free-flying"])
def test_a_joint_that_would_go_beyond_its_limit_is_named(mode):
    arm, bent = planar_arm(1e6, elbow_limit=1.0), 1.6
    wide = planar_arm(1e6)
    q = wide.configuration(joints={"shoulder": 0.3, "elbow": bent})
    error = failure(arm, pose_of(wide, q, "tool")[0], mode=mode)
    assert error.cause == "joint limits"
    (joint,) = error.beyond
    assert joint.joint == "elbow"
    assert abs(joint.value) == pytest.approx(bent, abs=1e-6)
    assert (joint.lower, joint.upper) == (-1.0, 1.0)
    assert "joint 'elbow' would be at" in str(error)
    assert any("'elbow'" in advice for advice in error.advice)


def test_an_attitude_that_takes_a_joint_beyond_its_limit_is_told_from_one_out_of_the_plane():
    arm = planar_arm(1e8, elbow_limit=1.0)
    wide = planar_arm(1e8)
    q = wide.configuration(joints={"shoulder": 0.3, "elbow": 0.5, "wrist": 0.2})
    place, rotation = pose_of(wide, q, "tool")
    out_of_plane = failure(arm, place, (0.2, 0.0, 0.3))
    assert out_of_plane.cause == "attitude"
    assert out_of_plane.without_attitude
    assert "its position is within reach" in str(out_of_plane)
    q = wide.configuration(joints={"shoulder": 0.3, "elbow": 1.5, "wrist": 0.2})
    place, rotation = pose_of(wide, q, "tool")
    assert failure(arm, place, angles_of(rotation)).cause == "joint limits"


@pytest.mark.parametrize("mode", ["free-flying", "free-floating"])
def test_a_pose_that_the_reaction_takes_away_is_said_to_be_that(mode):
    arm, angle = planar_arm(3.0), 1.8
    reach = UPPER + FORE - 0.01
    error = failure(arm, (SHOULDER + reach * np.cos(angle), reach * np.sin(angle), 0.0), mode=mode)
    assert error.cause == "base reaction"
    assert error.arm is None
    assert not error.beyond


def test_a_pose_out_of_the_plane_is_neither_too_far_nor_too_close():
    error = failure(planar_arm(1e8), (SHOULDER + 0.5, 0.5, 0.4))
    assert error.cause == "unknown"
    assert error.arm is None
    assert "too" not in str(error).split("what may help")[0].replace("tool", "")
