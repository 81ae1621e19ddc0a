"""Flights that begin in motion, such as from a target that the robot lets go."""

import re
from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.dynamics.momentum import connection
from tests.helpers.meetings import AT, LIMITS, frame_poses, meeting_for, plan_for

TIGHT = {"joint_acceleration": 0.05, "thruster_acceleration": 0.01}
TOOL, PLACE = ("arm_ee_link", "arm_wrist_3_link"), (-0.3, 0.0, -0.61)
MEETING = fp.Meeting("arm_tool0", 120.0, target="target", position=PLACE, links=TOOL)


@pytest.fixture(scope="module")
def capture():
    approach = fp.plan(fp.load_scenario("capture"))
    return approach, approach.timed(**TIGHT, meeting=MEETING)


@pytest.fixture(scope="module")
def retreat(capture):
    approach, flight = capture
    away = replace(
        approach.problem,
        scene=approach.problem.scene.later(flight.duration),
        start=approach.configurations[-1],
        goal=approach.problem.start,
        duration=150.0,
    )
    return fp.plan(away)


@pytest.fixture(scope="module")
def departing(capture, retreat):
    return retreat.timed(**TIGHT, departure=fp.Departure.from_flight(capture[1]))


def complaints(flight, **changes):
    """What a verification says of the flight with another departure."""
    report = replace(flight, departure=replace(flight.departure, **changes)).verify()
    assert not report.ok
    return " ".join(report.problems)


def test_a_departure_begins_where_the_capture_ended(capture, departing):
    last, first = capture[1].at([MEETING.at]), departing.at([0.0])
    assert first.configurations == pytest.approx(last.configurations, abs=1e-9)
    assert first.velocities == pytest.approx(last.velocities, abs=1e-9)
    assert departing.duration == departing.problem.duration
    end = departing.at([departing.duration])
    assert np.max(np.abs(end.velocities)) < 1e-9
    assert end.base_position[0] == pytest.approx(departing.problem.goal[:3], abs=1e-9)
    report = departing.verify()
    assert report.ok, report.problems
    assert any("which they may touch, in the first" in each for each in report.not_checked)


def test_only_the_named_links_touch_and_only_at_the_begin(departing):
    robot, scene = departing.robot, departing.problem.scene
    times = np.linspace(0.0, 30.0, 301)
    states, target = departing.at(times), scene.bodies[0]
    touched = []
    poses = frame_poses(robot, MEETING.frame, states.configurations)
    for time, q, pose in zip(times, states.configurations, poses, strict=True):
        apart = np.linalg.norm(pose.translation - target.point(PLACE, time))
        touched.append(fp.clearance(robot, scene.at(time), q) <= 0.0)
        assert not touched[-1] or apart <= MEETING.within
    assert touched[0]
    assert not touched[-1]
    assert departing.least_clearance > 0.0


@pytest.mark.parametrize("changes", [{"links": ()}, {"links": TOOL[1:]}, {"within": 1e-3}])
def test_another_contact_is_noticed(departing, changes):
    assert re.search(
        r"link 'arm_(ee|wrist_3)_link' is .* inside moving body", complaints(departing, **changes)
    )


def test_another_first_state_is_noticed(departing):
    velocity = departing.departure.velocity + 1e-6
    assert "first velocity misses" in complaints(departing, velocity=velocity)
    joints = departing.departure.configuration + np.append(np.zeros(12), 1e-6)
    assert "first configuration misses" in complaints(departing, configuration=joints)


def test_contact_by_a_link_that_is_not_named_is_refused(departing, retreat):
    few = replace(departing.departure, links=TOOL[1:])
    with pytest.raises(fp.UnprovenCurve, match=r"'arm_ee_link' .* moving body 'target'"):
        retreat.timed(**TIGHT, departure=few)
    with pytest.raises(fp.InvalidInput, match=r"departure.target: got 'hubble'"):
        retreat.timed(**TIGHT, departure=replace(departing.departure, target="hubble"))


@pytest.mark.parametrize("mode", ["free-flying", "attitude-held", "free-floating"])
def test_a_robot_departs_from_where_it_met_a_frame(mode):
    plan = plan_for("planar_dual_arm", mode)
    met = plan.timed(meeting=meeting_for("planar_dual_arm"), **LIMITS[mode])
    departure = fp.Departure.from_flight(met)
    back = replace(plan.problem, start=plan.configurations[-1], goal=plan.problem.start)
    how = {"until": "first"} if mode == "free-floating" else {"planner": "lattice-optimum"}
    flight = fp.plan(back, **how).timed(departure=departure, duration=2.0 * AT, **LIMITS[mode])
    assert flight.at([0.0]).velocities[0] == pytest.approx(departure.velocity, abs=1e-9)
    assert np.max(np.abs(flight.at([2.0 * AT]).velocities)) < 1e-9
    report = flight.verify()
    assert report.ok, report.problems


@pytest.fixture(scope="module")
def plan():
    return plan_for("planar_dual_arm", "free-flying")


@pytest.fixture(scope="module")
def moving(plan):
    """A state at the start in which a joint turns, and the base as momentum lets it."""
    robot, q = plan.problem.robot, plan.problem.start
    rates = np.zeros(robot.nd)
    rates[0] = 0.02
    return fp.Departure(q, np.concatenate([np.zeros(3), connection(robot, q) @ rates, rates]))


def test_a_base_that_rotates_against_momentum_is_refused(plan, moving):
    still = moving.velocity * np.append(
        np.ones(3), [*np.zeros(3), *np.ones(len(moving.velocity) - 6)]
    )
    with pytest.raises(fp.InvalidInput, match=r"departure.velocity: .*conserve angular momentum"):
        plan.timed(departure=fp.Departure(moving.configuration, still), duration=AT,
                   **LIMITS["free-flying"])  # fmt: skip
    with pytest.raises(fp.InvalidInput, match=r"departure.velocity: .*numbers"):
        plan.timed(departure=fp.Departure(moving.configuration, still[:-1]), duration=AT,
                   **LIMITS["free-flying"])  # fmt: skip


def test_too_short_a_flight_names_a_time_that_is_possible(plan, moving):
    limits = LIMITS["free-flying"]
    with pytest.raises(fp.InvalidInput, match=r"duration: got 5.0; allowed: at least") as caught:
        plan.timed(departure=moving, duration=5.0, **limits)
    least = float(caught.value.allowed.split()[2])
    assert plan.timed(departure=moving, duration=1.001 * least, **limits).verify().ok


@pytest.mark.parametrize(
    ("given", "match"),
    [
        ({}, "duration: got None; allowed: a time"),
        ({"duration": AT, "corners": "rest"}, "corners: .*'smooth' with a departure"),
        ({"duration": AT, "joint_jerk": 1.0}, "no limit on jerk with a departure"),
        ({"duration": AT, "joint_velocity": 0.01}, "departure.velocity: .*at most 0.01"),
        ({"duration": AT, "meeting": fp.Meeting("left_3", AT)}, "departure: .*None with a meeting"),
    ],
)
def test_what_does_not_go_with_a_departure_is_refused(plan, moving, given, match):
    with pytest.raises(fp.InvalidInput, match=match):
        plan.timed(departure=moving, **{**LIMITS["free-flying"], **given})


def test_links_need_a_target_and_a_frame():
    for given in ({"links": TOOL}, {"links": TOOL, "target": "it"}, {"links": TOOL, "frame": "f"}):
        with pytest.raises(fp.InvalidInput, match=r"links: .*none without a (target|frame)"):
            fp.Departure([0.0], [0.0], **given)
