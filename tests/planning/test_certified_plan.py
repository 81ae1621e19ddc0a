"""Plans: figures of merit, the continuous motion, the paper's experiment."""

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.problem.objective import path_length
from tests.helpers.sample_sizes import sample
from tests.helpers.urdf_builders import random_configuration, random_robot, random_scene

SEEDS = sample(6, 20)


@pytest.fixture(scope="module")
def experiment():
    """The paper's experiment, some seeds for each delta."""
    scenarios = [fp.Scenario.load(name) for name in ("fig2a", "fig2b")]
    return {
        s.problem.delta: [
            fp.plan(s.problem, s.planner, seed, refine=False) for seed in range(SEEDS)
        ]
        for s in scenarios
    }


@pytest.mark.parametrize("delta", [6.0, 2.0])
def test_every_plan_of_the_papers_experiment_verifies(experiment, delta):
    for plan in experiment[delta]:
        report = plan.verify(200)
        assert report.ok, report.problems
        assert report.momentum_residual <= 1e-9
        assert plan.certificate.least_clearance > 0.0
        assert report.least_clearance >= plan.certificate.least_clearance


def test_a_larger_delta_keeps_farther_from_the_obstacles(experiment):
    """Fig. 2: mean clearance over the seeds, delta = 6 against delta = 2."""
    mean = {d: np.mean([p.clearances.mean() for p in plans]) for d, plans in experiment.items()}
    assert mean[6.0] > mean[2.0]


def test_the_papers_experiment_has_several_curved_paths(experiment):
    for plan in experiment[6.0] + experiment[2.0]:
        assert np.abs(plan.nodes).max() > 10
        walked = plan.trails.tail[plan.trails.layer == 12] - 40
        assert walked.min() < -10  # below the first sphere
        assert walked.max() > 10  # and above


@given(st.integers(0, 10_000))
@settings(max_examples=25)
def test_plans_of_random_robots_verify_in_both_modes(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    start = random_configuration(robot, rng, spread=0.0)
    goal = np.array(random_configuration(robot, rng, spread=0.2))
    goal[:3] += rng.normal(size=3)
    goal[0] += 6.0
    mode = ("free-flying", "attitude-held")[seed % 2]
    problem = fp.Problem(
        robot, random_scene(rng, 4), start, goal, mode=mode, delta=0.5,
        lattice=fp.Lattice(8, fp.Axis(3, 0.4), fp.Axis(1, 0.5) if seed % 3 else None),
    )  # fmt: skip
    try:
        plan = fp.plan(problem, fp.AntSystem(ants=5, cycles=3), seed)
    except fp.PlanningError:
        return
    report = plan.verify(100)
    assert report.ok, report.problems
    if mode == "free-flying":
        assert report.momentum_residual < 1e-9


def test_the_motion_passes_through_the_configurations(fig2a_plan):
    m = fig2a_plan.problem.lattice.divisions
    assert np.allclose(fig2a_plan.at(np.arange(m + 1) / m), fig2a_plan.configurations, atol=1e-12)
    before = fig2a_plan.at((np.arange(1, m)) / m - 1e-9)
    after = fig2a_plan.at((np.arange(1, m)) / m + 1e-9)
    assert np.allclose(before, after, atol=1e-6)


def test_at_takes_numbers_and_arrays_of_any_shape(fig2a_plan):
    nq = fig2a_plan.problem.robot.model.nq
    assert fig2a_plan.at(0.3).shape == (nq,)
    assert fig2a_plan.at(np.zeros((2, 3))).shape == (2, 3, nq)
    assert np.array_equal(fig2a_plan.at([0.3, 0.7])[0], fig2a_plan.at(0.3))


def test_the_base_turns_although_nobody_turned_it(fig2a_plan):
    first, last = fig2a_plan.configurations[[0, -1], 3:7]
    assert rotations.angle_between(first, last) > 0.1
    assert np.allclose(fig2a_plan.arrival_attitude, rotations.to_angles(last))
    assert np.array_equal(fig2a_plan.attitudes, fig2a_plan.motion.attitudes)


def test_the_objective_recomputed_from_scratch_is_the_plans(fig2a_plan):
    problem = fig2a_plan.problem
    along = problem.start[:3] + np.arange(41)[:, None] / 40 * problem.base_displacement
    offsets = fig2a_plan.configurations[:, :3] - along
    assert path_length(problem, offsets) == pytest.approx(fig2a_plan.length, rel=1e-12)
    nearness = 6.0 * np.sum(0.1 / fig2a_plan.clearances[1:-1])
    assert fig2a_plan.objective == pytest.approx(fig2a_plan.length / 0.1 + nearness, rel=1e-12)


def test_nodes_are_offset_indices_with_zero_for_none(fig2a_plan):
    assert fig2a_plan.nodes.shape == (41,)
    assert fig2a_plan.nodes[0] == fig2a_plan.nodes[-1] == 0
    lateral = fig2a_plan.configurations[:, 1]
    assert np.allclose(lateral, 0.075 * fig2a_plan.nodes)


def test_plans_and_problems_cannot_be_changed_by_accident(fig2a_plan):
    for array in (fig2a_plan.configurations, fig2a_plan.clearances, fig2a_plan.nodes,
                  fig2a_plan.problem.start, fig2a_plan.problem.scene.centers):  # fmt: skip
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
    with pytest.raises(AttributeError):
        fig2a_plan.length = 3.0


def test_a_file_that_is_no_plan_is_refused(tmp_path):
    for text in ("[1, 2]", "{}", '{"format": "ffsr-plan/99"}'):
        (tmp_path / "plan.json").write_text(text)
        with pytest.raises(fp.InvalidInput, match="format 'ffsr-plan/3'"):
            fp.Plan.load(tmp_path / "plan.json")
    with pytest.raises(fp.InvalidInput, match="No such file"):
        fp.Plan.load(tmp_path / "missing.json")


def test_certificates_count_every_edge_of_the_path(robot, point):
    empty = fp.Problem(
        robot, fp.Scene(), robot.neutral(), robot.configuration((4, 0, 0)),
        lattice=fp.Lattice(10, fp.Axis(5, 0.2)),
    )  # fmt: skip
    for problem in (empty, fp.load_scenario("fig2b")):
        for planner in (fp.LatticeOptimum(), fp.MaxMinAntSystem(cycles=5), fp.AntSystem(cycles=2)):
            proof = fp.plan(problem, planner).certificate
            assert proof.edges_free >= problem.lattice.divisions
            assert min(proof[:4]) >= 0


def test_a_gap_exists_where_nothing_counts_as_length(robot):
    problem = fp.Problem(
        robot, fp.Scene(), robot.neutral(), robot.configuration(joints={"left_1": 1.0}),
        rotation_weight=0.0, lattice=fp.Lattice(10),
    )  # fmt: skip
    plan = fp.plan(problem)
    assert plan.gap == 0.0
    assert plan.length == 0.0


def test_a_goal_pose_that_the_mode_does_not_lead_to_is_told(robot):
    """The start's pose counts as none given, and a goal of inverse kinematics is reached."""
    lattice, joints = fp.Lattice(4), {"left_1": 0.9}
    start = robot.configuration()
    turned = robot.configuration((1.0, 0.0, 0.0), (1.0, 0.0, 0.0), joints)
    flying = fp.Problem(robot, fp.Scene(), start, turned, lattice=lattice)
    with pytest.warns(fp.GoalPoseIgnored) as told:
        plan = fp.plan(flying)
    angle = rotations.angle_between(plan.motion.attitudes[-1], turned[3:7])
    assert f"attitude is not demanded, and missed by {angle:.3g} rad;" in str(told[0].message)
    afloat = fp.Problem(robot, fp.Scene(), start, turned, "free-floating", lattice)
    with pytest.warns(fp.GoalPoseIgnored, match=r"attitude is .*, its base position is not"):
        fp.plan(afloat)
    quiet = [
        fp.Problem(robot, fp.Scene(), start, turned, "attitude-held", lattice),
        fp.Problem(robot, fp.Scene(), start, plan.motion.configurations()[-1], lattice=lattice),
        fp.Problem(
            robot,
            fp.Scene(),
            start,
            robot.configuration((1, 0, 0), joints=joints),
            lattice=lattice,
        ),
        afloat.reaching("left_3", (0.5, 0.9, 0.0)),
    ]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for problem in quiet:
            fp.plan(problem, "lattice-optimum")
