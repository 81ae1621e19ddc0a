"""The best plans known: judged again, and not below the bounds."""

from dataclasses import replace

import numpy as np
import pytest

import ffsr_plan as fp
from ffsr_plan.problem_set.best_plans import BestPlan, BestPlans
from ffsr_plan.problem_set.making.best_known import adopted, bound_of
from ffsr_plan.problem_set.making.generation import FAMILIES
from ffsr_plan.problem_set.making.rebuilt_plans import verification_faults


def smallest(problems, best, family):
    """Name of the problem of a family whose best plan is the smallest file."""
    known = [name for name in problems.names(family) if (row := best.get(name)) and row.sha256]
    return min(known, key=lambda name: (problems.folder / f"best/{name}.npz").stat().st_size)


@pytest.mark.parametrize("family", FAMILIES)
def test_a_best_plan_of_each_family_is_accepted(problems, best, family):
    name = smallest(problems, best, family)
    row, verdict = best.get(name), fp.judge(problems[name], best.trajectory(name))
    assert verdict.accepted, verdict.reason
    assert verdict.objective == pytest.approx(row.objective, rel=1e-9)
    assert verdict.length == pytest.approx(row.length, rel=1e-9)
    assert verdict.proven_clearance is None or verdict.proven_clearance > 0.0
    assert verdict.clearance is None or verdict.proven_clearance <= verdict.clearance + 1e-9


@pytest.mark.parametrize("family", FAMILIES)
def test_a_best_plan_of_each_family_is_verified_by_other_code(problems, best, family):
    name = smallest(problems, best, family)
    assert verification_faults(problems[name], best.trajectory(name)) == ""


def test_every_best_plan_was_verified(problems, best):
    rows = [row for name in problems.names() if (row := best.get(name)) and row.objective]
    assert [row.problem for row in rows if not row.verified] == []


def test_a_motion_through_an_obstacle_is_not_verified(problems):
    problem = problems["paper/03"].problem
    ends = [problem.robot.joint_values(q) for q in (problem.start, problem.goal)]
    straight = fp.Trajectory.of_array(
        [0.0, 100.0], ends, problem.robot.joint_names,
        base_positions=[problem.start[:3], problem.goal[:3]],
    )  # fmt: skip
    assert "proven free" in verification_faults(problems["paper/03"], straight)


def test_a_motion_that_ends_elsewhere_is_not_verified(problems, best):
    given = best.trajectory("paper/03")
    moved = fp.Trajectory(
        given.times, dict(given.joints), base_positions=given.base_positions * [0.99, 1.0, 1.0]
    )
    assert "goal" in verification_faults(problems["paper/03"], moved)


def test_no_best_plan_falls_below_its_bound(problems, best):
    rows = [best.get(name) for name in problems.names()]
    known = [row for row in rows if row is not None and row.objective is not None]
    assert len(known) > 0.9 * len(problems)
    for row in known:
        assert row.objective >= row.bound * (1.0 - 1e-9), row.problem
        assert row.gap >= -1e-9


def test_bounds_count_the_nearest_of_all_whole_turns(problems):
    problem = problems["reaching/00"].problem
    robot = problem.robot
    values = robot.joint_values(problem.goal)
    away = values.copy()
    k = int(np.argmax(robot.upper - values))
    away[k] += 2.0 * np.pi if values[k] < 0.0 else -2.0 * np.pi
    assert robot.lower[k] <= away[k] <= robot.upper[k]
    turned = fp.Problem(
        robot, problem.scene, problem.start,
        robot.configuration(joints=dict(zip(robot.joint_names, away, strict=True))),
        "free-floating",
    )  # fmt: skip
    assert turned.straight_length > problem.straight_length + 0.1
    assert bound_of(turned)[0] == pytest.approx(bound_of(problem)[0])


def test_a_better_plan_replaces_the_file_and_its_digest(problems, best, tmp_path):
    name = smallest(problems, best, "servicing")
    own, row, given = BestPlans(tmp_path), best.get(name), best.trajectory(name)
    own.put(row, given)
    again = BestPlans(tmp_path)
    assert again.get(name) == row
    assert again.trajectory(name) == given
    slower = fp.Trajectory(
        2.0 * given.times, dict(given.joints),
        base_positions=given.base_positions, base_attitudes=given.base_attitudes,
    )  # fmt: skip
    own.put(row, slower)
    assert own.get(name).sha256 != row.sha256
    assert BestPlans(tmp_path).trajectory(name) == slower
    assert best.get("nothing/00") is None
    (tmp_path / "best" / f"{name}.npz").write_bytes(b"changed")
    with pytest.raises(fp.InvalidInput, match="unchanged"):
        own.trajectory(name)


def test_what_is_better_in_results_of_others_is_kept(problems, best, submitted, tmp_path):
    name = "paper/03"
    folder, own = submitted({name: best.trajectory(name)}), BestPlans(tmp_path / "own")
    own.folder.mkdir()
    row = best.get(name)
    own.put(replace(row, objective=row.objective - 1.0), best.trajectory(name))
    assert adopted(folder, problems, own) == []
    own.put(replace(row, objective=row.objective + 1.0), best.trajectory(name))
    assert adopted(folder, problems, own) == [name]
    assert own.get(name).objective == pytest.approx(row.objective, rel=1e-9)
    assert own.get(name).planner == "theirs"
    assert own.get(name).bound == row.bound


def test_a_problem_without_a_plan_has_no_gap():
    assert BestPlan("traps/00", 3.0, "straight way").gap is None
