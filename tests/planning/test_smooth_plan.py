"""`Plan.smooth`: start, goal, attitude and figures of smooth plans of the bundled scenarios."""

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.core.rotations import angle_between
from tests.helpers.dense_curve import flown
from tests.helpers.dense_flight import least_gap

PLANNED = {
    "fig2a": {},
    "gate": {},
    "double_gate": {},
    "reach": {"until": "first"},
    "cup": {"until": "first"},
    "tuck": {"until": "first"},
}


@pytest.fixture(scope="module", params=list(PLANNED))
def plan(request):
    problem, options = fp.load_scenario(request.param), PLANNED[request.param]
    return fp.plan(problem, seed=0, **options)


def test_smooth_plans_keep_start_and_goal_and_touch_nothing(plan):
    smooth = plan.smooth()
    first, last = smooth.at([0.0, 1.0])
    assert first == pytest.approx(plan.configurations[0], abs=1e-12)
    robot, goal = plan.problem.robot, plan.configurations[-1]
    assert robot.joint_values(last) == pytest.approx(robot.joint_values(goal), abs=1e-12)
    if plan.problem.mode.has_thrusters:
        assert last[:3] == pytest.approx(goal[:3], abs=1e-12)
    if plan.problem.reach_attitude:
        assert smooth.arrival_attitude_error < 1e-8
        assert angle_between(last[3:7], plan.problem.goal[3:7]) < 1e-6
    else:
        assert smooth.arrival_attitude_error is None
    path = flown(plan.problem, smooth.curve.motion.control, 40 * smooth.curve.pieces)
    s = np.linspace(0.0, 1.0, len(path))
    assert smooth.at(s) == pytest.approx(path, abs=1e-6)
    gap, touching = least_gap(plan, path)
    assert not touching
    least = smooth.certificate.least_clearance
    assert 0.0 < least <= gap + 1e-9
    assert smooth.kind in ("spline", "refined spline")


def test_smooth_plans_are_the_same_every_time(plan):
    first, again = plan.smooth(), plan.smooth()
    s = np.linspace(0.0, 1.0, 50)
    assert np.array_equal(first.at(s), again.at(s))
    assert first.certificate == again.certificate
    assert (first.length, first.objective) == (again.length, again.objective)


def test_figures_of_a_smooth_plan_are_those_of_its_curve(fig2a_plan):
    smooth = fig2a_plan.smooth()
    assert smooth.kind == "spline"
    assert 0.9 * fig2a_plan.length < smooth.length < fig2a_plan.length
    m = fig2a_plan.edges
    assert np.array_equal(smooth.nodes, np.arange(m + 1.0))
    inner = smooth.curve.at(smooth.nodes[1:-1]).configurations
    problem = fig2a_plan.problem
    gaps = np.array([float(fp.clearance(problem.robot, problem.scene, q)) for q in inner])
    assert smooth.clearances[1:-1] == pytest.approx(gaps, abs=1e-9)
    terms = problem.delta * problem.length_unit / np.minimum(gaps, problem.clearance_cap or np.inf)
    wanted = smooth.length / problem.length_unit + terms.sum()
    assert smooth.objective == pytest.approx(wanted, rel=1e-9)
    s = np.linspace(0.0, 1.0, 200 * m + 1)
    q = smooth.at(s)
    ways = problem.position_weight * np.diff(q[:, :3], axis=0)
    turns = problem.rotation_weight * np.diff(problem.robot.joint_values(q), axis=0)
    polyline = np.sqrt(np.sum(ways**2, axis=1) + np.sum(turns**2, axis=1)).sum()
    assert smooth.length == pytest.approx(polyline, rel=1e-5)
    counts = smooth.certificate
    assert (counts.edges_free, counts.edges_refused) == (m, 0)
    assert counts.node_queries >= m + 1
    assert counts.edge_queries >= 0
    assert "spline, L " in repr(smooth)
    assert "proven along the motion" in smooth._repr_html_()


def test_lengths_without_a_lattice_count_the_turn_by_wheels(robot):
    start = robot.configuration((0, 0, 0))
    goal = robot.configuration((1, 0, 0), (0.5, 0, 0))
    problem = fp.Problem(robot, fp.Scene(), start, goal, "attitude-held", rotation_weight=2.0)
    plan = fp.plan(problem, until="first")
    smooth = plan.smooth()
    assert smooth.length == pytest.approx(plan.length, rel=1e-9)
    assert smooth.length == pytest.approx(np.hypot(1.0, 2.0 * 0.5), rel=1e-9)
    assert smooth.certificate.edge_queries >= 0
    assert smooth.certificate.least_clearance == np.inf


@pytest.mark.parametrize("wrong", [-0.1, 1.1, np.nan, [0.0, 2.0]])
def test_parameters_outside_are_refused(fig2a_plan, wrong):
    with pytest.raises(fp.InvalidInput, match="s"):
        fig2a_plan.smooth().at(wrong)
