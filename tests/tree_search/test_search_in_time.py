"""Plans without a lattice among bodies that move."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp

QUICK = fp.TreePlanner(checks=120_000)


def without_lattice(name):
    return replace(fp.load_scenario(name), lattice=None)


def swung(mode="free-floating"):
    """An arm that has to wait until a boom has swung by."""
    robot = fp.load_robot("satellite_ur5")
    start = robot.configuration((0.0, 0.0, 0.0), joints="stowed")
    goal = robot.configuration((0.0, 0.0, 0.0), joints="ready")
    boom = fp.Box((3.0, 0.2, 0.2))
    body = fp.MovingBody([boom], fp.Spin((0.0, 0.0, 0.05)), (2.3, 0.1, 1.0), name="boom")
    return fp.Problem(
        robot, fp.Scene(bodies=[body]), start, goal, mode,
        duration=120.0, delta=0.02, clearance_cap=0.5,
    )  # fmt: skip


@pytest.fixture(scope="module")
def past_the_door():
    return fp.plan(without_lattice("door"), QUICK, until="first")


def test_a_door_is_waited_for_without_a_lattice(past_the_door):
    plan = past_the_door
    assert plan.lattice is None
    assert plan.motion.edges == 80
    steps = np.linalg.norm(plan.motion.base_steps(), axis=1)
    assert np.count_nonzero(steps == 0.0) > 5
    assert 0.0 < plan.slip < np.inf
    assert plan.verify().ok


def test_the_same_seed_gives_the_same_run(past_the_door):
    assert fp.plan(without_lattice("door"), QUICK, until="first") == past_the_door


def test_clearances_count_where_bodies_are_at_their_times(past_the_door):
    problem, every = past_the_door.problem, np.arange(2, 80, 2)
    near = problem.delta / np.minimum(past_the_door.clearances[every], problem.clearance_cap or 9e9)
    assert past_the_door.objective == pytest.approx(
        past_the_door.length / problem.length_unit + near.sum() * problem.length_unit, rel=1e-12
    )
    later = replace(past_the_door, objective=past_the_door.objective * (1.0 + 1e-6))
    assert not later.verify().ok


def test_a_run_that_is_read_back_is_the_same(past_the_door, tmp_path):
    past_the_door.save(tmp_path / "plan.json")
    assert fp.Plan.load(tmp_path / "plan.json") == past_the_door


def test_a_floating_arm_waits_and_nothing_else_moves_its_centre_of_mass():
    plan = fp.plan(swung(), QUICK, until="first")
    report = plan.verify()
    assert report.ok
    assert report.momentum_residual < 1e-9
    assert report.center_drift < 1e-9
    still = np.all(np.diff(plan.motion.joint_values, axis=0) == 0.0, axis=1)
    assert 0 < np.count_nonzero(still) < 80
    assert np.array_equal(plan.configurations[:-1][still], plan.configurations[1:][still])


def test_speeds_stay_within_their_limits():
    problem, limits = without_lattice("door"), {"base_speed": 0.09, "joint_speed": 0.02}
    problem = replace(problem, ramp=0.1)
    plan = fp.plan(problem, fp.TreePlanner(checks=120_000, time_steps=160, **limits), until="first")
    pace = problem.pace(plan.motion.edges).instants(np.arange(plan.motion.edges + 1.0))
    speeds = np.linalg.norm(plan.motion.base_steps(), axis=1) / np.diff(pace)
    assert speeds.max() <= 0.09 * (1.0 + 1e-9)
    turned = np.abs(np.diff(plan.motion.joint_values, axis=0)).max(axis=1) / np.diff(pace)
    assert turned.max() <= 0.02 * (1.0 + 1e-9)
    slow = fp.TreePlanner(checks=60_000, base_speed=1e-3)
    with pytest.raises(fp.PathNotFound, match=r"paths were found past what is at rest; .*duration"):
        fp.plan(problem, slow)


def test_a_body_that_comes_along_the_way_is_given_way_to():
    robot = fp.load_robot("satellite_ur5")
    bar = fp.MovingBody([fp.Box((0.3, 0.3, 0.3))], fp.Drift((-0.05, 0.0, 0.0)), (8.0, 0.0, 0.0))
    start, goal = (robot.configuration((x, 0.0, 0.0), joints="stowed") for x in (0.0, 4.0))
    problem = fp.Problem(
        robot, fp.Scene(bodies=[bar]), start, goal, duration=150.0,
        window=((-1.0, -3.0, 0.0), (5.0, 3.0, 0.0)),
    )  # fmt: skip
    plan = fp.plan(problem, fp.TreePlanner(checks=400_000), until="first")
    assert np.abs(plan.motion.positions[:, 1]).max() > 0.3
    low, high = problem.base_window
    assert np.all((plan.motion.positions >= low - 1e-9) & (plan.motion.positions <= high + 1e-9))
    assert plan.verify().ok


def test_ends_are_checked_at_their_times(robot):
    goal = robot.configuration((4.0, 0.0, 0.0))

    def among(place, velocity):
        ball = fp.MovingBody([fp.Ball(0.4)], fp.Drift(velocity), place, name="rock")
        return fp.Problem(robot, fp.Scene(bodies=[ball]), robot.neutral(), goal, duration=100.0)

    with pytest.raises(fp.StartInCollision, match="rock"):
        fp.plan(among((0.0, 0.0, 0.0), (0.0, 0.1, 0.0)), QUICK)
    with pytest.raises(fp.GoalInCollision, match="rock"):
        fp.plan(among((4.0, 10.0, 0.0), (0.0, -0.1, 0.0)), QUICK)
    plan = fp.plan(among((4.0, 0.0, 0.0), (0.0, 0.1, 0.0)), QUICK, until="first")
    assert plan.verify().ok


def test_where_no_path_can_be_run_the_error_says_when_it_is_closed(robot):
    wall = fp.MovingBody([fp.Box((0.2, 40.0, 9.0))], fp.Drift((-0.1, 0.0, 0.0)), (5.0, 0.0, 0.0))
    goal = robot.configuration((2.0, 0.0, 0.0))
    problem = fp.Problem(robot, fp.Scene(bodies=[wall]), robot.neutral(), goal, duration=100.0)
    with pytest.raises(fp.PathNotFound, match=r"the last of which is closed from \d+") as found:
        fp.plan(problem, QUICK)
    assert 20.0 < found.value.closed_at < 60.0


def test_steps_of_time_come_in_multiples_of_forty():
    with pytest.raises(fp.InvalidInput, match="time_steps"):
        fp.TreePlanner(time_steps=50)


def test_a_portfolio_runs_trees_among_bodies_too():
    problem = fp.load_scenario("crossing")
    plan = fp.plan(problem, fp.Portfolio(trees=QUICK), refine=False)
    assert plan.verify().ok


def test_trees_pass_drifting_debris(robot):
    rng = np.random.default_rng(0)
    centers = rng.uniform((1.0, -4.0, -0.5), (5.0, 4.0, 0.5), (15, 3))
    cloud = fp.DebrisCloud(centers, np.full(15, 0.15), rng.normal(size=(15, 3)) * (0.02, 0.03, 0.0))
    problem = fp.Problem(
        robot, fp.Scene(debris=[cloud]), robot.neutral(), robot.configuration((6.0, 0.0, 0.0)),
        duration=120.0, delta=0.05, clearance_cap=1.0,
    )  # fmt: skip
    rounds = []
    plan = fp.plan(problem, QUICK, on_cycle=rounds.append)
    assert 0.0 < plan.slip < np.inf
    assert plan.verify().ok
    times, still = np.linspace(0.0, 120.0, 81), plan.problem.scene.at
    near = [
        fp.clearance(robot, still(t), q) for t, q in zip(times, plan.configurations, strict=True)
    ]
    assert plan.clearances == pytest.approx(np.array(near), abs=1e-9)
    assert plan.clearances.min() < 1.0
    assert rounds[-1].nodes > 0
    assert rounds[-1].best == plan.objective
