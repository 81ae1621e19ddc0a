"""Dynamic singularities: where the least singular value of J* vanishes, and who says so."""

import warnings

import numpy as np
import pytest
from scipy.optimize import brentq

import ffsr_plan as fp
from ffsr_plan.core.rotations import IDENTITY
from ffsr_plan.dynamics.dynamic_singularity import slowest_place
from ffsr_plan.dynamics.momentum import generalized_jacobian
from ffsr_plan.meetings.arrival import Arrival
from ffsr_plan.published_numbers.air_bearing_robot import START, air_bearing_robot
from ffsr_plan.published_numbers.planar_manipulator import (
    determinant_by_formula,
    planar_manipulator,
)
from ffsr_plan.trajectory.flight_limits import FlightLimits

TIP = "end_effector"
FIRST = np.radians(-65.0)
SECOND = brentq(lambda second: determinant_by_formula(FIRST, second), -0.5, 0.0)


@pytest.fixture(scope="module")
def manipulator():
    return planar_manipulator().robot()


@pytest.fixture(scope="module")
def air_bearing():
    return air_bearing_robot().robot()


def at(robot, *values):
    return robot.assemble(np.zeros(3), IDENTITY, np.array(values))


def motion_through(robot, *corners):
    """A free-floating motion; corners of joint values."""
    values = np.array(corners)
    begin, end = at(robot, *values[0]), at(robot, *values[-1])
    positions = np.zeros((len(values), 3))
    return fp.Motion(robot, "free-floating", begin, end, positions, values)


def test_it_vanishes_where_the_determinant_does_in_closed_form(manipulator):
    there = fp.least_singular_value(
        manipulator, at(manipulator, FIRST, SECOND), TIP, attitude=False
    )
    assert there < 1e-9
    beside = at(manipulator, FIRST, SECOND + 0.1)
    assert fp.least_singular_value(manipulator, beside, TIP, attitude=False) > 1e-2
    assert abs(SECOND) > 0.15  # a base at rest is singular where the arm is straight
    straight = at(manipulator, FIRST, 0.0)
    assert fp.least_singular_value(manipulator, straight, TIP, attitude=False) > 1e-2


def test_it_is_the_least_speed_for_joint_rates_of_norm_one(manipulator):
    q = at(manipulator, 0.3, 0.9)
    angles = np.linspace(0.0, np.pi, 2001)
    rates = np.array([np.cos(angles), np.sin(angles)])
    speeds = np.linalg.norm(generalized_jacobian(manipulator, q, TIP)[:3] @ rates, axis=0)
    found = fp.least_singular_value(manipulator, q, TIP, attitude=False)
    assert found == pytest.approx(speeds.min(), rel=1e-5)


def test_it_does_not_depend_on_the_base_pose(air_bearing):
    q = at(air_bearing, *START)
    elsewhere = np.array(q)
    elsewhere[:7] = 3.0, -1.0, 2.0, *fp.load_robot("point").configuration(attitude=(1, 0.4, 2))[3:]
    found = fp.least_singular_value(air_bearing, elsewhere, "hand")
    assert found == pytest.approx(fp.least_singular_value(air_bearing, q, "hand"), rel=1e-9)


def test_directions_that_a_planar_robot_never_has_do_not_count(air_bearing, robot):
    jacobian = generalized_jacobian(air_bearing, at(air_bearing, *START), "hand")
    assert np.linalg.matrix_rank(jacobian) == 3
    assert fp.least_singular_value(air_bearing, at(air_bearing, *START), "hand") > 0.01
    bent = robot.configuration(joints={"left_1": 0.3, "left_2": 0.8, "left_3": 0.5})
    assert fp.least_singular_value(robot, bent, "left_3") > 1e-3  # six joints, three directions


def test_along_a_motion_the_singularity_is_found_where_it_is(manipulator):
    motion = motion_through(manipulator, (FIRST, SECOND - 0.4), (FIRST, SECOND + 0.4), (FIRST, 0.9))
    value, parameter = slowest_place(motion, TIP, False, 50)
    assert value < 1e-9
    assert parameter == pytest.approx(0.25)


def test_a_plan_has_it_along_its_motion():
    robot = planar_manipulator().robot()
    q = at(robot, FIRST, SECOND - 0.4)
    goal = at(robot, FIRST, SECOND + 0.4)
    problem = fp.Problem(robot, fp.Scene(), q, goal, mode="free-floating",
                         lattice=fp.Lattice(4))  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fp.GoalPoseIgnored)
        plan = fp.plan(problem, "lattice-optimum", refine=False)
    place = plan.least_singular_value(TIP, attitude=False)
    assert place.value < 1e-9
    assert place.parameter == pytest.approx(0.5)
    with pytest.raises(fp.InvalidInput, match="samples"):
        plan.least_singular_value(TIP, samples=0)


def test_what_has_no_generalized_jacobian_is_refused(manipulator, point):
    with pytest.raises(fp.InvalidInput, match="robot with joints"):
        fp.least_singular_value(point, point.neutral(), point.link_names[0])
    q = at(manipulator, FIRST, 0.3)
    motion = fp.Motion(manipulator, "free-flying", q, at(manipulator, FIRST, 0.5), np.zeros((2, 3)))
    with pytest.raises(fp.InvalidInput, match="free-floating"):
        slowest_place(motion, TIP, True, 3)


def tip_position(robot, q):
    import pinocchio as pin

    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return data.oMf[robot.model.getFrameId(TIP)].translation


def test_inverse_kinematics_warns_of_a_goal_near_a_singularity(manipulator):
    near, far = at(manipulator, FIRST, SECOND), at(manipulator, FIRST, 0.9)
    with pytest.warns(fp.NearDynamicSingularity, match="'end_effector'.*joint rates"):
        fp.inverse_kinematics(manipulator, None, TIP, tip_position(manipulator, near), start=near,
                              mode="free-floating")  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fp.inverse_kinematics(manipulator, None, TIP, tip_position(manipulator, far), start=far,
                              mode="free-floating")  # fmt: skip
        fp.inverse_kinematics(manipulator, None, TIP, tip_position(manipulator, near), start=near,
                              mode="attitude-held")  # fmt: skip


def test_a_meeting_warns_of_an_arrival_near_a_singularity(air_bearing):
    def planar(second):
        return np.linalg.det(
            generalized_jacobian(air_bearing, at(air_bearing, 0.8, second, 0.5), "hand")[[0, 1, 5]]
        )

    singular = brentq(planar, -1.0, 1.0)
    limits = FlightLimits(*3 * (np.full(5, 1.0),), np.full(3, np.inf), 0.0)
    begin = (0.1, 0.5, 0.5)

    def check(second):
        motion = motion_through(air_bearing, begin, (0.8, second, 0.5))
        arrival = Arrival(motion, fp.Meeting("hand", 10.0), fp.Scene())
        arrival.check(arrival.state(motion.joint_values[-1]), limits)

    with pytest.warns(fp.NearDynamicSingularity, match="'hand'"):
        check(singular)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check(singular + 0.5)
