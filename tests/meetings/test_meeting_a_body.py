"""A frame meets a body that moves: its twist, and who may touch it."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from tests.helpers.meetings import frame_poses, twist_of

LIMITS = {"joint_acceleration": 0.05, "thruster_acceleration": 0.01}
TOOL, PLACE = ("arm_ee_link", "arm_wrist_3_link"), (-0.3, 0.0, -0.61)
MEETING = fp.Meeting("arm_tool0", 120.0, target="target", position=PLACE, links=TOOL)


@pytest.fixture(scope="module")
def plan():
    return fp.plan(fp.load_scenario("capture"))


@pytest.fixture(scope="module")
def flight(plan):
    return plan.timed(**LIMITS, meeting=MEETING)


def target_of(flight):
    return flight.problem.scene.bodies[0]


def complaints(flight, **changes):
    """What a verification says of the flight with another meeting."""
    report = replace(flight, meeting=replace(MEETING, **changes)).verify()
    assert not report.ok
    return " ".join(report.problems)


def test_the_frame_takes_part_in_the_motion_of_the_body(flight):
    target, (pose,) = (
        target_of(flight),
        frame_poses(flight.robot, MEETING.frame, flight.at([MEETING.at]).configurations),
    )
    assert pose.translation == pytest.approx(target.point(PLACE, MEETING.at), abs=1e-8)
    step = 0.01
    reached = twist_of(flight.robot, MEETING.frame, flight.at([MEETING.at]))
    for own in (PLACE, (0.4, 0.1, -0.2)):
        early, late = (target.point(own, MEETING.at + each) for each in (-step, step))
        place = target.point(own, MEETING.at)
        carried = reached[:3] + np.cross(reached[3:], place - pose.translation)
        assert carried == pytest.approx((late - early) / (2.0 * step), abs=1e-6)


def test_only_the_named_links_touch_and_only_at_the_end(flight):
    report = flight.verify()
    assert report.ok, report.problems
    assert any("distances of arm_ee_link, arm_wrist_3_link" in each for each in report.not_checked)
    assert 0.0 < flight.least_clearance <= report.least_clearance + 1e-9
    robot, scene = flight.robot, flight.problem.scene
    times = np.linspace(100.0, MEETING.at, 201)
    states, target = flight.at(times), target_of(flight)
    touched = []
    poses = frame_poses(robot, MEETING.frame, states.configurations)
    for time, q, pose in zip(times, states.configurations, poses, strict=True):
        apart = np.linalg.norm(pose.translation - target.point(PLACE, time))
        touched.append(fp.clearance(robot, scene.at(time), q) <= 0.0)
        assert not touched[-1] or apart <= MEETING.within
    assert touched[-1]


@pytest.mark.parametrize("changes", [{"links": ()}, {"links": TOOL[1:]}, {"within": 1e-3}])
def test_another_contact_is_noticed(flight, changes):
    assert "link 'arm_ee_link' is" in complaints(flight, **changes)


def test_another_twist_or_place_is_noticed(flight):
    assert "angular velocity misses" in complaints(flight, angular_velocity=(0.0, 0.0, 1e-6))
    assert "position misses" in complaints(flight, position=(-0.3, 0.0, -0.611))


def test_contact_by_a_link_that_is_not_named_is_refused(plan):
    deep = replace(MEETING, position=(-0.3, 0.0, -0.60), links=TOOL[:1])
    with pytest.raises(fp.UnprovenCurve, match=r"'arm_\w+' .* moving body 'target' at 1\d\d"):
        plan.timed(**LIMITS, meeting=deep)


def test_what_cannot_be_met_is_refused(plan):
    for changes, match in (
        ({"target": "hubble"}, r"meeting.target: got 'hubble'; allowed: .*'target'"),
        ({"links": ("claw",)}, "meeting.links: got 'claw'; allowed: .*arm_ee_link"),
    ):
        with pytest.raises(fp.InvalidInput, match=match):
            plan.timed(**LIMITS, meeting=replace(MEETING, **changes))
    with pytest.raises(fp.InvalidInput, match=r"links: .*none without a target"):
        fp.Meeting("arm_tool0", 120.0, links=TOOL)
    with pytest.raises(fp.InvalidInput, match=r"links: .*a list of names"):
        fp.Meeting("arm_tool0", 120.0, target="target", links="arm_ee_link")
