"""Flights verify, and flights that are not what they state do not."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.verification.flights.verify_flight import verify_flight

LIMITS = {"joint_acceleration": 0.05, "thruster_acceleration": 0.01}


class Altered:
    """A flight whose states, limits or problem are changed."""

    def __init__(self, flight, states=None, **others):
        self._flight, self._states, self._others = flight, states, others

    def __getattr__(self, name):
        return self._others[name] if name in self._others else getattr(self._flight, name)

    def at(self, times):
        states = self._flight.at(times)
        return states if self._states is None else self._states(states, np.asarray(times))


@pytest.fixture(scope="module")
def flight(fig2a_plan):
    return fig2a_plan.timed(**LIMITS)


def problems(flight, states=None, **others):
    report = verify_flight(Altered(flight, states, **others), 200)
    assert report.ok == (not report.problems)
    return "; ".join(report.problems)


def arm_plan(mode, scene=None):
    """A way with bent joints past a ball, on a lattice with a posture axis in all modes."""
    robot = fp.load_robot("planar_dual_arm")
    goal = robot.configuration(
        (0.0 if mode == "free-floating" else 2.0, 0.0, 0.0),
        (0.0, 0.0, 0.3 if mode == "attitude-held" else 0.0),
        joints={"left_1": 0.6},
    )
    return fp.plan(
        fp.Problem(robot, scene or fp.Scene([], []), robot.configuration(), goal, mode=mode), seed=0
    )


@pytest.mark.parametrize("corners", ["smooth", "rest"])
@pytest.mark.parametrize("mode", ["free-flying", "attitude-held", "free-floating"])
def test_flights_in_all_modes_verify(mode, corners):
    limits = {"joint_acceleration": 0.05}
    if mode != "free-floating":
        limits["thruster_acceleration"] = 0.01
    if mode == "attitude-held":
        limits["turn_acceleration"] = 0.01
    report = arm_plan(mode).timed(corners=corners, **limits).verify()
    assert report.problems == ()
    assert report.position_error < 1e-7
    assert report.attitude_error < 1e-7
    assert max(report.thrust_error, report.torque_error) < 1e-6
    assert 0.97 < max(report.limits.values()) <= 1.0 + 1e-6


def test_a_flight_with_pulses_verifies(fig2a_plan):
    flight = fig2a_plan.timed(corners="rest", velocity_jump=0.04, **LIMITS)
    assert len(flight.pulses) > 0
    report = flight.verify()
    assert report.ok
    assert any("pulse" in each for each in report.not_checked)
    assert "from where its thrust moves it" in problems(flight, pulses=0.9 * flight.pulses)
    assert "pulses displace it" in problems(flight, corner_cut=1.0)


def test_the_least_clearance_is_that_of_the_proof(fig2a_plan, flight):
    report, proven = flight.verify(), flight.smooth_plan.certificate.least_clearance
    assert proven <= report.least_clearance < proven + 0.01


def test_an_attitude_that_does_not_react_is_noticed(flight):
    def still(states, _):
        q = states.configurations.copy()
        q[:, 3:7] = flight.problem.start[3:7]
        v = states.velocities.copy()
        v[:, 3:6] = 0.0
        return states._replace(configurations=q, velocities=v)

    assert "rad from that of momentum conservation" in problems(flight, still)


def test_a_reaction_about_the_other_side_is_noticed(flight):
    def mirrored(states, _):
        q = states.configurations.copy()
        q[:, 3:7] = rotations.inverse(q[:, 3:7])
        return states._replace(configurations=q)

    assert "rad from that of momentum conservation" in problems(flight, mirrored)


def test_wrong_thrust_and_torques_are_noticed(flight):
    def scaled(states, _):
        return states._replace(thrust=states.thrust * (1.0 + 1e-5))

    assert "another thrust" in problems(flight, scaled)

    def heavy(states, _):
        return states._replace(torques=states.torques * (1.0 + 1e-5))

    assert "another torques" in problems(flight, heavy)

    def wheeled(states, _):
        return states._replace(wheel_torque=states.wheel_torque + 1e-4)

    assert "another torques" in problems(flight, wheeled)


def test_wheels_that_store_another_momentum_are_noticed():
    flight = arm_plan("attitude-held").timed(turn_acceleration=0.01, **LIMITS)

    def reversed_(states, _):
        return states._replace(wheel_momentum=-states.wheel_momentum)

    assert "another wheel momentum" in problems(flight, reversed_)


def test_joints_that_go_elsewhere_than_their_velocities_are_noticed(flight):
    def slower(states, _):
        v = states.velocities.copy()
        v[:, 6:] *= 0.999
        return states._replace(velocities=v)

    assert "from the integral of their velocities" in problems(flight, slower)


@pytest.mark.parametrize(
    ("row", "column", "name"),
    [
        ("velocity", 0, "base_velocity"),
        ("acceleration", 0, "thruster_acceleration"),
        ("jerk", 0, "thruster_jerk"),
        ("velocity", 2, "joint_velocity"),
        ("acceleration", 2, "joint_acceleration"),
        ("torque", 0, "joint_torque"),
    ],
)
def test_each_limit_that_is_exceeded_is_named(flight, row, column, name):
    values = getattr(flight.limits, row).copy()
    values[column] = 1e-7
    assert f"{name} is exceeded" in problems(flight, limits=flight.limits._replace(**{row: values}))


def test_limits_of_wheels_and_of_joint_values_are_looked_at():
    flight = arm_plan("attitude-held").timed(turn_acceleration=0.01, **LIMITS)
    for row in ("velocity", "acceleration"):
        values = getattr(flight.limits, row).copy()
        values[1] = 1e-7
        assert f"turn_{row} is exceeded" in problems(
            flight, limits=flight.limits._replace(**{row: values})
        )

    def beyond(states, _):
        return states._replace(joints=states.joints + 9.0)

    assert "joint limits is exceeded" in problems(flight, beyond)


def test_an_obstacle_in_the_way_is_named(flight):
    middle = flight.at([0.5 * flight.duration]).base_position[0]
    scene = fp.Scene(
        np.vstack([flight.problem.scene.centers, middle]), [*flight.problem.scene.radii, 0.1]
    )
    other = replace(flight.problem, scene=scene)
    assert "an obstacle at" in problems(flight, problem=other)


def test_between_two_samples_a_contact_is_looked_for(flight):
    quarter = flight.at([0.25 * flight.duration]).base_position[0]
    thin = replace(flight.problem, scene=fp.Scene([quarter], [1e-3]))
    report = verify_flight(Altered(flight, problem=thin), 2)
    assert "an obstacle at" in "; ".join(report.problems)
    assert report.samples > 3


def test_links_that_touch_are_named(flight):
    def folded(states, times):
        joints = states.joints.copy()
        share = np.sin(np.pi * times / flight.duration)[:, None]
        joints[:] += share * np.array([1.5, 1.5, 1.5, -1.5, -1.5, -1.5])
        q = flight.robot.assemble(states.base_position, states.attitudes, joints)
        return states._replace(configurations=q, joints=joints)

    assert "two links touch" in problems(flight, folded)


def test_start_goal_and_rest_are_looked_at(flight):
    robot, problem = flight.problem.robot, flight.problem
    elsewhere = robot.configuration((10.0, 0.5, 0.0))
    found = problems(flight, problem=replace(problem, goal=elsewhere))
    assert "does not end at the goal" in found
    found = problems(flight, problem=replace(problem, start=robot.configuration((0.0, 0.1, 0.0))))
    assert "does not begin at the start" in found
    assert "does not rest at the end" in problems(flight, duration=0.9 * flight.duration)


def test_a_goal_attitude_that_is_missed_is_named(flight):
    goal = flight.problem.goal.copy()
    problem = replace(flight.problem)
    assert "attitude is missed" not in problems(flight)
    demanded = Altered(problem, reach_attitude=True, goal=goal)
    assert "attitude is missed" in problems(flight, problem=demanded)


def test_samples_that_cannot_be_are_refused(flight):
    with pytest.raises(fp.InvalidInput, match="samples"):
        flight.verify(0)
