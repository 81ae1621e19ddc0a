"""The summary of a plan in rows."""

import ffsr_plan as fp
from ffsr_plan.plans.plan_summary import plan_rows


def test_rows_are_pairs_of_texts(fig2a_plan):
    rows = dict(plan_rows(fig2a_plan))
    assert list(rows)[:3] == ["length L", "objective F", "on the lattice"]
    assert rows["length L"] == f"{fig2a_plan.length:.4f} m"
    assert "gap" in rows["on the lattice"]
    assert rows["planner"].startswith("ant-system, seed 0, ")
    assert not [name for name in rows if name.startswith("wheels")]


def test_an_empty_scene_has_no_clearances(robot):
    goal = robot.configuration((3, 0, 0), (0.1, 0, 0))
    lattice = fp.Lattice(4)
    problem = fp.Problem(robot, fp.Scene(), robot.neutral(), goal, "attitude-held", lattice)
    plan = fp.plan(problem, fp.LatticeOptimum())
    rows = dict(plan_rows(plan, duration=60.0))
    assert rows["clearance at nodes"] == rows["proven along the motion"] == "no obstacles"
    assert rows["planner"] == "lattice-optimum"
    assert rows["wheels, if it takes 60 s"].endswith("N m s in base axes")
