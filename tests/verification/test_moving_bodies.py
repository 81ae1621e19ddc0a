"""Plans verified among bodies that move."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.bodies.body_motion import Drift, Spin
from ffsr_plan.bodies.moving_body import MovingBody
from ffsr_plan.bodies.pose_function import PoseFunction
from ffsr_plan.bodies.tumble import Tumble
from ffsr_plan.cli.printed_tables import report_rows
from ffsr_plan.core.errors import InvalidInput
from tests.helpers.moving_scenes import (
    DURATION,
    KINDS,
    MILLISECOND,
    body_of,
    clearances_by_hand,
    problem_past,
    share_run,
)
from tests.helpers.sample_sizes import sample

TIMES = np.linspace(0.0, DURATION, round(DURATION / MILLISECOND) + 1)


def planned(problem):
    return fp.plan(problem, fp.LatticeOptimum())


def among(plan, *bodies, **fields):
    """The plan among other bodies, or at another pace; what it claims of its clearance is zero."""
    problem = replace(plan.problem, scene=fp.Scene(bodies=bodies), **fields)
    certificate = plan.certificate._replace(least_clearance=0.0)
    return replace(plan, problem=problem, certificate=certificate)


def hits(report):
    """What a report says of obstacles in the way."""
    return [each for each in report.problems if "on edge" in each]


def place_at(plan, time):
    """The base origin at a time."""
    return plan.at(float(share_run(plan.problem, [time])[0]))[:3]


@pytest.fixture(scope="module")
def straight():
    """A way of 20 m in 20 s, whose only body stays far away."""
    away = MovingBody([fp.Ball(0.1)], Drift(), (0.0, 50.0, 0.0))
    return planned(problem_past(away, length=20.0))


@pytest.mark.parametrize("ramp", [0.0, 0.3])
@pytest.mark.parametrize("kind", KINDS)
def test_a_plan_past_a_body_verifies(kind, ramp):
    plan = planned(problem_past(body_of(kind), ramp=ramp))
    report = plan.verify()
    assert report.ok, report.problems
    assert report.nearest_body == f"moving body '{plan.problem.scene.bodies[0].name}'"
    assert 0.0 < report.clearance_bound <= report.least_clearance < 2.0
    assert report.clearance_error < 1e-8
    rows = dict(report_rows(report))
    assert rows["  nearest obstacle"].startswith(report.nearest_body)


@pytest.mark.parametrize("seed", range(sample(4, 10)))
def test_what_is_measured_is_what_a_thousand_looks_a_second_see(seed):
    bodies = [body_of(KINDS[seed % 5], seed), body_of(KINDS[(seed + 2) % 5], seed + 50)]
    plan = planned(problem_past(*bodies, seed=seed, ramp=(0.0, 0.25, 0.5)[seed % 3]))
    report, seen = plan.verify(), clearances_by_hand(plan, TIMES)
    assert report.ok, report.problems
    least, step = float(seen.min()), float(np.abs(np.diff(seen)).max())
    assert report.clearance_bound - 1e-9 <= least
    assert least - step <= report.least_clearance <= least + 0.5 * report.largest_step + step
    then = round(report.nearest_time / MILLISECOND)
    assert seen[then] == pytest.approx(report.least_clearance, abs=step + 1e-9)
    nodes = np.interp(np.arange(7) / 6, share_run(plan.problem, TIMES), TIMES)
    assert plan.clearances == pytest.approx(np.interp(nodes, TIMES, seen), abs=step)


@pytest.mark.parametrize("ramp", [0.0, 0.3])
@pytest.mark.parametrize("kind", ["drift", "spin", "function"])
def test_a_body_put_across_the_way_touches_when_it_is_there(straight, kind, ramp):
    at, velocity = 7.3, np.array([0.3, 1.5, 0.0])
    place = place_at(among(straight, *straight.problem.scene.bodies, ramp=ramp), at)
    begin = place - at * velocity
    motion = {
        "drift": Drift(velocity),
        "spin": Spin((0.0, 0.3, 2.0), velocity),
        "function": PoseFunction(
            lambda time: (begin + time * velocity, (0.0, 0.0, 0.0, 1.0)), 1.531
        ),
    }[kind]
    where = {} if kind == "function" else {"position": begin}
    intruder = MovingBody([fp.Ball(0.2)], motion, name="intruder", **where)
    plan = among(straight, intruder, ramp=ramp)
    report, seen = plan.verify(), clearances_by_hand(plan, TIMES)
    assert report.nearest_body == "moving body 'intruder'"
    assert any("inside moving body 'intruder' on edge" in each for each in hits(report))
    assert any(f"at {report.nearest_time:.6g} s" in each for each in hits(report))
    touched = TIMES[seen <= 0.0]
    assert touched[0] < report.nearest_time < touched[-1]
    assert report.nearest_time == pytest.approx(at, abs=0.3)
    share = share_run(plan.problem, [report.nearest_time])[0]
    assert f"on edge {int(share * plan.edges)} " in hits(report)[0]
    if kind != "function":
        late = MovingBody([fp.Ball(0.2)], motion, begin - 10.0 * velocity)
        assert not hits(among(straight, late, ramp=ramp).verify())


def test_at_another_duration_the_body_is_in_the_way(straight):
    crossing = MovingBody([fp.Ball(0.2)], Drift((0.0, 1.0, 0.0)), (10.0, -15.0, 0.0))
    assert not hits(among(straight, crossing).verify())  # there at 15 s, the robot at 10 s
    report = among(straight, crossing, duration=30.0).verify()
    assert hits(report)
    assert report.nearest_time == pytest.approx(15.0, abs=0.6)
    assert any("node clearances differ" in each for each in report.problems)


def test_at_another_ramp_the_body_is_in_the_way(straight):
    crossing = MovingBody([fp.Ball(0.2)], Drift((0.0, 1.0, 0.0)), (5.0, -np.sqrt(50.0), 0.0))
    assert not hits(among(straight, crossing).verify())
    report = among(straight, crossing, ramp=0.5).verify()  # 5 m of 20 m are run after 20 s / sqrt 8
    assert hits(report)
    assert report.nearest_time == pytest.approx(np.sqrt(50.0), abs=0.6)


@pytest.mark.parametrize("kind", KINDS)
def test_growth_of_bodies_is_taken_from_their_distance(kind):
    plan = planned(problem_past(body_of(kind)))
    away, bodies = plan.verify().least_clearance, plan.problem.scene.bodies
    near = among(plan, *bodies, min_clearance=away - 0.01).verify()
    assert not hits(near)
    assert near.least_clearance == pytest.approx(0.01, abs=1e-3)
    assert hits(among(plan, *bodies, min_clearance=away + 0.01).verify())


@pytest.mark.parametrize("samples", [1, 50])
@pytest.mark.parametrize("speed", [3.0, 300.0])
def test_a_body_that_is_gone_before_the_next_sample_is_found(straight, speed, samples):
    at, way = 9.137, np.array([0.1, 1.0, 0.0])
    bullet = MovingBody(
        [fp.Ball(0.01)], Drift(speed * way), place_at(straight, at) - at * speed * way
    )
    report = among(straight, bullet).verify(samples)
    assert any("moving body (bodies.0)" in each for each in hits(report))
    assert any(f" at {at:.2g}" in each for each in hits(report))
    beside = MovingBody(bullet.shapes, bullet.motion, bullet.position + np.array([0.0, 0.0, 3.0]))
    missed = among(straight, beside).verify(samples)
    assert not hits(missed)
    assert missed.least_clearance > 2.0


def test_a_panel_without_thickness_may_touch_between_two_samples():
    point = fp.load_robot("point")
    panel = MovingBody([fp.Box((0.0, 0.3, 0.3))], Drift((-1.3, 0.0, 0.0)), (8.0, 0.0, 0.0))
    away = MovingBody(panel.shapes, panel.motion, (8.0, 5.0, 0.0))
    ends = {"start": point.configuration(), "goal": point.configuration((10.0, 0.0, 0.0))}
    scene, lattice = fp.Scene(bodies=[away]), fp.Lattice(2)
    plan = planned(fp.Problem(point, scene, **ends, lattice=lattice, duration=DURATION))
    assert plan.verify().ok
    (told,) = hits(among(plan, panel).verify())
    assert "may touch moving body (bodies.0) on edge 0 at 4.44444 s" in told  # 8 m, 1.8 m/s


@pytest.mark.parametrize("mode", ["free-flying", "attitude-held", "free-floating"])
def test_bodies_are_passed_in_every_mode(mode):
    floats, robot = mode == "free-floating", fp.load_robot("planar_dual_arm")
    base, axes = (0.0, 4.0)[not floats], {} if floats else {"lateral": fp.Axis(4, 0.4)}
    start = robot.neutral()
    goal = robot.configuration((base, 0.0, 0.0), joints={"left_1": 0.8, "right_2": -0.5})
    balls = [fp.Ball(0.2, (0.0, 0.3, 0.0))]
    tumble = Tumble((1.0, 1.6, 2.1), (0.1, 0.5, 0.2), (0.02, 0.01, 0.0), DURATION)
    body = MovingBody(balls, tumble, (0.5 * base - 0.3, 1.8, 0.0))
    fields = {"mode": mode, "lattice": fp.Lattice(5, **axes), "duration": DURATION, "ramp": 0.2}
    plan = planned(fp.Problem(robot, fp.Scene(bodies=[body]), start, goal, delta=0.1, **fields))
    report, seen = plan.verify(), clearances_by_hand(plan, TIMES)
    assert report.ok, report.problems
    assert report.clearance_bound - 1e-9 <= seen.min() <= report.least_clearance + 1e-3
    near = among(plan, body, min_clearance=float(seen.min()) + 1e-3)
    assert hits(near.verify())


def test_a_function_faster_than_stated_is_noticed(straight):
    def poses(time):
        return (time, 50.0, 0.0), (0.0, 0.0, np.sin(0.2 * time), np.cos(0.2 * time))

    for speed, rate, honest in ((1.0, 0.4, True), (0.9, 0.4, False), (1.0, 0.3, False)):
        body = MovingBody([fp.Ball(0.1, (1.0, 0.0, 0.0))], PoseFunction(poses, speed, rate))
        report = among(straight, body).verify()
        fast = [each for each in report.problems if "more between two samples than it can" in each]
        assert bool(fast) != honest
        assert all(each.startswith("moving body (bodies.0) moves by") for each in fast)
        assert any("is no faster than stated" in each for each in report.not_checked)


def test_a_function_that_tells_no_pose_is_refused(straight):
    body = MovingBody(
        [fp.Ball(0.1)], PoseFunction(lambda time: ((0.0, 50.0, np.nan), (0.0, 0.0, 0.0, 1.0)), 1.0)
    )
    with pytest.raises(InvalidInput, match="position"):
        among(straight, body).verify()


def test_what_sees_no_times_is_refused_past_bodies(straight):
    with pytest.raises(InvalidInput, match=r"scene bodies: .*sees no times"):
        straight.least_fuel()
    with pytest.raises(InvalidInput, match="a scene at rest"):
        fp.plan(straight.problem, fp.LeastFuel())


def test_a_flight_into_a_body_is_noticed(straight):
    flight = straight.timed(joint_acceleration=1.0, thruster_acceleration=1.0, corners="rest")
    at = 0.5 * flight.duration
    place = flight.at([at]).configurations[0, :3]
    velocity = np.array([0.0, 1.0, 0.0])
    bullet = MovingBody([fp.Ball(0.1)], Drift(velocity), place - at * velocity)
    hit = replace(flight, problem=replace(straight.problem, scene=fp.Scene(bodies=[bullet])))
    (told,) = [each for each in hit.verify().problems if "on piece" in each and "inside" in each]
    assert "moving body (bodies.0)" in told
    assert abs(float(told.split(" at ")[1].split(" s")[0]) - at) < 1.5
    assert flight.verify().ok


@pytest.mark.parametrize("ramp", [0.0, 0.3])
def test_a_table_of_the_path_has_the_times_of_the_pace(straight, tmp_path, ramp):
    plan = among(straight, *straight.problem.scene.bodies, ramp=ramp)
    plan.to_csv(tmp_path / "path.csv", 41)
    table = np.genfromtxt(tmp_path / "path.csv", delimiter=",", names=True)
    assert share_run(plan.problem, table["t_s"]) == pytest.approx(table["s_1"], abs=1e-12)
    assert np.all(np.diff(table["t_s"]) > 0.0)


def test_a_refined_plan_past_a_body_verifies():
    plan = fp.plan(problem_past(body_of("drift"), ramp=0.25), fp.LatticeOptimum(), refine=False)
    refined = fp.refine(plan)
    assert refined.objective < plan.objective
    assert refined.verify().ok
