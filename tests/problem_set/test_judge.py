"""The judge: what solves a problem is accepted, and nothing else."""

import json
from dataclasses import replace

import jsonschema
import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.problem_set.judging.figures import figures_of
from ffsr_plan.problem_set.judging.judged_folder import judge_folder
from ffsr_plan.problem_set.judging.result_files import read_judged, read_results
from ffsr_plan.problem_set.judging.schemas import SCHEMAS

FLYING, FLOATING, MOVING = "paper/03", "remounted/00", "moving/00"


def with_fields(given, **changes):
    """A trajectory with some of its fields changed."""
    fields = {
        "times": given.times,
        "joints": dict(given.joints),
        "base_positions": given.base_positions,
        "base_attitudes": given.base_attitudes,
        "interpolation": given.interpolation,
    } | changes
    return fp.Trajectory(fields.pop("times"), fields.pop("joints"), **fields)


def straight(problem):
    """The straight motion of base and joints."""
    names = problem.robot.joint_names
    ends = np.stack([problem.robot.joint_values(q) for q in (problem.start, problem.goal)])
    return fp.Trajectory.of_array(
        [0.0, 100.0], ends, names, base_positions=np.stack([problem.start[:3], problem.goal[:3]])
    )


def test_the_way_through_an_obstacle_is_refused(problems):
    verdict = fp.judge(problems[FLYING], straight(problems[FLYING].problem))
    assert not verdict.accepted
    assert verdict.reason.startswith("in contact at")
    assert verdict.objective is None


def test_another_goal_is_refused(problems, best):
    given = best.trajectory(FLYING)
    joints = {name: np.array(values) for name, values in given.joints.items()}
    joints["left_1"][-1] += 0.002
    verdict = fp.judge(problems[FLYING], with_fields(given, joints=joints, base_attitudes=None))
    assert not verdict.accepted
    assert "joints 0.002 away from the goal" in verdict.reason
    places = np.array(given.base_positions)
    places[-1, 1] += 0.002
    moved = with_fields(given, base_positions=places)
    assert "base origin [m] 0.002 away" in fp.judge(problems[FLYING], moved).reason


def test_another_start_is_refused(problems, best):
    given = best.trajectory(FLYING)
    places = np.array(given.base_positions)
    places[0, 1] += 1e-3
    verdict = fp.judge(problems[FLYING], with_fields(given, base_positions=places))
    assert "away from the start" in verdict.reason


def test_a_base_stated_at_rest_is_refused_where_it_reacts(problems, best):
    given = best.trajectory(FLOATING)
    plain = with_fields(given, base_positions=None, base_attitudes=None)
    assert fp.judge(problems[FLOATING], plain).accepted
    count = len(given.times)
    still = np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))
    turned = fp.judge(problems[FLOATING], with_fields(plain, base_attitudes=still))
    assert not turned.accepted
    assert "from where its arms turn it" in turned.reason
    moved = fp.judge(problems[FLOATING], with_fields(plain, base_positions=np.zeros((count, 3))))
    assert "from where momentum takes it" in moved.reason


def test_an_attitude_that_is_demanded_has_to_be_reached(problems):
    """The straight motion is free where there are no obstacles, and turns the base otherwise."""
    given = problems["attitudes/00"]
    tables = {key: table for key, table in given.scenario.items() if key != "obstacles"}
    alone = replace(given, scenario=tables, spheres_sha256="")
    verdict = fp.judge(alone, straight(alone.problem))
    assert not verdict.accepted
    assert verdict.reason.startswith("base attitude [rad]")
    del tables["goal"]["attitude"]
    assert fp.judge(replace(alone, scenario=tables), straight(alone.problem)).accepted


def test_another_duration_is_refused_among_moving_bodies(problems, best):
    given = best.trajectory(MOVING)
    slow = with_fields(given, times=1.1 * given.times)
    assert "200 s is asked" in fp.judge(problems[MOVING], slow).reason


def test_a_base_outside_its_window_is_refused(problems, best):
    name = next(n for n in problems.names("traps") if best.get(n) and best.get(n).sha256)
    given = problems[name]
    tables = json.loads(json.dumps(given.scenario))
    path = best.trajectory(name).base_positions
    high = path.max(axis=0)
    low = np.minimum(path.min(axis=0) - 1.0, high)
    low[1] = min(0.0, path[:, 1].min() + 0.05)
    if path[:, 1].min() > -0.06:  # the path goes left
        low[1], high[1] = -5.0, path[:, 1].max() - 0.05
    tables["window"] = {"low": low.tolist(), "high": high.tolist()}
    verdict = fp.judge(replace(given, scenario=tables), best.trajectory(name))
    assert "leaves its window" in verdict.reason


def test_unknown_joints_and_degrees_are_refused_with_the_reason(problems, best):
    given = best.trajectory(FLOATING)
    joints = dict(given.joints)
    joints["panda_joint9"] = joints.pop("panda_joint1")
    assert "panda_joint9" in fp.judge(problems[FLOATING], with_fields(given, joints=joints)).reason
    degrees = {name: np.degrees(values) for name, values in given.joints.items()}
    reason = fp.judge(problems[FLOATING], with_fields(given, joints=degrees)).reason
    assert ("panda_joint" in reason and "limit" in reason) or "to" in reason


def test_figures_do_not_depend_on_how_a_path_is_written(problems, best):
    given = best.trajectory(FLYING)
    times = np.union1d(given.times, 0.5 * (given.times[1:] + given.times[:-1]))
    joints = {name: np.interp(times, given.times, v) for name, v in given.joints.items()}
    places = np.column_stack([np.interp(times, given.times, c) for c in given.base_positions.T])
    finer = fp.Trajectory(times, joints, base_positions=places)
    one, other = fp.judge(problems[FLYING], given), fp.judge(problems[FLYING], finer)
    assert other.length == pytest.approx(one.length, rel=1e-9)
    assert other.objective == pytest.approx(one.objective, rel=1e-6)
    assert other.delta_v == pytest.approx(one.delta_v, rel=0.05)


def test_velocity_change_of_a_straight_flight_is_twice_its_speed(problems):
    problem = problems[FLYING].problem
    robot = problem.robot
    goal = robot.assemble(problem.goal[:3], problem.start[3:7], robot.joint_values(problem.start))
    only = fp.Problem(robot, fp.Scene(), problem.start, goal)
    report = fp.certify(robot, fp.Scene(), straight(only), "free-flying")
    found = figures_of(only, report)
    assert found.delta_v == pytest.approx(2.0 * 10.0 / 100.0, rel=1e-9)
    assert found.length == pytest.approx(10.0)
    assert found.clearance == np.inf


def test_a_folder_of_results_is_judged_row_by_row(problems, best, submitted):
    folder = submitted(
        {FLYING: best.trajectory(FLYING), FLOATING: straight(problems[FLOATING].problem)}
    )
    (folder / "broken.csv").write_text("time [s],left_1\n0,x\n")
    data = json.loads((folder / "results.json").read_text())
    data["results"] += [
        {"problem": "traps/01", "trajectory": "broken.csv", "seconds": 1.0},
        {"problem": "traps/02", "trajectory": "missing.csv", "seconds": 1.0},
        {"problem": "traps/03", "trajectory": None, "seconds": 9.0, "reason": "out of time"},
    ]
    (folder / "results.json").write_text(json.dumps(data))
    judged = judge_folder(folder, problems)
    assert [row.accepted for row in judged.rows] == [True, False, False, False, False]
    assert judged.rows[0].curve == ((0.5, judged.rows[0].objective),)
    assert "broken.csv" in judged.rows[2].reason
    assert "missing.csv" in judged.rows[3].reason
    assert judged.rows[4].reason == "out of time"
    assert read_judged(folder) == judged


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"format": "results"}, "format"),
        ({"set_version": "0"}, "version 1"),
        ({"results": {}}, "a list"),
        ({"results": [{"problem": "paper/03"}]}, "trajectory"),
        ({"results": [{"problem": "paper/03", "trajectory": None, "seconds": -1}]}, "seconds"),
        ({"results": [{"problem": "pappe", "trajectory": None, "seconds": 1}]}, "pappe"),
        ({"results": [{"problem": "p", "trajectory": None, "seconds": 1, "note": 1}]}, "note"),
        ({"results": [{"problem": "p", "trajectory": None, "seconds": 1, "curve": [1]}]}, "curve"),
    ],
)
def test_wrong_result_files_are_refused_by_name(problems, submitted, change, named):
    with pytest.raises(fp.InvalidInput, match=named):
        judge_folder(submitted({}, **change), problems)


def test_results_hold_to_the_published_schema(submitted, best):
    folder = submitted({FLYING: best.trajectory(FLYING)})
    jsonschema.validate(json.loads((folder / "results.json").read_text()), SCHEMAS["results"]())
    assert read_results(folder).planner == "theirs"
