"""Plans: what they hold, the continuous motion, verification, saving and loading."""

import json
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ffsr_plan as fp
from ffsr_plan.core import rotations
from ffsr_plan.core.arrays import frozen
from ffsr_plan.problem.objective import path_length
from ffsr_plan.robots.robot import robot_from_urdf
from tests.helpers.builders import random_configuration, random_robot, random_scene


@pytest.fixture(scope="module")
def experiment():
    """The paper's experiment, 20 seeds for each delta."""
    scenarios = [fp.Scenario.load(name) for name in ("fig2a", "fig2b")]
    return {
        s.problem.delta: [fp.plan(s.problem, s.planner, seed, refine=False) for seed in range(20)]
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
    """Fig. 2: mean clearance over 20 seeds, delta = 6 against delta = 2."""
    mean = {d: np.mean([p.clearances.mean() for p in plans]) for d, plans in experiment.items()}
    assert mean[6.0] > mean[2.0]


def test_the_papers_experiment_has_to_bend_and_has_more_than_one_way_round(experiment):
    for plan in experiment[6.0] + experiment[2.0]:
        assert np.abs(plan.nodes).max() > 10
        walked = plan.trails.tail[plan.trails.layer == 12] - 40
        assert walked.min() < -10  # below the first sphere
        assert walked.max() > 10  # and above


def test_full_verification_of_one_plan(fig2a_plan):
    report = fig2a_plan.verify()
    assert report.ok
    assert report.samples >= 40 * 2000
    assert report.clearance_error < 1e-12
    assert report.objective_error < 1e-12
    assert report.least_self_separation > 0.0


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


def test_the_motion_passes_through_the_configurations_and_joins_up(fig2a_plan):
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


def moved(plan, **changes):
    """A forged plan."""
    return replace(plan, **changes)


@pytest.mark.parametrize("mode", ["free-flying", "attitude-held"])
@pytest.mark.parametrize("divisions", [2, 3])
def test_momentum_is_summed_sharply_where_arms_move_far_on_few_edges(mode, divisions):
    for seed in (7, 15, 16, 20):
        robot = random_robot(seed)
        ends = (robot.assemble(np.array([x, 0.0, 0.0]), rotations.IDENTITY, np.full(robot.nd, v))
                for x, v in ((0.0, -2.9), (6.0, 2.9)))  # fmt: skip
        robot.collision_model.removeAllCollisionPairs()
        problem = fp.Problem(robot, fp.Scene(), *ends, mode, fp.Lattice(divisions))
        report = fp.plan(problem, fp.LatticeOptimum(), refine=False).verify(5)
        error = report.wheel_momentum_error if mode != "free-flying" else report.momentum_residual
        assert error < 1e-9


def test_verification_notices_an_obstacle_that_the_planner_did_not_see(fig2a_plan):
    problem = fig2a_plan.problem
    in_the_way = fig2a_plan.at(0.4123)[:3] + np.array([0.0, 0.0, 0.3])
    scene = fp.Scene(
        np.vstack([problem.scene.centers, in_the_way]), np.append(problem.scene.radii, 0.1)
    )
    report = moved(fig2a_plan, problem=with_changes(problem, scene=scene)).verify(200)
    assert not report.ok
    assert "inside an obstacle" in " ".join(report.problems)


def test_verification_notices_a_base_that_does_not_react(fig2a_plan):
    """The plan of a held attitude, passed off as a free-flying one."""
    held = with_changes(fig2a_plan.problem, mode="attitude-held")
    plan = fp.plan(held, fp.AntSystem(), seed=0, refine=False)
    forged = replace(plan, problem=fig2a_plan.problem)
    forged.__dict__["motion"] = plan.motion
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
    shifted = np.array(fig2a_plan.configurations)
    shifted[:, 0] += 0.01
    report = moved(fig2a_plan, configurations=frozen(shifted)).verify(20)
    assert "the motion does not begin at the start" in report.problems
    assert "the motion does not end at the goal" in report.problems


def with_changes(problem, **changes):
    names = ("robot", "scene", "start", "goal", "mode", "lattice", "delta", "length_unit")
    return fp.Problem(**{name: getattr(problem, name) for name in names} | changes)


def test_a_saved_plan_loads_bit_for_bit(fig2a_plan, tmp_path):
    fig2a_plan.save(tmp_path / "plan.json")
    loaded = fp.Plan.load(tmp_path / "plan.json")
    assert loaded == fig2a_plan
    assert loaded.seconds == fig2a_plan.seconds
    assert np.array_equal(loaded.configurations, fig2a_plan.configurations)
    assert np.array_equal(loaded.at(0.37), fig2a_plan.at(0.37))
    loaded.save(tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == (tmp_path / "plan.json").read_bytes()


def test_a_plan_without_obstacles_saves_and_loads_too(point, tmp_path):
    start, goal = point.configuration(), point.configuration((4, 0, 0))
    lattice = fp.Lattice(4, fp.Axis(1, 0.5), fp.Axis(2, 0.5))
    plan = fp.plan(fp.Problem(point, fp.Scene(), start, goal, lattice=lattice))
    plan.save(tmp_path / "plan.json")
    assert fp.Plan.load(tmp_path / "plan.json") == plan
    assert plan.verify(10).ok
    assert plan.nodes.shape == (5, 2)


def test_a_plan_file_cut_short_is_refused(fig2a_plan, tmp_path):
    path = tmp_path / "plan.json"
    fig2a_plan.save(path)
    path.write_text(path.read_text()[:-2000])
    with pytest.raises(fp.InvalidInput, match="cut short"):
        fp.Plan.load(path)


@pytest.mark.parametrize("key", ["length", "configurations", "problem"])
def test_an_edited_plan_file_is_refused(fig2a_plan, tmp_path, key):
    path = tmp_path / "plan.json"
    fig2a_plan.save(path)
    data = json.loads(path.read_text())
    if key == "length":
        data["length"] += 1e-9
    elif key == "configurations":
        data["configurations"][3][0] += 1e-9
    else:
        data["problem"]["scene"]["radii"][0] *= 0.5
    path.write_text(json.dumps(data))
    with pytest.raises(fp.InvalidInput, match="digest"):
        fp.Plan.load(path)


def test_a_file_that_is_no_plan_is_refused(tmp_path):
    for text in ("[1, 2]", "{}", '{"format": "ffsr-plan/99"}'):
        (tmp_path / "plan.json").write_text(text)
        with pytest.raises(fp.InvalidInput, match="format 'ffsr-plan/3'"):
            fp.Plan.load(tmp_path / "plan.json")
    with pytest.raises(fp.InvalidInput, match="FileNotFoundError"):
        fp.Plan.load(tmp_path / "missing.json")


def resigned(path, change):
    """Change a plan file and give it a digest that fits, as only a forger would."""
    from ffsr_plan.planning.plan_file import _digest

    data = json.loads(path.read_text())
    data.pop("sha256")
    change(data)
    path.write_text(json.dumps({"sha256": _digest(data), **data}))


@pytest.mark.parametrize(
    "change",
    [
        lambda d: d["configurations"].pop(),
        lambda d: d.update(configurations=[]),
        lambda d: d.update(clearances=d["clearances"][:3]),
        lambda d: d["nodes"].pop(),
        lambda d: d["problem"]["lattice"].update(divisions=41),
        lambda d: d.update(length="a"),
        lambda d: d["planner"].update(name="ants"),
        lambda d: d.pop("history"),
    ],
)
def test_a_malformed_plan_file_is_refused_even_with_a_fitting_digest(fig2a_plan, tmp_path, change):
    fig2a_plan.save(tmp_path / "plan.json")
    resigned(tmp_path / "plan.json", change)
    with pytest.raises(fp.InvalidInput):
        fp.Plan.load(tmp_path / "plan.json")


FORGED = [
    (lambda d: d.update(seed="x"), "seed of the plan: got 'x'"),
    (lambda d: d.update(seed=-1), "seed of the plan: got -1"),
    (lambda d: d.update(seed=True), "seed of the plan: got True"),
    (lambda d: d.update(interrupted="no"), "interrupted of the plan"),
    (lambda d: d["certificate"].update(edges_free=-1), "edges_free: got -1"),
    (lambda d: d["certificate"].update(edges_refused=1.5), "edges_refused: got 1.5"),
    (lambda d: d["certificate"].update(node_queries="3"), "node_queries: got '3'"),
    (lambda d: d["certificate"].update(edge_queries=-2), "edge_queries: got -2"),
    (lambda d: d["certificate"].update(least_clearance=-0.5), "least_clearance: got -0.5"),
    (lambda d: d["nodes"].__setitem__(3, 999), "nodes of the plan, lateral: got 999"),
    (
        lambda d: d["problem"]["robot"].update(disabled_pairs=[["base", "left_link_2"]]),
        "disabled_pairs of the plan.*those of its SRDF",
    ),
    (
        lambda d: d["problem"]["robot"]["replacements"].append({"link": "base"}),
        "replacements of the plan.*those of its URDF",
    ),
]


@pytest.mark.parametrize(("change", "message"), FORGED)
def test_figures_that_no_planner_gives_are_refused_even_with_a_fitting_digest(
    fig2a_plan, tmp_path, change, message
):
    fig2a_plan.save(tmp_path / "plan.json")
    resigned(tmp_path / "plan.json", change)
    with pytest.raises(fp.InvalidInput, match=message):
        fp.Plan.load(tmp_path / "plan.json")


@pytest.mark.parametrize("lattice", [fp.Lattice(4), fp.Lattice(4, postures=[
    fp.PostureAxis({"left_1": 1.0}, 2, 0.1)])])  # fmt: skip
def test_nodes_lie_within_the_lattice(robot, tmp_path, lattice):
    goal = robot.configuration((4, 0, 0))
    plan = fp.plan(fp.Problem(robot, fp.Scene(), robot.neutral(), goal, lattice=lattice))
    path = tmp_path / "plan.json"
    plan.save(path)
    assert fp.Plan.load(path) == plan
    resigned(path, lambda d: d["nodes"].__setitem__(2, 3))
    with pytest.raises(fp.InvalidInput, match=r"nodes of the plan.*got 3"):
        fp.Plan.load(path)


@pytest.mark.parametrize(
    "text", ['{"format": "ffsr-plan/3", "a": NaN}', "[" * 100_000, '{"a": ' + "1" * 5001 + "}"]
)
def test_hostile_json_is_refused(tmp_path, text):
    (tmp_path / "plan.json").write_text(text)
    with pytest.raises(fp.InvalidInput):
        fp.Plan.load(tmp_path / "plan.json")


def test_verification_notices_a_proof_that_claims_too_much(fig2a_plan):
    certificate = fig2a_plan.certificate._replace(least_clearance=9.0)
    report = moved(fig2a_plan, certificate=certificate).verify(50)
    assert "said to be proven" in " ".join(report.problems)


def test_certificates_count_every_edge_of_the_path_and_nothing_below_zero(robot, point):
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


def test_verification_does_not_depend_on_the_order_of_links_in_the_urdf(robot):
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
