"""MuJoCo flies timed plans: the base goes where they say, by the forces that they state."""

from functools import lru_cache

import numpy as np
import pytest

import ffsr_plan as fp
from benchmarks.studies.general.families import loaded
from ffsr_plan.core import rotations
from tests.helpers.dense_flight import least_gap
from tests.helpers.free_scenes import held_turn, scattered
from tests.trajectory.test_timed_mujoco import inverse_dynamics

pytest.importorskip("mujoco", minversion="4")

from tests.helpers import mujoco_flight as engine

AGREEMENT = 1e-5  # [rad] and [m]
FORCES = 1e-6  # of their peaks
STEPS = {"free-flying": 0.005, "attitude-held": 0.01, "free-floating": 0.005}
"""Of the engine [s]: accelerations jump between the steps of the law."""
RECORDED = 0.2  # [s]
LIMITS = {
    "free-flying": {"joint_acceleration": 0.3, "thruster_acceleration": 0.05},
    "attitude-held": {
        "joint_acceleration": 0.3,
        "thruster_acceleration": 0.05,
        "turn_acceleration": 0.05,
    },
    "free-floating": {"joint_acceleration": 0.05},
}


def course_of(flight):
    """The course of a timed plan."""

    @lru_cache(maxsize=4)  # the engine asks twice at the middle of a step, and at both its ends
    def course(t):
        states = flight.at([min(t, flight.duration)])
        return engine.Course(
            (states.base_position[0], states.base_velocity[0], states.base_acceleration[0]),
            (states.attitudes[0], states.angular_velocity[0], states.accelerations[0, 3:6]),
            (states.joints[0], states.joint_velocities[0], states.joint_accelerations[0]),
        )

    return course


def problem_in(mode):
    robot = loaded("planar_dual_arm")
    if mode == "attitude-held":
        return held_turn(scattered(robot, 21, mode), 0.5)
    if mode == "free-floating":
        return fp.load_scenario("spatial_turn")
    return scattered(robot, 11)


@lru_cache
def flown_in(mode):
    """A plan and its flight."""
    problem = problem_in(mode)
    plan = fp.plan(problem, seed=0, **({} if problem.lattice is not None else {"until": "first"}))
    return plan, plan.timed(**LIMITS[mode])


@pytest.mark.parametrize("mode", LIMITS)
def test_mujoco_flies_smooth_flights(mode):
    plan, flight = flown_in(mode)
    step, course = STEPS[mode], course_of(flight)
    every = round(RECORDED / step)
    flown = engine.fly(plan.problem.robot, mode, course, flight.duration, step, every)
    states = flight.at(np.minimum(flown.times, flight.duration))
    turned = rotations.angle_between(flown.attitudes, states.attitudes)
    assert turned.max() < AGREEMENT
    assert np.linalg.norm(flown.positions - states.base_position, axis=1).max() < AGREEMENT
    assert np.abs(flown.joints - states.joints).max() < AGREEMENT
    assert rotations.angle_between(flown.attitudes[0], flown.attitudes).max() > 0.02
    robot = plan.problem.robot
    least, touching = least_gap(
        plan, robot.assemble(flown.positions, flown.attitudes, flown.joints)
    )
    assert not touching
    assert least >= flight.smooth_plan.certificate.least_clearance - AGREEMENT


@pytest.mark.parametrize("mode", LIMITS)
def test_the_engine_needs_the_forces_that_a_smooth_flight_states(mode):
    plan, flight = flown_in(mode)
    ends = flight.switch_times
    states = flight.at(0.5 * (ends[1:] + ends[:-1])[::3])
    force, moment, torques = inverse_dynamics(plan.problem.robot, states)
    peak = np.abs(states.torques).max()
    assert np.abs(torques - states.torques).max() < FORCES * peak
    assert np.abs(moment - states.wheel_torque).max() < FORCES * peak
    assert np.abs(force - states.thrust).max() < FORCES * max(np.abs(states.thrust).max(), peak)
