"""Continuous joints that go beyond half a turn per layer: one motion from proof to file.

The robot is a disc with a rod that a continuous joint at its centre turns. The base then turns
back by a fixed share of what the joint turns, so that the whole motion is known in closed form
from the stored joint values.
"""

import csv

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.display.plan_page import frames_per_edge
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.urdf_builders import capsule, inertial, joint, link, sphere, urdf

HUB, ROD, MIDDLE = 5.0, 2.0, 0.6  # [kg], [kg], [m] from the joint to the rod's middle
HUB_INERTIA, ROD_INERTIA = 0.5, 0.1  # about z [kg m^2]
BASE_RADIUS, RADIUS, LENGTH = 0.15, 0.04, 0.7
SHARE = (
    ROD_INERTIA + (around := HUB * ROD / (HUB + ROD) * MIDDLE**2)
) / (HUB_INERTIA + ROD_INERTIA + around)  # fmt: skip
POSTURES = "<robot name='made'>{}</robot>".format(
    "".join(
        f"<group_state name='at_{v}' group='all'><joint name='spin' value='{v}'/></group_state>"
        for v in (4, 9, 100)
    )
)


@pytest.fixture(scope="module")
def spinner():
    rod = capsule(RADIUS, LENGTH, (MIDDLE, 0, 0), (0, np.pi / 2, 0))
    return robot_from_urdf(
        urdf(
            link("hub", inertial(HUB, (0.3, 0.3, HUB_INERTIA)), sphere(BASE_RADIUS)),
            link("rod", inertial(ROD, (0.01, 0.1, ROD_INERTIA), (MIDDLE, 0, 0)), rod),
            joint("spin", "continuous", "hub", "rod", (0, 0, 0)),
        ),
        "spinner",
        srdf=POSTURES,
    )


def axis(spacing):
    return fp.PostureAxis({"spin": 1.0}, 1, spacing)


def planned(robot, posture, ends, obstacle):
    start, goal = (
        robot.configuration(place, joints={"spin": value})
        for place, value in zip(((0, 0, 0), (3, 0, 0)), ends, strict=True)
    )
    lattice = fp.Lattice(6, postures=[posture])
    return fp.plan(fp.Problem(robot, fp.Scene(*obstacle), start, goal, lattice=lattice), seed=1)


def turned(plan):
    """Whether a joint goes more than half a turn on an edge."""
    return np.max(np.abs(np.diff(plan.motion.joint_values, axis=0))) > np.pi


def by_hand(plan, s):
    """Base origins (N, 3), yaws (N,) and joint values (N,) from the stored corners alone."""
    corners = np.linspace(0.0, 1.0, len(plan.motion.joint_values))
    joints = np.interp(s, corners, plan.motion.joint_values[:, 0])
    places = [np.interp(s, corners, plan.motion.positions[:, k]) for k in range(3)]
    return np.stack(places, axis=1), -SHARE * (joints - joints[0]), joints


def least_distance(plan, count=60_001):
    """Distance of hub and rod to the obstacles, densely, with no code of the project's."""
    places, yaws, joints = by_hand(plan, np.linspace(0.0, 1.0, count))
    heading = np.stack([np.cos(yaws + joints), np.sin(yaws + joints), 0.0 * yaws], axis=1)
    least = np.inf
    for center, radius in zip(plan.problem.scene.centers, plan.problem.scene.radii, strict=True):
        away = center - places
        hub = np.linalg.norm(away, axis=1) - BASE_RADIUS
        near, far = MIDDLE - LENGTH / 2, MIDDLE + LENGTH / 2
        along = np.clip(np.sum(away * heading, axis=1), near, far)
        rod = np.linalg.norm(away - along[:, None] * heading, axis=1) - RADIUS
        least = min(least, float(np.min(np.minimum(hub, rod))) - radius)
    return least


BEFORE, BEHIND = (3.0, 2.5), (-3.0, -2.5)
CASES = [
    (axis(3.2), BEFORE, ([[1.26, 0.5, 0.0]], [0.27])),
    (axis(4.0), BEFORE, ([[1.28, 0.5, 0.0]], [0.25])),
    (axis(6.4), BEFORE, ([[1.52, 0.49, 0.0]], [0.17])),
    (fp.PostureAxis.towards("at_4", 1), BEHIND, ([[1.82, -0.63, 0.0]], [0.29])),
    (fp.PostureAxis.towards("at_9", 2), BEHIND, ([[1.75, -0.52, 0.0]], [0.28])),
    (fp.PostureAxis.towards("at_100", 9), BEHIND, ([[1.46, -0.51, 0.0]], [0.18])),
]


@pytest.mark.parametrize(("posture", "ends", "obstacle"), CASES)
def test_what_is_proven_is_what_is_returned(spinner, posture, ends, obstacle, tmp_path):
    plan = planned(spinner, posture, ends, obstacle)
    proven, measured = plan.certificate.least_clearance, least_distance(plan)
    assert turned(plan)
    assert 0.9 * measured <= proven <= measured + 1e-9
    s = np.linspace(0.0, 1.0, 2001)
    q = plan.at(s)
    places, yaws, joints = by_hand(plan, s)
    assert np.allclose(q[:, :3], places, atol=1e-12)
    assert np.allclose(q[:, 7], np.cos(joints), atol=1e-12)
    assert np.allclose(q[:, 8], np.sin(joints), atol=1e-12)
    half = 0.5 * yaws
    expected = np.stack([0 * half, 0 * half, np.sin(half), np.cos(half)], axis=1)
    assert np.allclose(np.abs(np.sum(q[:, 3:7] * expected, axis=1)), 1.0, atol=1e-12)
    report = plan.verify(500)
    assert report.ok, report.problems
    plan.save(tmp_path / "plan.json")
    loaded = fp.Plan.load(tmp_path / "plan.json")
    assert loaded == plan
    assert np.array_equal(loaded.at(s), q)
    assert np.array_equal(loaded.motion.joint_values, plan.motion.joint_values)


def test_tables_and_flights_follow_the_unwrapped_joint(spinner, tmp_path):
    plan = planned(spinner, *CASES[2])
    plan.to_csv(tmp_path / "path.csv", samples=301)
    with (tmp_path / "path.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    column = np.array([float(row["spin position [rad]"]) for row in rows])
    assert np.allclose(column, by_hand(plan, np.linspace(0.0, 1.0, 301))[2], atol=1e-12)
    flight = plan.timed(corners="rest", joint_acceleration=0.5, thruster_acceleration=0.1)
    states = flight.at(np.linspace(0.0, flight.duration, 301))
    assert np.allclose(states.joints[:, 0], by_hand(plan, states.parameters)[2], atol=1e-9)
    assert np.max(np.abs(np.diff(states.joints[:, 0]))) < 1.0


def test_the_length_counts_every_turn(spinner):
    plan = planned(spinner, *CASES[-1])
    steps = np.diff(plan.motion.joint_values[:, 0])
    straight = np.diff(plan.lattice.nominal.joint_values[:, 0])
    squares = 0.5**2 + straight**2 + (steps - straight) ** 2
    assert plan.length == pytest.approx(np.sum(np.sqrt(squares)), rel=1e-12)
    assert plan.length > 20.0


def test_pages_show_frames_between_which_no_joint_goes_half_a_turn(spinner, tmp_path):
    plan = planned(spinner, *CASES[-1])
    steps = np.abs(np.diff(plan.motion.joint_values, axis=0))
    assert steps.max() / frames_per_edge(plan) < 1.0
    plan.write_html(tmp_path / "plan.html")
