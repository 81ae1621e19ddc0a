"""Verification finds what is wrong with a plan."""

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.collision.distances import SelfQuery
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import frozen
from ffsr_plan.robots.loading import robot_from_urdf
from tests.helpers.urdf_builders import random_robot


def test_full_verification_of_one_plan(fig2a_plan):
    report = fig2a_plan.verify()
    assert report.ok
    assert report.samples >= 40 * 50 + 1
    assert report.largest_gap == 0.0
    assert report.clearance_bound > fig2a_plan.certificate.least_clearance - 1e-6
    assert report.clearance_bound <= report.least_clearance
    assert report.clearance_error < 1e-12
    assert report.objective_error < 1e-12


@pytest.mark.parametrize("name", ["fig2a", "fig2b", "inspection", "gate"])
def test_the_least_distance_of_links_is_that_of_coal_over_the_same_samples(name):
    problem = fp.load_scenario(name)
    settings = {} if problem.lattice.postures else {"planner": "lattice-optimum", "refine": False}
    plan = fp.plan(problem, **settings)
    report, m = plan.verify(20), problem.lattice.divisions
    edges, times = np.repeat(np.arange(m), 21), np.tile(np.arange(21) / 20.0, m)
    query = SelfQuery(problem.robot)
    least = min(query.distance(q) for q in plan.motion.at(edges, times))
    assert report.samples >= 20 * m + 1
    assert least - 5e-3 < report.least_self_separation < least + 1e-7
    if report.samples == 20 * m + 1:
        assert report.least_self_separation == pytest.approx(least, abs=1e-7)


def moved(plan, **changes):
    """A forged plan."""
    return replace(plan, **changes)


@pytest.mark.parametrize("mode", ["free-flying", "attitude-held"])
@pytest.mark.parametrize("divisions", [2, 3])
def test_momentum_is_sharp_where_arms_move_far_on_few_edges(mode, divisions):
    for seed in (7, 15, 16, 20):
        robot = random_robot(seed)
        ends = (robot.assemble(np.array([x, 0.0, 0.0]), rotations.IDENTITY, np.full(robot.nd, v))
                for x, v in ((0.0, -2.9), (6.0, 2.9)))  # fmt: skip
        robot.collision_model.removeAllCollisionPairs()
        problem = fp.Problem(robot, fp.Scene(), *ends, mode, fp.Lattice(divisions))
        report = fp.plan(problem, fp.LatticeOptimum(), refine=False).verify(5)
        error = report.wheel_momentum_error if mode != "free-flying" else report.momentum_residual
        assert error < 1e-9


def test_verification_finds_an_obstacle_unknown_to_planning(fig2a_plan):
    problem = fig2a_plan.problem
    in_the_way = fig2a_plan.at(0.4123)[:3] + np.array([0.0, 0.0, 0.3])
    scene = fp.Scene(
        np.vstack([problem.scene.centers, in_the_way]), np.append(problem.scene.radii, 0.1)
    )
    report = moved(fig2a_plan, problem=with_changes(problem, scene=scene)).verify(200)
    assert not report.ok
    assert "inside an obstacle" in " ".join(report.problems)
    assert " -" not in " ".join(report.problems)  # no negative distances


def test_verification_notices_a_base_that_does_not_react(fig2a_plan):
    """The plan of a held attitude, passed off as a free-flying one."""
    held = with_changes(fig2a_plan.problem, mode="attitude-held")
    plan = fp.plan(held, fp.AntSystem(), seed=0, refine=False)
    forged = replace(plan, problem=fig2a_plan.problem)
    report = forged.verify(50)
    assert report.momentum_residual > 1e-3
    assert not report.ok


@pytest.mark.parametrize(
    ("field", "change", "complaint"),
    [
        ("length", lambda v: v * 1.001, "the length is"),
        ("objective", lambda v: v * 0.999, "F is"),
        ("clearances", lambda v: frozen(v + 1e-6), "node clearances differ"),
    ],
)
def test_verification_notices_wrong_figures(fig2a_plan, field, change, complaint):
    forged = moved(fig2a_plan, **{field: change(getattr(fig2a_plan, field))})
    report = forged.verify(20)
    assert not report.ok
    assert complaint in " ".join(report.problems)


def test_verification_notices_a_wrong_start_and_goal(fig2a_plan):
    shifted = fig2a_plan.motion.displaced(np.array([0.01, 0.0, 0.0]))
    report = replace(fig2a_plan, motion=shifted).verify(20)
    assert "the motion does not begin at the start" in report.problems
    assert "the motion does not end at the goal" in report.problems


def with_changes(problem, **changes):
    names = ("robot", "scene", "start", "goal", "mode", "lattice", "delta", "length_unit")
    return fp.Problem(**{name: getattr(problem, name) for name in names} | changes)


def test_verification_notices_a_proof_that_claims_too_much(fig2a_plan):
    certificate = fig2a_plan.certificate._replace(least_clearance=9.0)
    report = moved(fig2a_plan, certificate=certificate).verify(50)
    assert "the plan's proven clearance is" in " ".join(report.problems)


def test_verification_ignores_the_order_of_links_in_the_urdf(robot):
    """Pinocchio lists shapes along the tree, the re-check as they stand in the file."""
    root = ElementTree.fromstring(robot.urdf)
    links = root.findall("link")
    for element in links:
        root.remove(element)
    root.extend(reversed(links))
    shuffled = robot_from_urdf(ElementTree.tostring(root, encoding="unicode"), "shuffled")
    original = fp.load_scenario("fig2b")
    plans = [
        fp.plan(with_changes(original, robot=r), fp.LatticeOptimum(), refine=False)
        for r in (robot, shuffled)
    ]
    reports = [plan.verify(50) for plan in plans]
    assert all(report.ok for report in reports)
    assert reports[0].least_self_separation == pytest.approx(reports[1].least_self_separation)


def test_verification_notices_arms_that_pass_through_each_other(robot):
    """A robot whose self-collision pairs got lost plans through itself; the check has its own."""
    careless = robot_from_urdf(robot.urdf, "careless")
    careless.collision_model.removeAllCollisionPairs()
    names = robot.joint_names
    begin, end = (-1.6, -1.0, -0.4, 0.9, 1.9, 1.0), (-1.6, -1.5, -0.7, 1.0, -0.6, 0.6)
    start = robot.configuration(joints=dict(zip(names, begin, strict=True)))
    goal = robot.configuration((6, 0, 0), joints=dict(zip(names, end, strict=True)))
    problem = fp.Problem(careless, fp.Scene(), start, goal,
                         lattice=fp.Lattice(8, fp.Axis(2, 0.3)))  # fmt: skip
    report = fp.plan(problem, fp.LatticeOptimum()).verify(100)
    assert not report.ok
    assert "two links touch" in " ".join(report.problems)


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"lattice_objective": 1.001}, "F on the lattice is"),
        ({"optimum": 0.0}, "the optimum is below F of any path"),
    ],
)
def test_verification_notices_wrong_figures_of_the_lattice(fig2a_plan, changes, complaint):
    changed = {name: getattr(fig2a_plan, name) * factor for name, factor in changes.items()}
    report = replace(fig2a_plan, **changed).verify(5)
    assert complaint in " ".join(report.problems)


@pytest.fixture(scope="module")
def small_plans():
    """One on the lattice, one refined, of a problem whose optimum is not straight."""
    robot = fp.load_robot("planar_dual_arm")
    problem = fp.Problem(
        robot, fp.Scene([[2.0, 0.3, 0.0]], [0.2]), robot.configuration(),
        robot.configuration((4.0, 0.0, 0.0)), lattice=fp.Lattice(8, fp.Axis(8, 0.25)), delta=0.5,
    )  # fmt: skip
    return [fp.plan(problem, fp.LatticeOptimum(), refine=refine) for refine in (False, True)]


@pytest.mark.parametrize("which", [0, 1])
def test_nodes_that_contradict_the_figures_are_noticed(small_plans, which):
    plan = small_plans[which]
    assert plan.verify(5).ok
    for layer in (1, 4, 8):
        nodes = np.array(plan.nodes)
        nodes[layer] += 1
        assert not replace(plan, nodes=frozen(nodes)).verify(5).ok


def test_a_base_outside_the_window_is_noticed(small_plans):
    plan = small_plans[1]
    offsets = np.zeros((9, 3))
    offsets[4, 2] = 0.01
    report = replace(plan, motion=plan.motion.displaced(offsets)).verify(5)
    assert "the base leaves the window of the lattice" in report.problems


def test_an_exact_planner_whose_path_is_not_the_optimum_is_noticed(small_plans):
    report = replace(small_plans[0], optimum=small_plans[0].optimum * 0.99).verify(5)
    assert "the optimum is not F of the exact planner's own path" in report.problems


def test_a_report_says_what_it_did_not_check(small_plans):
    told = " ".join(small_plans[1].verify(5).not_checked)
    assert "optimum" in told
    assert "history" in told
    assert "the refined one was checked" in told
    assert "the refined one" not in " ".join(small_plans[0].verify(5).not_checked)


def test_a_claim_beyond_the_true_clearance_is_not_confirmed(small_plans):
    plan = small_plans[1]
    true = plan.verify(500).least_clearance
    for claim, fine in ((true - 1e-3, True), (true + 1e-5, False), (0.0, True)):
        certificate = plan.certificate._replace(least_clearance=claim)
        assert replace(plan, certificate=certificate).verify(3).ok == fine


def test_a_plan_far_from_the_origin_is_the_same_plan(robot):
    figures = []
    for far in (0.0, 98_765.0):
        place = np.array([far, -far, 0.3 * far])
        start = robot.configuration(place)
        goal = robot.configuration(place + np.array([3.0, 0.0, 0.0]), joints={"left_1": 1.0})
        for mode in ("free-flying", "attitude-held", "free-floating"):
            end = robot.assemble(start[:3] if mode == "free-floating" else goal[:3],
                                 goal[3:7], goal[7:])  # fmt: skip
            scene = fp.Scene([place + np.array([1.5, 2.0, 0.1])], [0.2])
            problem = fp.Problem(robot, scene, start, end, mode, fp.Lattice(10), delta=0.1)
            report = fp.plan(problem).verify()
            assert report.ok, (far, mode, report.problems)
            figures.append((report.least_clearance, report.least_self_separation))
    assert np.allclose(figures[:3], figures[3:], atol=1e-9)


def test_progress_is_told_up_to_the_end(small_plans):
    told = []
    small_plans[0].verify(2000, told.append)
    assert len(told) > 5
    assert told == sorted(told)
    assert told[-1] == 1.0
    with pytest.raises(fp.InvalidInput, match="samples"):
        small_plans[0].verify(10**8)
