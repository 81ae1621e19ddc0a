"""`Plan.timed`: smooth flights by default, rests and pulses where asked for."""

import numpy as np
import pytest

import ffsr_plan as fp

LIMITS = {"joint_acceleration": 0.05, "thruster_acceleration": 0.01}


@pytest.fixture(scope="module")
def flight(fig2a_plan):
    return fig2a_plan.timed(**LIMITS)


def test_a_plan_is_flown_along_its_smooth_curve_by_default(fig2a_plan, flight):
    assert isinstance(flight, fp.SmoothFlight)
    ends = flight.at([0.0, flight.duration])
    assert np.allclose(ends.configurations, fig2a_plan.configurations[[0, -1]], atol=1e-9)
    rests = fig2a_plan.timed(corners="rest", **LIMITS)
    assert isinstance(rests, fp.TimedPlan)
    assert flight.duration < 0.5 * rests.duration
    assert flight.delta_v < 0.5 * rests.delta_v


def test_at_the_time_that_rests_take_a_smooth_flight_needs_a_fifth_of_the_delta_v(fig2a_plan):
    rests = fig2a_plan.timed(corners="rest", **LIMITS)
    calm = fig2a_plan.timed(duration=rests.duration, **LIMITS)
    assert calm.duration == pytest.approx(rests.duration, rel=1e-12)
    assert calm.delta_v < 0.2 * rests.delta_v


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"corners": "smoth"}, "corners.*did you mean 'smooth'"),
        ({"corners": "rest", "duration": 100.0}, "duration.*None with corners='rest'"),
        ({"velocity_jump": 0.02}, "velocity_jump.*corners='rest'"),
        ({"duration": 10.0}, "duration.*the fastest flight within these limits"),
        ({"duration": -1.0}, "duration.*greater than 0"),
        ({"turn_velocity": 0.1}, "turn_velocity.*no wheels"),
    ],
)
def test_arguments_that_do_not_go_together_are_refused(fig2a_plan, given, message):
    with pytest.raises(fp.InvalidInput, match=message):
        fig2a_plan.timed(**LIMITS, **given)


def test_thrusters_of_a_floating_robot_cannot_be_limited(robot):
    goal = robot.configuration(joints={"left_1": 0.4, "right_2": -0.3})
    problem = fp.Problem(robot, fp.Scene(), robot.neutral(), goal, mode="free-floating")
    plan = fp.plan(problem, until="first")
    assert plan.timed(joint_acceleration=0.05).delta_v == 0.0
    with pytest.raises(fp.InvalidInput, match=r"thruster_acceleration.*no thrusters"):
        plan.timed(**LIMITS)


def test_a_smooth_plan_can_be_flown_itself(fig2a_plan, flight):
    smooth = fig2a_plan.smooth()
    again = smooth.timed(**LIMITS)
    assert again.smooth_plan is smooth
    assert again.duration == flight.duration
    with pytest.raises(fp.InvalidInput, match=r"corners.*none to rest at"):
        smooth.timed(corners="rest", **LIMITS)
    with pytest.raises(fp.InvalidInput, match=r"velocity_jump.*corners='rest'"):
        smooth.timed(velocity_jump=0.1, **LIMITS)


def test_a_curve_of_least_fuel_flies_with_the_delta_v_that_it_promises(fig2a_plan):
    curve = fig2a_plan.least_fuel(margin=0.02)
    flight = curve.timed(duration=400.0, **LIMITS)
    assert flight.smooth_plan.kind == "least fuel"
    assert flight.delta_v == pytest.approx(curve.delta_v(400.0), rel=0.02)
    assert flight.delta_v < 0.5 * fig2a_plan.timed(duration=400.0, **LIMITS).delta_v
    assert flight.verify().ok


def test_no_flight_needs_less_than_the_straight_line(fig2a_plan, flight):
    rests = fig2a_plan.timed(corners="rest", **LIMITS)
    calm = fig2a_plan.timed(duration=rests.duration, **LIMITS)
    assert rests.straight_delta_v == pytest.approx(calm.straight_delta_v, rel=1e-9)
    assert rests.straight_delta_v < calm.delta_v < rests.delta_v
    assert flight.straight_delta_v < flight.delta_v
