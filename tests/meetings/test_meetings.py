"""Meetings that are asked for and those that cannot be: what errors name, and what helps."""

import numpy as np
import pinocchio as pin
import pytest

import ffsr_plan as fp
from ffsr_plan.core.rotations import from_angles, matrix
from tests.helpers.meetings import AT, LIMITS, frame_poses, meeting_for, plan_for, twist_of
from tests.helpers.smooth_flights import limits_of

NAME, MODE = "planar_dual_arm", "free-flying"


@pytest.fixture(scope="module")
def plan():
    return plan_for(NAME, MODE)


def test_another_pose_than_the_plans_is_met(plan):
    frame, robot = "right_link_3", plan.problem.robot
    (old,) = frame_poses(robot, frame, plan.configurations[-1:])
    position = old.translation + np.array([0.1, -0.2, 0.0])
    angles = (0.3 + np.arctan2(old.rotation[1, 0], old.rotation[0, 0]), 0.0, 0.0)
    wanted = meeting_for(NAME, position=position, attitude=angles)
    flight = plan.timed(meeting=wanted, **LIMITS[MODE])
    (reached,) = frame_poses(robot, frame, flight.at([AT]).configurations)
    assert np.linalg.norm(reached.translation - position) < 1e-9
    assert np.linalg.norm(pin.log3(reached.rotation.T @ matrix(from_angles(angles)))) < 1e-9


def test_a_target_at_rest_is_met_at_rest(plan):
    flight = plan.timed(meeting=fp.Meeting("right_link_3", 120.0), **LIMITS[MODE])
    last = flight.at([120.0])
    assert np.max(np.abs(last.velocities)) < 1e-12
    assert flight.duration == 120.0


def test_meetings_are_flown_the_same_every_time(plan):
    times = np.linspace(0.0, AT, 50)
    one, other = (plan.timed(meeting=meeting_for(NAME), **LIMITS[MODE]) for _ in range(2))
    assert one.at(times) == other.at(times)
    assert one.delta_v == other.delta_v


def test_where_obstacles_are_close_a_meeting_is_proven_too(fig2a_plan):
    wanted = fp.Meeting("right_link_3", 300.0, (0.02, -0.02, 0.0), (0.0, 0.0, 0.03))
    flight = fig2a_plan.timed(meeting=wanted, **LIMITS[MODE])
    assert flight.smooth_plan.certificate.least_clearance > 0.0
    reached = twist_of(flight.robot, "right_link_3", flight.at([300.0]))
    assert reached == pytest.approx([0.02, -0.02, 0.0, 0.0, 0.0, 0.03], abs=1e-9)


def test_too_early_a_meeting_names_a_time_that_is_possible(plan):
    with pytest.raises(fp.InvalidInput, match=r"meeting.at: got 10.0; allowed: at least") as caught:
        plan.timed(meeting=meeting_for(NAME, at=10.0), **LIMITS[MODE])
    least = float(caught.value.allowed.split()[2])
    assert plan.timed(meeting=meeting_for(NAME, at=least), **LIMITS[MODE]).duration == least
    with pytest.raises(fp.InvalidInput, match=r"meeting.at.*at least"):
        plan.timed(meeting=meeting_for(NAME, at=0.95 * least), **LIMITS[MODE])


def test_a_twist_that_a_planar_robot_cannot_have_is_refused(plan):
    tilted = meeting_for(NAME, angular_velocity=(0.01, 0.0, 0.0))
    with pytest.raises(fp.InvalidInput, match=r"meeting.angular_velocity.*in the mode free-flying"):
        plan.timed(meeting=tilted, **LIMITS[MODE])


def test_a_floating_robot_cannot_move_its_frame_out_of_its_plane():
    mode = "free-floating"
    with pytest.raises(fp.InvalidInput, match=r"meeting.velocity, .*in the mode free-floating"):
        plan_for(NAME, mode).timed(
            meeting=meeting_for(NAME, velocity=(0.0, 0.0, 0.01)), **LIMITS[mode]
        )


def test_a_twist_beyond_the_joints_or_the_thrusters_is_refused(plan):
    fast = meeting_for(NAME, angular_velocity=(0.0, 0.0, 0.1))
    with pytest.raises(fp.InvalidInput, match=r"angular_velocity.*of it at most: joint .* need"):
        plan.timed(meeting=fast, joint_velocity=0.01, **LIMITS[MODE])
    quick = meeting_for(NAME, velocity=(0.5, 0.0, 0.0))
    with pytest.raises(fp.InvalidInput, match=r"meeting.velocity.*the base moves at 0.2 m/s"):
        plan.timed(meeting=quick, base_velocity=0.2, **LIMITS[MODE])


def test_a_pose_far_from_the_plans_end_is_refused():
    mode = "free-floating"
    far = meeting_for(NAME, position=(30.0, 0.0, 0.0))
    with pytest.raises(fp.InvalidInput, match=r"meeting.position.*problem.reaching"):
        plan_for(NAME, mode).timed(meeting=far, **LIMITS[mode])


def test_a_curve_into_an_obstacle_is_not_flown(plan):
    """The frame's wanted place is inside the obstacle."""
    inside = meeting_for(NAME, position=plan.problem.scene.centers[0])
    with pytest.raises(fp.UnprovenCurve, match="edge 8 of 8"):
        plan.timed(meeting=inside, **LIMITS[MODE])


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"corners": "rest"}, "corners.*'smooth' with a meeting"),
        ({"duration": 100.0}, "duration.*None with a meeting"),
        ({"joint_jerk": 0.1}, "joint_jerk.*no limit on jerk with a meeting"),
        ({"thruster_jerk": 0.1}, "thruster_jerk.*no limit on jerk with a meeting"),
        ({"velocity_jump": 0.1}, "velocity_jump.*0 with a meeting"),
        ({"meeting": "tool"}, "meeting.*a Meeting or None"),
        ({"meeting": fp.Meeting("right_link", AT)}, "frame.*did you mean"),
    ],
)
def test_arguments_that_do_not_go_with_a_meeting_are_refused(plan, given, message):
    with pytest.raises(fp.InvalidInput, match=message):
        plan.timed(**{"meeting": meeting_for(NAME), **LIMITS[MODE], **given})


def test_without_a_needed_limit_a_meeting_is_refused(plan):
    with pytest.raises(fp.InvalidInput, match="thruster_acceleration"):
        plan.timed(meeting=meeting_for(NAME), joint_acceleration=0.05)


def test_limits_of_a_meeting_are_those_of_other_flights(plan):
    flight = plan.timed(meeting=meeting_for(NAME), **LIMITS[MODE])
    expected = limits_of(flight.curve, **LIMITS[MODE])
    for got, wanted in zip(flight.limits, expected, strict=True):
        assert np.array_equal(got, wanted)


def test_joints_that_would_leave_their_limits_on_the_way_are_named(plan):
    """The later the meeting, the longer the joints turn at its rates before it."""
    late = meeting_for(NAME, at=1e5)
    with pytest.raises(fp.InvalidInput, match=r"joint \w+ on the way.*all along the curve"):
        plan.timed(meeting=late, **LIMITS[MODE])


def test_far_too_late_a_meeting_is_refused(plan):
    late = meeting_for(NAME, at=1e8)
    with pytest.raises(fp.InvalidInput, match=r"arrive before 1e\+08 s"):
        plan.timed(meeting=late, **LIMITS[MODE])
