"""Flights of both kinds verify, and verification finds what is wrong with a flight."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.verification.flights.verify_flight import verify_flight
from tests.helpers.free_scenes import held_turn, scattered

LIMITS = {"joint_acceleration": 0.05, "thruster_acceleration": 0.01}
WHEELS = LIMITS | {"turn_acceleration": 1e-3}
JERKS = LIMITS | {"thruster_jerk": 0.01, "joint_jerk": 0.05}
REST, PULSES = {"corners": "rest"}, {"corners": "rest", "velocity_jump": 0.01}


class Forged:
    """A flight whose states or attributes are not its own."""

    def __init__(self, flight, states=None, **changes):
        self._flight, self._changed = flight, states
        self.__dict__ |= changes

    def __getattr__(self, name):
        return getattr(self._flight, name)

    def at(self, times):
        states = self._flight.at(times)
        return states if self._changed is None else self._changed(states, np.asarray(times))


def report_of(flight, clearance=0.0, states=None, **changes):
    return verify_flight(Forged(flight, states, **changes), clearance)


def complaints(report):
    assert not report.ok
    return " ".join(report.problems)


@pytest.fixture(scope="module")
def flight(fig2a_plan):
    return fig2a_plan.timed(**LIMITS, joint_torque=1.0)


@pytest.fixture(scope="module")
def plans(fig2a_plan):
    robot = fig2a_plan.problem.robot
    goal = robot.configuration(joints={"left_1": 0.9, "right_2": -0.8, "left_3": 0.5})
    floating = fp.Problem(robot, fp.Scene(), robot.neutral(), goal, mode="free-floating")
    return {
        "free-flying": fig2a_plan,
        "free-floating": fp.plan(floating, until="first"),
        "attitude-held": fp.plan(held_turn(scattered(robot, 3), 0.7), until="first"),
    }


@pytest.mark.parametrize("options", [{}, REST], ids=["smooth", "rest"])
@pytest.mark.parametrize("mode", ["free-flying", "attitude-held", "free-floating"])
def test_flights_of_all_modes_verify_with_room_to_spare(plans, mode, options):
    limits = {"free-flying": LIMITS, "attitude-held": WHEELS}.get(
        mode, {"joint_acceleration": 0.05}
    )
    report = plans[mode].timed(**limits, **options).verify()
    assert report.ok, report.problems
    assert report.attitude_error < 1e-6
    assert report.position_error < 1e-6
    errors = (report.velocity_error, report.thrust_error, report.wheel_error, report.torque_error)
    assert max(errors) < 1e-7
    assert max(report.limits.values()) <= 1.0 + 1e-9
    assert report.largest_gap == 0.0


@pytest.mark.parametrize("options", [PULSES, JERKS, JERKS | REST, {"duration": 423.0}])
def test_flights_with_pulses_jerk_limits_and_durations_verify(fig2a_plan, options):
    report = fig2a_plan.timed(**LIMITS | options).verify()
    assert report.ok, report.problems
    assert 0.9 < max(report.limits.values()) <= 1.0 + 1e-9


def test_a_smooth_flight_confirms_the_proven_clearance(flight):
    proven = flight.smooth_plan.certificate.least_clearance
    report = flight.verify()
    assert proven - 1e-6 <= report.clearance_bound <= report.least_clearance
    forged = report_of(flight, report.least_clearance + 1e-5)
    assert "the flight's proven clearance is" in complaints(forged)


def turned(states, times, angle):
    """The base rotated about z by an angle that grows to `angle` in mid-flight."""
    turn = np.zeros((len(times), 3))
    turn[:, 2] = angle * np.sin(np.pi * times / times.max()) if times.max() > 0.0 else 0.0
    q = np.array(states.configurations)
    q[:, 3:7] = rotations.multiply(q[:, 3:7], rotations.exp(turn))
    return states._replace(configurations=q)


def changed(states, times, name, change):
    return states._replace(**{name: change(getattr(states, name), times)})


def wave(times):
    return np.sin(0.5 * times)[:, None]


def scaled(factor):
    return lambda values, times: factor * values


def with_last(factor):
    def change(values, times):
        values = np.array(values)
        values[:, -1] *= factor
        return values

    return change


@pytest.mark.parametrize(
    ("name", "change", "complaint"),
    [
        ("thrust", scaled(-1.0), "thrust is not what the motion needs"),
        ("thrust", scaled(1.00001), "thrust is not what the motion needs"),
        ("torques", scaled(-1.0), "joint torques are not"),
        ("torques", scaled(1.00001), "joint torques are not"),
        ("accelerations", with_last(-1.0), "velocities are not the integrals of accelerations"),
        ("accelerations", with_last(1.001), "velocities are not the integrals of accelerations"),
        ("joints", lambda v, t: v + 1e-4 * wave(t), "joints are not where their rates lead"),
        ("velocities", with_last(1.001), "joints are not where their rates lead"),
    ],
)
def test_states_that_do_not_belong_together_are_noticed(flight, name, change, complaint):
    report = report_of(flight, 0.0, lambda s, t: changed(s, t, name, change))
    assert complaint in complaints(report)


def test_a_base_with_another_reaction_is_noticed(flight):
    report = report_of(flight, 0.0, lambda s, t: turned(s, t, 1e-4))
    assert "the base's attitude is not that of its joints' motion" in complaints(report)
    assert report.attitude_error > 5e-5


def test_a_base_elsewhere_is_noticed(plans):
    def shifted(states, times):
        q = np.array(states.configurations)
        q[:, :1] += 1e-4 * wave(times)
        return states._replace(configurations=q)

    for mode, limits in (("free-flying", LIMITS), ("free-floating", {"joint_acceleration": 0.05})):
        report = report_of(plans[mode].timed(**limits), np.inf, shifted)
        assert "the base is not where its motion leads" in complaints(report)


def test_configurations_with_other_joints_are_noticed(flight):
    def bent(states, times):
        q = np.array(states.configurations)
        q[:, -1:] += 1e-4 * wave(times)
        return states._replace(configurations=q)

    assert "joints are not where their rates lead" in complaints(report_of(flight, 0.0, bent))


def test_wheels_that_store_another_momentum_or_turn_otherwise_are_noticed(plans):
    flight = plans["attitude-held"].timed(**WHEELS)
    for name in ("wheel_torque", "wheel_momentum"):
        report = report_of(flight, 0.0, lambda s, t, name=name: changed(s, t, name, scaled(-1.0)))
        assert "the moment on the base is not" in complaints(report)


@pytest.mark.parametrize(
    ("field", "columns", "name"),
    [
        ("velocity", slice(2, None), "joint_velocity"),
        ("velocity", slice(0, 1), "base_velocity"),
        ("acceleration", slice(2, None), "joint_acceleration"),
        ("acceleration", slice(0, 1), "thruster_acceleration"),
        ("torque", slice(None), "joint_torque"),
        ("jerk", slice(2, None), "joint_jerk"),
        ("jerk", slice(0, 1), "thruster_jerk"),
    ],
)
def test_every_limit_is_looked_at(fig2a_plan, field, columns, name):
    given = JERKS | {"joint_torque": 1.0, "base_velocity": 1.0, "joint_velocity": 1.0}
    flight = fig2a_plan.timed(**given)
    share = flight.verify().limits[name]
    limit = np.array(getattr(flight.limits, field))
    limit[columns] *= share / 1.01
    report = report_of(flight, 0.0, limits=flight.limits._replace(**{field: limit}))
    assert f"{name} is 1.01 times its limit" in complaints(report)
    limit[columns] *= 1.02
    report = report_of(flight, 0.0, limits=flight.limits._replace(**{field: limit}))
    assert report.ok, report.problems


@pytest.mark.parametrize(("column", "name"), [("velocity", "turn_velocity"),
                                              ("acceleration", "turn_acceleration")])  # fmt: skip
def test_limits_of_wheels_are_looked_at(plans, column, name):
    flight = plans["attitude-held"].timed(**WHEELS, turn_velocity=0.1)
    limit = np.array(getattr(flight.limits, column))
    limit[1] *= 0.5 * flight.verify().limits[name]
    report = report_of(flight, 0.0, limits=flight.limits._replace(**{column: limit}))
    assert f"{name} is 2 times its limit" in complaints(report)


@pytest.mark.parametrize("options", [{}, REST], ids=["smooth", "rest"])
@pytest.mark.parametrize("share", [0.31, 0.5, 0.77])
def test_a_crumb_in_the_way_is_found(fig2a_plan, options, share):
    flight = fig2a_plan.timed(**LIMITS, **options)
    problem = flight.problem
    place = flight.at([share * flight.duration]).base_position
    scene = fp.Scene(
        np.vstack([problem.scene.centers, place]), np.append(problem.scene.radii, 1e-4)
    )
    report = report_of(flight, 0.0, problem=replace(problem, scene=scene))
    assert "an obstacle on piece" in complaints(report)


def test_pulses_that_are_not_those_of_the_corners_are_noticed(fig2a_plan):
    flight = fig2a_plan.timed(**LIMITS, **PULSES)
    assert len(flight.pulses)
    report = report_of(flight, 0.0, pulses=-flight.pulses)
    assert "velocities are not the integrals" in complaints(report)
    assert "pulses do not add up" in complaints(report)
    assert "pulses leave the path" in complaints(report_of(flight, 0.0, corner_cut=0.0))


def test_other_ends_and_another_delta_v_are_noticed(flight):
    far = flight.problem.goal + np.eye(len(flight.problem.goal))[0]
    report = report_of(flight, 0.0, problem=replace(flight.problem, goal=far))
    assert "the motion does not end at the goal" in complaints(report)
    report = report_of(flight, 0.0, delta_v=1.01 * flight.delta_v)
    assert "delta-v is not the integral" in complaints(report)


def test_a_report_says_what_it_did_not_check(flight):
    told = " ".join(flight.verify().not_checked)
    assert "no flight within the limits is shorter" in told
    assert "100 instants" in told


def test_meetings_verify_and_missed_ones_do_not():
    robot = fp.load_robot("planar_dual_arm")
    goal = robot.configuration((3.0, 0.3, 0.0), joints={"right_1": 0.3, "right_2": -0.6})
    lattice = fp.Lattice(12, fp.Axis(4, 0.1))
    problem = fp.Problem(robot, fp.Scene(), robot.neutral(), goal, lattice=lattice)
    meeting = fp.Meeting("right_link_3", at=120.0, velocity=(0.01, -0.004, 0.0))
    flight = fp.plan(problem, "lattice-optimum").timed(**LIMITS, meeting=meeting)
    report = flight.verify()
    assert report.ok, report.problems
    faster = replace(meeting, velocity=(0.011, -0.004, 0.0))
    assert "velocity misses" in complaints(report_of(flight, meeting=faster))
    later = replace(meeting, at=121.0)
    assert "arrives at" in complaints(report_of(flight, meeting=later))
    elsewhere = replace(meeting, position=(9.0, 0.0, 0.0))
    assert "position misses" in complaints(report_of(flight, meeting=elsewhere))
    at = flight.at([120.0]).configurations[0]
    angles = fp.load_robot("planar_dual_arm").components(at).attitude
    turned = replace(meeting, attitude=np.add(angles, [0.0, 0.0, 1.0]))
    assert "attitude misses" in complaints(report_of(flight, meeting=turned))
    assert "does not rest at both" in complaints(report_of(flight, meeting=None))


@pytest.mark.parametrize("options", [{}, REST], ids=["smooth", "rest"])
def test_a_base_that_mirrored_arms_do_not_turn_verifies(options):
    robot = fp.load_robot("planar_dual_arm")
    mirrored = {"left_1": 0.3, "right_1": -0.3, "left_2": -0.5, "right_2": 0.5}
    goal = robot.configuration((4.0, 0.0, 0.0), joints=mirrored)
    fields = {"lattice": fp.Lattice(6, fp.Axis(2, 0.4)), "delta": 0.1}
    problem = fp.Problem(robot, fp.Scene([[2.0, 1.9, 0.0]], [0.3]), robot.neutral(), goal, **fields)
    flight = fp.plan(problem, fp.LatticeOptimum()).timed(**LIMITS, **options)
    report = flight.verify()
    assert report.ok, report.problems
    turning = np.max(np.abs(flight.at([0.5 * flight.duration]).angular_velocity))
    assert turning < 1e-9
