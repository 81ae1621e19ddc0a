"""Posture axes: the arms turn the base to the goal's attitude, and come back to where they were."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.dynamics.reaction import Reaction
from ffsr_plan.robots.loading import robot_from_urdf
from ffsr_plan.search.postures import posture_lattice
from ffsr_plan.search.postures.lower_bound import lower_bound
from ffsr_plan.search.postures.path_proof import CORRECTABLE
from ffsr_plan.search.postures.posture_lattice import PostureLattice
from tests.helpers.spatial_robot import curvatures, spatial_problem
from tests.helpers.turning_dynamic_programme import turning_oracle

REST = {"left_2": 0.8, "right_2": -0.8}
SWING = fp.PostureAxis({"left_1": 1, "right_1": -1}, 8, 0.25)
BEND = fp.PostureAxis({"left_2": 1, "right_2": 1}, 12, 0.25)
LATTICE = fp.Lattice(80, postures=[SWING, BEND])
COARSE = fp.Lattice(
    24,
    postures=[
        fp.PostureAxis({"left_1": 1, "right_1": -1}, 3, 0.5),
        fp.PostureAxis({"left_2": 1, "right_2": 1}, 3, 0.5),
    ],
)
CASES = [(5, 0), (-15, 1), (30, 2), (-45, 3), (60, 4), (75, 0), (-75, 1)]  # degrees, seed


def turning(degrees, lattice=COARSE, **options):
    robot = fp.load_robot("planar_dual_arm")
    start = robot.configuration(joints=REST)
    goal = robot.configuration((0, 0, 0), (math.radians(degrees), 0, 0), REST)
    return fp.Problem(
        robot, fp.Scene(), start, goal, lattice=lattice, reach_attitude=True, **options
    )


@cache
def planned(degrees, seed):
    return fp.plan(turning(degrees, LATTICE), seed=seed)


@cache
def quick(degrees=20, mode="free-flying"):
    return fp.plan(turning(degrees, mode=mode), seed=0)


@cache
def oracle():
    return turning_oracle(turning(10, LATTICE), math.radians(0.1))


@pytest.mark.parametrize(("degrees", "seed"), CASES)
def test_the_arms_turn_the_base_to_the_goal_and_come_back(degrees, seed):
    plan = planned(degrees, seed)
    report = plan.verify(20)
    assert report.ok, report.problems
    assert plan.arrival_attitude_error <= 1e-8
    assert math.degrees(plan.arrival_attitude[0]) == pytest.approx(degrees, abs=0.06)
    assert report.momentum_residual <= 1e-9
    assert report.least_self_separation > 0.0
    assert np.array_equal(plan.configurations[0, 7:], plan.configurations[-1, 7:])
    assert np.array_equal(plan.configurations[0], plan.problem.start)


@pytest.mark.parametrize(("degrees", "seed"), CASES)
def test_the_joint_path_is_within_5_percent_of_the_oracle(degrees, seed):
    plan, yaw = planned(degrees, seed), math.radians(degrees)
    assert plan.lattice_objective <= 1.05 * oracle().least(yaw)
    assert plan.lattice_objective >= oracle().least(yaw, CORRECTABLE) * (1 - 1e-9)


@pytest.mark.parametrize("degrees", range(5, 80, 10))
def test_the_lower_bound_is_below_what_the_oracle_finds(degrees):
    problem = turning(degrees, LATTICE)
    assert 0.0 < lower_bound(PostureLattice(problem)) <= oracle().least(math.radians(degrees))


def test_finer_bins_change_little_in_the_oracle():
    fine = turning_oracle(turning(10, LATTICE), math.radians(0.05))
    for degrees in (5, 15, 30, 45, 60, 75):
        yaw = math.radians(degrees)
        assert fine.least(yaw) == pytest.approx(oracle().least(yaw), rel=2e-3)


def test_the_oracle_agrees_with_all_paths_of_a_tiny_lattice():
    axes = [fp.PostureAxis(dict(a.joints), 1, 0.9) for a in LATTICE.postures]
    problem = turning(10, fp.Lattice(4, postures=axes))
    lattice, m = PostureLattice(problem), 4
    step_rotations = 2.0 * np.arctan2(
        lattice.step_rotations[0, ..., 2], lattice.step_rotations[0, ..., 3]
    )
    found = []

    def extend(p, layer, length, yaw):
        if layer == m:
            found.extend([(length, yaw)] if p == lattice.origin else [])
            return
        for step, on in enumerate(lattice.successors[p]):
            if on >= 0 and lattice.allowed[0, on]:
                edge = math.sqrt(lattice.squared_steps[lattice.rows[layer], p, step])
                extend(on, layer + 1, length + edge, yaw + step_rotations[p, step])

    extend(lattice.origin, 0, 0.0, 0.0)
    lengths, yaws = np.array(found).T
    tried = turning_oracle(problem, math.radians(0.05))
    for yaw in (0.0, *yaws[np.argsort(yaws)[[0, -1]]]):
        near = np.abs(yaws - yaw) <= math.radians(0.5)
        assert tried.least(yaw) == pytest.approx(lengths[near].min(), rel=1e-9)
    assert tried.farthest == pytest.approx(np.abs(yaws).max(), abs=math.radians(0.05))


def test_postures_change_by_one_level_a_layer_at_most():
    for plan in (planned(75, 0), spatial(30, (0, 0, 1))):
        steps = np.abs(np.diff(plan.nodes, axis=0))
        assert steps.max() == 1
        assert not plan.nodes[[0, -1]].any()


def test_postures_in_which_links_touch_are_not_used():
    lattice = PostureLattice(turning(75, LATTICE))
    assert not lattice.allowed.all()
    plan = planned(75, 0)
    number = {tuple(index): p for p, index in enumerate(lattice.indices.tolist())}
    assert all(lattice.allowed[0, number[tuple(node)]] for node in plan.nodes.tolist())


def test_there_and_back_along_the_same_joint_path_turns_nothing():
    motion = planned(75, 0).motion
    there = motion.joint_values
    back = Reaction.along(motion.robot, np.vstack([there, there[-2::-1]])).attitudes(
        rotations.IDENTITY
    )
    assert rotations.angle_between(back[0], back[-1]) < 1e-9
    assert rotations.angle_between(back[0], back[len(there) - 1]) > 1.0


def test_a_robot_that_nothing_holds_turns_too():
    plan = quick(20, "free-floating")
    report = plan.verify(200)
    assert report.ok, report.problems
    assert report.center_drift <= 1e-6
    assert report.momentum_residual <= 1e-9
    assert plan.arrival_attitude_error <= 1e-8


def test_an_unreachable_goal_attitude_states_the_error():
    problem = turning(120)
    with pytest.raises(fp.AttitudeOutOfReach, match=r"of 120\.0 degrees") as caught:
        fp.plan(problem, seed=0)
    reach = turning_oracle(problem, math.radians(0.1), math.radians(200)).farthest
    assert caught.value.wanted == pytest.approx(math.radians(120))
    short = caught.value.wanted - reach
    assert CORRECTABLE < short <= caught.value.missed + 1e-9
    assert caught.value.missed < short + 0.25 * reach


@pytest.mark.parametrize("planner", [fp.LatticeOptimum(), fp.AntSystem()])
def test_planners_over_nodes_refuse_posture_axes_and_say_why(planner):
    with pytest.raises(fp.InvalidInput, match=r"posture-annealing.*depends on the path"):
        fp.plan(turning(10), planner)


def test_the_same_seed_and_a_file_give_the_same_plan(tmp_path):
    plan = quick()
    assert fp.plan(plan.problem, seed=0) == plan
    plan.save(tmp_path / "plan.json")
    loaded = fp.Plan.load(tmp_path / "plan.json")
    assert loaded == plan
    assert loaded.arrival_attitude_error == plan.arrival_attitude_error
    assert loaded.verify(20).ok


def test_the_reaction_to_many_joint_steps_is_that_to_each(monkeypatch):
    """However many of them are integrated together."""
    problem = spatial_problem(10, (1, 0, 0), levels=1)
    moved = replace(problem, goal=problem.robot.configuration(joints={"left_1": 0.3}))
    for each in (problem, moved):
        monkeypatch.setattr(posture_lattice, "_STEPS_AT_ONCE", 10**6)
        whole = PostureLattice(each).step_rotations
        monkeypatch.setattr(posture_lattice, "_STEPS_AT_ONCE", 7)
        assert np.max(rotations.angle_between(PostureLattice(each).step_rotations, whole)) < 1e-9


def test_steps_back_undo_steps_there():
    lattice = PostureLattice(spatial_problem(10, (1, 0, 0), levels=1))
    p, step = np.nonzero(lattice.successors >= 0)
    on = lattice.successors[p, step]
    begin = lattice.joint_values[0, p]
    steps = lattice.joint_values[0, on] - begin
    alone = Reaction(lattice.problem.robot, begin, steps).increments
    assert np.max(rotations.angle_between(lattice.step_rotations[0, p, step], alone)) < 1e-7


@cache
def spatial(degrees, axis):
    return fp.plan(spatial_problem(degrees, axis), seed=0)


def test_a_small_loop_rotates_by_area_times_curvature():
    rng = np.random.default_rng(0)
    robot = spatial_problem(10, (1, 0, 0)).robot
    for _ in range(5):
        middle, (u, v, w) = rng.uniform(-1, 1, 6), rng.normal(size=(3, 6))
        edge = 1e-3
        corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * edge / 2
        turned = Reaction.along(robot, middle + corners @ np.array([u, v])).attitudes(
            rotations.IDENTITY
        )
        expected = curvatures(robot, middle, (u, v, w))[0]
        assert rotations.log(turned[-1]) / edge**2 == pytest.approx(expected, rel=0.02, abs=2e-3)


@pytest.mark.parametrize(("degrees", "axis"), [(10, (1, -1, 1)), (30, (0, 0, 1)), (30, (1, 1, 0))])
def test_three_posture_axes_turn_a_base_about_any_axis(degrees, axis):
    plan = spatial(degrees, axis)
    assert plan.arrival_attitude_error <= 1e-8
    report = plan.verify(10)
    assert report.ok, report.problems
    assert report.momentum_residual <= 1e-9
    assert report.least_self_separation > 0.0


SCENARIO = """
[robot]
urdf = "planar_dual_arm"
mode = "free-flying"
[start]
joints = { left_2 = 0.8, right_2 = -0.8 }
[goal]
attitude = [0.3490658503988659, 0.0, 0.0]
joints = { left_2 = 0.8, right_2 = -0.8 }
[lattice]
divisions = 24
postures = [
  { joints = { left_1 = 1.0, right_1 = -1.0 }, half_count = 3, spacing = 0.5 },
  { joints = { left_2 = 1.0, right_2 = 1.0 }, half_count = 3, spacing = 0.5 },
]
"""


def test_a_scenario_file_can_ask_for_a_goal_attitude(tmp_path):
    path = tmp_path / "turn.toml"
    path.write_text(SCENARIO, encoding="utf-8")
    problem = fp.load_scenario(path)
    assert problem.reach_attitude
    assert problem.lattice == COARSE
    assert np.array_equal(fp.plan(problem, seed=0).configurations, quick().configurations)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ('{ towards = "stowed" }', "levels.*required"),
        ('{ towards = "stowed", levels = 2, spacing = 0.1 }', "unknown key.*spacing"),
        ("{ joints = { left_1 = 1.0 }, half_count = 0, spacing = 0.1 }", "half_count"),
        ("{ towrds = 1 }", "did you mean"),
    ],
)
def test_wrong_axes_in_a_scenario_file_are_refused(tmp_path, wrong, message):
    path = tmp_path / "turn.toml"
    head = SCENARIO[: SCENARIO.index("postures")]
    path.write_text(f"{head}postures = [{wrong}]\n", encoding="utf-8")
    with pytest.raises(fp.InvalidInput, match=message):
        fp.load_scenario(path)


@pytest.mark.parametrize(
    ("axis", "message"),
    [
        (lambda: fp.PostureAxis({}, 2, 0.1), "joint names"),
        (lambda: fp.PostureAxis({"left_1": 0.0}, 2, 0.1), "a joint that moves"),
        (lambda: fp.PostureAxis({"left_1": math.nan}, 2, 0.1), "left_1"),
        (lambda: fp.PostureAxis({"left_1": 1.0}, 0, 0.1), "half_count"),
        (lambda: fp.PostureAxis({"left_1": 1.0}, 2, 0.0), "spacing"),
        (lambda: fp.PostureAxis.towards("stowed", 0), "levels"),
        (lambda: fp.PostureAxis.towards("", 2), "the name of a posture"),
    ],
)
def test_axes_that_cannot_be_are_refused(axis, message):
    with pytest.raises(fp.InvalidInput, match=message):
        axis()


STATES = "<robot name='made'><group_state name='stowed' group='arms'>{}</group_state></robot>"
STOWED = "<joint name='left_1' value='0.4'/>"


def with_states(text):
    robot = fp.load_robot("planar_dual_arm")
    return robot_from_urdf(robot.urdf, "made", srdf=STATES.format(text))


@pytest.mark.parametrize(
    ("axis", "message"),
    [
        (fp.PostureAxis({"left_9": 1.0}, 2, 0.1), r"joints: got 'left_9'.*did you mean 'left_\d'"),
        (fp.PostureAxis.towards("stowd", 2), "got 'stowd'.*did you mean 'stowed'"),
    ],
)
def test_axes_that_the_robot_does_not_have_are_refused_by_name(axis, message):
    robot, problem = with_states(STOWED), turning(10)
    with pytest.raises(fp.InvalidInput, match=message):
        replace(problem, robot=robot, lattice=fp.Lattice(4, postures=[axis]))


def test_an_axis_towards_a_posture_ends_in_it():
    axis = fp.PostureAxis.towards("stowed", 4)
    problem = replace(
        turning(10), robot=with_states(STOWED), lattice=fp.Lattice(8, postures=[axis])
    )
    lattice = PostureLattice(problem)
    left = problem.robot.joint_names.index("left_1")
    assert lattice.joint_values[3, :, left] == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4])
    others = np.delete(lattice.joint_values - lattice.joint_values[:, :1], left, axis=2)
    assert not others.any()


def test_in_an_empty_scene_no_distance_to_an_obstacle_is_counted():
    certificate = quick().certificate
    assert certificate.node_queries == 0
    assert certificate.edge_queries == 0  # lower bounds keep the links apart from each other
    assert certificate.edges_free == COARSE.divisions


def test_too_many_postures_are_refused_before_memory_runs_out():
    axes = [fp.PostureAxis({name: 1.0}, 40, 0.05) for name in ("left_1", "left_2", "right_1")]
    with pytest.raises(fp.InvalidInput, match="lattice postures"):
        fp.plan(turning(10, fp.Lattice(40, postures=axes)))


def test_a_goal_attitude_needs_arms_that_react_and_posture_axes():
    with pytest.raises(fp.InvalidInput, match="wheels"):
        turning(10, mode="attitude-held")
    with pytest.raises(fp.InvalidInput, match="posture axes"):
        turning(10, fp.Lattice(40))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<joint name='left_1' value='40'/>", r"left_1'.*got 40.0"),
        ("<joint name='left_7' value='0'/>", r"stowed', joint.*did you mean 'left_\d'"),
        ("<joint name='left_1' value='much'/>", "left_1"),
        ("<joint name='left_1'/>", "left_1"),
    ],
)
def test_postures_beyond_limits_or_of_no_joint_are_refused(text, message):
    with pytest.raises(fp.InvalidInput, match=message):
        _ = with_states(text).postures
