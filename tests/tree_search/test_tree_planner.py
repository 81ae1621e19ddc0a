"""Plans without a lattice."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core.rotations import angle_between
from tests.helpers.free_scenes import beside_a_box, cup, gap, scattered

QUICK = fp.TreePlanner(checks=60_000)


def test_a_problem_without_a_lattice_needs_nothing_else(robot):
    plan = fp.plan(scattered(robot, 0), QUICK)
    assert plan.planner == QUICK
    assert plan.lattice is None
    assert not plan.optimum_is_exact
    assert plan.optimum <= plan.objective
    assert plan.verify().ok
    assert fp.plan(scattered(robot, 0), until="first").planner == fp.TreePlanner()


@pytest.mark.parametrize("make", [gap, lambda robot, seed: cup(robot)])
def test_walls_with_gaps_and_cups_are_passed(robot, make):
    for seed in range(2):
        plan = fp.plan(make(robot, seed), seed=seed, until="first")
        assert plan.verify().ok


def test_a_floating_arm_gets_around_a_box():
    robot = fp.load_robot("satellite_ur5")
    for seed in range(3):
        plan = fp.plan(beside_a_box(robot, seed), QUICK)
        assert plan.verify().ok
        assert plan.motion.joint_values[-1] == pytest.approx(robot.joint_values(plan.problem.goal))


@pytest.mark.parametrize("name", ["planar_dual_arm", "spatial_dual_arm"])
def test_held_attitudes_turn_when_there_is_room(name):
    robot = fp.load_robot(name)
    scene = fp.Scene([[1.5, 0.0, 0.0], [1.5, 1.0, 0.5]], [0.3, 0.2])
    goal = robot.configuration((3.0, 0.0, 0.0), (0.0, 0.0, 1.4))
    problem = fp.Problem(robot, scene, robot.neutral(), goal, "attitude-held")
    plan = fp.plan(problem, QUICK)
    assert plan.verify().ok
    assert plan.motion.turn_shares is not None
    assert angle_between(plan.configurations[-1, 3:7], goal[3:7]) < 1e-9
    assert plan.timed(
        joint_acceleration=0.1, thruster_acceleration=0.1, turn_acceleration=0.1
    ).duration > 0.0  # fmt: skip
    assert plan.wheel_momentum(100.0).peak > 0.0


def test_the_straight_way_is_taken_where_it_is_free(robot):
    goal = robot.configuration((3.0, 0.0, 0.0), joints={"left_1": 0.4})
    plan = fp.plan(fp.Problem(robot, fp.Scene([[9.0, 9, 0]], [1.0]), robot.neutral(), goal))
    assert plan.gap == 0.0
    assert plan.length == pytest.approx(np.hypot(3.0, 0.4))


def test_the_same_seed_gives_the_same_plan(robot):
    first, second = (fp.plan(gap(robot, 0), QUICK, seed=3) for _ in range(2))
    assert first == second
    assert first != fp.plan(gap(robot, 0), QUICK, seed=5)


def test_the_first_path_is_returned_on_request(robot):
    problem = scattered(robot, 1)
    first, best = fp.plan(problem, until="first"), fp.plan(problem, fp.TreePlanner(checks=300_000))
    assert first.seconds < best.seconds
    assert best.length < first.length
    assert first.verify().ok


def test_more_weight_on_clearance_keeps_farther_away(robot):
    means = []
    for delta in (0.0, 0.02, 0.2):
        problem = scattered(robot, 2, delta=delta, clearance_cap=0.6)
        plan = fp.plan(problem, fp.TreePlanner(checks=400_000))
        assert plan.verify().ok
        gaps = [fp.clearance(robot, problem.scene, q) for q in plan.at(np.linspace(0, 1, 200))]
        means.append(np.mean(np.minimum(gaps, 0.6)))
    assert means[0] < means[1] < means[2]


def test_the_base_stays_in_its_window(robot):
    window = ((-0.5, -1.8, 0.0), (4.5, 1.8, 0.0))
    plan = fp.plan(scattered(robot, 0, window=window), fp.TreePlanner(checks=300_000))
    assert np.all(plan.motion.positions >= window[0])
    assert np.all(plan.motion.positions <= window[1])
    assert plan.verify().ok


def test_robots_in_a_plane_stay_in_it(robot):
    low, high = scattered(robot, 0).base_window
    assert low[2] == high[2] == 0.0
    assert np.all(high[:2] > low[:2] + 4.0)
    spatial = fp.load_robot("spatial_dual_arm")
    goal = spatial.configuration((1.0, 0.0, 0.0))
    low, high = fp.Problem(spatial, fp.Scene(), spatial.neutral(), goal).base_window
    assert np.all(high > low)


def test_plans_survive_a_file(robot, tmp_path):
    goal = robot.configuration((3.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    scene = fp.Scene([[1.5, 0.0, 0.0]], [0.3])
    held = fp.Problem(robot, scene, robot.neutral(), goal, "attitude-held")
    for problem in (scattered(robot, 0), held):
        plan = fp.plan(problem, QUICK)
        plan.save(tmp_path / "plan.json")
        again = fp.Plan.load(tmp_path / "plan.json")
        assert again == plan
        assert np.array_equal(again.at(0.37), plan.at(0.37))
        plan.write_html(tmp_path / "plan.html")
        plan.to_csv(tmp_path / "plan.csv")


def test_callbacks_follow_the_rounds(robot):
    cycles = []
    plan = fp.plan(gap(robot, 0), fp.TreePlanner(checks=300_000), on_cycle=cycles.append)
    assert [cycle.number for cycle in cycles] == list(range(1, len(cycles) + 1))
    best = [cycle.best for cycle in cycles]
    assert best == sorted(best, reverse=True)
    assert best[-1] == plan.objective
    assert np.all(np.diff(plan.history.best) <= 0.0)
    assert plan.history.best[-1] == plan.objective


def test_a_time_limit_ends_the_search(robot):
    plan = fp.plan(gap(robot, 0), time_limit=1.5)
    assert plan.interrupted
    assert plan.seconds < 3.0
    assert plan.verify().ok


def test_what_cannot_be_found_is_reported(robot):
    with pytest.raises(fp.PathNotFound) as caught:
        fp.plan(gap(robot, 0, width=0.3), fp.TreePlanner(checks=20_000))
    error = caught.value
    assert error.nodes > 100
    assert error.tries >= 1
    assert error.contact.link in robot.link_names
    assert abs(error.contact.depth) < 0.2
    assert "what may help" in str(error)


def test_ends_in_collision_are_reported(robot):
    scene, goal = fp.Scene([[0.0, 0.0, 0.0]], [0.3]), robot.configuration((3.0, 0.0, 0.0))
    with pytest.raises(fp.StartInCollision):
        fp.plan(fp.Problem(robot, scene, robot.neutral(), goal))
    with pytest.raises(fp.GoalInCollision):
        fp.plan(fp.Problem(robot, scene, goal, robot.neutral(), "attitude-held"))
    arm = fp.load_robot("satellite_ur5")
    folded, rng = arm.neutral(), np.random.default_rng(0)
    while not len(fp.self_collisions(arm, folded)):
        joints = rng.uniform(arm.lower, arm.upper)
        folded = arm.assemble(np.array([3.0, 0.0, 0.0]), folded[3:7], joints)
    with pytest.raises(fp.GoalInCollision):
        fp.plan(fp.Problem(arm, fp.Scene(), arm.configuration(joints="stowed"), folded))


def test_planners_are_refused_where_they_do_not_apply(robot):
    free = scattered(robot, 0)
    for name in ("ant-system", "max-min-ant-system", "lattice-optimum", "posture-annealing"):
        with pytest.raises(fp.errors.InvalidInput, match="tree-planner"):
            fp.plan(free, name)
    ends = free.start, free.goal
    lattice = fp.Problem(robot, free.scene, *ends, lattice=fp.Lattice())
    with pytest.raises(fp.errors.InvalidInput, match="max-min-ant-system"):
        fp.plan(lattice, fp.TreePlanner())
    with pytest.raises(fp.errors.InvalidInput, match="until"):
        fp.plan(lattice, until="first")
    with pytest.raises(fp.errors.InvalidInput, match="colonies"):
        fp.plan(free, colonies=2)
    with pytest.raises(fp.errors.InvalidInput, match="window"):
        fp.Problem(robot, free.scene, *ends, lattice=fp.Lattice(), window=((-9,) * 3, (9,) * 3))
    with pytest.raises(fp.errors.InvalidInput, match="goal"):
        fp.Problem(robot, free.scene, *ends, window=((-1, -1, 0), (1, 1, 0)))
    with pytest.raises(fp.errors.InvalidInput, match="a problem with a lattice"):
        fp.LayeredLattice(free)
