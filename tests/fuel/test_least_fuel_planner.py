"""`LeastFuel`: the margin along polygon and curve, its figures, its files and what it refuses."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.collision.distances import ObstacleQuery
from ffsr_plan.core.errors import OutOfTime
from ffsr_plan.curves.control_points import control_points_on
from ffsr_plan.curves.curved_motion import CurvedMotion
from ffsr_plan.fuel.refinement import FuelRefinement
from ffsr_plan.scene.generators import scatter
from ffsr_plan.search.fuel_figures import velocity_change
from tests.helpers.urdf_builders import random_scene


@pytest.fixture(scope="module")
def problem():
    return fp.load_scenario("fig2a")


@pytest.fixture(scope="module")
def plan(problem):
    return fp.plan(problem, fp.LeastFuel(margin=0.02))


def in_space():
    robot = fp.load_robot("planar_dual_arm")
    scene = fp.Scene([[3.0, 0.1, 0.1], [6.0, -0.3, 0.2]], [0.5, 0.6])
    goal = robot.configuration((9.0, 0.0, 0.0), joints={"left_1": 0.5})
    lattice = fp.Lattice(20, fp.Axis(6, 0.3), fp.Axis(6, 0.3))
    return fp.Problem(robot, scene, robot.configuration(), goal, lattice=lattice)


def least_sampled(plan):
    """Least clearance sampled along the polygon and along its curve [m]."""
    m, query = plan.edges, ObstacleQuery(plan.problem.robot, plan.problem.scene)
    edges, times = np.repeat(np.arange(m), 40), np.tile(np.arange(40) / 39.0, m)
    curve = CurvedMotion(plan.motion, control_points_on(plan.motion, np.arange(m + 1.0)))
    return [float(query.distances(each.at(edges, times)).min()) for each in (plan.motion, curve)]


def test_two_hundred_seconds_take_at_most_149_millimetres_a_second(plan):
    assert plan.fuel.delta_v(200.0) <= 0.149
    assert plan.fuel.straight == pytest.approx(20.0)
    assert plan.fuel.change >= plan.fuel.straight
    assert plan.fuel.gap == 0.0
    assert plan.fuel.change == pytest.approx(velocity_change(plan.motion.positions), rel=1e-12)


def test_the_margin_is_kept_along_polygon_and_curve(plan):
    assert min(least_sampled(plan)) > plan.fuel.margin
    assert plan.certificate.least_clearance >= plan.fuel.margin
    assert plan.verify().ok


def test_the_curve_is_proven_where_its_stations_miss_an_obstacle(problem):
    """A scene whose curve is too close between its knots and the middles of its pieces."""
    scene = scatter(1025, (4, 11), (1.8, -3.0), (8.2, 3.0), (0.15, 0.5))
    crowded = replace(problem, scene=scene, lattice=fp.Lattice(40, fp.Axis(20, 0.15)))
    plan = fp.plan(crowded, fp.LeastFuel(margin=0.02))
    assert min(least_sampled(plan)) > 0.02
    assert plan.smooth().kind == "spline"


@pytest.mark.parametrize("margin", [0.0, 0.05, 0.2])
def test_a_larger_margin_takes_no_less_fuel_and_is_kept(problem, plan, margin):
    other = fp.plan(problem, fp.LeastFuel(margin=margin))
    assert min(least_sampled(other)) > margin
    longer = other.fuel.change - plan.fuel.change
    assert longer * (margin - plan.fuel.margin) > 0.0


def test_in_space_two_axes_are_used_and_the_margin_is_kept():
    given = in_space()
    plan = fp.plan(given, fp.LeastFuel(margin=0.05))
    assert min(least_sampled(plan)) > 0.05
    assert plan.verify().ok
    flat = replace(given, lattice=fp.Lattice(20, fp.Axis(6, 0.3)))
    assert plan.fuel.change < fp.plan(flat, fp.LeastFuel(margin=0.05)).fuel.change


def test_it_takes_less_fuel_than_the_shortest_path_and_the_optimum_of_f(problem, plan):
    for delta in (0.0, 0.05, problem.delta):
        other = fp.plan(replace(problem, delta=delta), fp.LatticeOptimum())
        assert plan.fuel.change < velocity_change(other.motion.positions)
        assert other.fuel is None


def test_f_and_l_are_those_of_the_motion_and_the_optimum_that_of_the_lattice(problem, plan):
    optimum = fp.plan(problem, fp.LatticeOptimum(), refine=False)
    assert plan.optimum == plan.lattice_objective == optimum.objective
    assert np.array_equal(plan.nodes, optimum.nodes)
    assert plan.length >= optimum.problem.delta_d * plan.edges
    assert plan.objective > optimum.objective  # clearance is not what it looks for


def test_the_seed_does_not_matter_and_the_same_problem_gives_the_same_plan(problem, plan):
    again = fp.plan(problem, "least-fuel", seed=7)
    assert np.array_equal(again.motion.positions, plan.motion.positions)
    assert again.fuel == plan.fuel


def test_without_obstacles_the_way_is_straight(problem):
    plan = fp.plan(replace(problem, scene=fp.Scene([], [])), fp.LeastFuel())
    assert plan.fuel.change == pytest.approx(plan.fuel.straight, rel=1e-9)
    assert plan.certificate.least_clearance == np.inf


def test_wheels_that_hold_the_attitude_need_no_other_planner():
    problem = fp.load_scenario("fig2a")
    held = replace(problem, mode="attitude-held")
    plan = fp.plan(held, fp.LeastFuel())
    assert min(least_sampled(plan)) > 0.02


@pytest.mark.parametrize("seed", range(6))
def test_random_scenes_give_proven_plans_or_no_path(seed):
    rng, robot = np.random.default_rng(seed), fp.load_robot("point")
    scene = random_scene(rng, 10, (1.0, -1.5, -0.2), (7.0, 1.5, 0.2), (0.2, 0.8))
    goal = robot.configuration((8.0, 0.0, 0.0))
    lattice = fp.Lattice(24, fp.Axis(20, 0.1))
    given = fp.Problem(robot, scene, robot.configuration(), goal, lattice=lattice)
    try:
        plan = fp.plan(given, fp.LeastFuel(margin=0.03, layers=8))
    except fp.NoPath:
        return
    assert min(least_sampled(plan)) > 0.03


def test_a_plan_comes_back_from_its_file(plan, tmp_path):
    plan.save(tmp_path / "plan.json")
    back = fp.Plan.load(tmp_path / "plan.json")
    assert back == plan
    assert back.fuel == plan.fuel
    assert back.planner == fp.LeastFuel(margin=0.02)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"change": 25.0}, "fuel.change"),
        ({"straight": 19.0}, "fuel.straight"),
        ({"margin": 0.5}, "fuel.margin"),
        ({"start": "a guess"}, "fuel.start.*pair-programme or lattice-optimum"),
        ({"lattice_bound": 40.0}, "fuel.lattice_bound.*to lattice_change"),
        ({"lattice_bound": 10.0}, "fuel.lattice_bound.*from straight"),
        ({"lattice_bound": None}, "fuel.lattice_bound"),
        ({"spent": 1.0}, "spent"),
    ],
)
def test_figures_that_cannot_be_are_refused(plan, change, message):
    data = plan.to_dict()
    data["fuel"] = data["fuel"] | change
    with pytest.raises(fp.InvalidInput, match=message):
        fp.Plan.from_dict(data)


def test_figures_belong_to_the_planner(problem, plan):
    data = plan.to_dict()
    del data["fuel"]
    with pytest.raises(fp.InvalidInput, match=r"fuel.*figures of least-fuel"):
        fp.Plan.from_dict(data)
    other = fp.plan(problem, fp.LatticeOptimum()).to_dict()
    other["fuel"] = plan.to_dict()["fuel"]
    with pytest.raises(fp.InvalidInput, match=r"fuel.*none with lattice-optimum"):
        fp.Plan.from_dict(other)


def test_the_margin_is_that_of_start_and_goal_at_most(problem):
    with pytest.raises(fp.InvalidInput, match=r"margin.*clearance of the start"):
        fp.plan(problem, fp.LeastFuel(margin=5.0))


def test_where_no_path_keeps_the_margin_the_layer_is_named():
    robot = fp.load_robot("point")
    wall = fp.Scene([[3.0, y, 0.0] for y in np.arange(-3.0, 3.1, 0.6)], [0.25] * 11)
    goal = robot.configuration((6.0, 0.3, 0.0))
    start = robot.configuration((0.0, 0.3, 0.0))
    lattice = fp.Lattice(24, fp.Axis(20, 0.05))
    given = fp.Problem(robot, wall, start, goal, lattice=lattice)
    assert fp.plan(given, fp.LeastFuel(margin=0.0)).fuel is not None
    with pytest.raises(fp.NoPath):
        fp.plan(given, fp.LeastFuel(margin=0.2))


def refused(problem, words, **settings):
    with pytest.raises(fp.InvalidInput, match=words):
        fp.plan(problem, fp.LeastFuel(), **settings)


def test_what_it_cannot_do_is_refused_by_name(problem, plan):
    robot = problem.robot
    refused(replace(problem, lattice=None), "least-fuel.*a problem with a lattice")
    folding = fp.PostureAxis({"left_2": 1.0}, half_count=1, spacing=0.2)
    refused(replace(problem, lattice=fp.Lattice(8, postures=[folding])), "without posture axes")
    floating = replace(problem, mode="free-floating", lattice=fp.Lattice(8), scene=fp.Scene([], []))
    refused(floating, "a mode with thrusters")
    still = robot.configuration(joints={"left_1": 0.4})
    at_rest = fp.Problem(robot, fp.Scene([], []), robot.neutral(), still, lattice=fp.Lattice(8))
    refused(at_rest, "a base that moves")
    refused(problem, "refine.*lie off the lattice", refine=False)
    refused(problem, "colonies", colonies=2)
    with pytest.raises(fp.InvalidInput, match="a plan of another planner"):
        fp.refine(plan)
    with pytest.raises(fp.InvalidInput, match=r"layers and spacing.*larger spacing"):
        fp.plan(problem, fp.LeastFuel(spacing=1e-5))


def test_a_deadline_that_is_too_short_is_an_error_and_a_longer_one_gives_a_plan(problem):
    with pytest.raises(fp.OutOfTime):
        fp.plan(problem, fp.LeastFuel(), time_limit=1e-4)
    assert not fp.plan(problem, fp.LeastFuel(), time_limit=60.0).interrupted


def test_without_time_for_refinement_the_proven_path_of_few_layers_is_returned(
    problem, monkeypatch
):
    def too_late(self, offsets):
        raise OutOfTime("the refinement of a path", "no path")

    monkeypatch.setattr(FuelRefinement, "refined", too_late)
    plan = fp.plan(problem, fp.LeastFuel(margin=0.02))
    assert plan.interrupted
    assert plan.certificate.least_clearance >= 0.02
    assert plan.fuel.change == plan.fuel.lattice_change
    assert plan.fuel.change == pytest.approx(velocity_change(plan.motion.positions), rel=1e-9)
    assert least_sampled(plan)[0] >= 0.02
    assert plan.verify().ok
    with pytest.raises(OutOfTime):  # corners between the layers of the problem's lattice
        fp.plan(problem, fp.LeastFuel(layers=9))
