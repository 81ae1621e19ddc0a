"""What holds of every flight that meets: pose, twist, time, momentum, limits, proof."""

import numpy as np
import pinocchio as pin
import pytest

from ffsr_plan.core import rotations
from tests.helpers.dense_flight import least_gap
from tests.helpers.meetings import (
    AT,
    FRAMES,
    LIMITS,
    frame_poses,
    meeting_for,
    momenta,
    plan_for,
    twist_of,
)
from tests.helpers.smooth_flights import instants, shares_in_use

CASES = [(name, mode) for name in FRAMES for mode in LIMITS]


@pytest.fixture(scope="module", params=CASES, ids="-".join)
def flight(request):
    name, mode = request.param
    return plan_for(name, mode).timed(meeting=meeting_for(name), **LIMITS[mode])


def test_the_frame_arrives_with_the_pose_of_the_plan(flight):
    plan, frame = flight.smooth_plan.plan, flight.meeting.frame
    last = flight.at([AT]).configurations
    both = np.vstack([plan.configurations[-1], last])
    wanted, reached = frame_poses(flight.robot, frame, both)
    assert np.linalg.norm(reached.translation - wanted.translation) < 1e-9
    assert np.linalg.norm(pin.log3(reached.rotation.T @ wanted.rotation)) < 1e-9


def test_the_frame_arrives_with_the_twist(flight):
    meeting = flight.meeting
    reached = twist_of(flight.robot, meeting.frame, flight.at([AT]))
    assert reached[:3] == pytest.approx(meeting.velocity, abs=1e-9)
    assert reached[3:] == pytest.approx(meeting.angular_velocity, abs=1e-9)


def test_the_twist_is_that_of_differences_of_poses(flight):
    step, meeting = 0.02, flight.meeting
    states = flight.at([AT - 2.0 * step, AT - step, AT])
    before, middle, last = frame_poses(flight.robot, meeting.frame, states.configurations)

    def change(quantity):
        return (4.0 * quantity(middle) - quantity(before)) / (-2.0 * step)

    velocity = change(lambda pose: pose.translation - last.translation)
    turn = change(lambda pose: pin.log3(pose.rotation @ last.rotation.T))
    assert velocity == pytest.approx(meeting.velocity, abs=1e-6)
    assert turn == pytest.approx(meeting.angular_velocity, abs=1e-6)


def test_it_starts_at_rest_and_arrives_on_time(flight):
    plan = flight.smooth_plan.plan
    assert abs(flight.duration - AT) < 1e-9
    first = flight.at([0.0])
    assert first.configurations[0] == pytest.approx(plan.configurations[0], abs=1e-12)
    assert np.max(np.abs(first.velocities)) < 1e-12


def test_momentum_is_conserved_all_the_way(flight):
    states = flight.at(np.linspace(0.0, AT, 200))
    found, scale = momenta(flight.robot, states), flight.robot.mass
    angular = found[:, 3:]
    if flight.mode.has_wheels:
        angular = angular + rotations.rotate(states.attitudes, states.wheel_momentum)
    assert np.max(np.abs(angular)) < 1e-10 * scale
    if flight.mode.floats:
        assert np.max(np.abs(found[:, :3])) < 1e-10 * scale


def test_configurations_move_as_velocities_say(flight):
    """The base reacts along the curve as its velocities have it, not only on arrival."""
    robot, step = flight.robot, 1e-3
    times = np.linspace(1.0, AT - 1.0, 40)
    before, after = (flight.at(times + sign * step).configurations for sign in (-0.5, 0.5))
    velocities = flight.at(times).velocities
    for q, moved, velocity in zip(before, after, velocities, strict=True):
        assert pin.difference(robot.model, q, moved) / step == pytest.approx(velocity, abs=1e-7)


def test_wheels_do_not_turn_the_base_on_arrival(flight):
    if flight.mode.has_wheels:
        plan, last = flight.smooth_plan.plan, flight.at([AT])
        assert last.angular_velocity == pytest.approx(np.zeros((1, 3)), abs=1e-15)
        goal = plan.configurations[-1, 3:7]
        assert rotations.angle_between(last.attitudes[0], goal) < 1e-9


def test_limits_hold_at_all_times(flight):
    shares = shares_in_use(flight, flight.limits, instants(flight, 20))
    for what, share in shares.items():
        assert share <= 1.0 + 1e-9, what


def test_no_flight_needs_less_delta_v_than_two_pulses(flight):
    states = flight.at([0.0, AT])
    data, mass = flight.robot.model.createData(), flight.robot.mass
    centers = [
        np.array(pin.centerOfMass(flight.robot.model, data, q)) for q in states.configurations
    ]
    mean = (centers[1] - centers[0]) / AT
    last = momenta(flight.robot, states)[1, :3] / mass
    pulses = np.linalg.norm(mean) + np.linalg.norm(last - mean)
    if flight.mode.floats:
        assert flight.delta_v == flight.straight_delta_v == 0.0
    else:
        assert flight.straight_delta_v == pytest.approx(pulses, rel=1e-9)
        assert flight.straight_delta_v < flight.delta_v < 4.0 * flight.straight_delta_v


def test_the_curve_is_proven_free_and_within_joint_limits(flight):
    smooth, robot = flight.smooth_plan, flight.robot
    assert smooth.kind == "meeting"
    path = smooth.at(np.linspace(0.0, 1.0, 2000))
    gap, touching = least_gap(smooth.plan, path)
    assert not touching
    assert 0.0 < smooth.certificate.least_clearance <= gap + 1e-9
    joints = np.array([robot.joint_values(q) for q in path])
    assert np.all(joints >= robot.lower - 1e-9)
    assert np.all(joints <= robot.upper + 1e-9)
    assert len(smooth.nodes) == smooth.plan.edges + 1
    assert np.all(np.diff(smooth.nodes) > 0.0)
